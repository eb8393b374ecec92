// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/pair_meshes.h"
#include "pairs/displacement.h"

#include <array>

namespace raycontact {

/// A direction on its way from one to another, by a part of it.
inline Vec3 part_of_turn(const Vec3& from, const Vec3& to, double part) {
    return unit((1 - part) * from + part * to);
}

/// Of two points, and so far around.
inline Box box_of(const Vec3& p, const Vec3& q, double around) {
    const Vec3 grown{around, around, around};
    return {least(p, q) - grown, most(p, q) + grown};
}

/// One body of a pair as the other sees it, in the other's centred frame.
struct OneWay {
    const ShapeData &source, &target;
    Pose now, next;
    bool moves;    ///< as seen from either, points of the other may go farther than the margin until the next step
    double thrown; ///< how far from its way what stops the body elsewhere may throw a point, metres; 0: it stays
};

/// A pair whose speculative contacts are asked for (docs/internals/speculative.md): what is nearer than a margin, and
/// what will touch on its way to the next step. They are found in double, so they are the same for every device.
struct SpeculativePair {
    SpeculativePair(const PlacedBody& first, const PlacedBody& second, double within);

    const PlacedBody &a, &b;
    double margin;                ///< metres
    double perturbation;          ///< metres: what is nearer touches
    std::array<OneWay, 2> bodies; ///< a, b
};

} // namespace raycontact
