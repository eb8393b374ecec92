// SPDX-License-Identifier: Apache-2.0
#include <plane.h>

#include <objects.h>
#include <raycontact/query.h>
#include <vectors.h>

#include <LinearMath/btAabbUtil2.h>

#include <cmath>

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

HalfSpace half_space(const btStaticPlaneShape& plane, const btTransform& plane_pose, const Stretch& stretch) {
    btVector3 normal = plane.getPlaneNormal();
    double nearer = 1;
    if (stretch != no_stretch) { // normal . p <= constant is (inverse normal) . (stretch p) <= constant
        const Stretch s = inverse(stretch);
        const Vec3 n = to_vec(normal);
        const Vec3 turned{s[0] * n.x + s[1] * n.y + s[2] * n.z, s[3] * n.x + s[4] * n.y + s[5] * n.z,
                          s[6] * n.x + s[7] * n.y + s[8] * n.z};
        nearer = std::sqrt(turned.x * turned.x + turned.y * turned.y + turned.z * turned.z);
        normal = to_bullet({turned.x / nearer, turned.y / nearer, turned.z / nearer});
    }
    normal = (plane_pose.getBasis() * normal).normalized();
    return {normal, dot_in_double(normal, plane_pose.getOrigin()) + double(plane.getPlaneConstant()) / nearer};
}

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
        mesh.in_bullet->bounds(relative, low, high);
        const btVector3 around(slack, slack, slack);
        face = face_under(low - around, high + around, half);
    }
    if (face < 0) return std::nullopt;
    const int axis = face / 2;
    const btVector3 upwards = box_pose.getBasis().getColumn(axis).normalized();
    const btVector3 normal = face % 2 == 0 ? -upwards : upwards;
    return HalfSpace{normal, dot_in_double(normal, box_pose.getOrigin()) + double(half[axis])};
}

double depth_in(const HalfSpace& space, const Vec3& point) {
    const btVector3& n = space.normal;
    return space.height - (double(n.x()) * point.x + double(n.y()) * point.y + double(n.z()) * point.z);
}

void plane_contacts(const Converted& mesh, const btTransform& mesh_pose, const HalfSpace& space, btScalar reach,
                    std::vector<PlaneContact>& out) {
    out.clear();
    const btVector3& normal = space.normal;
    const double height = space.height + double(reach);

    // The tree prunes in the mesh's frame, with slack; the depth is computed in double, in the world.
    const Vec3 local = to_vec(normal * mesh_pose.getBasis()); // row vector: the inverse rotation
    const double at = dot_in_double(normal, mesh_pose.getOrigin());
    const double slack = 1e-5 * (mesh.shape->radius() + std::fabs(height - at));
    static thread_local std::vector<std::uint32_t> below;
    vertices_below(*mesh.shape, local, height - at + slack, below);
    const Pose pose = to_pose(mesh_pose);
    for (const std::uint32_t v : below) {
        const Vec3 p = transform_point(pose, mesh.shape->vertices()[v]);
        const double depth = depth_in(space, p);
        if (depth > -double(reach)) out.push_back({v, to_bullet(p), btScalar(depth)});
    }
}

} // namespace raycontact::bullet
