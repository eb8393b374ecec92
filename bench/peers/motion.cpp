// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/motion.h>

#include <scenes/models/trigonometry.h>
#include <scenes/random.h>

#include <array>
#include <cmath>
#include <utility>

namespace raycontact::bench {

namespace {

using Quaternion = std::array<double, 4>; // w x y z

Quaternion times(const Quaternion& a, const Quaternion& b) {
    return {
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

/// In a ball, not too near its middle.
std::array<double, 3> random_direction(scenes::Random& random) {
    for (;;) {
        const double x = random.symmetric(), y = random.symmetric(), z = random.symmetric();
        const double square = x * x + y * y + z * z;
        if (square > 1 || square < 0.01) continue;
        const double length = std::sqrt(square);
        return {x / length, y / length, z / length};
    }
}

Quaternion random_rotation(scenes::Random& random) {
    for (;;) {
        const Quaternion q{random.symmetric(), random.symmetric(), random.symmetric(), random.symmetric()};
        const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        if (square <= 1 && square > 0.01) return q;
    }
}

/// Two bodies that meet: the second lies along `way` from the first, each turns about an axis of its own.
struct Encounter {
    Vec3 home; ///< of the first body, metres
    std::array<double, 3> way, spin_a, spin_b;
    Quaternion a, b;

    /// Of one of the two, `distance` metres apart, turned by the angle whose half has this sine and cosine (or any
    /// multiple of both).
    Pose pose(bool second, double distance, double sine, double cosine) const {
        const auto& spin = second ? spin_b : spin_a;
        const Quaternion q = times({cosine, sine * spin[0], sine * spin[1], sine * spin[2]}, second ? b : a);
        const double at = second ? distance : 0;
        const Vec3 where{home.x + at * way[0], home.y + at * way[1], home.z + at * way[2]};
        return pose_from_quaternion(where, q[0], q[1], q[2], q[3]);
    }
};

/// Always the same ones, in cells of 4 m: meshes are 1 m, so no pair sees another.
std::vector<Encounter> encounters(std::uint32_t count) {
    constexpr double cell = 4;
    scenes::Random random(1);
    std::vector<Encounter> list(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        Encounter& one = list[i];
        const std::uint32_t column = i % 4, row = i / 4 % 4, layer = i / 16;
        one.home = {cell * column, cell * row, cell * layer};
        one.way = random_direction(random);
        one.spin_a = random_direction(random);
        one.spin_b = random_direction(random);
        one.a = random_rotation(random);
        one.b = random_rotation(random);
    }
    return list;
}

/// Bodies 2 i and 2 i + 1 are pair i, all of one shape; no steps yet.
Work encounter_work(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                    std::uint32_t count) {
    Work work;
    work.name = std::move(name);
    work.source = std::move(source);
    work.shapes = {shape};
    work.body_shape.assign(std::size_t{2} * count, 0);
    return work;
}

std::vector<Pair> encounter_pairs(std::size_t count) {
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < count; ++i) pairs.emplace_back(BodyId{2 * i, 0}, BodyId{2 * i + 1, 0});
    return pairs;
}

/// Of all bodies, each pair so far apart, all turned alike.
std::vector<Pose> poses_of(const std::vector<Encounter>& meeting, const std::vector<double>& distances, double sine,
                           double cosine) {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < meeting.size(); ++i)
        for (const bool second : {false, true}) poses.push_back(meeting[i].pose(second, distances[i], sine, cosine));
    return poses;
}

/// Largest distance at which each pair has a contact: from afar in steps of 2 cm, then halved eight times.
std::vector<double> find_touch(const Work& work, const std::vector<Encounter>& meeting) {
    const auto scene = make_scene(work, one_thread(Method::standard));
    const std::vector<Pair> pairs = encounter_pairs(meeting.size());
    const auto touching = [&](const std::vector<double>& distances) {
        place(*scene, {poses_of(meeting, distances, 0, 1), {}});
        std::vector<bool> touches(meeting.size());
        for (const Contact& contact : scene->find_contacts(pairs)) touches[contact.body_a.slot / 2] = true;
        return touches;
    };
    const double far = 2 * work.shapes[0]->radius(), stride = 0.02;
    std::vector<double> distances(meeting.size(), far);
    for (double distance = far; distance > 0; distance -= stride) {
        const std::vector<bool> touches = touching(distances);
        for (std::size_t i = 0; i < meeting.size(); ++i)
            if (!touches[i]) distances[i] = distance;
    }
    std::vector<double> apart(distances);
    for (double& d : apart) d += stride;
    for (int halving = 0; halving < 8; ++halving) {
        std::vector<double> middle(meeting.size());
        for (std::size_t i = 0; i < meeting.size(); ++i) middle[i] = (apart[i] + distances[i]) / 2;
        const std::vector<bool> touches = touching(middle);
        for (std::size_t i = 0; i < meeting.size(); ++i) (touches[i] ? distances : apart)[i] = middle[i];
    }
    return distances;
}

std::vector<Pose> rolled(const std::vector<Encounter>& rolls, const std::vector<double>& distances, double turns) {
    const scenes::SineCosine half = scenes::sine_cosine(turns / 2);
    return poses_of(rolls, distances, half.sine, half.cosine);
}

/// The largest distance of each pair, within `width` of where it was, at which it has so many contacts.
void find_distances(Scene& scene, std::span<const Pair> pairs, const std::vector<Encounter>& rolls, double turns,
                    std::uint32_t contacts, double width, std::vector<double>& distances) {
    std::vector<double> near(distances), far(distances);
    for (double& d : near) d = std::fmax(0, d - width);
    for (double& d : far) d += width;
    std::vector<std::uint32_t> counts;
    for (int halving = 0; halving < 14; ++halving) {
        for (std::size_t i = 0; i < rolls.size(); ++i) distances[i] = (near[i] + far[i]) / 2;
        place(scene, {rolled(rolls, distances, turns), {}});
        counts.assign(rolls.size(), 0);
        for (const Contact& contact : scene.find_contacts(pairs)) ++counts[contact.body_a.slot / 2];
        for (std::size_t i = 0; i < rolls.size(); ++i) (counts[i] >= contacts ? near : far)[i] = distances[i];
    }
    distances = near;
}

void roll(Work& work, const std::vector<Encounter>& rolls, double turns, const RollingOptions& options) {
    const auto scene = make_scene(work, one_thread(Method::standard));
    const std::vector<Pair> pairs = encounter_pairs(rolls.size());
    const double radius = work.shapes[0]->radius();
    std::vector<double> distances(rolls.size(), radius);
    find_distances(*scene, pairs, rolls, 0, options.contacts, radius, distances);
    work.steps.clear();
    for (std::uint32_t k = 0; k < options.steps; ++k) {
        // A body that turns a little moves its surface no more than that; the bumps of the surface are the rest.
        if (k > 0 && turns > 0)
            find_distances(*scene, pairs, rolls, k * turns, options.contacts, 0.02 + 7 * turns * radius, distances);
        work.steps.push_back({rolled(rolls, distances, k * turns), pairs});
    }
}

} // namespace

Work approaching_pairs(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                       const ApproachOptions& options) {
    Work work = encounter_work(std::move(name), shape, std::move(source), options.pairs);
    const std::vector<Encounter> meeting = encounters(options.pairs);
    const std::vector<double> touch = find_touch(work, meeting);
    // Six tenths of the time to come together, the rest to turn in each other; about 12 degrees each way a body.
    for (std::uint32_t k = 0; k < options.steps; ++k) {
        const double time = (k + 0.5) / options.steps;
        const double in = std::fmin(1, time / 0.6);
        std::vector<double> distances(touch);
        for (double& d : distances) d = d + options.clearance - (options.clearance + options.depth) * in;
        const double turn = 0.2 * (time - 0.6); // tan(angle / 2); 0 at the pose that `touch` was found for
        work.steps.push_back({poses_of(meeting, distances, turn, 1), {}});
    }
    find_pairs(work);
    return work;
}

Work rolling_pairs(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                   const RollingOptions& options) {
    Work work = encounter_work(std::move(name), shape, std::move(source), options.pairs);
    const std::vector<Encounter> rolls = encounters(options.pairs);
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
