// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/nvrtc_search.h"

#include "platform/system.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace raycontact::cuda {

namespace {

namespace fs = std::filesystem;

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

} // namespace

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

} // namespace raycontact::cuda
