// SPDX-License-Identifier: Apache-2.0
// What the three engines share: bodies, 50 hares above a bin, what is kept of contacts, and whether the hares lie
// still.
#pragma once

#include <raycontact/mass.h>
#include <raycontact/rigid_motion.h>
#include <raycontact/scene.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace engine {

using raycontact::Contact, raycontact::Pose, raycontact::Vec3;

constexpr Vec3 gravity{0, 0, -9.81}; // m/s^2
constexpr double friction = 0.5, seconds = 8;

/// A rigid body, SI units, world frame. Its origin is its centre of mass.
struct Body {
    raycontact::BodyId id;
    Pose pose;
    Vec3 velocity, spin;                 // spin: rad/s
    double inverse_mass = 0;             // 0: it does not move
    std::array<Vec3, 3> inverse_inertia; // rows, body axes

    Vec3 velocity_at(const Vec3& arm) const { return velocity + cross(spin, arm); }
    /// The change of spin by an angular impulse: R I^-1 R^T.
    Vec3 turned_by(const Vec3& twist) const {
        const auto& r = pose.rotation;
        const Vec3 x{r[0], r[3], r[6]}, y{r[1], r[4], r[7]}, z{r[2], r[5], r[8]};
        const Vec3 own{dot(x, twist), dot(y, twist), dot(z, twist)};
        const auto& [row_x, row_y, row_z] = inverse_inertia;
        return dot(row_x, own) * x + dot(row_y, own) * y + dot(row_z, own) * z;
    }
    void push(const Vec3& arm, const Vec3& impulse) {
        velocity += inverse_mass * impulse;
        spin += turned_by(cross(arm, impulse));
    }
    /// The speed along a unit vector that an impulse of 1 along it gives to the point at this arm.
    double yields(const Vec3& arm, const Vec3& along) const {
        const Vec3 twist = cross(arm, along);
        return inverse_mass + dot(twist, turned_by(twist));
    }
    /// Gyroscopic torque is left out: what falls and rolls here hardly shows it.
    Pose pose_after(double dt) const { return raycontact::pose_at({pose, dt * velocity, dt * spin, {}}, 1); }
    Vec3 to_own(const Vec3& point) const { // of a point of the world
        const auto& r = pose.rotation;
        const Vec3 p = point - pose.translation;
        return {r[0] * p.x + r[3] * p.y + r[6] * p.z, r[1] * p.x + r[4] * p.y + r[7] * p.z,
                r[2] * p.x + r[5] * p.y + r[8] * p.z};
    }
};

/// What is kept of each contact from step to step, by its bodies and its key.
template <class T>
class Kept {
public:
    /// Forgets what had no contact in the step that ends.
    void next_step() {
        before_.swap(now_);
        now_.clear();
    }
    /// What was kept of it, else `fresh`. It stays in place until the next step.
    T& of(const Contact& contact, const T& fresh = {}) {
        const Key key(contact.body_a, contact.body_b, contact.key());
        const auto old = before_.find(key);
        return now_.emplace(key, old == before_.end() ? fresh : old->second).first->second;
    }

private:
    using Key = std::tuple<raycontact::BodyId, raycontact::BodyId, std::uint64_t>;
    std::map<Key, T> before_, now_;
};

