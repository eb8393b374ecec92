// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string_view>

namespace raycontact {

/// How many lists and objects of a JSON text lie in one another at most. Asked before it is parsed: a parser keeps some
/// hundred bytes for each level, of a text that may be nothing but brackets.
inline int json_depth(std::string_view text) {
    int now = 0, most = 0;
    bool in_text = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"')
            in_text = !in_text;
        else if (in_text)
            i += c == '\\' ? 1 : 0; // and what it escapes
        else if (c == '[' || c == '{')
            most = std::max(most, ++now);
        else if (c == ']' || c == '}')
            --now;
    }
    return most;
}

} // namespace raycontact
