// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/precision.h>

class btDiscreteDynamicsWorld;

namespace raycontact::bullet {

/// What recommend() asks of Bullet's solver. docs/solvers.md has the reason and the figure of each.
struct SolverSettings {
    /// Metres that a contact may stay deep. Without speculative contacts a vertex is in contact only while it is
    /// inside: pushed out to the surface, it would be lost, and come back. With them heaps lie nearer with
    /// less, but stacks and what fits closely tremble. For bodies of
    /// 0.2 to 5 m; a thousandth to a hundredth of the smallest.
    double slop = 0.001;
    double erp = 0.3;    ///< part of the depth beyond the slop that a step undoes, without giving speed; 0 to 1
    int iterations = 20; ///< at least 1; Bullet's own are 10
};

/// Settings with which meshes in contact come to rest, written to world.getSolverInfo(); others stay. Call it once,
/// when the world is made. Beside the settings above: depth is undone by split impulses, however small it is, and
/// friction has two directions, fixed by the normal. Throws InputError, and sets nothing, where a setting is out of its
/// range.
void recommend(btDiscreteDynamicsWorld& world, const SolverSettings& settings = {});

} // namespace raycontact::bullet
