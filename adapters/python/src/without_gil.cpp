// SPDX-License-Identifier: Apache-2.0
#include "without_gil.h"

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace nb = nanobind;

namespace raycontact::python {

namespace {

std::atomic<int> computing = 0;    ///< threads without the GIL, and those that are about to get it back
std::atomic<bool> ending = false;  ///< nobody but `last` gets it back
std::atomic<std::thread::id> last; ///< that ends the interpreter

// Daemon threads alone are left. What they do comes to its end first: nothing that it uses is destroyed before.
void end() {
    last = std::this_thread::get_id();
    ending = true;
    PyThreadState* state = PyEval_SaveThread();
    while (computing > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    PyEval_RestoreThread(state);
}

} // namespace

bool is_ending() {
    return ending;
}

void watch_the_end() {
    nb::module_::import_("atexit").attr("register")(nb::cpp_function(&end));
    const nb::module_ os = nb::module_::import_("os");
    if (nb::hasattr(os, "register_at_fork")) { // a child has none of its parent's threads
        os.attr("register_at_fork")(nb::arg("after_in_child") = nb::cpp_function([] { computing = 0; }));
    }
}

WithoutGil::WithoutGil() : state_(nullptr) {
    ++computing;
    state_ = PyEval_SaveThread();
}

WithoutGil::~WithoutGil() {
    take_back();
    --computing;
}

// Counted until it has the GIL, so that end() lets go of it once more for this thread.
void WithoutGil::take_back() {
    if (ending && std::this_thread::get_id() != last) {
        --computing;
        for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
    }
    PyEval_RestoreThread(state_);
}

void WithoutGil::check_signals() {
    if (ending) return; // what computes asks is_ending(), and then ends
    take_back();
    if (PyErr_CheckSignals() == 0) {
        state_ = PyEval_SaveThread();
        return;
    }
    nb::python_error stopped;
    state_ = PyEval_SaveThread();
    throw stopped;
}

} // namespace raycontact::python
