// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>

#include <atomic>

namespace raycontact {

/// Thrown by what was ended as an Interruptible says. Not a std::exception: it is no fault, and nobody mends it.
class RAYCONTACT_API Interrupted {};

/// For as long as it lives, what its thread calls, and what that runs on other threads, throws Interrupted soon after
/// the flag has become true: any thread may set it, and a signal handler. Shapes, files and answers are then not made;
/// of a Scene the step is undone, so that the next one finds its contacts anew. Opening a device and a step on a GPU
/// come to their end first.
class RAYCONTACT_API Interruptible {
public:
    /// flag: must live as long; null: nothing ends, whatever was asked for before.
    explicit Interruptible(const std::atomic<bool>* flag);
    ~Interruptible();
    Interruptible(const Interruptible&) = delete;
    Interruptible& operator=(const Interruptible&) = delete;

private:
    const std::atomic<bool>* outer_;
};

} // namespace raycontact
