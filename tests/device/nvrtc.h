// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace raycontact::device_test {

/// NVIDIA's run-time compiler, loaded when asked for: from RAYCONTACT_NVRTC (a library, or a folder searched through),
/// from the loader's own paths, or from a CUDA toolkit.
class Nvrtc {
public:
    /// Throws std::runtime_error saying where it looked.
    Nvrtc();
    ~Nvrtc();
    Nvrtc(const Nvrtc&) = delete;
    Nvrtc& operator=(const Nvrtc&) = delete;

    /// The PTX. Throws std::runtime_error with the log for a text that does not compile, or compiles with warnings.
    std::string compile(const std::string& text, const std::vector<std::string>& options) const;
    std::string version() const;

private:
    struct Api;
    std::unique_ptr<Api> api_;
};

} // namespace raycontact::device_test
