// SPDX-License-Identifier: Apache-2.0
#include <convert.h>

#include <raycontact/bullet/mesh_shape.h>
#include <raycontact/error.h>
#include <stand_in.h>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btMultiSphereShape.h>
#include <BulletCollision/CollisionShapes/btScaledBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <bit>
#include <cmath>
#include <iterator>
#include <utility>

namespace raycontact::bullet {

namespace {

constexpr std::uint64_t keep_dispatches = 600;
constexpr std::uint64_t keep_stretched = 16; ///< where another of the same shape is made: its scale may change for ever

/// Locks one part of a mesh interface for as long as it lives.
struct Part {
    Part(const btStridingMeshInterface& mesh, int index) : mesh_(mesh), index_(index) {
        mesh.getLockedReadOnlyVertexIndexBase(&vertices, vertex_count, vertex_type, vertex_stride, &indices,
                                              index_stride, triangle_count, index_type, index);
    }
    ~Part() { mesh_.unLockReadOnlyVertexBase(index_); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

    std::uint32_t corner(int triangle, int k) const {
        const unsigned char* row = indices + static_cast<std::ptrdiff_t>(triangle) * index_stride;
        switch (index_type) {
        case PHY_INTEGER:
            return reinterpret_cast<const unsigned int*>(row)[k];
        case PHY_SHORT:
            return reinterpret_cast<const unsigned short*>(row)[k];
        default:
            return row[k];
        }
    }
    Vec3 vertex(int v) const {
        const unsigned char* row = vertices + static_cast<std::ptrdiff_t>(v) * vertex_stride;
        if (vertex_type == PHY_DOUBLE) {
            const double* p = reinterpret_cast<const double*>(row);
            return {p[0], p[1], p[2]};
        }
        const float* p = reinterpret_cast<const float*>(row);
        return {p[0], p[1], p[2]};
    }

    const unsigned char* vertices = nullptr;
    const unsigned char* indices = nullptr;
    int vertex_count = 0, vertex_stride = 0, index_stride = 0, triangle_count = 0;
    PHY_ScalarType vertex_type = PHY_FLOAT, index_type = PHY_INTEGER;

private:
    const btStridingMeshInterface& mesh_;
    int index_;
};

bool mirrors(const btVector3& s) {
    return s.x() * s.y() * s.z() < 0;
}

void append(Mesh& mesh, const btStridingMeshInterface& interface, int index, const btVector3& scaling) {
    const Part part(interface, index);
    if (part.vertex_type != PHY_FLOAT && part.vertex_type != PHY_DOUBLE)
        throw InputError(mesh.name + ": part " + std::to_string(index)
                         + " has vertices that are neither float nor double; convert them");
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.reserve(mesh.vertices.size() + static_cast<std::size_t>(part.vertex_count));
    mesh.triangles.reserve(mesh.triangles.size() + static_cast<std::size_t>(part.triangle_count));
    for (int v = 0; v < part.vertex_count; ++v) {
        const Vec3 p = part.vertex(v);
        mesh.vertices.push_back({p.x * static_cast<double>(scaling.x()), p.y * static_cast<double>(scaling.y()),
                                 p.z * static_cast<double>(scaling.z())});
    }
    for (int t = 0; t < part.triangle_count; ++t) {
        std::array<std::uint32_t, 3> corners{};
        for (int k = 0; k < 3; ++k) {
            corners[k] = part.corner(t, k);
            if (corners[k] >= static_cast<std::uint32_t>(part.vertex_count))
                throw InputError(mesh.name + ": triangle " + std::to_string(t) + " of part " + std::to_string(index)
                                 + " names vertex " + std::to_string(corners[k]) + " of "
                                 + std::to_string(part.vertex_count) + "; correct the index");
            corners[k] += base;
        }
        if (mirrors(scaling)) std::swap(corners[1], corners[2]);
        mesh.triangles.push_back(corners);
    }
}

/// A height field is open: its faces must point up, or it would support bodies from below.
struct FieldTriangles : btTriangleCallback {
    Mesh* mesh;
    std::vector<PlaceName>* names;
    int up;
    FieldTriangles(Mesh* m, std::vector<PlaceName>* n, int u) : mesh(m), names(n), up(u) {}
    void processTriangle(btVector3* t, int part, int index) override {
        names->push_back({part, index});
        const auto base = static_cast<std::uint32_t>(mesh->vertices.size());
        for (int k = 0; k < 3; ++k) mesh->vertices.push_back({double(t[k].x()), double(t[k].y()), double(t[k].z())});
        const bool looks_up = (t[1] - t[0]).cross(t[2] - t[0])[up] > 0;
        if (looks_up)
            mesh->triangles.push_back({base, base + 1, base + 2});
        else
            mesh->triangles.push_back({base, base + 2, base + 1});
    }
};

const btStridingMeshInterface* interface_of(const btCollisionShape& shape) {
    switch (shape.getShapeType()) {
    case TRIANGLE_MESH_SHAPE_PROXYTYPE:
    case MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE:
        return static_cast<const btBvhTriangleMeshShape&>(shape).getMeshInterface();
    case SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE:
        return static_cast<const btScaledBvhTriangleMeshShape&>(shape).getChildShape()->getMeshInterface();
    case GIMPACT_SHAPE_PROXYTYPE:
        return static_cast<const btGImpactShapeInterface&>(shape).getGImpactShapeType() == CONST_GIMPACT_TRIMESH_SHAPE
                   ? static_cast<const btGImpactMeshShape&>(shape).getMeshInterface()
                   : nullptr;
    default:
        return nullptr;
    }
}

void append_gimpact(Mesh& mesh, const btGImpactMeshShapePart& part) {
    const btPrimitiveManagerBase* base = part.getPrimitiveManager();
    const auto* manager = static_cast<const btGImpactMeshShapePart::TrimeshPrimitiveManager*>(base);
    append(mesh, *manager->m_meshInterface, part.getPart(), part.getLocalScaling());
}

/// names: of a field's triangles, otherwise none.
Mesh extract(const btCollisionShape& shape, std::vector<PlaceName>& names) {
    Mesh mesh;
    mesh.name = shape.getName();
    if (shape.getShapeType() == TERRAIN_SHAPE_PROXYTYPE) {
        const auto& field = static_cast<const btHeightfieldTerrainShape&>(shape);
        btVector3 low, high;
        field.getAabb(btTransform::getIdentity(), low, high);
        FieldTriangles triangles(&mesh, &names, field.getUpAxis());
        field.processAllTriangles(&triangles, low, high);
    } else if (shape.getShapeType() == GIMPACT_SHAPE_PROXYTYPE) {
        const auto& g = static_cast<const btGImpactShapeInterface&>(shape);
        if (g.getGImpactShapeType() == CONST_GIMPACT_TRIMESH_SHAPE_PART) {
            append_gimpact(mesh, static_cast<const btGImpactMeshShapePart&>(g));
        } else {
            const auto& whole = static_cast<const btGImpactMeshShape&>(g);
            for (int i = 0; i < whole.getMeshPartCount(); ++i) append_gimpact(mesh, *whole.getMeshPart(i));
        }
    } else if (const btStridingMeshInterface* interface = interface_of(shape)) {
        const btVector3 scaling = scaling_of(shape);
        for (int i = 0; i < interface->getNumSubParts(); ++i) append(mesh, *interface, i, scaling);
    }
    if (mesh.triangles.empty()) throw InputError(mesh.name + ": the collision shape has no triangles; fill it first");
    return mesh;
}

std::uint64_t mix(std::uint64_t hash, std::uint64_t word) {
    hash = (hash ^ word) * 0x9e3779b97f4a7c15ull;
    return hash ^ (hash >> 29);
}

std::uint64_t content_hash(const std::vector<btScalar>& numbers) {
    std::uint64_t hash = numbers.size();
    for (const btScalar n : numbers) hash = mix(hash, std::bit_cast<std::uint64_t>(double(n)));
    return hash;
}

/// Two hashes that differ in their beginnings and in how they mix: 128 bits stand for a mesh, which need not be kept.
std::array<std::uint64_t, 2> content_hashes(const Mesh& mesh) {
    std::uint64_t one = mesh.vertices.size(), two = ~std::uint64_t{mesh.triangles.size()};
    const auto add = [&](std::uint64_t word) {
        one = mix(one, word);
        two = (std::rotl(two, 23) ^ word) * 0xff51afd7ed558ccdull;
    };
    for (const Vec3& v : mesh.vertices) {
        for (const double c : {v.x, v.y, v.z}) add(std::bit_cast<std::uint64_t>(c));
    }
    for (const auto& t : mesh.triangles) {
        add(t[0] | std::uint64_t{t[1]} << 32);
        add(t[2]);
    }
    return {one, two};
}

/// Shape::make has the same limit.
constexpr btScalar most_metres = btScalar(1e9);

void check_point(const btCollisionShape& shape, const btVector3& p, const char* what, int number) {
    const auto fail = [&](const char* why) {
        throw InputError(std::string(shape.getName()) + ": " + what + ' ' + std::to_string(number) + why);
    };
    for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(p[k])) fail(", scaled, is not finite; correct it");
        if (btFabs(p[k]) > most_metres) fail(" is further than 1e9 m from the origin; scale the shape");
    }
}

void check_radius(const btCollisionShape& shape, btScalar radius) {
    if (!(radius >= 0 && radius <= most_metres))
        throw InputError(std::string(shape.getName()) + ": the radius " + std::to_string(radius)
                         + " is not from 0 to 1e9 m; correct it");
}

/// Whether anyone beside the cache has it. Its tree has its shape, too.
bool in_use(const Converted& converted) {
    return converted.tree.use_count() > 1;
}

/// A ball, or a capsule of two.
bool is_round(const btMultiSphereShape& shape) {
    const btVector3& scaling = shape.getLocalScaling();
    if (!(scaling.x() > 0 && scaling.x() == scaling.y() && scaling.x() == scaling.z())) return false;
    const int count = shape.getSphereCount();
    return count == 1 || (count == 2 && shape.getSphereRadius(0) == shape.getSphereRadius(1));
}

} // namespace

