// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact::cuda {

/// What to do where there is no NVRTC, or only one that does not suit the driver.
inline constexpr std::string_view how_to_install =
    "`pip install --target FOLDER nvidia-cuda-nvrtc-cu12==12.9.86` and set RAYCONTACT_NVRTC to FOLDER";

/// NVIDIA's run-time compiler, which turns the kernels' text into what a driver loads. Its library is looked for
/// - in RAYCONTACT_NVRTC: a library, or a folder that is searched through,
/// - where the loader looks,
/// - in CUDA toolkits: CUDA_HOME, CUDA_PATH, /usr/local/cuda,
/// - in Python's packages of the active virtual environment, of the user and of the system.
class Nvrtc {
public:
    /// Takes the first that is not of a newer CUDA than the driver; if all are newer, or the first is named by
    /// RAYCONTACT_NVRTC, the first. Throws DeviceError if there is none, with what to do.
    explicit Nvrtc(int driver_major);
    ~Nvrtc();
    Nvrtc(const Nvrtc&) = delete;
    Nvrtc& operator=(const Nvrtc&) = delete;

    int major() const { return major_; }
    std::string version() const { return std::to_string(major_) + "." + std::to_string(minor_); }
    /// That it knows, ascending: 75 for a compute capability of 7.5.
    const std::vector<int>& architectures() const { return architectures_; }

    struct Compiled {
        std::string image; ///< for --gpu-architecture=sm_XY a cubin, for compute_XY a PTX text
        std::string log;   ///< its warnings
    };
    /// Throws DeviceError, with the log, for a text that does not compile.
    Compiled compile(const std::string& text, const std::vector<std::string>& options) const;

private:
    struct Api;
    std::unique_ptr<const Api> api_;
    int major_ = 0, minor_ = 0;
    std::vector<int> architectures_;
};

} // namespace raycontact::cuda
