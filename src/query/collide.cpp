// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>
#include <raycontact/scene.h>

#include <memory>
#include <utility>

namespace raycontact {

namespace {

Settings settings_of(const CollideOptions& options) {
    Settings settings;
    settings.method = Method::standard; // nothing to keep for a next step
    settings.direction = options.direction;
    settings.features = options.features;
    if (options.margin != 0) {
        settings.speculative = Speculative::on;
        settings.speculative_margin = options.margin;
    }
    settings.max_contacts_per_pair = options.max_contacts_per_pair;
    settings.execution.threads = options.threads;
    settings.execution.devices = "cpu";
    return settings;
}

/// What a thread asks in again: to make a scene takes longer than most questions. Between them it has no body.
struct Asked {
    explicit Asked(const CollideOptions& own) : options(own), scene(settings_of(own)) {}

    bool is_for(const CollideOptions& other) const {
        return options.direction == other.direction && options.features == other.features
               && options.margin == other.margin && options.max_contacts_per_pair == other.max_contacts_per_pair
               && other.threads == 1;
    }

    CollideOptions options;
    Scene scene;
};

// Of more triangles what a step takes is too much to be kept, and a scene is soon made beside it. Ids are not endless.
constexpr std::size_t most_triangles = 1 << 15;
constexpr std::uint32_t most_questions = 1 << 20;

} // namespace

std::vector<Contact> collide(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                             const CollideOptions& options) {
    if (!(options.margin >= 0 && options.margin <= 1e12))
        throw InputError("collide: the margin is not from 0 to 1e12 m");
    check_pose(pose_a, "pose of the first mesh");
    check_pose(pose_b, "pose of the second mesh");
    thread_local std::unique_ptr<Asked> kept;
    auto asked = std::exchange(kept, nullptr); // a scene that throws is dropped
    if (!asked || !asked->is_for(options)) asked = std::make_unique<Asked>(options);
    Scene& scene = asked->scene;
    const Pair pair{scene.add(a.shared_from_this(), pose_a), scene.add(b.shared_from_this(), pose_b)};
    const auto found = scene.find_contacts({&pair, 1});
    std::vector<Contact> contacts(found.begin(), found.end());
    for (Contact& contact : contacts) contact.body_a = {0}, contact.body_b = {1};
    const bool small = a.triangles().size() + b.triangles().size() <= most_triangles;
    // Threads of its own would wait for the calling one to end.
    if (options.threads != 1 || !small || pair.first.generation >= most_questions) return contacts;
    scene.remove(pair.first);
    scene.remove(pair.second);
    scene.find_contacts(std::span<const Pair>());
    kept = std::move(asked);
    return contacts;
}

} // namespace raycontact