Kind kind_of(const btCollisionShape& shape) {
    switch (shape.getShapeType()) {
    case FAST_CONCAVE_MESH_PROXYTYPE:
        return dynamic_cast<const MeshShape*>(&shape) ? Kind::mesh : Kind::other;
    case TRIANGLE_MESH_SHAPE_PROXYTYPE:
    case SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE:
    case MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE:
        return Kind::mesh;
    case GIMPACT_SHAPE_PROXYTYPE:
        return static_cast<const btGImpactShapeInterface&>(shape).getGImpactShapeType() == CONST_GIMPACT_COMPOUND_SHAPE
                   ? Kind::other
                   : Kind::mesh;
    case STATIC_PLANE_PROXYTYPE:
        return Kind::plane;
    case TERRAIN_SHAPE_PROXYTYPE:
        return Kind::field;
    case SPHERE_SHAPE_PROXYTYPE:
    case CAPSULE_SHAPE_PROXYTYPE:
        return Kind::round;
    case MULTI_SPHERE_SHAPE_PROXYTYPE:
        return is_round(static_cast<const btMultiSphereShape&>(shape)) ? Kind::round : Kind::convex;
    default:
        return has_stand_in(shape) ? Kind::convex : Kind::other;
    }
}

unsigned kinds_in(const btCollisionShape& shape) {
    if (!shape.isCompound()) return bit(kind_of(shape));
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    unsigned kinds = 0;
    for (int i = 0; i < compound.getNumChildShapes(); ++i) kinds |= kinds_in(*compound.getChildShape(i));
    return kinds;
}

