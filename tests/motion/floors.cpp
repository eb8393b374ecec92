// SPDX-License-Identifier: Apache-2.0
#include <tests/motion/floors.h>

#include <scenes/random.h>
#include <tests/holds/parts.h>
#include <tests/holds/scenes.h>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <cstdio>
#include <utility>

namespace raycontact::scenes {

namespace {

constexpr double width = floor_width;

std::string cells_of(std::uint32_t x, std::uint32_t y) {
    return std::to_string(x) + " x " + std::to_string(y);
}

Floor one_body(std::string name, StackShape shape, const Pose& pose) {
    return {std::move(name), {std::move(shape)}, {{.pose = pose, .fixed = true}}};
}

/// A box for who takes boxes, cut into cells for who takes meshes; its middle is its origin.
StackShape slab_of(double x, double y, std::uint32_t cells_x, std::uint32_t cells_y) {
    Mesh mesh = sheet(x, y, cells_x, cells_y, 1);
    for (Vec3& v : mesh.vertices) v.z += 0.5;
    StackShape shape = shape_of(std::move(mesh), true);
    shape.box = {x, y, 1};
    return shape;
}

Floor own_floor(std::string name, std::function<std::shared_ptr<btCollisionShape>()> own, double z) {
    StackShape shape = box_of({width, width, 1});
    shape.own = std::move(own);
    return one_body(std::move(name), std::move(shape), at(0, 0, z));
}

/// Bullet's shape looks at heights that others keep.
struct HeightField {
    static constexpr int points = 101;
    std::vector<float> heights = std::vector<float>(points * points, 0.0F);
    btHeightfieldTerrainShape shape{points, points, heights.data(), 1, -1, 1, 2, PHY_FLOAT, false};
};

} // namespace

Mesh sheet(double size_x, double size_y, std::uint32_t cells_x, std::uint32_t cells_y, double thick,
           const Height& height) {
    Mesh mesh;
    mesh.name = "floor";
    for (std::uint32_t j = 0; j <= cells_y; ++j)
        for (std::uint32_t i = 0; i <= cells_x; ++i) {
            const double x = size_x * (static_cast<double>(i) / cells_x - 0.5);
            const double y = size_y * (static_cast<double>(j) / cells_y - 0.5);
            mesh.vertices.push_back({x, y, height ? height(x, y) : 0});
        }
    const auto number = [&](std::uint32_t i, std::uint32_t j) { return j * (cells_x + 1) + i; };
    for (std::uint32_t j = 0; j < cells_y; ++j)
        for (std::uint32_t i = 0; i < cells_x; ++i) {
            const std::uint32_t a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1), d = number(i, j + 1);
            if ((i + j) % 2 == 0) {
                mesh.triangles.push_back({a, b, c});
                mesh.triangles.push_back({a, c, d});
            } else {
                mesh.triangles.push_back({a, b, d});
                mesh.triangles.push_back({b, c, d});
            }
        }
    if (!(thick > 0)) return mesh;
    const auto below = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t k = 0; k < below; ++k) {
        Vec3 v = mesh.vertices[k];
        v.z -= thick;
        mesh.vertices.push_back(v);
    }
    const std::size_t above = mesh.triangles.size();
    for (std::size_t k = 0; k < above; ++k) {
        const auto t = mesh.triangles[k];
        mesh.triangles.push_back({t[0] + below, t[2] + below, t[1] + below});
    }
    const auto wall = [&](std::uint32_t a, std::uint32_t b) {
        mesh.triangles.push_back({a, a + below, b + below});
        mesh.triangles.push_back({a, b + below, b});
    };
    for (std::uint32_t i = 0; i < cells_x; ++i) {
        wall(number(i, 0), number(i + 1, 0));
        wall(number(i + 1, cells_y), number(i, cells_y));
    }
    for (std::uint32_t j = 0; j < cells_y; ++j) {
        wall(number(cells_x, j), number(cells_x, j + 1));
        wall(number(0, j + 1), number(0, j));
    }
    return mesh;
}

Floor closed_floor(std::uint32_t cells_x, std::uint32_t cells_y) {
    return one_body("closed " + cells_of(cells_x, cells_y), slab_of(width, width, cells_x, cells_y), at(0, 0, -0.5));
}

Floor open_floor(std::uint32_t cells_x, std::uint32_t cells_y) {
    return one_body("open " + cells_of(cells_x, cells_y), shape_of(sheet(width, width, cells_x, cells_y, 0), false),
                    at(0, 0, 0));
}

Floor uneven_floor() {
    Random random(3);
    const Height height = [&](double, double) { return 1e-5 * random.symmetric(); };
    return one_body("uneven 100 x 100", shape_of(sheet(width, width, 100, 100, 1, height), false), at(0, 0, 0));
}

Floor box_floor() {
    return own_floor(
        "btBoxShape", [] { return std::make_shared<btBoxShape>(btVector3(width / 2, width / 2, btScalar(0.5))); },
        -0.5);
}

Floor plane_floor() {
    return own_floor(
        "plane", [] { return std::make_shared<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)); }, 0);
}

Floor height_field_floor() {
    return own_floor(
        "height field",
        [] {
            const auto field = std::make_shared<HeightField>();
            const btScalar cell = btScalar(width / (HeightField::points - 1));
            field->shape.setLocalScaling(btVector3(cell, cell, 1));
            return std::shared_ptr<btCollisionShape>(field, &field->shape);
        },
        0);
}

Floor joined_floor(std::uint32_t left, std::uint32_t right) {
    Mesh mesh;
    for (const auto& [side, cells] : {std::pair{-1, left}, {1, right}}) {
        const Mesh half = sheet(width / 2, width, std::max(1U, cells / 2), cells, 0);
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const Vec3& v : half.vertices) mesh.vertices.push_back({v.x + side * width / 4, v.y, v.z});
        for (const auto& t : half.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    mesh.name = "floor";
    return one_body("T-junctions " + std::to_string(left) + " to " + std::to_string(right),
                    shape_of(std::move(mesh), false), {});
}

Floor flush_floor(double gap, double rise, std::uint32_t cells) {
    char name[80];
    std::snprintf(name, sizeof name, "two slabs of %u x %u cells, %g mm apart, %g mm up", cells, cells, 1000 * gap,
                  1000 * rise);
    Floor floor{name, {slab_of(width / 2, width, cells, cells)}, {}};
    floor.bodies.push_back({.pose = at(-width / 4, 0, -0.5), .fixed = true});
    floor.bodies.push_back({.pose = at(width / 4 + gap, 0, -0.5 + rise), .fixed = true});
    return floor;
}

Floor tiled_floor(double uneven) {
    char name[80];
    std::snprintf(name, sizeof name, "144 cubes, %g mm up by turns", 1000 * uneven);
    Floor floor{name, {box_of({1, 1, 1})}, {}};
    for (int i = 0; i < 12; ++i)
        for (int k = 0; k < 12; ++k)
            floor.bodies.push_back(
                {.pose = at(i - 5.5, k - 5.5, -0.5 + ((i + k) % 2 == 0 ? 0 : uneven)), .fixed = true});
    return floor;
}

Floor stepped_floor(double rise) {
    char name[80];
    std::snprintf(name, sizeof name, "a step of %g mm", 1000 * rise);
    return one_body(name, shape_of(step(width, width, 1, rise), false), {});
}

} // namespace raycontact::scenes
