// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <string>
#include <string_view>

namespace raycontact::gpu {

/// Whether all of the text is a number.
inline bool read_number(std::string_view text, std::size_t& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size();
}

/// "use opencl:0 to opencl:2"
inline std::string use_one_of(const std::string& prefix, std::size_t count) {
    return "use " + prefix + "0" + (count > 1 ? " to " + prefix + std::to_string(count - 1) : "");
}

} // namespace raycontact::gpu
