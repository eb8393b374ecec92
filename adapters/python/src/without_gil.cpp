// SPDX-License-Identifier: Apache-2.0
#include "without_gil.h"

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <csignal>
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

std::atomic<bool> ctrl_c = false; ///< was pressed while the main thread computes
std::atomic<unsigned long> main_thread = 0;

void find_main_thread() {
    main_thread = nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
}

#ifdef SA_SIGINFO

struct sigaction pythons {}; ///< what was there before ours

// Python knows it first: whoever sees the flag raises what Python has to raise, once. It may run on any thread.
void on_ctrl_c(int number) {
    pythons.sa_handler(number);
    ctrl_c = true;
}

bool is_there(const struct sigaction& action) {
    return (action.sa_flags & SA_SIGINFO) == 0 && action.sa_handler != SIG_DFL && action.sa_handler != SIG_IGN;
}

/// Whether this is the main thread, and Ctrl-C would raise KeyboardInterrupt: a handler of the user's may go on.
bool python_raises() {
    if (PyThread_get_thread_ident() != main_thread) return false;
    try {
        // That of signal tries to make an enumerator of the handler first, which takes microseconds.
        static const nb::handle handler = nb::object(nb::module_::import_("_signal").attr("getsignal")).release();
        static const nb::handle usual =
            nb::object(nb::module_::import_("_signal").attr("default_int_handler")).release();
        static const nb::handle number = nb::object(nb::int_(SIGINT)).release();
        return handler(number).is(usual);
    } catch (const nb::python_error&) {
        return false; // the interpreter is about to end
    }
}

bool listen() {
    struct sigaction now {};
    if (!python_raises() || sigaction(SIGINT, nullptr, &now) != 0) return false;
    // Ours is there in a call from within another one, of its progress(), say: that one listens.
    if (!is_there(now) || now.sa_handler == on_ctrl_c) return false;
    ctrl_c = false;
    pythons = now;
    struct sigaction ours = now;
    ours.sa_handler = on_ctrl_c;
    return sigaction(SIGINT, &ours, nullptr) == 0;
}

void stop_listening() {
    struct sigaction now {};
    if (sigaction(SIGINT, nullptr, &now) == 0 && is_there(now) && now.sa_handler == on_ctrl_c)
        sigaction(SIGINT, &pythons, nullptr);
}

#else

bool listen() {
    return false;
}
void stop_listening() {}

#endif

} // namespace

bool is_ending() {
    return ending;
}

void watch_the_end() {
    find_main_thread();
    nb::module_::import_("atexit").attr("register")(nb::cpp_function(&end));
    const nb::module_ os = nb::module_::import_("os");
    if (nb::hasattr(os, "register_at_fork")) { // a child has none of its parent's threads
        os.attr("register_at_fork")(nb::arg("after_in_child") = nb::cpp_function([] {
                                        computing = 0;
                                        find_main_thread();
                                        stop_listening();
                                    }));
    }
}

WithoutGil::WithoutGil() : listens_(listen()) {
    if (listens_ && PyErr_CheckSignals() != 0) {
        stop_listening();
        throw nb::python_error();
    }
    if (listens_) interruptible_.emplace(&ctrl_c);
    ++computing;
    state_ = PyEval_SaveThread();
}

WithoutGil::~WithoutGil() {
    if (listens_) stop_listening();
    take_back();
    --computing;
}

const std::atomic<bool>* WithoutGil::flag() const {
    return listens_ ? &ctrl_c : nullptr;
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
