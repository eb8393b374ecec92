// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clash/parts.h"

namespace raycontact::clash {

/// Whether one part is a copy of the other in the same place: as many vertices and triangles, and every vertex of one
/// where the other has one, to a millionth of their size. Both have shapes.
bool are_duplicates(const Part& a, const Part& b);

} // namespace raycontact::clash
