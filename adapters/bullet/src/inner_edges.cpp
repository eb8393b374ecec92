// SPDX-License-Identifier: Apache-2.0
#include <inner_edges.h>

#include <bullet_mesh.h>

#include <algorithm>
#include <span>

namespace raycontact::bullet {

namespace {

/// Cosine from which on a normal is its face's.
constexpr btScalar is_face = btScalar(0.9999);

btVector3 normal_of(const BulletMesh& mesh, std::uint32_t t) {
    const btVector3 n = (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
    return n.fuzzyZero() ? n : n.normalized();
}

btScalar away_from(const btVector3& p, const btVector3& from, const btVector3& to) {
    const btVector3 along = to - from;
    const btScalar at = btClamped((p - from).dot(along) / along.length2(), btScalar(0), btScalar(1));
    return (p - from - at * along).length2();
}

/// Whether a triangle that shares no corner lies in the plane of another, at a point of its border: a T-junction.
bool goes_on(const BulletMesh& mesh, std::span<const std::uint32_t> around, std::uint32_t t, const btVector3& point) {
    const btVector3 face = normal_of(mesh, t);
    return std::ranges::any_of(around, [&](std::uint32_t k) {
        for (const int i : {0, 1, 2})
            for (const int j : {0, 1, 2})
                if (mesh.corner(k, i) == mesh.corner(t, j)) return false;
        const btVector3 n = normal_of(mesh, k);
        bool beside = btFabs(n.dot(face)) > is_face;
        for (const int i : {0, 1, 2}) {
            const btVector3 along = mesh.corner(k, i + 1) - mesh.corner(k, i);
            beside =
                beside && n.cross(along).dot(point - mesh.corner(k, i)) > -gContactBreakingThreshold * along.length();
        }
        return beside;
    });
}

/// The direction out of the mesh at a point of a triangle's border, nearest to the one given. All in the mesh's frame.
/// around: the triangles near the point.
btVector3 allowed(const Leaf& leaf, std::span<const std::uint32_t> around, std::uint32_t t, const btVector3& point,
                  const btVector3& out) {
    const BulletMesh& mesh = *leaf.converted.in_bullet;
    const btVector3 face = normal_of(mesh, t);
    const btScalar side = face.dot(out) < 0 ? btScalar(-1) : btScalar(1);
    const btVector3 own = side * face;
    if (own.dot(out) > is_face) return out;
    int edge = 0;
    for (const int k : {1, 2})
        if (away_from(point, mesh.corner(t, k), mesh.corner(t, k + 1))
            < away_from(point, mesh.corner(t, edge), mesh.corner(t, edge + 1)))
            edge = k;
    const std::uint32_t across = leaf.converted.shape->neighbours()[t][static_cast<std::size_t>(edge)];
    if (across == Shape::no_triangle) return goes_on(mesh, around, t, point) ? own : out;
    const btVector3 other = side * normal_of(mesh, across);
    // Away from the triangle, over the edge.
    const btVector3 beyond = (mesh.corner(t, edge + 1) - mesh.corner(t, edge)).cross(face).normalized();
    const btScalar turned = other.dot(beyond); // above 0: the edge is convex on this side
    if (turned <= 0 || out.dot(beyond) <= 0) return own;
    return out.dot(beyond) * other.dot(own) < turned * out.dot(own) ? out : other;
}

} // namespace

void leave_inner_edges(btPersistentManifold& manifold, const Leaf& leaf, bool mesh_is_0) {
    const BulletMesh& mesh = *leaf.converted.in_bullet;
    const auto& numbers = leaf.converted.shape->triangle_index();
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
        btManifoldPoint& p = manifold.getContactPoint(i);
        const auto number = static_cast<std::uint32_t>(mesh_is_0 ? p.m_index0 : p.m_index1);
        const btVector3 point = leaf.pose.invXform(mesh_is_0 ? p.m_positionWorldOnA : p.m_positionWorldOnB);
        const btVector3 near(gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold);
        const auto triangles = mesh.overlapping(point - near, point + near);
        const auto t = std::ranges::find(triangles, number, [&](std::uint32_t k) { return numbers[k]; });
        if (t == triangles.end()) continue;
        const btVector3 out = (mesh_is_0 ? -p.m_normalWorldOnB : p.m_normalWorldOnB) * leaf.pose.getBasis();
        const btVector3 normal = allowed(leaf, triangles, *t, point, out);
        if (normal == out) continue;
        const btVector3 in_world = leaf.pose.getBasis() * normal;
        p.m_distance1 *= btMax(btScalar(0), normal.dot(out));
        p.m_normalWorldOnB = mesh_is_0 ? -in_world : in_world;
    }
}

} // namespace raycontact::bullet
