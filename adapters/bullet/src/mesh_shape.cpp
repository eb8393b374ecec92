// SPDX-License-Identifier: Apache-2.0
#include <raycontact/bullet/mesh_shape.h>

#include <bullet_mesh.h>
#include <convert.h>
#include <raycontact/bullet/mass.h>
#include <raycontact/error.h>
#include <vectors.h>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <LinearMath/btAabbUtil2.h>

#include <cmath>
#include <utility>
#include <vector>

namespace raycontact::bullet {

MeshShape::MeshShape(std::shared_ptr<const Shape> shape, Bounds bounds)
    : original_(std::move(shape)), scaled_(original_), scaling_(1, 1, 1), bounds_(bounds) {
    if (!original_) throw InputError("MeshShape: no shape given; make one with raycontact::Shape::make");
    in_bullet_ = std::make_shared<const BulletMesh>(scaled_);
    // Not CUSTOM_CONCAVE_SHAPE_TYPE: Bullet 3 gave the same number to its signed-distance shape and would cast to that.
    m_shapeType = FAST_CONCAVE_MESH_PROXYTYPE;
    m_collisionMargin = 0;
}

MeshShape::~MeshShape() = default;

void MeshShape::getAabb(const btTransform& t, btVector3& aabb_min, btVector3& aabb_max) const {
    if (bounds_ == Bounds::box) {
        const Vec3 low = scaled_->box_min(), high = scaled_->box_max();
        btTransformAabb(to_bullet(low), to_bullet(high), getMargin(), t, aabb_min, aabb_max);
        return;
    }
    in_bullet_->bounds(t, aabb_min, aabb_max);
    const btVector3 margin(getMargin(), getMargin(), getMargin());
    aabb_min -= margin;
    aabb_max += margin;
}

void MeshShape::processAllTriangles(btTriangleCallback* callback, const btVector3& aabb_min,
                                    const btVector3& aabb_max) const {
    for (const std::uint32_t t : in_bullet_->overlapping(aabb_min, aabb_max)) {
        btVector3 corners[3] = {in_bullet_->corner(t, 0), in_bullet_->corner(t, 1), in_bullet_->corner(t, 2)};
        callback->processTriangle(corners, 0, static_cast<int>(scaled_->triangle_index()[t]));
    }
}

void MeshShape::calculateLocalInertia(btScalar mass, btVector3& inertia) const {
    const MassProperties p = mass_properties(*scaled_);
    const double density = p.volume > 0 ? static_cast<double>(mass) / p.volume : 0;
    inertia.setValue(btScalar(p.inertia[0] * density), btScalar(p.inertia[4] * density),
                     btScalar(p.inertia[8] * density));
}

void MeshShape::setLocalScaling(const btVector3& scaling) {
    if (scaling == scaling_) return;
    for (int k = 0; k < 3; ++k)
        if (scaling[k] == btScalar(0))
            throw InputError(original_->name() + ": local scaling must not be zero in any axis");
    const Stretch stretch{double(scaling.x()), 0, 0, 0, double(scaling.y()), 0, 0, 0, double(scaling.z())};
    scaled_ = stretch == no_stretch ? original_ : stretch_shape(*original_, stretch);
    in_bullet_ = std::make_shared<const BulletMesh>(scaled_);
    scaling_ = scaling;
}

int MeshShape::calculateSerializeBufferSize() const {
    return static_cast<int>(sizeof(btTriangleMeshShapeData));
}

const char* MeshShape::serialize(void* data, btSerializer* serializer) const {
    auto& out = *static_cast<btTriangleMeshShapeData*>(data);
    out = {};
    btCollisionShape::serialize(&out.m_collisionShapeData, serializer);
    out.m_collisionShapeData.m_shapeType = TRIANGLE_MESH_SHAPE_PROXYTYPE;
    std::vector<btScalar> vertices;
    for (const Vec3& v : original_->vertices())
        vertices.insert(vertices.end(), {btScalar(v.x), btScalar(v.y), btScalar(v.z)});
    std::vector<int> indices;
    for (const auto& t : original_->triangles())
        for (const std::uint32_t corner : t) indices.push_back(static_cast<int>(corner));
    btTriangleIndexVertexArray mesh(static_cast<int>(indices.size() / 3), indices.data(), 3 * sizeof(int),
                                    static_cast<int>(vertices.size() / 3), vertices.data(), 3 * sizeof(btScalar));
    mesh.setScaling(scaling_);
    mesh.serialize(&out.m_meshInterface, serializer); // copies the lists
    out.m_collisionMargin = static_cast<float>(m_collisionMargin);
    return "btTriangleMeshShapeData";
}

} // namespace raycontact::bullet
