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

/// Calls visit(interface, part, scaling) for each part of a mesh of Bullet's.
template <class Visit>
void each_part(const btCollisionShape& shape, Visit&& visit) {
    const auto all_of = [&](const btBvhTriangleMeshShape& whole, const btVector3& scaling) {
        const btStridingMeshInterface& mesh = *whole.getMeshInterface();
        for (int i = 0; i < mesh.getNumSubParts(); ++i) visit(mesh, i, mesh.getScaling() * scaling);
    };
    const auto one = [&](const btGImpactMeshShapePart& part) {
        const btPrimitiveManagerBase* base = part.getPrimitiveManager();
        const auto* manager = static_cast<const btGImpactMeshShapePart::TrimeshPrimitiveManager*>(base);
        visit(*manager->m_meshInterface, part.getPart(), part.getLocalScaling());
    };
    switch (shape.getShapeType()) {
    case TRIANGLE_MESH_SHAPE_PROXYTYPE:
    case MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE:
        all_of(static_cast<const btBvhTriangleMeshShape&>(shape), btVector3(1, 1, 1));
        break;
    case SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE:
        all_of(*static_cast<const btScaledBvhTriangleMeshShape&>(shape).getChildShape(), shape.getLocalScaling());
        break;
    case GIMPACT_SHAPE_PROXYTYPE: {
        const auto& g = static_cast<const btGImpactShapeInterface&>(shape);
        if (g.getGImpactShapeType() == CONST_GIMPACT_TRIMESH_SHAPE_PART)
            return one(static_cast<const btGImpactMeshShapePart&>(g));
        const auto& whole = static_cast<const btGImpactMeshShape&>(g);
        for (int i = 0; i < whole.getMeshPartCount(); ++i) one(*whole.getMeshPart(i));
        break;
    }
    default:
        break;
    }
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
    }
    each_part(shape, [&](const btStridingMeshInterface& interface, int part, const btVector3& scaling) {
        append(mesh, interface, part, scaling);
    });
    if (mesh.triangles.empty()) throw InputError(mesh.name + ": the collision shape has no triangles; fill it first");
    return mesh;
}

/// Two hashes that differ in how they mix: 128 bits stand for what a shape is made of, which need not be kept.
struct ContentHash {
    std::array<std::uint64_t, 2> hashes{0, ~std::uint64_t{0}};

    void add(std::uint64_t word) {
        auto& [one, two] = hashes;
        one = (one ^ word) * 0x9e3779b97f4a7c15ull;
        one ^= one >> 29;
        two = (std::rotl(two, 23) ^ word) * 0xff51afd7ed558ccdull;
    }
    void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
};

std::array<std::uint64_t, 2> content_of(const Mesh& mesh, const std::vector<PlaceName>& names) {
    ContentHash hash;
    for (const std::size_t size : {mesh.vertices.size(), mesh.triangles.size(), names.size()})
        hash.add(std::uint64_t{size});
    for (const Vec3& v : mesh.vertices)
        for (const double c : {v.x, v.y, v.z}) hash.add(c);
    for (const auto& t : mesh.triangles) {
        hash.add(t[0] | std::uint64_t{t[1]} << 32);
        hash.add(std::uint64_t{t[2]});
    }
    for (const PlaceName& name : names) hash.add(double(name.part)), hash.add(double(name.index));
    return hash.hashes;
}

/// Of a convex shape, by its numbers: the stand-in is not made to find out whether it is there.
std::array<std::uint64_t, 2> content_of(const btCollisionShape& convex) {
    ContentHash hash;
    for (const btScalar number : surface_numbers(convex)) hash.add(double(number));
    return hash.hashes;
}

/// Shape::make has the same limit.
constexpr btScalar most_metres = btScalar(1e9);

[[noreturn]] void refuse(const btCollisionShape& shape, const std::string& why) {
    throw InputError(std::string(shape.getName()) + ": " + why);
}

void check_point(const btCollisionShape& shape, const btVector3& p, const char* what, int number) {
    const std::string name = what + (' ' + std::to_string(number));
    for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(p[k])) refuse(shape, name + ", scaled, is not finite; correct it");
        if (btFabs(p[k]) > most_metres) refuse(shape, name + " is further than 1e9 m from the origin; scale the shape");
    }
}

void check_radius(const btCollisionShape& shape, btScalar radius) {
    if (!(radius >= 0 && radius <= most_metres))
        refuse(shape, "the radius " + std::to_string(radius) + " is not from 0 to 1e9 m; correct it");
}

