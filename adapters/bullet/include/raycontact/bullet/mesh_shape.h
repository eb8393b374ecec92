// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/precision.h>
#include <raycontact/export.h>
#include <raycontact/shape.h>

#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include <memory>

namespace raycontact::bullet {

class BulletMesh;

/// What the world box of getAabb bounds.
enum class Bounds {
    vertices, ///< the vertices (small groups of them for big meshes): fewest pairs
    box, ///< the local box, turned, as Bullet does for its own meshes: quicker, and about twice the pairs in a pile
};

/// A RayContact shape as a Bullet collision shape, moving or not. Bullet takes the body's origin for its centre of
/// mass; see mass_properties() for a shape whose centre of mass lies elsewhere. CollisionDispatcher tests it against
/// meshes, planes, height fields and, unless ConvexShapes::bullet is set, Bullet's convex shapes; Bullet's own
/// algorithms do ray and sweep tests.
ATTRIBUTE_ALIGNED16(class) RAYCONTACT_API MeshShape : public btConcaveShape {
public:
    BT_DECLARE_ALIGNED_ALLOCATOR()

    /// Share one shape among any number of these. Throws InputError for none.
    explicit MeshShape(std::shared_ptr<const Shape> shape, Bounds bounds = Bounds::vertices);
    ~MeshShape() override;

    /// With the local scaling applied.
    const std::shared_ptr<const Shape>& shape() const {
        return scaled_;
    }
    /// For the library's own use.
    const std::shared_ptr<const BulletMesh>& in_bullet() const {
        return in_bullet_;
    }

    /// The world box, enlarged by the margin. It is kept for the next time that this transform, by its address, is
    /// asked about.
    void getAabb(const btTransform& t, btVector3& aabb_min, btVector3& aabb_max) const override;
    /// Those whose boxes meet this one, as Bullet asks for them.
    void processAllTriangles(btTriangleCallback * callback, const btVector3& aabb_min, const btVector3& aabb_max)
        const override;
    /// Diagonal of the true inertia tensor about the centre of mass for a closed mesh; that of its box for an open one.
    void calculateLocalInertia(btScalar mass, btVector3 & inertia) const override;
    /// Makes another Shape, which takes time. Throws InputError when a factor is zero or not finite, or makes the mesh
    /// too small or too large (Shape::make()).
    void setLocalScaling(const btVector3& scaling) override;
    /// As setLocalScaling() was given it; at first 1.
    const btVector3& getLocalScaling() const override {
        return scaling_;
    }
    /// For Bullet's own messages.
    const char* getName() const override {
        return "RayContactMesh";
    }
    /// As a btBvhTriangleMeshShape, with the vertices and triangles of the mesh after its repairs. Bullet's importers
    /// read it back as one, which the dispatcher takes as it takes this. They make bodies of such meshes static, and
    /// a world puts those to sleep. One that moved needs, in this order: removeRigidBody(body);
    /// body->setMassProps(mass, inertia), with the inertia of a MeshShape, since Bullet's meshes have none;
    /// body->updateInertiaTensor(); body->setCollisionFlags(0); addRigidBody(body); body->activate(true).
    int calculateSerializeBufferSize() const override;
    /// Writes it, as Bullet has it; returns the name of the struct.
    const char* serialize(void* data, btSerializer* serializer) const override;

private:
    std::shared_ptr<const Shape> original_;
    std::shared_ptr<const Shape> scaled_;
    std::shared_ptr<const BulletMesh> in_bullet_;
    btVector3 scaling_;
    Bounds bounds_;
};

} // namespace raycontact::bullet
