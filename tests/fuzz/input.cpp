// SPDX-License-Identifier: Apache-2.0
#include "fuzz/input.h"

#include <raycontact/error.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace raycontact::fuzz {

namespace {
std::uint64_t taken_so_far = 0;
}

void fail(std::string_view what) {
    std::fprintf(stderr, "finding: %.*s\n", static_cast<int>(what.size()), what.data());
    std::abort();
}

bool taken(const std::function<void()>& read) {
    try {
        read();
        ++taken_so_far;
        return true;
    } catch (const InputError& error) {
        const std::string_view text = error.what();
        if (text.empty()) fail("an error without words");
        if (text.find_first_of("\r\n") != std::string_view::npos) fail("an error of several lines");
        if (text.size() > 2000) fail("an error too long to read");
    } catch (const std::exception& other) {
        fail(std::string("no InputError: ") + other.what());
    }
    return false;
}

std::uint64_t times_taken() {
    return taken_so_far;
}

} // namespace raycontact::fuzz
