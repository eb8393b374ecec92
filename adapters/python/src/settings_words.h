// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/settings.h>

#include <nanobind/nanobind.h>

namespace raycontact::python {

/// `s` with those changed that are named. raycontact/scene.py names all, and refuses other names.
Settings settings_from(const nanobind::dict& words, Settings s);
/// All by their names, as settings_from() takes them.
nanobind::dict words_of(const Settings& s);

} // namespace raycontact::python
