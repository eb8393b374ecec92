// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bullet_mesh.h>
#include <placement.h>
#include <raycontact/bullet/dispatcher.h>
#include <raycontact/shape.h>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

namespace raycontact::bullet {

/// A place on a shape as Bullet's callbacks name it: sub-part and triangle of a mesh; -1 of a shape without triangles.
/// Of a height field Bullet's two numbers are twice the column, plus one in its second triangle, and the row.
struct PlaceName {
    int part = -1, index = -1;
    friend bool operator==(const PlaceName&, const PlaceName&) = default;
};

/// A converted Bullet mesh, or a convex shape's stand-in: what RayContact and the tests of planes and balls need of it.
/// Without a shape where a convex shape is flat.
struct Converted {
    std::shared_ptr<const Shape> shape;
    std::shared_ptr<const BulletMesh> in_bullet;
    std::shared_ptr<const std::vector<PlaceName>> names{}; ///< of a field's triangles; null of other shapes
};

/// What RayContact sees in a shape that is not a compound.
enum class Kind {
    mesh,   ///< MeshShape, GImpact mesh or part, BVH triangle mesh, scaled or not
    plane,  ///< btStaticPlaneShape
    field,  ///< btHeightfieldTerrainShape
    convex, ///< one for which a mesh can stand: box, cylinder, cone, hull, multi-sphere
    round,  ///< ball or capsule, also as a multi-sphere of one ball, or of two equal ones
    other,  ///< left to Bullet
};
Kind kind_of(const btCollisionShape& shape, ConvexShapes convex = ConvexShapes::by_mesh);
/// The kinds of a shape and of all its children, a bit for each.
unsigned kinds_in(const btCollisionShape& shape, ConvexShapes convex);
constexpr unsigned bit(Kind kind) {
    return 1u << static_cast<unsigned>(kind);
}

/// The effective scaling of a mesh or field.
btVector3 scaling_of(const btCollisionShape& shape);

/// Of a mesh. triangle: counted through all sub-parts.
PlaceName name_of_triangle(const btCollisionShape& shape, int triangle);

/// Throws InputError where a point, radius, height or normal of a ball, capsule, plane, hull or multi-sphere is of no
/// use: not finite, negative or out of range. Of other shapes meshes are made, which are checked then.
void check_numbers(const btCollisionShape& shape);

/// Equal, or not a number in the same places: what is not usable has not changed either.
inline bool alike(const btVector3& a, const btVector3& b) {
    for (int k = 0; k < 3; ++k)
        if (!(a[k] == b[k] || (a[k] != a[k] && b[k] != b[k]))) return false;
    return true;
}

/// What can be compared in every step: if it changes, the shape must be converted again. A new shape may have the
/// address of a deleted one; where all of this is the same, too, refresh() must be called.
struct Form {
    int type = INVALID_SHAPE_PROXYTYPE;
    btVector3 size{0, 0, 0}; ///< scaling or dimensions
    int count = 0;           ///< points of a hull, balls of a multi-sphere, triangles of a mesh; the axis of others
    btVector3 low{0, 0, 0}, high{0, 0, 0}; ///< box of a hull, multi-sphere or field
    const void* data = nullptr;            ///< a mesh's interface, or Shape
    const void* vertices = nullptr;        ///< of its first part, where the interface tells without a lock
    friend bool operator==(const Form& a, const Form& b) {
        return a.type == b.type && alike(a.size, b.size) && a.count == b.count && alike(a.low, b.low)
               && alike(a.high, b.high) && a.data == b.data && a.vertices == b.vertices;
    }
};
Form form_of(const btCollisionShape& shape);

/// Shapes by content, so bodies with equal meshes share one and no pointer can go stale. Throws InputError for an
/// empty or damaged mesh interface.
class ShapeCache {
public:
    /// threads: of those that make a shape; 0: one per core.
    explicit ShapeCache(std::uint32_t threads) : threads_(threads) {}
    /// `shape` is of kind mesh, field or convex.
    Converted get(const btCollisionShape& shape);
    /// The same for a shape that is asked for again and again without a body: a mesh interface or field is read anew
    /// only when its form or box changes, after forget(), or if it was not asked for in a while.
    Converted get_again(const btCollisionShape& shape);
    /// The same, stretched, and wound the other way if `reversed`; one for all that are made alike. Throws InputError
    /// where no mesh is left.
    Converted stretched(const Converted& converted, const Stretch& stretch, bool reversed = false);
    void forget(const btCollisionShape& shape) { known_.erase(&shape); }
    /// How many shapes it has made so far.
    std::uint64_t made() const { return made_; }
    /// Call it once a dispatch: drops shapes that no body has used for a while. Making shapes counts as time, too, so
    /// that memory is bounded where nothing is ever dispatched.
    void sweep();

private:
    using Hashes = std::array<std::uint64_t, 2>;
    struct Entry {
        Converted converted;
        std::uint64_t used = 0;
    };
    /// What get_again() knows by address. Its form has the box of any shape: a new mesh may lie where an old one lay.
    struct Known : Entry {
        Form form;
    };
    struct Stretched : Entry {
        Converted original; ///< kept, since its shape's address is a key
    };
    Converted convert(Mesh mesh, Repair repair);

    std::uint32_t threads_;
    std::map<Hashes, Entry> entries_; ///< by the content
    std::unordered_map<const btCollisionShape*, Known> known_;
    std::map<std::tuple<const Shape*, Stretch, bool>, Stretched> stretched_; ///< by the original, and what was done
    std::uint64_t now_ = 0, made_ = 0;
};

/// The same shape, stretched in its own frame, with the file's indices; windings turn when it is mirrored, and when
/// `reversed`. Throws InputError when an entry is not finite or the result has no area. threads: as of Shape::make.
std::shared_ptr<const Shape> stretch_shape(const Shape& shape, const Stretch& stretch, std::uint32_t threads = 0,
                                           bool reversed = false);

} // namespace raycontact::bullet
