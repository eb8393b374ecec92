// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/micro/batch.h"

namespace raycontact::bench {

/// How much of a shape the kernels look at, on average: counted by the kernels' own text, not by a copy of it.
struct Visits {
    double cluster_blocks = 0;  ///< a pair and direction: tests of sixteen boxes of vertex blocks or clusters
    double nodes = 0;           ///< a ray: tests of eight child boxes
    double triangle_blocks = 0; ///< a ray: tests of sixteen triangles
    double close_looks = 0;     ///< a ray: triangles that pass and are looked at again, accurately
};

Visits count_visits(const Batch& batch, const std::vector<kernels::Ray>& rays);

} // namespace raycontact::bench