void aabb_once(const btCollisionShape& shape, const btTransform& transform, btVector3& low, btVector3& high) {
    const auto* own = dynamic_cast<const MeshShape*>(&shape);
    own ? own->aabb_once(transform, low, high) : shape.getAabb(transform, low, high);
}

btVector3 scaling_of(const btCollisionShape& shape) {
    switch (shape.getShapeType()) {
    case GIMPACT_SHAPE_PROXYTYPE: {
        // The parts scale; the whole shape's own factor stays 1 until it is set.
        const auto& g = static_cast<const btGImpactShapeInterface&>(shape);
        if (g.getGImpactShapeType() == CONST_GIMPACT_TRIMESH_SHAPE) {
            const auto& whole = static_cast<const btGImpactMeshShape&>(g);
            if (whole.getMeshPartCount() > 0) return whole.getMeshPart(0)->getLocalScaling();
        }
        return g.getLocalScaling();
    }
    case SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE:
        return interface_of(shape)->getScaling() * shape.getLocalScaling();
    case TRIANGLE_MESH_SHAPE_PROXYTYPE:
    case MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE:
        return interface_of(shape)->getScaling();
    default:
        return shape.getLocalScaling();
    }
}

PlaceName name_of_triangle(const btCollisionShape& shape, int triangle) {
    if (shape.getShapeType() == GIMPACT_SHAPE_PROXYTYPE) {
        const auto& g = static_cast<const btGImpactShapeInterface&>(shape);
        if (g.getGImpactShapeType() == CONST_GIMPACT_TRIMESH_SHAPE_PART)
            return {static_cast<const btGImpactMeshShapePart&>(g).getPart(), triangle};
    }
    PlaceName name{0, triangle};
    const btStridingMeshInterface* mesh = interface_of(shape);
    for (; mesh && name.part < mesh->getNumSubParts(); ++name.part) {
        const int count = Part(*mesh, name.part).triangle_count;
        if (name.index < count) break;
        name.index -= count;
    }
    return name;
}

