// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>

#include <stdexcept>
#include <string>

namespace raycontact {

/// Bad input or bad usage: the text says what is wrong, where, and what to do about it, in one line.
/// The program turns it into exit status 2; every other exception is a failed run, status 1.
///
/// Each function says when it throws InputError, and when it throws std::runtime_error, for what failed though the
/// input was good: a device, a disk. Any may throw std::bad_alloc; any that prepares meshes, makes shapes or finds
/// contacts may throw std::runtime_error where the system gives no threads. What a callback throws passes through. A
/// function that says nothing throws nothing else, and Interrupted only as an Interruptible has it.
class RAYCONTACT_API InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

} // namespace raycontact
