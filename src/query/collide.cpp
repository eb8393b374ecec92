// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>
#include <raycontact/scene.h>

namespace raycontact {

std::vector<Contact> collide(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                             const CollideOptions& options) {
    check_pose(pose_a, "pose of the first mesh");
    check_pose(pose_b, "pose of the second mesh");
    Settings settings;
    settings.method = Method::standard; // nothing to keep for a next step
    settings.direction = options.direction;
    settings.features = options.features;
    settings.execution.threads = options.threads;
    settings.execution.devices = "cpu";
    Scene scene(settings);
    const Pair pair{scene.add(a.shared_from_this(), pose_a), scene.add(b.shared_from_this(), pose_b)};
    const auto contacts = scene.find_contacts({&pair, 1});
    return {contacts.begin(), contacts.end()};
}

} // namespace raycontact
