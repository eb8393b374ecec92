// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>
#include <raycontact/pose.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class btCollisionShape;

namespace raycontact::scenes {

/// A shape of a stack; its origin is its centre of mass.
struct StackShape {
    Mesh mesh;
    std::optional<Vec3> box; ///< its size, if it is a box
    bool convex = true;
    double size = 0; ///< longest edge of its box, metres
    /// Makes a shape of Bullet's that every finder gets in place of the mesh.
    std::function<std::shared_ptr<btCollisionShape>()> own = nullptr;
};

struct StackBody {
    std::size_t shape = 0;
    Pose pose = {};
    bool fixed = false;    ///< part of the ground
    double density = 500;  ///< kg/m^3
    double friction = 0.8; ///< two that touch have the product
    double damping = 0;    ///< part of its speeds that a body loses in a second
    double rolling = 0;    ///< friction against rolling and spinning, metres; of two the mean by their frictions
};

StackShape shape_of(Mesh mesh, bool convex); ///< the mesh's origin must be its centre of mass
StackShape box_of(const Vec3& size);
StackShape tray_of(const Vec3& size, double thick); ///< solid_tray

/// Bodies that stand on a ground with its top at z = 0, or fall on it.
struct Stack {
    std::string name;
    std::vector<StackShape> shapes;
    std::vector<StackBody> bodies;
    bool stands = true;    ///< where it was put; otherwise it falls, and must not pass through anything
    double gravity = 9.81; ///< m/s^2
    bool convex() const;   ///< all bodies that move are, or are shapes of Bullet's own
};

Stack column();        ///< ten cubes
Stack turned_column(); ///< ten cubes, each turned by 15 degrees against the one below
Stack wall();          ///< 8 x 5 bricks, neighbours touching, each row a quarter of a brick off
Stack logs();          ///< 16 bars laid crosswise, two in a layer: edges alone touch
Stack table();         ///< a plate on four legs, a cube on it
Stack rim();           ///< a cube, turned, on the rim of a box without a lid: edges alone touch
Stack corner();        ///< a cube on a corner of such a rim
Stack wedges();        ///< three boxes of two wedges each
Stack plates();        ///< 60 dropped, so low that none falls by its thickness in a step

/// In the order above.
std::vector<Stack> all_stacks();

} // namespace raycontact::scenes
