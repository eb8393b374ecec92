// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace raycontact {

/// What names a device: "cpu", "cpu/1" (one core), "cuda:0", "opencl:0", "opencl:0/1" (one core of it).
struct DeviceId {
    std::string kind; ///< "cpu", "cuda", "opencl"
    std::uint32_t index = 0;
    std::optional<std::uint32_t> part;

    /// Throws InputError for a text that is none. Says nothing of whether such a device is there.
    static DeviceId read(std::string_view text);
    std::string whole() const; ///< without the part
    std::string text() const;

    friend bool operator==(const DeviceId&, const DeviceId&) = default;
};

/// "use opencl:0 to opencl:2"
std::string use_one_of(const std::string& prefix, std::size_t count);

} // namespace raycontact
