// SPDX-License-Identifier: Apache-2.0
// Listing and opening: what is shown, compiled, kept, and refused.
#include "device/cuda/fake_machine.h"

#include "device/cuda/device.h"
#include "device/cuda/image.h"
#include "device/gpu/launches.h"

#include <raycontact/error.h>

#include <fstream>
#include <set>

using namespace raycontact;

namespace {

using Open = cuda_test::FakeMachine;
namespace fs = std::filesystem;

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST_F(Open, lists_what_the_driver_shows_before_opencl) {
    cuda.devices = 2;
    const std::vector<DeviceInfo> all = list_devices();
    ASSERT_GE(all.size(), 3u);
    EXPECT_EQ(all[0].id, "cpu");
    for (std::size_t i = 0; i < 2; ++i) {
        const DeviceInfo& info = all[i + 1];
        EXPECT_EQ(info.id, "cuda:" + std::to_string(i));
        EXPECT_EQ(info.kind, "cuda");
        EXPECT_EQ(info.type, "gpu");
        EXPECT_EQ(info.bus, "0000:6a:0" + std::to_string(i) + ".0");
        EXPECT_EQ(info.name, "Test GPU");
        EXPECT_EQ(info.driver, "CUDA 12.8");
        EXPECT_EQ(info.cores, 132u);
        EXPECT_EQ(info.memory_bytes, std::uint64_t{80} << 30);
        EXPECT_TRUE(info.exact && info.usable);
        EXPECT_EQ(info.why_not, "");
    }
    for (std::size_t i = 3; i < all.size(); ++i) EXPECT_NE(all[i].kind, "cuda");
    EXPECT_EQ(nvrtc.count("nvrtcCompileProgram"), 0u);
}

TEST_F(Open, what_is_not_there_is_bad_usage) {
    EXPECT_TRUE(contains(refusal("cuda:7"), "'cuda:7': there is none; use cuda:0"));
    for (const char* id : {"cuda:", "cuda:x", "cuda:0/0", "cuda:-1"})
        EXPECT_TRUE(contains(refusal(id), std::string("'") + id + "': give cpu, cpu/k, cuda:i")) << id;
    cuda.devices = 0;
    EXPECT_TRUE(contains(refusal(), "shows no device")) << refusal();
    cuda.fails = "cuInit";
    EXPECT_TRUE(contains(refusal(), "does not start: cuInit: CUDA_ERROR_FAKE (it was told to fail)")) << refusal();
    EXPECT_THROW(cuda::open("cuda:0", true), InputError);
    EXPECT_EQ(cuda::describe().size(), 0u);
}

TEST_F(Open, a_device_that_fails_when_asked_is_listed_as_such) {
    cuda.fails = "cuDeviceTotalMem_v2";
    const std::vector<DeviceInfo> infos = cuda::describe();
    ASSERT_EQ(infos.size(), 1u);
    EXPECT_FALSE(infos[0].usable);
    EXPECT_TRUE(contains(infos[0].why_not, "cuDeviceTotalMem: CUDA_ERROR_FAKE")) << infos[0].why_not;
    EXPECT_THROW(cuda::open("cuda:0", true), InputError);
}

TEST_F(Open, bits_that_differ_are_refused) {
    EXPECT_TRUE(contains(refusal("cuda:0", false), "products that it computed are not the host's"));
    EXPECT_THROW(cuda::open("cuda:0", false), InputError);
    const auto device = open();
    EXPECT_FALSE(device->info().exact);
    EXPECT_FALSE(device->traits().has_double);
    EXPECT_FALSE(device->traits().shares_memory);
}

// Nothing is loaded or compiled in a step.
TEST_F(Open, launches_every_kernel_once) {
    open();
    std::set<std::string> launched;
    for (const auto& launch : cuda.launches) launched.insert(launch.kernel);
#define RAYCONTACT_KERNEL(name) EXPECT_EQ(launched.count(#name), 1u) << #name;
#define RAYCONTACT_CPU_KERNEL(name) EXPECT_EQ(launched.count(#name), 0u) << #name;
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
    for (const char* name : gpu::scan_kernels) EXPECT_EQ(launched.count(name), 1u) << name;
    EXPECT_EQ(cuda.alive, 0u) << "closed again";
}

TEST_F(Open, compiles_for_the_device_with_exact_options) {
    open();
    const std::vector<std::string> expected = {"--fmad=false", "--prec-div=true", "--prec-sqrt=true",
                                               "--ftz=false",  "--std=c++17",     "--gpu-architecture=sm_90"};
    EXPECT_EQ(nvrtc.options, expected);
}

TEST_F(Open, what_was_compiled_is_kept) {
    open();
    EXPECT_EQ(nvrtc.count("nvrtcCompileProgram"), 1u);
    open();
    EXPECT_EQ(nvrtc.count("nvrtcCompileProgram"), 1u);
    std::size_t files = 0;
    for (const auto& file : fs::directory_iterator(cache)) {
        EXPECT_EQ(file.path().extension(), ".cubin");
        ++files;
    }
    EXPECT_EQ(files, 1u);

    cuda.architecture = 80; // another device, another text
    open();
    EXPECT_EQ(nvrtc.count("nvrtcCompileProgram"), 2u);
    cuda::open("cuda:0", true, [](cuda::Source& source) { source.text += "// more\n"; });
    EXPECT_EQ(nvrtc.count("nvrtcCompileProgram"), 3u);
}

TEST_F(Open, a_damaged_file_is_compiled_again) {
    open();
    const fs::path file = fs::directory_iterator(cache)->path();
    const auto size = static_cast<std::streamoff>(fs::file_size(file));
    std::size_t compiled = 1;
    const auto damage = [&](const auto& how) {
        how();
        open();
        EXPECT_EQ(nvrtc.count("nvrtcCompileProgram"), ++compiled);
        open(); // whole again
        EXPECT_EQ(nvrtc.count("nvrtcCompileProgram"), compiled);
    };
    for (const std::streamoff at : {std::streamoff{0}, std::streamoff{9}, size / 2, size - 1})
        damage([&] {
            std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
            stream.seekg(at);
            const int letter = stream.get();
            stream.seekp(at);
            stream.put(static_cast<char>(letter ^ 1));
        });
    for (const std::streamoff kept : {std::streamoff{0}, std::streamoff{5}, std::streamoff{16}, size - 1})
        damage([&] { fs::resize_file(file, static_cast<std::uintmax_t>(kept)); });
    damage([&] { std::ofstream(file, std::ios::app) << 'x'; });
}

TEST_F(Open, a_cache_that_cannot_be_written_fails_nothing) {
    std::ofstream(cache) << "a file, no folder"; // not even by root
    EXPECT_EQ(refusal(), "");
    EXPECT_EQ(refusal(), "");
    EXPECT_EQ(nvrtc.count("nvrtcCompileProgram"), 2u);
    fs::remove(cache);
    open();
    const fs::path file = fs::directory_iterator(cache)->path();
    fs::remove(file);
    fs::create_directory(file); // where the file should be
    EXPECT_EQ(refusal(), "");
    EXPECT_EQ(std::distance(fs::directory_iterator(cache), fs::directory_iterator()), 1) << "no part is left";
}

TEST_F(Open, a_compiler_newer_than_the_driver_makes_ptx_that_the_driver_reads) {
    nvrtc.major = 13;
    EXPECT_EQ(refusal(), "");
    EXPECT_EQ(nvrtc.options.back(), "--gpu-architecture=compute_50");
    EXPECT_EQ(fs::directory_iterator(cache)->path().extension(), ".ptx");
    EXPECT_EQ(refusal(), "");
    EXPECT_EQ(nvrtc.count("nvrtcCompileProgram"), 1u);
}

TEST_F(Open, a_gpu_newer_than_the_compiler_gets_ptx) {
    cuda.version = 13010;
    cuda.architecture = 103;
    EXPECT_EQ(refusal(), "");
    EXPECT_EQ(nvrtc.options.back(), "--gpu-architecture=compute_90");
    cuda.architecture = 35;
    EXPECT_TRUE(contains(refusal(), "does not know so old a GPU; `pip install")) << refusal();
}

TEST_F(Open, a_text_that_does_not_compile_shows_the_log) {
    try {
        cuda::open("cuda:0", true, [](cuda::Source& source) { source.text += "nonsense"; });
        FAIL();
    } catch (const DeviceError& error) {
        EXPECT_TRUE(contains(error.what(), "nonsense?")) << error.what();
        EXPECT_TRUE(contains(error.what(), "'cuda:0' (Test GPU) did not open")) << error.what();
    }
}

} // namespace
