// SPDX-License-Identifier: Apache-2.0
#include <plane.h>

#include <objects.h>
#include <vectors.h>

#include <cmath>

namespace raycontact::bullet {

HalfSpace half_space(const btStaticPlaneShape& plane, const btTransform& plane_pose, const Stretch& stretch) {
    HalfSpace space;
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
    space.normal = (plane_pose.getBasis() * normal).normalized();
    space.height = dot_in_double(space.normal, plane_pose.getOrigin()) + double(plane.getPlaneConstant()) / nearer;
    return space;
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
    const btVector3 local = normal * mesh_pose.getBasis(); // row vector: the inverse rotation
    const double at = dot_in_double(normal, mesh_pose.getOrigin());
    const double slack = 1e-5 * (mesh.shape->radius() + std::fabs(height - at));
    static thread_local std::vector<std::uint32_t> below;
    mesh.tree->vertices_below(local, btScalar(height - at + slack), below);
    const Pose pose = to_pose(mesh_pose);
    for (const std::uint32_t v : below) {
        const Vec3 p = transform_point(pose, mesh.shape->vertices()[v]);
        const double depth = depth_in(space, p);
        if (depth > -double(reach)) out.push_back({v, to_bullet(p), btScalar(depth)});
    }
}

} // namespace raycontact::bullet