Form form_of(const btCollisionShape& shape) {
    Form form;
    form.type = shape.getShapeType();
    const auto take_box = [&] {
        shape.getAabb(btTransform::getIdentity(), form.low, form.high);
        form.low.setW(0);
        form.high.setW(0);
    };
    switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
        form.size = static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin();
        break;
    case CYLINDER_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btCylinderShape&>(shape);
        form.size = s.getHalfExtentsWithMargin();
        form.count = s.getUpAxis();
        break;
    }
    case CONE_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btConeShape&>(shape);
        form.size.setValue(s.getRadius(), s.getHeight(), 0);
        form.count = s.getConeUpIndex();
        break;
    }
    case CONVEX_HULL_SHAPE_PROXYTYPE:
        form.size = shape.getLocalScaling();
        form.count = static_cast<const btConvexHullShape&>(shape).getNumPoints();
        take_box();
        break;
    case MULTI_SPHERE_SHAPE_PROXYTYPE:
        form.size = shape.getLocalScaling();
        form.count = static_cast<const btMultiSphereShape&>(shape).getSphereCount();
        take_box();
        break;
    case SPHERE_SHAPE_PROXYTYPE:
    case CAPSULE_SHAPE_PROXYTYPE:
        break; // read anew in every step
    case TERRAIN_SHAPE_PROXYTYPE:
        form.size = scaling_of(shape);
        take_box();
        break;
    default:
        form.size = scaling_of(shape);
        if (const auto* own = dynamic_cast<const MeshShape*>(&shape)) {
            form.data = own->shape().get();
        } else if (const btStridingMeshInterface* mesh = interface_of(shape)) {
            form.data = mesh;
            const auto* array = dynamic_cast<const btTriangleIndexVertexArray*>(mesh);
            if (array && array->getIndexedMeshArray().size() > 0) {
                form.vertices = array->getIndexedMeshArray()[0].m_vertexBase;
                form.count = array->getIndexedMeshArray()[0].m_numTriangles;
            }
        }
    }
    form.size.setW(0);
    return form;
}

