// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/precision.h>
#include <raycontact/export.h>

#include <optional>

class btDiscreteDynamicsWorld;

namespace raycontact::bullet {

/// What recommend() asks of Bullet's solver. docs/bullet.md has the reason and the figure of each.
struct SolverSettings {
    /// Metres that a contact may stay deep. Empty: a thousandth of the smallest moving body's size, without speculative
    /// contacts five thousandths. Without them a vertex is in contact only while it is inside: pushed out to the
    /// surface, it would be lost, and come back. With them heaps lie nearer with less, but stacks and what fits closely
    /// tremble.
    std::optional<double> slop{};
    /// Metres: the longest edge of the box of the smallest body that will move. Empty: that of those in the world now;
    /// where none is, 1 m.
    std::optional<double> size{};
    double erp = 0.3;    ///< part of the depth beyond the slop that a step undoes, without giving speed; 0 to 1
    int iterations = 20; ///< at least 1; Bullet's own are 10
};

/// Settings with which meshes in contact come to rest, written to world.getSolverInfo(); others stay. Call it when the
/// world is made, with a size, or once its bodies are in it; again when smaller ones come. Beside the settings above:
/// depth is undone by split impulses, however small it is, and friction has two directions, fixed by the normal. Where
/// the world's dispatcher is ours, it is attached to the world (CollisionDispatcher::attach). Throws InputError, and
/// sets nothing, where a setting is out of its range.
RAYCONTACT_API void recommend(btDiscreteDynamicsWorld& world, const SolverSettings& settings = {});

} // namespace raycontact::bullet
