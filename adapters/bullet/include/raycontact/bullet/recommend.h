// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/precision.h>

#include <optional>

class btDiscreteDynamicsWorld;

namespace raycontact::bullet {

/// What recommend() asks of Bullet's solver. docs/solvers.md has the reason and the figure of each.
struct SolverSettings {
    /// Metres that a contact may stay deep. Empty: 0 if the world's dispatcher is a CollisionDispatcher with
    /// speculative contacts, else 0.001, for bodies of 0.2 to 5 m (a thousandth to a hundredth of the smallest):
    /// without them a vertex is in contact only while it is inside, so one that was pushed out to the surface is lost,
    /// and comes back.
    std::optional<double> slop{};
    double erp = 0.3;    ///< part of the depth beyond the slop that a step undoes, without giving speed; 0 to 1
    int iterations = 20; ///< at least 1; Bullet's own are 10
};

/// Settings with which meshes in contact come to rest, written to world.getSolverInfo(); others stay. Call it once,
/// when the world is made. Beside the settings above: depth is undone by split impulses, however small it is, and
/// friction has two directions, fixed by the normal. Throws InputError, and sets nothing, where a setting is out of its
/// range.
void recommend(btDiscreteDynamicsWorld& world, const SolverSettings& settings = {});

} // namespace raycontact::bullet
