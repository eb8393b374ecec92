// SPDX-License-Identifier: Apache-2.0
#include <tests/motion/movers.h>

#include <scenes/models/machined.h>
#include <scenes/models/trigonometry.h>
#include <tests/holds/parts.h>
#include <tests/stacks/stack_world.h>

#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

namespace raycontact::scenes {

namespace {

using Own = std::function<std::shared_ptr<btCollisionShape>()>;

double lowest(const Mesh& mesh) {
    double low = 0;
    for (const Vec3& v : mesh.vertices) low = std::min(low, v.z);
    return -low;
}

Mover of_mesh(std::string name, Mesh mesh, bool convex) {
    centre(mesh);
    const double low = lowest(mesh);
    return {std::move(name), shape_of(std::move(mesh), convex), low};
}

/// The mesh has its mass.
Mover own(std::string name, Mover like, Own make) {
    like.name = std::move(name);
    like.shape.own = std::move(make);
    return like;
}

constexpr double edge_x = 0.3, edge_y = 0.24, edge_z = 0.2; // of the box
constexpr double radius = 0.15, height = 0.2;               // of cylinder and hull
constexpr double ball_radius = 0.1, capsule_length = 0.2;   // between the middles of its ends
constexpr std::uint32_t around = 24;

Mesh hull_mesh() {
    Mesh mesh = frustum(radius, 0.6 * radius, height, 7);
    centre(mesh);
    return mesh;
}

/// Its axis is x, and it stands on a face: with an even number of rings two are the widest.
Mesh lying_capsule(double between) {
    Mesh mesh = smooth_ball(ball_radius, around, around / 2);
    const SineCosine half_a_side = sine_cosine(0.5 / around);
    for (Vec3& v : mesh.vertices) {
        const double along = v.z + (v.z > 0 ? 0.5 : -0.5) * between;
        v = {along, half_a_side.sine * v.x + half_a_side.cosine * v.y,
             half_a_side.sine * v.y - half_a_side.cosine * v.x};
    }
    return mesh;
}

struct Piece {
    Vec3 size, middle;
};
/// A table: a plate and its legs.
std::vector<Piece> pieces() {
    std::vector<Piece> all{{{0.4, 0.3, 0.04}, {0, 0, 0.07}}};
    for (const double x : {-0.16, 0.16})
        for (const double y : {-0.11, 0.11}) all.push_back({{0.05, 0.05, 0.15}, {x, y, -0.025}});
    return all;
}

/// Its pieces touch: it has their mass, and nobody asks it for contacts.
Mesh table_mesh() {
    Mesh mesh;
    mesh.name = "table";
    for (const Piece& piece : pieces()) {
        const Mesh one = solid_box(piece.size);
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const Vec3& v : one.vertices)
            mesh.vertices.push_back({v.x + piece.middle.x, v.y + piece.middle.y, v.z + piece.middle.z});
        for (const auto& t : one.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return mesh;
}

/// Bullet's compound does not own its parts.
struct Table {
    explicit Table(const Vec3& middle, bool of_meshes) {
        for (const Piece& piece : pieces()) {
            if (of_meshes) {
                meshes.push_back(triangles_of(solid_box(piece.size)));
                auto mesh = std::make_unique<btGImpactMeshShape>(meshes.back().get());
                mesh->setMargin(0);
                mesh->updateBound();
                parts.push_back(std::move(mesh));
            } else {
                parts.push_back(std::make_unique<btBoxShape>(to_bullet(piece.size) / 2));
            }
            shape.addChildShape(btTransform(btQuaternion::getIdentity(), to_bullet(piece.middle) - to_bullet(middle)),
                                parts.back().get());
        }
    }
    std::vector<std::unique_ptr<btTriangleMesh>> meshes;
    std::vector<std::unique_ptr<btCollisionShape>> parts;
    btCompoundShape shape;
};

Mover table(const char* name, bool of_meshes) {
    Mesh mesh = table_mesh();
    const Vec3 middle = centre(mesh);
    return own(name, of_mesh(name, std::move(mesh), false), [=] {
        const auto whole = std::make_shared<Table>(middle, of_meshes);
        return std::shared_ptr<btCollisionShape>(whole, &whole->shape);
    });
}

} // namespace

Mover box() {
    return {"box", box_of({edge_x, edge_y, edge_z}), edge_z / 2};
}

Mover plate() {
    return {"plate of 5 mm", box_of({0.3, 0.2, 0.005}), 0.0025};
}

Mover cylinder() {
    return of_mesh("cylinder", frustum(radius, radius, height, around), true);
}

Mover hull() {
    return of_mesh("hull", hull_mesh(), true);
}

Mover ball_mesh() {
    return of_mesh("ball mesh", lying_capsule(0), true);
}

Mover capsule_mesh() {
    return of_mesh("capsule mesh", lying_capsule(capsule_length), true);
}

Mover pebble() {
    Mesh mesh = smooth_ball(0.15, 64, 39);
    for (Vec3& v : mesh.vertices) v.z = std::max(v.z, -0.1);
    return of_mesh("pebble", std::move(mesh), true);
}

Mover mug_on_its_foot() {
    return of_mesh("mug", mug(0.12, 0.24, 0.02), false);
}

Mover bullet_box() {
    return own("btBoxShape", box(), [] {
        return std::make_shared<btBoxShape>(to_bullet(Vec3{edge_x, edge_y, edge_z}) / 2);
    });
}

Mover bullet_cylinder() {
    return own("btCylinderShape", cylinder(), [] {
        return std::make_shared<btCylinderShapeZ>(to_bullet(Vec3{radius, radius, height / 2}));
    });
}

Mover bullet_hull() {
    return own("btConvexHullShape", hull(), [] {
        auto shape = std::make_shared<btConvexHullShape>();
        for (const Vec3& v : hull_mesh().vertices) shape->addPoint(to_bullet(v), false);
        shape->recalcLocalAabb();
        return shape;
    });
}

Mover bullet_ball() {
    Mover mover =
        own("btSphereShape", ball_mesh(), [] { return std::make_shared<btSphereShape>(btScalar(ball_radius)); });
    mover.low = ball_radius;
    return mover;
}

Mover bullet_capsule() {
    Mover mover = own("btCapsuleShape", capsule_mesh(), [] {
        return std::make_shared<btCapsuleShapeX>(btScalar(ball_radius), btScalar(capsule_length));
    });
    mover.low = ball_radius;
    return mover;
}

Mover compound() {
    return table("compound", false);
}

Mover compound_of_meshes() {
    return table("compound of meshes", true);
}

std::vector<Mover> all_movers() {
    return {box(),          plate(),       cylinder(),        hull(),       ball_mesh(),
            capsule_mesh(), pebble(),      mug_on_its_foot(), bullet_box(), bullet_cylinder(),
            bullet_hull(),  bullet_ball(), bullet_capsule(),  compound(),   compound_of_meshes()};
}

} // namespace raycontact::scenes
