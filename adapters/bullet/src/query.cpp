// SPDX-License-Identifier: Apache-2.0
#include <query.h>

#include <plane.h>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <array>

namespace raycontact::bullet {

btVector3 normal_of(const Contact& c) {
    return btVector3(c.normal[0], c.normal[1], c.normal[2]);
}

void surface_points(const Contact& c, btVector3& on_a, btVector3& on_b) {
    const btVector3 vertex(btScalar(c.point.x), btScalar(c.point.y), btScalar(c.point.z));
    const btVector3 across = normal_of(c) * btScalar(c.depth);
    // The vertex lies on its own body; the other's surface is a depth away, against the way it went in.
    on_a = c.vertex_body == VertexBody::a ? vertex : btVector3(vertex + across);
    on_b = c.vertex_body == VertexBody::a ? btVector3(vertex - across) : vertex;
}

void Queries::run(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, btManifoldResult& result) {
    const Kind kind_a = kind_of(*a.getCollisionShape()), kind_b = kind_of(*b.getCollisionShape());
    if (kind_a == Kind::plane || kind_b == Kind::plane) {
        const bool a_is_mesh = kind_b == Kind::plane;
        const btCollisionObjectWrapper& mesh = a_is_mesh ? a : b;
        const btCollisionObjectWrapper& plane = a_is_mesh ? b : a;
        if (kind_of(*mesh.getCollisionShape()) != Kind::mesh) return;
        btVector3 normal;
        std::vector<PlaneContact> found;
        plane_contacts(shapes_.get(*mesh.getCollisionShape()), mesh.getWorldTransform(),
                       static_cast<const btStaticPlaneShape&>(*plane.getCollisionShape()), plane.getWorldTransform(),
                       normal, found);
        for (const PlaneContact& c : found) {
            if (a_is_mesh)
                result.addContactPoint(normal, c.point + normal * c.depth, -c.depth);
            else
                result.addContactPoint(-normal, c.point, -c.depth);
        }
        return;
    }
    const BodyId body_a = scene_.add(shapes_.get(*a.getCollisionShape()).shape, to_pose(a.getWorldTransform()));
    const BodyId body_b = scene_.add(shapes_.get(*b.getCollisionShape()).shape, to_pose(b.getWorldTransform()));
    const std::array pairs{Pair{body_a, body_b}};
    for (const Contact& c : scene_.step(pairs)) {
        btVector3 on_a, on_b;
        surface_points(c, on_a, on_b);
        result.addContactPoint(-normal_of(c), on_b, btScalar(-c.depth));
    }
    scene_.remove(body_a);
    scene_.remove(body_b);
}

} // namespace raycontact::bullet
