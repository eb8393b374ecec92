// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/approaching.h>

#include <bench/peers/encounter.h>

#include <cmath>
#include <utility>

namespace raycontact::bench {

namespace {

/// Largest distance at which each pair has a contact: from afar in steps of 2 cm, then halved eight times.
std::vector<double> find_touch(const Work& work, const std::vector<Encounter>& meeting) {
    const auto scene = make_scene(work, one_thread(Method::standard));
    const std::vector<Pair> pairs = encounter_pairs(meeting.size());
    const auto touching = [&](const std::vector<double>& distances) {
        place_encounters(*scene, meeting.size(),
                         [&](std::size_t i, bool second) { return meeting[i].pose(second, distances[i], 0, 1); });
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
        WorkStep& step = work.steps.emplace_back();
        for (std::size_t i = 0; i < meeting.size(); ++i) {
            const double distance = touch[i] + options.clearance - (options.clearance + options.depth) * in;
            const double turn = 0.2 * (time - 0.6); // tan(angle / 2); 0 at the pose that `touch` was found for
            step.poses.push_back(meeting[i].pose(false, distance, turn, 1));
            step.poses.push_back(meeting[i].pose(true, distance, turn, 1));
        }
    }
    find_pairs(work);
    return work;
}

} // namespace raycontact::bench
