// SPDX-License-Identifier: Apache-2.0
#include <raycontact/pose.h>

#include "mesh/vector.h"
#include "pose_fault.h"

#include <raycontact/error.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace raycontact {

namespace {

constexpr double rigid_to = 1e-4;

double determinant(const std::array<double, 9>& m) {
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

// Largest departure of R^T R from the identity.
double shear_of(const std::array<double, 9>& r) {
    double worst = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const double product = r[i] * r[j] + r[3 + i] * r[3 + j] + r[6 + i] * r[6 + j];
            worst = std::max(worst, std::fabs(product - (i == j ? 1 : 0)));
        }
    return worst;
}

// Newton's iteration for the polar decomposition: the mean of a matrix and its inverse transpose.
std::array<double, 9> nearest_rotation(std::array<double, 9> r, int rounds) {
    for (int round = 0; round < rounds && shear_of(r) > 1e-15; ++round) {
        const double d = determinant(r);
        const std::array<double, 9> cofactors{
            r[4] * r[8] - r[5] * r[7], r[5] * r[6] - r[3] * r[8], r[3] * r[7] - r[4] * r[6],
            r[2] * r[7] - r[1] * r[8], r[0] * r[8] - r[2] * r[6], r[1] * r[6] - r[0] * r[7],
            r[1] * r[5] - r[2] * r[4], r[2] * r[3] - r[0] * r[5], r[0] * r[4] - r[1] * r[3]};
        for (int i = 0; i < 9; ++i) r[i] = 0.5 * (r[i] + cofactors[i] / d);
    }
    return r;
}

const char* infinite_part(const Pose& pose) {
    for (const double x : pose.rotation)
        if (!std::isfinite(x)) return "the rotation has an entry that is not a finite number";
    if (!is_finite(pose.translation)) return "the translation has an entry that is not a finite number";
    return nullptr;
}

} // namespace

const char* pose_fault(const Pose& pose) {
    if (const char* fault = infinite_part(pose)) return fault;
    if (determinant(pose.rotation) <= 0)
        return "the pose is mirrored or flat (determinant not above 0); give a rotation and a translation";
    if (shear_of(pose.rotation) > rigid_to)
        return "the pose is not rigid to 1e-4 (sheared or scaled); give a rotation and a translation";
    return nullptr;
}

void check_pose(const Pose& pose, const char* who) {
    if (const char* fault = pose_fault(pose)) throw InputError(std::string(who) + ": " + fault);
}

Pose pose_from_matrix(std::span<const double, 16> m) {
    Pose pose;
    pose.rotation = {m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
    pose.translation = {m[3], m[7], m[11]};
    for (const double x : m)
        if (!std::isfinite(x)) throw InputError("pose: an entry is not a finite number");
    if (std::fabs(m[12]) > rigid_to || std::fabs(m[13]) > rigid_to || std::fabs(m[14]) > rigid_to
        || std::fabs(m[15] - 1) > rigid_to)
        throw InputError("pose: the last row must be 0 0 0 1 (matrices are row-major)");
    check_pose(pose, "pose");
    pose.rotation = nearest_rotation(pose.rotation, 8);
    return pose;
}

Pose nearest_rigid_pose(const Pose& pose) {
    if (const char* fault = infinite_part(pose)) throw InputError(std::string("pose: ") + fault);
    double largest = 0;
    for (const double x : pose.rotation) largest = std::max(largest, std::fabs(x));
    Pose rigid = pose;
    for (double& x : rigid.rotation) x /= largest; // Newton's iteration halves what is too large, round by round
    const double volume = determinant(rigid.rotation);
    if (volume < -1e-9) throw InputError("pose: it is mirrored; give a rotation");
    if (!(volume > 1e-9))
        throw InputError("pose: it is flat, which scales a direction to nothing, or nearly; give one that is not");
    rigid.rotation = nearest_rotation(rigid.rotation, 64);
    return rigid;
}

Pose pose_from_quaternion(const Vec3& translation, double w, double x, double y, double z) {
    const double size = std::sqrt(w * w + x * x + y * y + z * z);
    if (!std::isfinite(size) || size == 0) throw InputError("pose: the quaternion is zero or not finite");
    w /= size;
    x /= size;
    y /= size;
    z /= size;
    Pose pose;
    pose.rotation = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                     2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    pose.translation = translation;
    check_pose(pose, "pose");
    return pose;
}

Vec3 transform_point(const Pose& pose, const Vec3& p) {
    return rotated(pose.rotation, p) + pose.translation;
}

Pose relative_pose(const Pose& outer, const Pose& inner) {
    const auto& o = outer.rotation;
    const auto& i = inner.rotation;
    Pose relative;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            relative.rotation[3 * row + column] =
                (o[row] * i[column] + o[3 + row] * i[3 + column]) + o[6 + row] * i[6 + column];
    relative.translation = rotated_back(o, inner.translation - outer.translation);
    return relative;
}

} // namespace raycontact
