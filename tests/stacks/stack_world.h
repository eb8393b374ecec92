// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/settings.h>
#include <tests/stacks/stack.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string_view>

class btDiscreteDynamicsWorld;
class btRigidBody;
class btTriangleMesh;
class btTypedConstraint;
class btVector3;

namespace raycontact::scenes {

/// What finds the contacts in Bullet.
enum class Finder {
    edges,    ///< RayContact, Features::edges
    vertices, ///< RayContact, Features::vertices
    gimpact,  ///< Bullet's own for moving meshes
    convex,   ///< btBoxShape and, for wedges, btConvexHullShape in place of the meshes, where all are convex
    bvh,      ///< the same, but what is fixed stays a btBvhTriangleMeshShape
};
enum class Ground {
    plane, ///< btStaticPlaneShape
    slab,  ///< a mesh of 12 triangles, 1 m thick
    box,   ///< btBoxShape of the slab's size
    quad,  ///< two triangles
    none,
};
inline constexpr double ground_reach = 10; ///< half its width, metres; the plane has none
std::string_view to_string(Finder finder);
std::string_view to_string(Ground ground);
/// Of the ground that is a slab or a quad.
Mesh ground_mesh(Ground ground);

btVector3 to_bullet(const Vec3& v);
std::unique_ptr<btTriangleMesh> triangles_of(const Mesh& mesh);

/// Of Bullet's solver, the same for every finder. Defaults: Bullet's own.
struct StackSolver {
    int iterations = 10;
    std::optional<double> slop;           ///< metres; empty: Bullet's or what is recommended
    bool two_friction_directions = false; ///< fixed by the normal
    bool recommended = false;             ///< the rest as bullet::recommend() sets it
    bool speculative = true;              ///< RayContact's contacts, not the solver's
};

/// A stack in a Bullet world with deactivation off. z is up. Meshes that move are btGImpactMeshShape, those that do not
/// btBvhTriangleMeshShape, for every finder: one line differs.
class StackWorld {
public:
    /// Throws InputError for Finder::convex and bvh where bodies are not.
    StackWorld(const Stack& stack, Ground ground, Finder finder, const StackSolver& solver = {});
    ~StackWorld();
    StackWorld(const StackWorld&) = delete;
    StackWorld& operator=(const StackWorld&) = delete;

    void step(double seconds = 1.0 / 60);
    Pose pose(std::size_t body) const;
    std::vector<Pose> poses() const;
    /// Every manifold point of the last step; the ground is body -1.
    void print_points(std::FILE* out) const;

    btDiscreteDynamicsWorld& world() const;
    btRigidBody& body(std::size_t index) const;
    /// Adds it to the world; the two bodies do not collide.
    void keep(std::unique_ptr<btTypedConstraint> constraint);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact::scenes
