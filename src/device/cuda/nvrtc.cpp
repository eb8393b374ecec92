// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/nvrtc.h"

#include "device/device.h"
#include "platform/system.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace raycontact::cuda {

namespace {

namespace fs = std::filesystem;

/// Where NVRTC may be: paths, and names for the loader.
struct NvrtcPlaces {
    std::vector<std::string> given, others; ///< of RAYCONTACT_NVRTC; all others
};

template <typename Iterator>
std::vector<fs::path> entries(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (Iterator at(folder, error), end; !error && at != end; at.increment(error)) found.push_back(at->path());
    std::sort(found.rbegin(), found.rend());
    return found;
}

// Where toolkits and Python's packages keep shared libraries.
constexpr const char* folder_in_toolkit = platform::on_windows ? "bin" : "lib64";
constexpr const char* folder_in_package = platform::on_windows ? "bin" : "lib";

// libnvrtc.so, .so.12, .so.13, .so.12.4.127, or nvrtc64_120_0.dll: not its builtins, not the .alt variant.
bool is_nvrtc(const std::string& name) {
    if (!platform::on_windows) return name.starts_with("libnvrtc.so");
    return name.starts_with("nvrtc64_") && name.ends_with("_0.dll");
}

// The newest first.
void add(std::vector<std::string>& list, const std::vector<fs::path>& files) {
    for (const fs::path& file : files)
        if (is_nvrtc(file.filename().string())) list.push_back(file.string());
}

void add_package(std::vector<std::string>& list, const fs::path& packages) {
    for (const char* package : {"cu13", "cuda_nvrtc"})
        add(list, entries<fs::directory_iterator>(packages / "nvidia" / package / folder_in_package));
}

// The packages nvidia-cuda-nvrtc (13 and later) and nvidia-cuda-nvrtc-cu12, of each Python under a prefix.
void add_packages(std::vector<std::string>& list, const fs::path& prefix) {
    if (platform::on_windows) return add_package(list, prefix / "Lib" / "site-packages");
    for (const fs::path& python : entries<fs::directory_iterator>(prefix / "lib")) {
        if (!python.filename().string().starts_with("python3")) continue;
        for (const char* packages : {"site-packages", "dist-packages"}) add_package(list, python / packages);
    }
}

NvrtcPlaces nvrtc_places() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return fs::path(value ? value : "");
    };
    NvrtcPlaces places;
    if (const fs::path given = variable("RAYCONTACT_NVRTC"); !given.empty()) {
        std::error_code error;
        if (fs::is_regular_file(given, error)) places.given.push_back(given.string());
        add(places.given, entries<fs::recursive_directory_iterator>(given));
    }
    if (platform::on_windows)
        places.others = {"nvrtc64_130_0.dll", "nvrtc64_120_0.dll"};
    else
        places.others = {"libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so"};
    for (const fs::path& toolkit : {variable("CUDA_HOME"), variable("CUDA_PATH"), fs::path("/usr/local/cuda")})
        if (!toolkit.empty()) add(places.others, entries<fs::directory_iterator>(toolkit / folder_in_toolkit));
    if (const fs::path environment = variable("VIRTUAL_ENV"); !environment.empty())
        add_packages(places.others, environment);
    if (const fs::path home = variable("HOME"); !home.empty()) add_packages(places.others, home / ".local");
    add_packages(places.others, "/usr/local");
    return places;
}

} // namespace

// The few functions used, declared as its binary interface is; status 0 is success.
struct Nvrtc::Api {
    explicit Api(const std::string& path) : library(path) {}

