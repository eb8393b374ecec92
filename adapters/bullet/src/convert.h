// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mesh_tree.h>
#include <raycontact/shape.h>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace raycontact::bullet {

/// A converted Bullet mesh: what RayContact and the plane test need of it.
struct Converted {
    std::shared_ptr<const Shape> shape;
    std::shared_ptr<const MeshTree> tree;
};

/// What RayContact sees in a shape that is not a compound.
enum class Kind {
    mesh,  ///< MeshShape, GImpact mesh or part, BVH triangle mesh, scaled or not
    plane, ///< btStaticPlaneShape
    field, ///< btHeightfieldTerrainShape
    other, ///< left to Bullet
};
Kind kind_of(const btCollisionShape& shape);

/// The effective scaling of a mesh or field: if it changes, the shape must be converted again.
btVector3 scaling_of(const btCollisionShape& shape);

/// Shapes by content, so bodies with equal meshes share one and no pointer can go stale. Throws InputError for an
/// empty or damaged mesh interface.
class ShapeCache {
public:
    /// `shape` is of kind mesh or field.
    Converted get(const btCollisionShape& shape);
    /// Call it once a dispatch: drops shapes that no body has used for a while.
    void sweep();

private:
    struct Entry {
        Mesh mesh; ///< compared in full: equal hashes do not mean equal meshes
        Converted converted;
        std::uint64_t used = 0;
    };
    std::multimap<std::uint64_t, Entry> entries_; ///< by hash of the content
    std::uint64_t now_ = 0;
};

/// The same shape with its coordinates multiplied; windings turn when the product is negative. Throws InputError when
/// a factor is zero or not finite.
std::shared_ptr<const Shape> scale_shape(const Shape& shape, const btVector3& scaling);

} // namespace raycontact::bullet
