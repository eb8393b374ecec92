// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <objects.h>
#include <round.h>

namespace raycontact::bullet {

/// What handles a pair of leaves; this does not depend on their positions.
enum class Work { batch, plane, round, bullet, nothing };

/// Bullet has only its empty algorithm for two concave shapes.
inline bool unsupported(const btCollisionShape& a, const btCollisionShape& b) {
    const auto empty = [](const btCollisionShape& s) { return s.getShapeType() == EMPTY_SHAPE_PROXYTYPE; };
    return a.isConcave() && b.isConcave() && !empty(a) && !empty(b);
}

/// Whether Bullet's rule for convex shapes holds: each face of an open level stops them on both sides. What moves and
/// is open lies on its vertices, whatever it is wound like.
inline bool is_two_sided(const Leaf& mesh, ConvexShapes convex) {
    return convex == ConvexShapes::by_mesh && mesh.kind == Kind::mesh && mesh.is_fixed && mesh.converted.shape
           && !mesh.converted.shape->has_inside();
}

inline Work work_for(const Leaf& a, const Leaf& b, ConvexShapes convex) {
    // A flat hull has no mesh to stand for it, and a stretched ball is none.
    const auto kind = [](const Leaf& leaf) {
        if (leaf.kind == Kind::round && leaf.stretch != no_stretch) return Kind::other;
        return leaf.kind == Kind::convex && !leaf.converted.shape ? Kind::other : leaf.kind;
    };
    const Kind one = kind(a), two = kind(b);
    const auto either = [&](Kind k) { return one == k || two == k; };
    if (either(Kind::mesh)) {
        if (either(Kind::plane)) return Work::plane;
        if (either(Kind::round)) return Work::round;
        if (either(Kind::convex) && (is_two_sided(a, convex) || is_two_sided(b, convex))) return Work::bullet;
        if (!either(Kind::other)) return Work::batch;
    }
    return unsupported(*a.shape, *b.shape) ? Work::nothing : Work::bullet;
}

/// A leaf of kind round, as a mesh sees it.
inline Round round_before(const Leaf& mesh, const Leaf& ball, ConvexShapes convex) {
    Round round = round_of(*ball.shape);
    round.two_sided = is_two_sided(mesh, convex);
    return round;
}

} // namespace raycontact::bullet
