// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/image.h"

#include "device/device.h"
#include "kernels_cuda.h"
#include "platform/system.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <xxhash.h>

namespace raycontact::cuda {

namespace {

namespace fs = std::filesystem;

// At the beginning of a file: length and hash of what follows.
using Head = std::array<std::uint64_t, 2>;
Head head_of(std::string_view bytes) {
    return {bytes.size(), XXH3_64bits(bytes.data(), bytes.size())};
}

/// What was compiled, kept in files from run to run, in $RAYCONTACT_CACHE, else $XDG_CACHE_HOME/raycontact, else
/// ~/.cache/raycontact (%LOCALAPPDATA%\raycontact on Windows). It never fails: what cannot be read, or was damaged, is
/// not there.
class Cache {
public:
    Cache() {
        const char* own = std::getenv("RAYCONTACT_CACHE");
        if (own && *own != '\0')
            folder_ = own;
        else if (const fs::path all = platform::cache_folder(); !all.empty())
            folder_ = (all / "raycontact").string();
    }

    std::optional<std::string> load(const std::string& name) const {
        if (folder_.empty()) return std::nullopt;
        std::ifstream file(fs::path(folder_) / name, std::ios::binary);
        std::ostringstream all; // what throws where it cannot be read is caught in here
        all << file.rdbuf();
        std::string bytes = std::move(all).str();
        Head head{};
        if (bytes.size() < sizeof head) return std::nullopt;
        std::memcpy(head.data(), bytes.data(), sizeof head);
        bytes.erase(0, sizeof head);
        return head == head_of(bytes) ? std::optional(std::move(bytes)) : std::nullopt;
    }

    void store(const std::string& name, const std::string& bytes) const {
        if (folder_.empty()) return;
        std::error_code error;
        fs::create_directories(folder_, error);
        // A name that no other process or thread has; renamed when it is whole.
        static std::atomic<unsigned> number = 0;
        const fs::path whole = fs::path(folder_) / name;
        const fs::path part =
            whole.string() + "." + std::to_string(platform::process_id()) + "-" + std::to_string(number++);
        const Head head = head_of(bytes);
        std::ofstream file(part, std::ios::binary);
        file.write(reinterpret_cast<const char*>(head.data()), sizeof head);
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        file.close();
        if (file) fs::rename(part, whole, error);
        if (!file || error) fs::remove(part, error);
    }

private:
    std::string folder_; ///< empty: nothing is kept
};

struct Target {
    std::string architecture; ///< as --gpu-architecture takes it
    std::string ptx_version;  ///< that the driver can read; empty: what the compiler writes
};

Target target_for(const Nvrtc& nvrtc, int architecture, int driver_major) {
    const std::vector<int>& known = nvrtc.architectures();
    const bool newer = nvrtc.major() > driver_major;
    if (!newer && std::find(known.begin(), known.end(), architecture) != known.end())
        return {"sm_" + std::to_string(architecture), ""};
    if (known.empty() || known.front() > architecture)
        throw DeviceError("NVRTC " + nvrtc.version() + " does not know so old a GPU; " + std::string(how_to_install));
    // A PTX text runs on every newer architecture. An older driver reads the oldest one, marked as of its own CUDA:
    // CUDA 11 brought PTX 7.0, CUDA 12 brought 8.0. Our kernels need nothing newer.
    if (newer) return {"compute_" + std::to_string(known.front()), std::to_string(driver_major - 4) + ".0"};
    const auto above = std::upper_bound(known.begin(), known.end(), architecture);
    return {"compute_" + std::to_string(*(above - 1)), ""};
}

void set_ptx_version(std::string& ptx, const std::string& version) {
    const std::string mark = "\n.version ";
    const std::size_t at = ptx.find(mark);
    if (at == std::string::npos) return;
    const std::size_t begin = at + mark.size();
    ptx.replace(begin, ptx.find('\n', begin) - begin, version);
}

// Everything that decides what comes out.
std::string name_for(const Nvrtc& nvrtc, const Source& source, const std::vector<std::string>& options,
                     const Target& target) {
    std::string all = nvrtc.version() + '\0' + target.ptx_version + '\0';
    for (const std::string& option : options) all += option + '\0';
    all += source.text;
    const XXH128_hash_t hash = XXH3_128bits(all.data(), all.size());
    std::array<char, 33> digits{};
    std::snprintf(digits.data(), digits.size(), "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                  static_cast<unsigned long long>(hash.low64));
    return digits.data() + std::string(target.architecture.starts_with("sm_") ? ".cubin" : ".ptx");
}

} // namespace

Source exact_source() {
    return {kernel_text(cuda_pieces, true),
            {"--fmad=false", "--prec-div=true", "--prec-sqrt=true", "--ftz=false", "--std=c++17"}};
}

std::string image_for(const Nvrtc& nvrtc, const Source& source, int architecture, int driver_major) {
    const Target target = target_for(nvrtc, architecture, driver_major);
    std::vector<std::string> options = source.options;
    options.push_back("--gpu-architecture=" + target.architecture);
    const Cache cache;
    const std::string name = name_for(nvrtc, source, options, target);
    if (auto kept = cache.load(name)) return *std::move(kept);
    std::string image = nvrtc.compile(source.text, options).image;
    if (!target.ptx_version.empty()) set_ptx_version(image, target.ptx_version);
    cache.store(name, image);
    return image;
}

} // namespace raycontact::cuda
