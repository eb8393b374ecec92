// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Python.h>

namespace raycontact::python {

/// Lets Python's other threads run for as long as it lives. Before 3.14 a thread that asks for the GIL while the
/// interpreter ends is ended itself, in the middle of C++ frames, which aborts the process; here it sleeps until the
/// process is gone.
class WithoutGil {
public:
    WithoutGil();
    ~WithoutGil();
    WithoutGil(const WithoutGil&) = delete;
    WithoutGil& operator=(const WithoutGil&) = delete;

    /// Takes the GIL for a moment to ask whether Ctrl-C was pressed; throws nanobind::python_error if so.
    void check_signals();

private:
    void take_back();
    PyThreadState* state_;
};

/// The interpreter is about to end: work of threads other than the main one is not wanted any more.
bool is_ending();

/// Once the module is loaded: from then on the interpreter waits at its end for those that compute.
void watch_the_end();

} // namespace raycontact::python
