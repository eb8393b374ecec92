// SPDX-License-Identifier: Apache-2.0
#include <tests/stacks/stack.h>

#include <scenes/models/machined.h>
#include <scenes/random.h>
#include <tests/stacks/solids.h>

#include <algorithm>
#include <cmath>

namespace raycontact::scenes {

namespace {

// Turned about z.
Pose placed(double x, double y, double z, double degrees = 0) {
    const double half = degrees * 3.14159265358979323846 / 360;
    return pose_from_quaternion({x, y, z}, std::cos(half), 0, 0, std::sin(half));
}

double lowest(const StackShape& shape) {
    double low = 0;
    for (const Vec3& v : shape.mesh.vertices) low = std::min(low, v.z);
    return low;
}

} // namespace

StackShape shape_of(Mesh mesh, bool convex) {
    StackShape shape;
    Vec3 low = mesh.vertices[0], high = low;
    for (const Vec3& v : mesh.vertices) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    shape.size = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    shape.mesh = std::move(mesh);
    shape.convex = convex;
    return shape;
}

StackShape box_of(const Vec3& size) {
    StackShape shape = shape_of(solid_box(size), true);
    shape.box = size;
    return shape;
}

StackShape tray_of(const Vec3& size, double thick) {
    return shape_of(solid_tray(size, thick), false);
}

bool Stack::convex() const {
    return std::ranges::all_of(
        bodies, [this](const StackBody& b) { return b.fixed || shapes[b.shape].convex || shapes[b.shape].own; });
}

Stack column() {
    Stack stack{"column", {box_of({1, 1, 1})}, {}};
    for (int k = 0; k < 10; ++k) stack.bodies.push_back({0, placed(0, 0, 0.5 + k)});
    return stack;
}

Stack turned_column() {
    Stack stack{"turned column", {box_of({1, 1, 1})}, {}};
    for (int k = 0; k < 10; ++k) stack.bodies.push_back({0, placed(0, 0, 0.5 + k, 15 * k)});
    return stack;
}

Stack wall() {
    Stack stack{"wall", {box_of({1, 0.5, 0.4})}, {}};
    for (int row = 0; row < 5; ++row)
        for (int k = 0; k < 8; ++k)
            stack.bodies.push_back({0, placed(k - 3.625 + (row % 2 == 0 ? 0 : 0.25), 0, 0.2 + 0.4 * row)});
    return stack;
}

Stack logs() {
    Stack stack{"logs", {box_of({2, 0.2, 0.2})}, {}};
    for (int k = 0; k < 8; ++k)
        for (const double side : {-0.7, 0.7}) {
            const bool along = k % 2 == 0;
            stack.bodies.push_back({0, placed(along ? 0 : side, along ? side : 0, 0.1 + 0.2 * k, along ? 0 : 90)});
        }
    return stack;
}

Stack table() {
    Stack stack{"table", {box_of({0.1, 0.1, 0.7}), box_of({1.5, 0.9, 0.06}), box_of({0.3, 0.3, 0.3})}, {}};
    for (const double x : {-0.6, 0.6})
        for (const double y : {-0.35, 0.35}) stack.bodies.push_back({0, placed(x, y, 0.35)});
    stack.bodies.push_back({1, placed(0, 0, 0.73)});
    stack.bodies.push_back({2, placed(0.2, 0.1, 0.91, 30)});
    return stack;
}

Stack rim() {
    Stack stack{"rim", {tray_of({1, 1, 0.6}, 0.06), box_of({0.95, 0.95, 0.95})}, {}};
    stack.bodies.push_back({0, placed(0, 0, -lowest(stack.shapes[0]))});
    stack.bodies.push_back({1, placed(0, 0, 0.6 + 0.475, 45)});
    return stack;
}

Stack corner() {
    Stack stack{"corner", {tray_of({1, 1, 0.6}, 0.06), box_of({0.6, 0.6, 0.6})}, {}};
    stack.bodies.push_back({0, placed(0, 0, -lowest(stack.shapes[0]))});
    stack.bodies.push_back({1, placed(0.4, 0.4, 0.9)});
    return stack;
}

Stack wedges() {
    const Vec3 size{1, 0.6, 0.27};
    Stack stack{"wedges", {shape_of(solid_wedge(size, false), true), shape_of(solid_wedge(size, true), true)}, {}};
    for (int k = 0; k < 3; ++k) // their corners meet at the origin's corner of the box
        for (std::size_t half = 0; half < 2; ++half) {
            const Vec3& corner = stack.shapes[half].mesh.vertices[0];
            stack.bodies.push_back({half, placed(-0.5 - corner.x, -0.3 - corner.y, 0.27 * k - corner.z)});
        }
    return stack;
}

Stack plates() {
    Stack stack{"plates", {box_of({1, 1, 0.1})}, {}};
    stack.stands = false;
    Random random(7);
    for (int layer = 0; layer < 3; ++layer)
        for (int i = 0; i < 5; ++i)
            for (int k = 0; k < 4; ++k) {
                const double shift = layer % 2 == 0 ? 0 : 0.75;
                const auto tilt = random.tilt(0.2);
                stack.bodies.push_back(
                    {0, pose_from_quaternion({1.5 * i - 3 + shift, 1.5 * k - 2.25 + shift, 0.3 + 0.5 * layer}, tilt[0],
                                             tilt[1], tilt[2], tilt[3])});
            }
    return stack;
}

std::vector<Stack> all_stacks() {
    return {column(), turned_column(), wall(), logs(), table(), rim(), corner(), wedges(), plates()};
}

} // namespace raycontact::scenes
