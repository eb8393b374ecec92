// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/swarm.h>

#include <bench/peers/turns.h>
#include <scenes/models/model.h>
#include <scenes/models/trigonometry.h>

namespace raycontact::bench {

namespace {

constexpr double circle = 1.1; // metres
constexpr double full_turn = 6.283185307179586;
constexpr double steps_a_second = 60;

struct Orbit {
    std::array<double, 3> u, v, axis; // the plane of the circle, and the axis that the body turns about
    Quaternion start;
    double phase = 0; // turns

    Pose pose(double along, double turned) const {
        const scenes::SineCosine at = scenes::sine_cosine(phase + along), half = scenes::sine_cosine(turned / 2);
        const auto on = [&](std::size_t k) { return circle * (at.cosine * u[k] + at.sine * v[k]); };
        const Quaternion q = times({half.cosine, half.sine * axis[0], half.sine * axis[1], half.sine * axis[2]}, start);
        return pose_from_quaternion({on(0), on(1), on(2)}, q[0], q[1], q[2], q[3]);
    }
};

Orbit random_orbit(scenes::Random& random) {
    Orbit orbit;
    orbit.u = random_direction(random);
    // Anything that is not along u, made perpendicular to it.
    for (;;) {
        const std::array<double, 3> w = random_direction(random);
        const double along = (orbit.u[0] * w[0] + orbit.u[1] * w[1]) + orbit.u[2] * w[2];
        for (std::size_t k = 0; k < 3; ++k) orbit.v[k] = w[k] - along * orbit.u[k];
        const double length = std::sqrt((orbit.v[0] * orbit.v[0] + orbit.v[1] * orbit.v[1]) + orbit.v[2] * orbit.v[2]);
        if (length < 0.1) continue;
        for (double& x : orbit.v) x /= length;
        break;
    }
    orbit.axis = random_direction(random);
    orbit.start = random_rotation(random);
    orbit.phase = (random.symmetric() + 1) / 2;
    return orbit;
}

} // namespace

Work swarm_work(const SwarmOptions& options) {
    constexpr const char* kinds[] = {"knot", "gear", "torus"};
    Work work;
    work.name = "swarm";
    work.source = std::to_string(options.bodies) + " bodies of " + std::to_string(options.triangles)
                  + " triangles (knots, gears, bumpy tori) run through each other, set and not simulated";
    for (std::uint32_t i = 0; i < std::min<std::uint32_t>(options.bodies, std::size(kinds)); ++i)
        work.shapes.push_back(Shape::make(scenes::scene_model(kinds[i], options.triangles).mesh));
    scenes::Random random(options.seed);
    std::vector<Orbit> orbits;
    for (std::uint32_t i = 0; i < options.bodies; ++i) {
        work.body_shape.push_back(i % static_cast<std::uint32_t>(work.shapes.size()));
        orbits.push_back(random_orbit(random));
    }
    for (std::uint32_t k = 0; k < options.steps; ++k) {
        WorkStep& step = work.steps.emplace_back();
        for (const Orbit& orbit : orbits)
            step.poses.push_back(orbit.pose(k * options.speed / (steps_a_second * full_turn * circle),
                                            k * options.turns / steps_a_second));
    }
    find_pairs(work);
    return work;
}

} // namespace raycontact::bench
