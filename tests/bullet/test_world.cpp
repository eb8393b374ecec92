// SPDX-License-Identifier: Apache-2.0
#include "test_world.h"

#include <scenes/models/model.h>

#include <algorithm>

namespace raycontact::test {

namespace {

/// The outer surface of a set of unit cells: faces between two filled cells are left out, so the result is closed.
Mesh cells_mesh(const std::vector<std::array<int, 3>>& cells, double x, double y, double z) {
    Mesh mesh;
    const auto filled = [&](int i, int j, int k) {
        return std::find(cells.begin(), cells.end(), std::array<int, 3>{i, j, k}) != cells.end();
    };
    const auto vertex = [&](int i, int j, int k) {
        const Vec3 v{i * x, j * y, k * z};
        const auto found = std::find(mesh.vertices.begin(), mesh.vertices.end(), v);
        if (found != mesh.vertices.end()) return static_cast<std::uint32_t>(found - mesh.vertices.begin());
        mesh.vertices.push_back(v);
        return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    };
    for (const auto& c : cells) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) {
                std::array<int, 3> beyond = c;
                beyond[axis] += side ? 1 : -1;
                if (filled(beyond[0], beyond[1], beyond[2])) continue;
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                std::array<std::uint32_t, 4> corner{};
                for (int k = 0; k < 4; ++k) {
                    std::array<int, 3> p = c;
                    p[axis] += side;
                    p[u] += (k == 1 || k == 2) ? 1 : 0;
                    p[v] += (k >= 2) ? 1 : 0;
                    corner[static_cast<std::size_t>(k)] = vertex(p[0], p[1], p[2]);
                }
                if (!side) std::swap(corner[1], corner[3]);
                mesh.triangles.push_back({corner[0], corner[1], corner[2]});
                mesh.triangles.push_back({corner[0], corner[2], corner[3]});
            }
        }
    }
    Vec3 low = mesh.vertices[0], high = low;
    for (const Vec3& v : mesh.vertices) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    for (Vec3& v : mesh.vertices)
        v = {v.x - (low.x + high.x) / 2, v.y - (low.y + high.y) / 2, v.z - (low.z + high.z) / 2};
    return mesh;
}

} // namespace

Mesh box_mesh(double x, double y, double z) {
    Mesh mesh = cells_mesh({{0, 0, 0}}, x, y, z);
    mesh.name = "box";
    return mesh;
}

Mesh table_mesh() {
    std::vector<std::array<int, 3>> cells;
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 5; ++j) {
            cells.push_back({i, j, 3});
            if (i % 4 == 0 && j % 4 == 0)
                for (int k = 0; k < 3; ++k) cells.push_back({i, j, k});
        }
    }
    Mesh mesh = cells_mesh(cells, 0.2, 0.2, 0.2);
    mesh.name = "table";
    return mesh;
}

std::shared_ptr<const Shape> table() {
    static const auto shape = Shape::make(table_mesh());
    return shape;
}

std::shared_ptr<const Shape> torus() {
    static const auto shape = Shape::make(scenes::scene_model("torus", 600).mesh);
    return shape;
}

TestWorld::TestWorld(const Settings& settings, const bullet::ManifoldSettings& manifolds, bullet::ConvexShapes convex)
    : dispatcher(&configuration, settings, manifolds, convex),
      world(&dispatcher, &broadphase, &solver, &configuration) {
    world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    world.getSolverInfo().m_linearSlop = btScalar(0.002);
}

TestWorld::~TestWorld() {
    while (!bodies.empty()) remove(*bodies.back());
}

btRigidBody& TestWorld::add(std::unique_ptr<btCollisionShape> shape, double mass, const btTransform& pose) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(btScalar(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, shape.get(), inertia);
    info.m_startWorldTransform = pose;
    info.m_friction = btScalar(0.8);
    bodies.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& body = *bodies.back();
    if (mass > 0) body.setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(&body);
    shapes.push_back(std::move(shape));
    return body;
}

void TestWorld::remove(btRigidBody& body) {
    world.removeRigidBody(&body);
    std::erase_if(bodies, [&](const auto& b) { return b.get() == &body; });
}

void TestWorld::steps(int count) {
    for (int i = 0; i < count; ++i) world.stepSimulation(btScalar(1.0 / 60), 0);
}

int TestWorld::touching() const {
    int count = 0;
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
        if (dispatcher.getManifoldByIndexInternal(i)->getNumContacts() > 0) ++count;
    }
    return count;
}

} // namespace raycontact::test
