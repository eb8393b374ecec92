// SPDX-License-Identifier: Apache-2.0
// raycontact._core: the public headers for Python, as they are. What makes them pleasant is raycontact/*.py.
#include "bind.h"
#include "without_gil.h"

#include <raycontact/error.h>
#include <raycontact/interruption.h>

#include <nanobind/nanobind.h>

#include <exception>

namespace nb = nanobind;

NB_MODULE(_core, m) {
    m.doc() = "The C++ half of raycontact; use the package itself.";
    nb::exception<raycontact::InputError>(m, "InputError", PyExc_ValueError).doc() =
        "Bad input: the text says what is wrong, where, and what to do about it. A ValueError.";
    nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
        try {
            std::rethrow_exception(thrown);
        } catch (const raycontact::Interrupted&) {
            if (PyErr_CheckSignals() == 0) PyErr_SetNone(PyExc_KeyboardInterrupt);
        }
    });
    nb::set_leak_warnings(false); // what a user's program holds when it ends is not ours
    m.attr("version") = RAYCONTACT_VERSION;
    raycontact::python::watch_the_end();
    raycontact::python::bind_mesh(m);
    raycontact::python::bind_shape(m);
    raycontact::python::bind_queries(m);
    raycontact::python::bind_single(m);
    raycontact::python::bind_placed(m);
    raycontact::python::bind_stats(m);
    raycontact::python::bind_scene(m);
    raycontact::python::bind_recordings(m);
    raycontact::python::bind_clash(m);
}
