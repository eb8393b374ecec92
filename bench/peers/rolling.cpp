// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/rolling.h>

#include <bench/peers/turns.h>
#include <scenes/models/trigonometry.h>

#include <algorithm>
#include <cmath>

namespace raycontact::bench {

namespace {

constexpr double cell = 4; // metres between pairs; meshes are 1 m, so no pair sees another

struct Roll {
    Vec3 home;
    std::array<double, 3> way, spin_a, spin_b;
    Quaternion a, b;

    Pose pose(bool second, double distance, double turns) const {
        const auto& spin = second ? spin_b : spin_a;
        const scenes::SineCosine half = scenes::sine_cosine(turns / 2);
        const Quaternion q =
            times({half.cosine, half.sine * spin[0], half.sine * spin[1], half.sine * spin[2]}, second ? b : a);
        const double at = second ? distance : 0;
        const Vec3 where{home.x + at * way[0], home.y + at * way[1], home.z + at * way[2]};
        return pose_from_quaternion(where, q[0], q[1], q[2], q[3]);
    }
};

/// The largest distance of each pair, within `width` of where it was, at which it has so many contacts.
void find_distances(Scene& scene, std::span<const Pair> pairs, const std::vector<Roll>& rolls, double turns,
                    std::uint32_t contacts, double width, std::vector<double>& distances) {
    std::vector<double> near(distances), far(distances);
    for (double& d : near) d = std::fmax(0, d - width);
    for (double& d : far) d += width;
    std::vector<std::uint32_t> counts(rolls.size());
    for (int halving = 0; halving < 14; ++halving) {
        for (BodyId i = 0; i < rolls.size(); ++i) {
            distances[i] = (near[i] + far[i]) / 2;
            scene.set_pose(2 * i, rolls[i].pose(false, distances[i], turns));
            scene.set_pose(2 * i + 1, rolls[i].pose(true, distances[i], turns));
            counts[i] = 0;
        }
        for (const Contact& contact : scene.step(pairs)) ++counts[contact.body_a / 2];
        for (std::size_t i = 0; i < rolls.size(); ++i) (counts[i] >= contacts ? near : far)[i] = distances[i];
    }
    distances = near;
}

void roll(Work& work, const std::vector<Roll>& rolls, double turns, const RollingOptions& options) {
    const auto scene = make_scene(work, one_thread(Method::standard));
    std::vector<Pair> pairs;
    for (BodyId i = 0; i < rolls.size(); ++i) pairs.emplace_back(2 * i, 2 * i + 1);
    const double radius = work.shapes[0]->radius();
    std::vector<double> distances(rolls.size(), radius);
    find_distances(*scene, pairs, rolls, 0, options.contacts, radius, distances);
    work.steps.clear();
    for (std::uint32_t k = 0; k < options.steps; ++k) {
        // A body that turns a little moves its surface no more than that; the bumps of the surface are the rest.
        if (k > 0 && turns > 0)
            find_distances(*scene, pairs, rolls, k * turns, options.contacts, 0.02 + 7 * turns * radius, distances);
        WorkStep& step = work.steps.emplace_back();
        for (std::size_t i = 0; i < rolls.size(); ++i) {
            step.poses.push_back(rolls[i].pose(false, distances[i], k * turns));
            step.poses.push_back(rolls[i].pose(true, distances[i], k * turns));
        }
        step.pairs = pairs;
    }
}

} // namespace

Work rolling_pairs(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                   const RollingOptions& options) {
    Work work;
    work.name = std::move(name);
    work.source = std::move(source);
    work.shapes = {shape};
    work.body_shape.assign(std::size_t{2} * options.pairs, 0);
    scenes::Random random(1);
    std::vector<Roll> rolls(options.pairs);
    for (std::uint32_t i = 0; i < options.pairs; ++i) {
        Roll& one = rolls[i];
        const std::uint32_t row = i / 4 % 4, layer = i / 16;
        one.home = {cell * (i % 4), cell * row, cell * layer};
        one.way = random_direction(random);
        one.spin_a = random_direction(random);
        one.spin_b = random_direction(random);
        one.a = random_rotation(random);
        one.b = random_rotation(random);
    }
    // A quarter of a turn moves a surface about one size; then as it came out.
    double turns = options.displacement / 8;
    roll(work, rolls, turns, options);
    if (turns > 0 && options.steps > 1) {
        for (int correction = 0; correction < 2; ++correction) {
            turns *= options.displacement / std::fmax(pace(work).median, 1e-12);
            roll(work, rolls, turns, options);
        }
    }
    return work;
}

} // namespace raycontact::bench