void check_numbers(const btCollisionShape& shape) {
    switch (shape.getShapeType()) {
    case SPHERE_SHAPE_PROXYTYPE:
        check_radius(shape, static_cast<const btSphereShape&>(shape).getRadius());
        break;
    case CAPSULE_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btCapsuleShape&>(shape);
        check_radius(shape, s.getRadius());
        if (!(s.getHalfHeight() >= 0 && s.getHalfHeight() <= most_metres))
            throw InputError(std::string(shape.getName()) + ": half the height is not from 0 to 1e9 m; correct it");
        break;
    }
    case MULTI_SPHERE_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btMultiSphereShape&>(shape);
        for (int i = 0; i < s.getSphereCount(); ++i) {
            check_radius(shape, s.getSphereRadius(i));
            const btScalar radius = s.getSphereRadius(i);
            const btVector3 reach(radius, radius, radius);
            check_point(shape, (s.getSpherePosition(i).absolute() + reach) * s.getLocalScaling(), "sphere", i);
        }
        break;
    }
    case CONVEX_HULL_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btConvexHullShape&>(shape);
        for (int i = 0; i < s.getNumPoints(); ++i) check_point(shape, s.getScaledPoint(i), "point", i);
        break;
    }
    case STATIC_PLANE_PROXYTYPE: {
        const auto& s = static_cast<const btStaticPlaneShape&>(shape);
        const btVector3& n = s.getPlaneNormal();
        if (!(std::isfinite(n.x()) && std::isfinite(n.y()) && std::isfinite(n.z()) && !n.isZero()))
            throw InputError(std::string(shape.getName()) + ": the normal is zero or not finite; correct it");
        if (!std::isfinite(s.getPlaneConstant()))
            throw InputError(std::string(shape.getName()) + ": the plane constant is not finite; correct it");
        break;
    }
    default:
        break;
    }
}

Converted ShapeCache::convert(Mesh mesh, Repair repair) {
    ++made_;
    PreparedMesh prepared = prepare_mesh(mesh, repair, Nesting::as_wound, Check::topology, threads_);
    mesh = {}; // a large one is large beside its shape
    const auto shape = Shape::make(std::move(prepared), threads_);
    return {shape, std::make_shared<const MeshTree>(shape)};
}

// By its numbers: the stand-in is not made to find out whether it is there.
Converted ShapeCache::get_convex(const btCollisionShape& shape) {
    std::vector<btScalar> numbers = surface_numbers(shape);
    const std::uint64_t hash = content_hash(numbers);
    const auto [first, last] = entries_.equal_range(hash);
    for (auto i = first; i != last; ++i) {
        if (i->second.numbers == numbers) {
            i->second.used = now_;
            return i->second.converted;
        }
    }
    check_numbers(shape); // Bullet's hull of points that are not finite never ends
    sweep();
    Entry entry;
    Mesh mesh = stand_in(shape);
    if (!mesh.triangles.empty()) entry.converted = convert(std::move(mesh), Repair::allowed);
    entry.numbers = std::move(numbers);
    entry.used = now_;
    return entries_.emplace(hash, std::move(entry))->second.converted;
}

Converted ShapeCache::get(const btCollisionShape& shape) {
    if (has_stand_in(shape)) return get_convex(shape);
    if (const auto* own = dynamic_cast<const MeshShape*>(&shape)) return {own->shape(), own->tree()};
    std::vector<PlaceName> names;
    Mesh mesh = extract(shape, names);
    const auto [hash, second_hash] = content_hashes(mesh);
    const auto [first, last] = entries_.equal_range(hash);
    for (auto i = first; i != last; ++i) {
        const auto& known_names = i->second.converted.names;
        if (i->second.numbers.empty() && i->second.second_hash == second_hash
            && (known_names ? *known_names == names : names.empty())) {
            i->second.used = now_;
            return i->second.converted;
        }
    }
    sweep();
    Entry entry;
    // We chose the windings of a height field; for an open sheet repairs could only guess.
    const Repair repair = kind_of(shape) == Kind::field ? Repair::as_is : Repair::allowed;
    entry.converted = convert(std::move(mesh), repair);
    if (!names.empty()) entry.converted.names = std::make_shared<const std::vector<PlaceName>>(std::move(names));
    entry.second_hash = second_hash;
    entry.used = now_;
    return entries_.emplace(hash, std::move(entry))->second.converted;
}

