// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>

#include <stdexcept>
#include <string>

namespace raycontact {

/// Bad input or bad usage: the text says what is wrong, where, and what to do about it, in one line.
/// The program turns it into exit status 2; every other exception is a failed run, status 1.
class RAYCONTACT_API InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

} // namespace raycontact