/// A box without a lid: a floor at z = 0 and walls around it, one concave mesh.
inline raycontact::Mesh bin(double width, double height, double thick) {
    raycontact::Mesh mesh{"bin", {}, {}};
    const double half = width / 2, out = half + thick;
    for (const auto& [x, z] : {std::pair{out, -thick}, {out, height}, {half, height}, {half, 0.0}}) // from below inward
        for (const auto& [i, j] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
            mesh.vertices.push_back({i * x, j * x, z});
    const auto quad = [&mesh](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (std::uint32_t ring = 0; ring < 12; ring += 4)
        for (std::uint32_t k = 0; k < 4; ++k) quad(ring + k, ring + (k + 1) % 4, ring + 4 + (k + 1) % 4, ring + 4 + k);
    quad(3, 2, 1, 0);
    quad(12, 13, 14, 15);
    return mesh;
}

/// 50 bodies of one mesh above a bin, which is the first of `bodies`; their places are slots of the scene.
class Heap {
public:
    raycontact::Scene scene;
    std::vector<Body> bodies;

    /// Arguments of the program: a mesh file, then a file for the poses at the end.
    Heap(int argc, char** argv, const raycontact::Settings& settings)
        : scene(settings), bodies(51), poses_file_(argc > 2 ? argv[2] : "") {
        raycontact::Mesh mesh = raycontact::load_mesh(argc > 1 ? argv[1] : "samples/hare.obj");
        const raycontact::Mass mass = raycontact::mass_of(mesh.vertices, mesh.triangles);
        if (!(mass.volume > 0))
            throw raycontact::InputError(mesh.name + ": encloses no volume; give a closed mesh, wound outward");
        for (Vec3& v : mesh.vertices) v = v - mass.centre;
        const auto shape = raycontact::Shape::make(mesh);
        radius_ = shape->radius();
        const auto& m = mass.inertia;
        const Vec3 x{m[0], m[1], m[2]}, y{m[3], m[4], m[5]}, z{m[6], m[7], m[8]};
        const double density = 1000, determinant = density * dot(x, cross(y, z)); // kg/m^3; for the inverse
        bodies[0].id = scene.add(raycontact::Shape::make(bin(6.2 * radius_, 5 * radius_, 0.3 * radius_)));
        for (std::size_t i = 1; i < bodies.size(); ++i) {
            Body& body = bodies[i];
            body.inverse_mass = 1 / (density * mass.volume);
            body.inverse_inertia = {cross(y, z) / determinant, cross(z, x) / determinant, cross(x, y) / determinant};
            const std::size_t k = i - 1;
            const Vec3 cell{double(k % 3) - 1, double(k / 3 % 3) - 1, double(k / 9) + 0.5};
            const double turn = 2.4 * double(i); // each lies another way
            body.pose = raycontact::pose_from_quaternion(2 * radius_ * cell, std::cos(turn), std::sin(turn),
                                                         std::sin(2 * turn), std::cos(3 * turn));
            body.id = scene.add(shape, body.pose);
        }
    }

    void set_poses() {
        for (const Body& body : bodies) scene.set_pose(body.id, body.pose);
    }
    /// After each step: watches how far bodies go in the last second.
    void watch(double time) {
        if (time < seconds - 1) {
            began_ = bodies;
            return;
        }
        for (std::size_t i = 1; i < bodies.size(); ++i) {
            const auto way = straight_motion(began_[i].pose, bodies[i].pose);
            moved_ = std::max(moved_, length(way.velocity) + radius_ * length(way.angular_velocity));
        }
        deepest_ = std::max(deepest_, scene.stats().depth_max);
    }
    /// Prints what was seen in the last second. 0, the exit status of success, if no point moved by more than a
    /// thousandth of a hare, and no contact is deeper than the limit, metres.
    int verdict(double deepest_allowed) const {
        if (!poses_file_.empty()) write_poses();
        double fastest = 0;
        for (const Body& body : bodies)
            fastest = std::max(fastest, length(body.velocity) + radius_ * length(body.spin));
        std::printf("50 hares: %g m/s at most; in the last second none moved by more than %g mm, none was deeper than "
                    "%g mm\n",
                    fastest, 1000 * moved_, 1000 * deepest_);
        return moved_ < 0.001 * 2 * radius_ && deepest_ <= deepest_allowed ? 0 : 1;
    }

private:
    /// A line for each hare: its rotation, row by row, and its place.
    void write_poses() const {
        std::ofstream out(poses_file_);
        for (std::size_t i = 1; i < bodies.size(); ++i) {
            const Pose& pose = bodies[i].pose;
            for (const double entry : pose.rotation) out << entry << ' ';
            out << pose.translation.x << ' ' << pose.translation.y << ' ' << pose.translation.z << '\n';
        }
    }

    std::string poses_file_;
    double radius_ = 0, moved_ = 0, deepest_ = 0; // metres
    std::vector<Body> began_;                     // as they were when the last second began
};

} // namespace engine