    using Program = void*;
    template <typename... Parameters>
    using Call = platform::Function<int(Parameters...)>;
    platform::Library library;
    Call<int*, int*> version{library, "nvrtcVersion"};
    Call<int*> architecture_count{library, "nvrtcGetNumSupportedArchs"};
    Call<int*> architectures{library, "nvrtcGetSupportedArchs"};
    Call<Program*, const char*, const char*, int, const char* const*, const char* const*> create{library,
                                                                                                 "nvrtcCreateProgram"};
    Call<Program*> destroy{library, "nvrtcDestroyProgram"};
    Call<Program, int, const char* const*> compile{library, "nvrtcCompileProgram"};
    Call<Program, std::size_t*> log_size{library, "nvrtcGetProgramLogSize"};
    Call<Program, char*> log{library, "nvrtcGetProgramLog"};
    Call<Program, std::size_t*> ptx_size{library, "nvrtcGetPTXSize"};
    Call<Program, char*> ptx{library, "nvrtcGetPTX"};
    Call<Program, std::size_t*> cubin_size{library, "nvrtcGetCUBINSize"};
    Call<Program, char*> cubin{library, "nvrtcGetCUBIN"};
    platform::Function<const char*(int)> error_text{library, "nvrtcGetErrorString"};

    void check(int status, const char* call) const {
        if (status != 0) throw DeviceError(std::string(call) + ": " + error_text(status));
    }
    /// Text or image of a program, in two calls.
    std::string fetch(Program program, const auto& size_of, const auto& get, const char* call) const {
        std::size_t size = 0;
        check(size_of(program, &size), call);
        std::string text(size, '\0');
        check(get(program, text.data()), call);
        return text;
    }
};

Nvrtc::Nvrtc(int driver_major) {
    const NvrtcPlaces places = nvrtc_places();
    const auto take = [&](const std::vector<std::string>& paths, int newest) {
        for (const std::string& path : paths) {
            auto api = std::make_unique<const Api>(path);
            if (!api->library || !api->library.missing().empty()) continue;
            api->check(api->version(&major_, &minor_), "nvrtcVersion");
            if (major_ > newest) continue;
            api_ = std::move(api);
            return true;
        }
        return false;
    };
    constexpr int any = 1 << 30;
    if (!take(places.given, driver_major) && !take(places.given, any) && !take(places.others, driver_major)
        && !take(places.others, any))
        throw DeviceError("NVRTC, the compiler that its kernels need, is not installed; "
                          + std::string(how_to_install));
    int count = 0;
    api_->check(api_->architecture_count(&count), "nvrtcGetNumSupportedArchs");
    architectures_.resize(static_cast<std::size_t>(count));
    api_->check(api_->architectures(architectures_.data()), "nvrtcGetSupportedArchs");
    std::sort(architectures_.begin(), architectures_.end());
}

Nvrtc::~Nvrtc() = default;

Nvrtc::Compiled Nvrtc::compile(const std::string& text, const std::vector<std::string>& options) const {
    Api::Program made = nullptr;
    api_->check(api_->create(&made, text.c_str(), "kernels.cu", 0, nullptr, nullptr), "nvrtcCreateProgram");
    const auto destroy = [this](Api::Program program) { api_->destroy(&program); };
    const std::unique_ptr<void, decltype(destroy)> program(made, destroy);

    std::vector<const char*> given;
    given.reserve(options.size());
    for (const std::string& option : options) given.push_back(option.c_str());
    const int status = api_->compile(made, static_cast<int>(given.size()), given.data());
    Compiled compiled;
    compiled.log = api_->fetch(made, api_->log_size, api_->log, "nvrtcGetProgramLog");
    compiled.log.resize(compiled.log.find_last_not_of(std::string_view("\0 \n", 3)) + 1);
    if (status != 0)
        throw DeviceError(std::string("nvrtcCompileProgram: ") + api_->error_text(status) + "\n" + compiled.log);

    const bool binary = std::any_of(options.begin(), options.end(), [](const std::string& option) {
        return option.starts_with("--gpu-architecture=sm_");
    });
    compiled.image = binary ? api_->fetch(made, api_->cubin_size, api_->cubin, "nvrtcGetCUBIN")
                            : api_->fetch(made, api_->ptx_size, api_->ptx, "nvrtcGetPTX");
    return compiled;
}

} // namespace raycontact::cuda
