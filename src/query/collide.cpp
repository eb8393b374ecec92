// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>
#include <raycontact/scene.h>

#include "pose_fault.h"

#include <string>

namespace raycontact {

std::vector<Contact> collide(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                             const CollideOptions& options) {
    if (const char* fault = pose_fault(pose_a)) throw InputError(std::string("pose of the first mesh: ") + fault);
    if (const char* fault = pose_fault(pose_b)) throw InputError(std::string("pose of the second mesh: ") + fault);
    Settings settings;
    settings.method = Method::standard; // nothing to keep for a next step
    settings.direction = options.direction;
    settings.features = options.features;
    settings.threads = options.threads;
    settings.devices = "cpu";
    Scene scene(settings);
    const Pair pair{scene.add(a.shared_from_this(), pose_a), scene.add(b.shared_from_this(), pose_b)};
    const auto contacts = scene.step({&pair, 1});
    return {contacts.begin(), contacts.end()};
}

} // namespace raycontact