Converted ShapeCache::get_again(const btCollisionShape& shape) {
    // These have few numbers to read, or none.
    if (has_stand_in(shape) || dynamic_cast<const MeshShape*>(&shape)) return get(shape);
    Known now;
    now.form = form_of(shape);
    shape.getAabb(btTransform::getIdentity(), now.low, now.high);
    const auto found = known_.find(&shape);
    if (found != known_.end() && found->second.form == now.form && found->second.low == now.low
        && found->second.high == now.high) {
        found->second.used = now_;
        return found->second.converted;
    }
    sweep();
    now.converted = get(shape);
    now.used = now_;
    known_[&shape] = now;
    return now.converted;
}

Converted ShapeCache::stretched(const Converted& converted, const Stretch& stretch) {
    if (stretch == no_stretch) return converted;
    const std::pair key(converted.shape.get(), stretch);
    auto found = stretched_.find(key);
    if (found == stretched_.end()) {
        sweep();
        std::erase_if(stretched_, [&](const auto& one) {
            return one.first.first == key.first && !in_use(one.second.converted)
                   && one.second.used + keep_stretched < now_;
        });
        ++made_;
        const auto shape = stretch_shape(*converted.shape, stretch, threads_);
        const Converted made{shape, std::make_shared<const MeshTree>(shape), converted.names};
        found = stretched_.emplace(key, Stretched{converted, made}).first;
    }
    found->second.used = now_;
    return found->second.converted;
}

void ShapeCache::sweep() {
    ++now_;
    if (now_ % 64 != 0) return;
    std::erase_if(known_, [&](const auto& known) { return known.second.used + keep_dispatches < now_; });
    const auto drop = [&](auto& made) { // what a body has is in use
        for (auto i = made.begin(); i != made.end();) {
            auto& entry = i->second;
            if (in_use(entry.converted)) entry.used = now_;
            i = entry.used + keep_dispatches < now_ ? made.erase(i) : std::next(i);
        }
    };
    drop(stretched_);
    drop(entries_);
}

std::shared_ptr<const Shape> stretch_shape(const Shape& shape, const Stretch& s, std::uint32_t threads) {
    for (const double x : s)
        if (!std::isfinite(x)) throw InputError(shape.name() + ": its scaling must be finite");
    const bool mirrored =
        s[0] * (s[4] * s[8] - s[5] * s[7]) - s[1] * (s[3] * s[8] - s[5] * s[6]) + s[2] * (s[3] * s[7] - s[4] * s[6])
        < 0;
    Mesh plain;
    plain.name = shape.name();
    plain.vertices.reserve(shape.vertices().size());
    for (const Vec3& v : shape.vertices())
        plain.vertices.push_back({s[0] * v.x + s[1] * v.y + s[2] * v.z, s[3] * v.x + s[4] * v.y + s[5] * v.z,
                                  s[6] * v.x + s[7] * v.y + s[8] * v.z});
    plain.triangles.assign(shape.triangles().begin(), shape.triangles().end());
    if (mirrored)
        for (auto& t : plain.triangles) std::swap(t[1], t[2]);
    // Lengths, areas and volumes have changed: check again, but keep the file's indices.
    PreparedMesh mesh;
    mesh.report = prepare_mesh(plain, Repair::as_is, Nesting::as_wound, Check::topology, threads).report;
    mesh.name = std::move(plain.name);
    mesh.vertices = std::move(plain.vertices);
    mesh.triangles = std::move(plain.triangles);
    mesh.vertex_index.assign(shape.vertex_index().begin(), shape.vertex_index().end());
    mesh.triangle_index.assign(shape.triangle_index().begin(), shape.triangle_index().end());
    return Shape::make(std::move(mesh), threads);
}

} // namespace raycontact::bullet
