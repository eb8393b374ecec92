// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/interruption.h>

#include <Python.h>

#include <atomic>
#include <optional>

namespace raycontact::python {

/// Lets Python's other threads run for as long as it lives. Before 3.14 a thread that asks for the GIL while the
/// interpreter ends is ended itself, in the middle of C++ frames, which aborts the process; here it sleeps until the
/// process is gone.
/// In the main thread, where Python's own handler would raise KeyboardInterrupt, Ctrl-C ends what is computed: it
/// throws Interrupted, for which the module raises what the handler does.
class WithoutGil {
public:
    WithoutGil(); ///< throws nanobind::python_error where Ctrl-C was pressed just before
    ~WithoutGil();
    WithoutGil(const WithoutGil&) = delete;
    WithoutGil& operator=(const WithoutGil&) = delete;

    /// Takes the GIL for a moment to ask whether Ctrl-C was pressed; throws nanobind::python_error if so.
    void check_signals();
    /// For Interruptible on other threads; null: Ctrl-C does not count.
    const std::atomic<bool>* flag() const;

private:
    void take_back();
    bool listens_;
    std::optional<Interruptible> interruptible_;
    PyThreadState* state_ = nullptr;
};

/// The interpreter is about to end: work of threads other than the main one is not wanted any more.
bool is_ending();

/// Once the module is loaded: from then on the interpreter waits at its end for those that compute.
void watch_the_end();

} // namespace raycontact::python
