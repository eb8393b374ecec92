// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "speculative/speculative_pair.h"

#include "pairs/near_edges.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

namespace raycontact {

/// How a vertex comes to the target's surface, in the target's centred frame.
struct Approach {
    std::uint32_t face; ///< of the target
    Vec3 normal;        ///< of the target, outward, unit
    double gap;         ///< metres; below 0 it is inside
    double when = 0;    ///< the part of the step after which they meet
};

/// A motion glances along a face of which it passes less than this part of what it passes of another.
inline constexpr double glancing = 0.25;
/// By how much a motion passes a plane; of what is inside already, by how much it goes farther in.
inline double passed_by(const Vec3& normal, double gap, const Vec3& way) {
    return -std::max(0.0, gap) - dot(normal, way);
}

/// The target's near features that stop a vertex (docs/internals/speculative.md).
class Approaches {
public:
    /// faces: at least all within the pair's margin of the vertex's straight way to the next step. Others do not count.
    Approaches(const SpeculativePair& pair, Side side, std::uint32_t vertex, std::span<const NearEdge> faces);
    /// Where the vertex is, target's centred frame.
    const Vec3& point() const { return way_[0]; }
    /// Asks of it where a contact puts it, now and at the next step. depth: metres along the target's normal.
    void leave(const Vec3& normal, double depth);

    /// What the first face on the way says, if the vertex comes from outside: from a perturbation behind, so that one
    /// on the surface counts.
    std::optional<Approach> first_met() const;
    /// Adds what each place of the target says that is nearest among its surroundings, within the margin, and that the
    /// vertex is outside of; the nearest first.
    void add_near(std::vector<Approach>& found) const;
    /// What averts a contact at a point of a face, and changes the motion least; the contact itself, or that of a face
    /// beside.
    Approach least_change(const Approach& stops, const Vec3& at) const;
    /// Whether the vertex reaches farthest against an approach's normal, of all about it, when they meet.
    bool reaches_farthest(const Approach& approach) const;

private:
    Approach stopped(const Approach& stops, const Vec3& at) const;
    bool is_listed(const Vec3& point) const;
    bool is_nearest(std::uint32_t face, const NearestPoint& point) const;

    const OneWay& body_;
    const ShapeData& target_;
    std::uint32_t vertex_;
    std::span<const NearEdge> faces_;
    std::array<Vec3, 2> way_;              ///< of the vertex, which the faces are of
    Vec3 from_, to_;                       ///< the way that is asked of
    double margin_, reach_, perturbation_; ///< reach_: how far off places count, at least the margin
};

} // namespace raycontact