/// Whether anyone beside the cache has it. It has its shape, too.
bool in_use(const Converted& converted) {
    return converted.in_bullet.use_count() > 1;
}

/// A ball, or a capsule of two.
bool is_round(const btMultiSphereShape& shape) {
    const btVector3& scaling = shape.getLocalScaling();
    if (!(scaling.x() > 0 && scaling.x() == scaling.y() && scaling.x() == scaling.z())) return false;
    const int count = shape.getSphereCount();
    return count == 1 || (count == 2 && shape.getSphereRadius(0) == shape.getSphereRadius(1));
}

} // namespace

Kind kind_of(const btCollisionShape& shape, ConvexShapes convex) {
    const bool ours = convex != ConvexShapes::bullet;
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
        return ours ? Kind::round : Kind::other;
    case MULTI_SPHERE_SHAPE_PROXYTYPE:
        if (ours && is_round(static_cast<const btMultiSphereShape&>(shape))) return Kind::round;
        [[fallthrough]];
    case BOX_SHAPE_PROXYTYPE:
    case CYLINDER_SHAPE_PROXYTYPE:
    case CONE_SHAPE_PROXYTYPE:
    case CONVEX_HULL_SHAPE_PROXYTYPE:
        return ours ? Kind::convex : Kind::other;
    default:
        return Kind::other;
    }
}

unsigned kinds_in(const btCollisionShape& shape, ConvexShapes convex) {
    if (!shape.isCompound()) return bit(kind_of(shape, convex));
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    unsigned kinds = 0;
    for (int i = 0; i < compound.getNumChildShapes(); ++i) kinds |= kinds_in(*compound.getChildShape(i), convex);
    return kinds;
}

btVector3 scaling_of(const btCollisionShape& shape) {
    btVector3 scaling = shape.getLocalScaling();
    each_part(shape, [&](const btStridingMeshInterface&, int, const btVector3& of_part) { scaling = of_part; });
    return scaling;
}

PlaceName name_of_triangle(const btCollisionShape& shape, int triangle) {
    PlaceName name{0, triangle};
    bool found = false, has_parts = false; // none: a shape of ours
    each_part(shape, [&](const btStridingMeshInterface& mesh, int part, const btVector3&) {
        has_parts = true;
        if (found) return;
        name.part = part;
        const int count = Part(mesh, part).triangle_count;
        found = name.index < count;
        if (!found) name.index -= count;
    });
    return found || !has_parts ? name : PlaceName{}; // what spans a hole has none
}

Form form_of(const btCollisionShape& shape) {
    Form form;
    form.type = shape.getShapeType();
    form.size = scaling_of(shape);
    const auto take_box = [&] { shape.getAabb(btTransform::getIdentity(), form.low, form.high); };
    switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
        form.size = static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin();
        break;
    case CYLINDER_SHAPE_PROXYTYPE:
        form.size = static_cast<const btCylinderShape&>(shape).getHalfExtentsWithMargin();
        form.count = static_cast<const btCylinderShape&>(shape).getUpAxis();
        break;
    case CONE_SHAPE_PROXYTYPE: {
        const auto& s = static_cast<const btConeShape&>(shape);
        form.size.setValue(s.getRadius(), s.getHeight(), 0);
        form.count = s.getConeUpIndex();
        break;
    }
    case CONVEX_HULL_SHAPE_PROXYTYPE:
        form.count = static_cast<const btConvexHullShape&>(shape).getNumPoints();
        take_box();
        break;
    case MULTI_SPHERE_SHAPE_PROXYTYPE:
        form.count = static_cast<const btMultiSphereShape&>(shape).getSphereCount();
        take_box();
        break;
    case TERRAIN_SHAPE_PROXYTYPE:
        take_box();
        break;
    default:
        if (const auto* own = dynamic_cast<const MeshShape*>(&shape)) {
            form.data = own->shape().get();
            break;
        }
        each_part(shape, [&](const btStridingMeshInterface& mesh, int, const btVector3&) {
            if (form.data) return;
            form.data = &mesh;
            const auto* array = dynamic_cast<const btTriangleIndexVertexArray*>(&mesh);
            if (!array || array->getIndexedMeshArray().size() == 0) return;
            form.vertices = array->getIndexedMeshArray()[0].m_vertexBase;
            form.count = array->getIndexedMeshArray()[0].m_numTriangles;
        });
    }
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
            refuse(shape, "half the height is not from 0 to 1e9 m; correct it");
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
            refuse(shape, "the normal is zero or not finite; correct it");
        if (!std::isfinite(s.getPlaneConstant())) refuse(shape, "the plane constant is not finite; correct it");
        break;
    }
    default:
        break;
    }
}

