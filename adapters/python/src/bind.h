// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>

namespace raycontact::python {

// One for each file; bind_mesh() comes first, as the others use its types.
void bind_mesh(nanobind::module_& m);
void bind_shape(nanobind::module_& m);
void bind_queries(nanobind::module_& m);
void bind_single(nanobind::module_& m);
void bind_placed(nanobind::module_& m);
void bind_stats(nanobind::module_& m);
void bind_scene(nanobind::module_& m);
void bind_recordings(nanobind::module_& m);
void bind_clash(nanobind::module_& m);

} // namespace raycontact::python
