// SPDX-License-Identifier: Apache-2.0
// What others wrote, fit for a message.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace raycontact {

/// One line whatever the text holds, not cut: a whole path, or a library's message.
inline std::string printable(std::string_view text) {
    std::string out(text);
    std::ranges::replace_if(
        out, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    return out;
}

/// Text from a file or a user in quotes, cut to a length, without control characters.
inline std::string in_quotes(std::string_view text) {
    constexpr std::size_t longest = 24;
    std::string out(text.substr(0, longest));
    // Bytes of a damaged file need not be UTF-8, which JSON and terminals expect.
    std::ranges::replace_if(
        out, [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
    return "'" + out + (text.size() > longest ? "...'" : "'");
}

} // namespace raycontact
