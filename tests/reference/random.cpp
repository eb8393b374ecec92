// SPDX-License-Identifier: Apache-2.0
#include "reference/random.h"

#include "reference/vector.h"

#include <scenes/random.h>

namespace raycontact::reference {

namespace {

Pose from_quaternion(double w, double x, double y, double z) {
    const double s = 1 / std::sqrt(w * w + x * x + y * y + z * z);
    w *= s, x *= s, y *= s, z *= s;
    Pose pose;
    pose.rotation = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                     2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    return pose;
}

} // namespace

std::uint64_t Random::bits() {
    return scenes::splitmix64(state_);
}

double Random::uniform() {
    return static_cast<double>(bits() >> 11) * 0x1p-53;
}

double Random::uniform(double low, double high) {
    return low + (high - low) * uniform();
}

std::uint32_t Random::below(std::uint32_t count) {
    return static_cast<std::uint32_t>(uniform() * static_cast<double>(count));
}

Vec3 Random::in_ball() {
    for (;;) {
        const double x = uniform(-1, 1);
        const double y = uniform(-1, 1);
        const double z = uniform(-1, 1);
        if (x * x + y * y + z * z <= 1) return {x, y, z};
    }
}

Vec3 Random::direction() {
    for (;;) {
        const Vec3 v = in_ball();
        if (dot(v, v) > 1e-4) return unit(v);
    }
}

Pose Random::rotation() {
    for (;;) { // uniform in the 4-ball, then on the 3-sphere
        const double w = uniform(-1, 1);
        const double x = uniform(-1, 1);
        const double y = uniform(-1, 1);
        const double z = uniform(-1, 1);
        const double squared = w * w + x * x + y * y + z * z;
        if (squared <= 1 && squared > 1e-3) return from_quaternion(w, x, y, z);
    }
}

Pose small_rotation(const Vec3& axis, double angle) {
    return from_quaternion(1, 0.5 * angle * axis.x, 0.5 * angle * axis.y, 0.5 * angle * axis.z);
}

} // namespace raycontact::reference
