// SPDX-License-Identifier: Apache-2.0
#include "device/nvrtc.h"

#include <algorithm>
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <stdexcept>

namespace raycontact::device_test {

namespace {

namespace fs = std::filesystem;

// libnvrtc.so, .so.12, .so.13, .so.12.4.127: not its builtins, not the .alt variant.
std::vector<std::string> libraries_under(const fs::path& folder) {
    std::vector<std::string> found;
    std::error_code error;
    for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        if (at->path().filename().string().starts_with("libnvrtc.so")) found.push_back(at->path().string());
    std::sort(found.rbegin(), found.rend());
    return found;
}

std::vector<std::string> candidates() {
    std::vector<std::string> list;
    const auto add_all = [&](const fs::path& place) {
        std::error_code error;
        if (fs::is_regular_file(place, error)) list.push_back(place.string());
        for (std::string& file : libraries_under(place)) list.push_back(std::move(file));
    };
    if (const char* given = std::getenv("RAYCONTACT_NVRTC")) add_all(given);
    for (const char* name : {"libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so"}) list.emplace_back(name);
    for (const char* variable : {"CUDA_HOME", "CUDA_PATH"})
        if (const char* toolkit = std::getenv(variable)) add_all(fs::path(toolkit) / "lib64");
    add_all("/usr/local/cuda/lib64");
    return list;
}

} // namespace

// The few functions used, declared as nvrtc.h does; status 0 is success.
struct Nvrtc::Api {
    using Program = void*;
    struct Close {
        void operator()(void* handle) const { dlclose(handle); }
    };
    std::unique_ptr<void, Close> library;
    int (*version)(int*, int*) = nullptr;
    int (*create)(Program*, const char*, const char*, int, const char* const*, const char* const*) = nullptr;
    int (*destroy)(Program*) = nullptr;
    int (*compile)(Program, int, const char* const*) = nullptr;
    int (*log_size)(Program, std::size_t*) = nullptr;
    int (*log)(Program, char*) = nullptr;
    int (*ptx_size)(Program, std::size_t*) = nullptr;
    int (*ptx)(Program, char*) = nullptr;
    const char* (*error_text)(int) = nullptr;

    template <typename Function>
    void find(Function& function, const char* name) {
        function = reinterpret_cast<Function>(dlsym(library.get(), name));
        if (!function) throw std::runtime_error(std::string(name) + " is not in the NVRTC library found");
    }
    void check(int status, const char* call) const {
        if (status != 0) throw std::runtime_error(std::string(call) + ": " + error_text(status));
    }
};

Nvrtc::Nvrtc() : api_(std::make_unique<Api>()) {
    std::string tried;
    for (const std::string& candidate : candidates()) {
        api_->library.reset(dlopen(candidate.c_str(), RTLD_NOW | RTLD_LOCAL));
        if (api_->library) break;
        tried += " " + candidate;
    }
    if (!api_->library)
        throw std::runtime_error("NVRTC is not installed (tried" + tried
                                 + "); run scripts/fetch-nvrtc, or set RAYCONTACT_NVRTC to its folder");
    api_->find(api_->version, "nvrtcVersion");
    api_->find(api_->create, "nvrtcCreateProgram");
    api_->find(api_->destroy, "nvrtcDestroyProgram");
    api_->find(api_->compile, "nvrtcCompileProgram");
    api_->find(api_->log_size, "nvrtcGetProgramLogSize");
    api_->find(api_->log, "nvrtcGetProgramLog");
    api_->find(api_->ptx_size, "nvrtcGetPTXSize");
    api_->find(api_->ptx, "nvrtcGetPTX");
    api_->find(api_->error_text, "nvrtcGetErrorString");
}

Nvrtc::~Nvrtc() = default;

std::string Nvrtc::version() const {
    int major = 0, minor = 0;
    api_->check(api_->version(&major, &minor), "nvrtcVersion");
    return std::to_string(major) + "." + std::to_string(minor);
}

std::string Nvrtc::compile(const std::string& text, const std::vector<std::string>& options) const {
    Api::Program made = nullptr;
    api_->check(api_->create(&made, text.c_str(), "kernels.cu", 0, nullptr, nullptr), "nvrtcCreateProgram");
    const auto destroy = [this](Api::Program program) { api_->destroy(&program); };
    const std::unique_ptr<void, decltype(destroy)> program(made, destroy);

    std::vector<const char*> given;
    given.reserve(options.size());
    for (const std::string& option : options) given.push_back(option.c_str());
    const int status = api_->compile(made, static_cast<int>(given.size()), given.data());
    std::size_t size = 0;
    api_->check(api_->log_size(made, &size), "nvrtcGetProgramLogSize");
    std::string log(size, '\0');
    api_->check(api_->log(made, log.data()), "nvrtcGetProgramLog");
    log.resize(log.find_last_not_of(std::string("\0 \n", 3)) + 1);
    if (status != 0 || !log.empty())
        throw std::runtime_error(std::string("nvrtcCompileProgram: ") + api_->error_text(status) + "\n" + log);

    api_->check(api_->ptx_size(made, &size), "nvrtcGetPTXSize");
    std::string ptx(size, '\0');
    api_->check(api_->ptx(made, ptx.data()), "nvrtcGetPTX");
    return ptx;
}

} // namespace raycontact::device_test
