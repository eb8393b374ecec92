// SPDX-License-Identifier: Apache-2.0
#include <tests/stacks/verdict.h>

#include <tests/stacks/overlap.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raycontact::scenes {

bool Verdict::fell(const Stack& stack, double allowed, double allowed_turn) const {
    // Negated, so that what is not a number has fallen.
    if (!(sunk <= drift_limit && overlap <= drift_limit)) return true;
    return stack.stands && !(drift <= std::max(allowed, drift_limit) && turn <= allowed_turn);
}

// The sine is exact where the cosine is not.
double angle_of(const Pose& moved) {
    const auto& r = moved.rotation;
    const double x = r[7] - r[5], y = r[2] - r[6], z = r[3] - r[1];
    return std::atan2(std::sqrt(x * x + y * y + z * z), r[0] + r[4] + r[8] - 1);
}

Verdict judge(const Stack& stack, std::span<const Pose> poses) {
    Verdict verdict;
    const auto most = [](double& known, double value) {
        if (!(value <= known)) known = value;
    };
    for (std::size_t i = 0; i < stack.bodies.size(); ++i) {
        const StackShape& shape = stack.shapes[stack.bodies[i].shape];
        const Pose moved = relative_pose(stack.bodies[i].pose, poses[i]);
        const Vec3& by = moved.translation;
        most(verdict.drift, std::sqrt(by.x * by.x + by.y * by.y + by.z * by.z) / shape.size);
        most(verdict.turn, angle_of(moved) * 180 / std::numbers::pi);
        for (const Vec3& v : shape.mesh.vertices) most(verdict.sunk, -transform_point(poses[i], v).z / shape.size);
        for (std::size_t k = 0; k < i; ++k) {
            const StackShape& other = stack.shapes[stack.bodies[k].shape];
            if (shape.box && other.box)
                most(verdict.overlap,
                     box_overlap(*shape.box, poses[i], *other.box, poses[k]) / std::min(shape.size, other.size));
        }
    }
    return verdict;
}

} // namespace raycontact::scenes
