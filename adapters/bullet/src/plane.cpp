// SPDX-License-Identifier: Apache-2.0
#include <plane.h>

#include <objects.h>
#include <vectors.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace raycontact::bullet {

HalfSpace half_space(const btStaticPlaneShape& plane, const btTransform& plane_pose, const Stretch& stretch) {
    HalfSpace space;
    btVector3 normal = plane.getPlaneNormal();
    btScalar nearer = 1;
    if (stretch != no_stretch) { // normal . p <= constant is (inverse normal) . (stretch p) <= constant
        std::array<btScalar, 9> s;
        std::transform(stretch.begin(), stretch.end(), s.begin(), [](double x) { return btScalar(x); });
        normal = btMatrix3x3(s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8]).inverse() * normal;
        nearer = normal.length();
    }
    space.normal = (plane_pose.getBasis() * normal).normalized();
    space.height = dot_in_double(space.normal, plane_pose.getOrigin()) + double(plane.getPlaneConstant() / nearer);
    return space;
}

void plane_contacts(const Converted& mesh, const btTransform& mesh_pose, const HalfSpace& space,
                    std::vector<PlaneContact>& out) {
    out.clear();
    const btVector3& normal = space.normal;
    const double nx = double(normal.x()), ny = double(normal.y()), nz = double(normal.z());
    const double height = space.height;

    // The tree prunes in the mesh's frame, with slack; the depth is computed in double, in the world.
    const btVector3 local = normal * mesh_pose.getBasis(); // row vector: the inverse rotation
    const double at = dot_in_double(normal, mesh_pose.getOrigin());
    const double slack = 1e-5 * (mesh.shape->radius() + std::fabs(height - at));
    static thread_local std::vector<std::uint32_t> below;
    mesh.tree->vertices_below(local, btScalar(height - at + slack), below);
    const Pose pose = to_pose(mesh_pose);
    for (const std::uint32_t v : below) {
        const Vec3 p = transform_point(pose, mesh.shape->vertices()[v]);
        const double depth = height - (nx * p.x + ny * p.y + nz * p.z);
        if (depth > 0) out.push_back({v, to_bullet(p), btScalar(depth)});
    }
}

} // namespace raycontact::bullet
