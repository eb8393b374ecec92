// SPDX-License-Identifier: Apache-2.0
#include "penalty_world.h"

#include "mesh/vector.h"

#include <raycontact/mass.h>

namespace raycontact::test {

namespace {

/// Of a symmetric matrix.
std::array<double, 9> inverse(const std::array<double, 9>& m) {
    const Vec3 x{m[0], m[1], m[2]}, y{m[3], m[4], m[5]}, z{m[6], m[7], m[8]};
    const double s = 1 / dot(x, cross(y, z));
    const Vec3 a = s * cross(y, z), b = s * cross(z, x), c = s * cross(x, y);
    return {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
}

/// A matrix in body axes times a vector in world axes.
Vec3 times(const Pose& pose, const std::array<double, 9>& matrix, const Vec3& a) {
    return rotated(pose.rotation, rotated(matrix, rotated_back(pose.rotation, a)));
}

} // namespace

std::uint32_t PenaltyWorld::add(std::shared_ptr<const Shape> shape, double density, const Pose& pose) {
    Body body;
    body.pose = pose;
    if (density > 0) {
        const Mass unit_mass = mass_of(shape->vertices(), shape->triangles());
        body.mass = density * unit_mass.volume;
        for (std::size_t i = 0; i < 9; ++i) body.inertia[i] = density * unit_mass.inertia[i];
        body.inverse_inertia = inverse(body.inertia);
    }
    body.id = scene_.add(std::move(shape), pose);
    bodies_.push_back(body);
    return body.id.slot;
}

void PenaltyWorld::press(const Contact& contact) {
    Body &a = bodies_[contact.body_a.slot], &b = bodies_[contact.body_b.slot];
    const Vec3 p = contact.point_a, q = contact.point_b;
    const Vec3 middle = 0.5 * (p + q); // one point for both: no torque out of nothing
    const Vec3 arm_a = middle - a.pose.translation, arm_b = middle - b.pose.translation;
    const Vec3 force =
        penalty_force(penalty_, contact, b.velocity + cross(b.spin, arm_b) - (a.velocity + cross(a.spin, arm_a)));
    a.force = a.force - force;
    a.torque = a.torque - cross(arm_a, force);
    b.force = b.force + force;
    b.torque = b.torque + cross(arm_b, force);
}

void PenaltyWorld::move(Body& body, double dt) {
    body.velocity = body.velocity + (dt / body.mass) * body.force;
    const Vec3 gyroscopic = cross(body.spin, times(body.pose, body.inertia, body.spin));
    body.spin = body.spin + dt * times(body.pose, body.inverse_inertia, body.torque - gyroscopic);
    Pose moved = body.pose;
    for (std::size_t k = 0; k < 3; ++k) { // each axis turns with the spin; then the nearest rotation
        const Vec3 axis{moved.rotation[k], moved.rotation[3 + k], moved.rotation[6 + k]};
        const Vec3 turned = axis + dt * cross(body.spin, axis);
        moved.rotation[k] = turned.x;
        moved.rotation[3 + k] = turned.y;
        moved.rotation[6 + k] = turned.z;
    }
    moved.translation = moved.translation + dt * body.velocity;
    body.pose = nearest_rigid_pose(moved);
}

void PenaltyWorld::step(double dt) {
    for (Body& body : bodies_) {
        body.force = body.mass * gravity_;
        body.torque = {};
    }
    for (const Contact& contact : scene_.find_contacts()) press(contact);
    for (Body& body : bodies_) {
        if (body.mass == 0) continue;
        move(body, dt);
        scene_.set_pose(body.id, body.pose);
    }
}

double PenaltyWorld::energy() const {
    double sum = 0;
    for (const Body& body : bodies_)
        sum += body.mass * (dot(body.velocity, body.velocity) / 2 - dot(gravity_, body.pose.translation))
               + dot(body.spin, times(body.pose, body.inertia, body.spin)) / 2;
    for (const Contact& contact : scene_.contacts()) {
        if (contact.is_speculative()) continue;
        const double depth = static_cast<double>(contact.depth);
        sum += static_cast<double>(contact.weight) * penalty_.stiffness * depth * depth / 2;
    }
    return sum;
}

} // namespace raycontact::test
