// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "penalty.h"

#include <raycontact/scene.h>

#include <array>
#include <memory>
#include <vector>

namespace raycontact::test {

/// Rigid bodies whose contacts answer with springs and dampers: a small reference beside sequential impulses. Steps are
/// explicit, so they must be short: dt^2 x stiffness of all of a body's contacts well below its mass.
class PenaltyWorld {
public:
    PenaltyWorld(const Penalty& penalty, const Settings& settings = {}, const Vec3& gravity = {0, 0, -9.81})
        : penalty_(penalty), gravity_(gravity), scene_(settings) {}

    /// The shape's origin must be its centre of mass. density: kg/m^3; 0: it does not move. Returns its slot.
    std::uint32_t add(std::shared_ptr<const Shape> shape, double density, const Pose& pose);
    /// Contacts where the bodies are, forces, then velocities, then poses with the new velocities (semi-implicit
    /// Euler). dt: seconds.
    void step(double dt);

    const Scene& scene() const { return scene_; }
    const Pose& pose(std::uint32_t slot) const { return bodies_.at(slot).pose; }
    const Vec3& velocity(std::uint32_t slot) const { return bodies_.at(slot).velocity; }
    double mass(std::uint32_t slot) const { return bodies_.at(slot).mass; }
    /// Joules: of motion, of height (0 at the origin), and of the springs of the last step's contacts.
    double energy() const;

private:
    using Matrix = std::array<double, 9>; ///< row-major
    struct Body {
        BodyId id;
        Pose pose;
        double mass = 0;                     ///< 0: it does not move
        Matrix inertia{}, inverse_inertia{}; ///< body axes
        Vec3 velocity, spin, force, torque;  ///< world axes, about the centre of mass
    };
    void press(const Contact& contact);
    static void move(Body& body, double dt);

    Penalty penalty_;
    Vec3 gravity_;
    Scene scene_;
    std::vector<Body> bodies_; ///< by slot
};

} // namespace raycontact::test
