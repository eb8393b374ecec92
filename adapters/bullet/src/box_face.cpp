// SPDX-License-Identifier: Apache-2.0
#include <box_face.h>
#include <vectors.h>

#include <LinearMath/btAabbUtil2.h>

namespace raycontact::bullet {

namespace {

/// The face that a box in the other box's frame lies over: twice the axis, plus one for the upper side; -1 for none.
int face_under(const btVector3& low, const btVector3& high, const btVector3& half) {
    int face = -1;
    for (int k = 0; k < 3; ++k) {
        // Beyond both faces, or neither, says nothing; the middle keeps the exit plain.
        const bool above = high[k] > half[k], below = low[k] < -half[k];
        if (!above && !below) continue;
        if (face >= 0 || (above && below) || (above ? low[k] < 0 : high[k] > 0)) return -1;
        face = 2 * k + (above ? 1 : 0);
    }
    return face;
}

} // namespace

std::optional<HalfSpace> only_face(const Converted& mesh, const btTransform& mesh_pose, const btBoxShape& box,
                                   const btTransform& box_pose) {
    const btVector3 half = box.getHalfExtentsWithMargin().absolute();
    const btTransform relative = box_pose.inverseTimes(mesh_pose);
    // Rims count as near from a little farther off: these frames are rounded.
    const btScalar slack = btScalar(1e-5) * (half[half.maxAxis()] + relative.getOrigin().length());
    btVector3 low, high;
    btTransformAabb(to_bullet(mesh.shape->box_min()), to_bullet(mesh.shape->box_max()), slack, relative, low, high);
    int face = face_under(low, high, half);
    if (face < 0) {
        // The vertices' own box is smaller and takes longer.
        const btVector3 size = high - low;
        bool near_rim = false;
        for (int k = 0; k < 3; ++k) near_rim = near_rim || size[k] > 2 * half[k];
        if (near_rim) return std::nullopt;
        mesh.tree->bounds_once(relative, low, high);
        const btVector3 around(slack, slack, slack);
        face = face_under(low - around, high + around, half);
    }
    if (face < 0) return std::nullopt;
    const int axis = face / 2;
    btVector3 normal = box_pose.getBasis().getColumn(axis).normalized();
    if (face % 2 == 0) normal = -normal;
    HalfSpace space;
    space.normal = normal;
    space.height = dot_in_double(normal, box_pose.getOrigin()) + double(half[axis]);
    return space;
}

} // namespace raycontact::bullet