Converted ShapeCache::convert(Mesh mesh, Repair repair) {
    ++made_;
    PreparedMesh prepared = prepare_mesh(mesh, {.repair = repair, .check = Check::topology, .threads = threads_});
    mesh = {}; // a large one is large beside its shape
    const auto shape = Shape::make(std::move(prepared), threads_);
    return {shape, std::make_shared<const BulletMesh>(shape)};
}

Converted ShapeCache::get(const btCollisionShape& shape) {
    if (const auto* own = dynamic_cast<const MeshShape*>(&shape)) return {own->shape(), own->in_bullet()};
    const Kind kind = kind_of(shape);
    std::vector<PlaceName> names;
    Mesh mesh;
    if (kind != Kind::convex) mesh = extract(shape, names);
    const Hashes content = kind == Kind::convex ? content_of(shape) : content_of(mesh, names);
    auto found = entries_.find(content);
    if (found == entries_.end()) {
        if (kind == Kind::convex) {
            check_numbers(shape); // Bullet's hull of points that are not finite never ends
            mesh = stand_in(shape);
        }
        sweep();
        Entry entry;
        // We chose the windings of a height field; for an open sheet repairs could only guess.
        if (!mesh.triangles.empty())
            entry.converted = convert(std::move(mesh), kind == Kind::field ? Repair::as_is : Repair::allowed);
        if (!names.empty()) entry.converted.names = std::make_shared<const std::vector<PlaceName>>(std::move(names));
        found = entries_.emplace(content, std::move(entry)).first;
    }
    found->second.used = now_;
    return found->second.converted;
}

Converted ShapeCache::get_again(const btCollisionShape& shape) {
    // These have few numbers to read, or none.
    if (kind_of(shape) == Kind::convex || dynamic_cast<const MeshShape*>(&shape)) return get(shape);
    Form form = form_of(shape);
    shape.getAabb(btTransform::getIdentity(), form.low, form.high);
    auto found = known_.find(&shape);
    if (found == known_.end() || found->second.form != form) {
        sweep();
        found = known_.insert_or_assign(&shape, Known{{get(shape)}, form}).first;
    }
    found->second.used = now_;
    return found->second.converted;
}

Converted ShapeCache::stretched(const Converted& converted, const Stretch& stretch, bool reversed) {
    if (stretch == no_stretch && !reversed) return converted;
    const std::tuple key(converted.shape.get(), stretch, reversed);
    auto found = stretched_.find(key);
    if (found == stretched_.end()) {
        sweep();
        std::erase_if(stretched_, [&](const auto& one) {
            return std::get<0>(one.first) == std::get<0>(key) && !in_use(one.second.converted)
                   && one.second.used + keep_stretched < now_;
        });
        ++made_;
        const auto shape = stretch_shape(*converted.shape, stretch, threads_, reversed);
        const Converted made{shape, std::make_shared<const BulletMesh>(shape), converted.names};
        found = stretched_.emplace(key, Stretched{{made}, converted}).first;
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

std::shared_ptr<const Shape> stretch_shape(const Shape& shape, const Stretch& s, std::uint32_t threads, bool reversed) {
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
    if (mirrored != reversed)
        for (auto& t : plain.triangles) std::swap(t[1], t[2]);
    // Lengths, areas and volumes have changed: check again, but keep the file's indices.
    PreparedMesh mesh;
    mesh.report = prepare_mesh(plain, {.repair = Repair::as_is, .check = Check::topology, .threads = threads}).report;
    mesh.report.file_vertices = shape.report().file_vertices;
    mesh.report.file_triangles = shape.report().file_triangles;
    mesh.report.holes = shape.report().holes;
    mesh.report.spanning = shape.report().spanning;
    mesh.report.solid = mesh.report.solid && shape.report().solid; // what holds nothing is not looked at as it is
    mesh.name = std::move(plain.name);
    mesh.vertices = std::move(plain.vertices);
    mesh.triangles = std::move(plain.triangles);
    mesh.vertex_index.assign(shape.vertex_index().begin(), shape.vertex_index().end());
    mesh.triangle_index.assign(shape.triangle_index().begin(), shape.triangle_index().end());
    return Shape::make(std::move(mesh), threads);
}

} // namespace raycontact::bullet
