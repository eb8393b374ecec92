// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iostream>
#include <string>
#include <string_view>

/// One line on stderr, whatever a file name or a library put into the message.
inline void complain(std::string_view program, std::string_view message) {
    std::string line = std::string(program) + ": ";
    for (const char c : message) line += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
    std::cerr << line << '\n';
}
