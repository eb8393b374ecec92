// SPDX-License-Identifier: Apache-2.0
#include <round.h>
#include <vectors.h>

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btMultiSphereShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>

namespace raycontact::bullet {

Round round_of(const btCollisionShape& shape) {
    if (shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE)
        return {{}, {}, double(static_cast<const btSphereShape&>(shape).getRadius())};
    if (shape.getShapeType() == MULTI_SPHERE_SHAPE_PROXYTYPE) {
        const auto& balls = static_cast<const btMultiSphereShape&>(shape);
        const btScalar scaling = balls.getLocalScaling().x();
        return {to_vec(balls.getSpherePosition(0) * scaling),
                to_vec(balls.getSpherePosition(balls.getSphereCount() - 1) * scaling),
                double(balls.getSphereRadius(0) * scaling)};
    }
    const auto& capsule = static_cast<const btCapsuleShape&>(shape);
    btVector3 end(0, 0, 0);
    end[capsule.getUpAxis()] = btMax(capsule.getHalfHeight(), btScalar(0));
    return {to_vec(-end), to_vec(end), double(capsule.getRadius())};
}

double size_of(const Round& round) {
    return 2 * round.radius + length(round.to - round.from);
}

void FieldFacets::near(const Vec3& low, const Vec3& high, std::vector<Facet>& out) const {
    struct Gather final : btTriangleCallback {
        std::vector<Facet>& out;
        explicit Gather(std::vector<Facet>& o) : out(o) {}
        void processTriangle(btVector3* t, int part, int index) override {
            add_facet({to_vec(t[0]), to_vec(t[1]), to_vec(t[2])}, 0, {part, index}, out);
        }
    } gather(out);
    field_->processAllTriangles(&gather, to_bullet(low), to_bullet(high));
}

double FieldFacets::size() const {
    btVector3 low, high;
    field_->getAabb(btTransform::getIdentity(), low, high);
    return double((high - low).length());
}

} // namespace raycontact::bullet
