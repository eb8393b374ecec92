// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/pose.h>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

/// Fewer contacts for a solver: those of a pair fall into patches, and some points stand for each patch
/// (docs/conventions.md, Fewer contacts). Settings::max_contacts_per_pair does it for a scene; these functions serve
/// solvers that choose for themselves.
namespace raycontact {

/// A contact to choose from. World frame, metres.
struct ManifoldPoint {
    /// Of a point that belongs to no patch yet.
    static constexpr std::uint32_t no_patch = std::numeric_limits<std::uint32_t>::max();
    Vec3 position;                  ///< between the witness points
    Vec3 normal;                    ///< unit
    double depth = 0;               ///< below 0 while the surfaces are apart
    double reach = 0;               ///< it joins a patch whose centre lies no farther off
    double place = 0;               ///< points no farther from each other are at one place
    bool present = false;           ///< it was chosen in the step before, which is an advantage
    std::uint32_t patch = no_patch; ///< of those there are, the one that it belongs to in any case
};

/// Contacts with like normals near to one place.
struct ManifoldPatch {
    Vec3 normal;                       ///< of the point that began it
    Vec3 centre;                       ///< the position of that point
    std::vector<std::uint32_t> points; ///< places in the list, the deepest first; equally deep, the first in the list
};

/// Adds each point to the patch whose normal is most like its own, if it is like it by `cosine` and within reach; else
/// the point begins a patch. The deepest go first; ties go to the first in the list. patches: none, or those of the
/// step before without points.
RAYCONTACT_API void join_patches(std::span<const ManifoldPoint> points, double cosine,
                                 std::vector<ManifoldPatch>& patches);

/// Whether the two say the same: at one place, their normals alike by a cosine of 0.98.
RAYCONTACT_API bool say_the_same(const ManifoldPoint& a, const ManifoldPoint& b);

/// Chooses at most four points of a patch: up to four extremes, each the one that lies farthest from the convex hull of
/// those before (of points that were there by a factor of two farther; the first is farthest from the middle); then
/// the deepest (one that was there counts as a tenth deeper) in place of the extreme that adds least, if it is not
/// among them; then the deepest of the rest. None says what another says. So the forces of a solver keep what torque
/// four points can keep, and the points stay while a body rocks. The deepest comes first, then the extremes. patch:
/// places in `points`, each once; they are not checked.
RAYCONTACT_API std::vector<std::uint32_t> choose_points(std::span<const ManifoldPoint> points,
                                                        std::span<const std::uint32_t> patch);

/// Of all contacts of a pair those that stand for all, no more than `most`, the most important first: points of patches
/// of like normals (a cosine of 0.8), shared out by the patches' depths (D'Hondt). What Settings::max_contacts_per_pair
/// keeps of a pair that had none in the step before.
RAYCONTACT_API std::vector<std::uint32_t> choose_contacts(std::span<const ManifoldPoint> points, std::size_t most);

} // namespace raycontact
