// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/fake_machine.h"

#include "device/cuda/device.h"

#include <cstdlib>
#include <dlfcn.h>
#include <stdexcept>
#include <unistd.h>

namespace raycontact::cuda_test {

namespace {

template <typename Fake>
Fake& find(const char* library, const char* name) {
    void* loaded = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    auto* get = loaded ? reinterpret_cast<Fake* (*)()>(dlsym(loaded, name)) : nullptr;
    if (!get) throw std::runtime_error(std::string(library) + " is not the test's; run this by ctest");
    return *get();
}

const char* compiler() {
    const char* path = std::getenv("RAYCONTACT_NVRTC");
    return path ? path : "libnvrtc.so.12";
}

} // namespace

FakeMachine::FakeMachine()
    : cuda(find<FakeCuda>("libcuda.so.1", "raycontact_fake_cuda")),
      nvrtc(find<FakeNvrtc>(compiler(), "raycontact_fake_nvrtc")),
      cache(std::filesystem::temp_directory_path() / ("raycontact-cuda-test-" + std::to_string(getpid()))) {
    setenv("RAYCONTACT_CACHE", cache.c_str(), 1);
    std::filesystem::remove_all(cache);
    cuda.reset();
    nvrtc.reset();
}

FakeMachine::~FakeMachine() {
    EXPECT_EQ(cuda.misuse, std::vector<std::string>{});
    std::filesystem::remove_all(cache);
}

std::unique_ptr<Device> FakeMachine::open() {
    return raycontact::cuda::open("cuda:0", true);
}

std::string FakeMachine::refusal(const char* id, bool inexact) {
    try {
        raycontact::cuda::open(id, inexact);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "";
}

} // namespace raycontact::cuda_test
