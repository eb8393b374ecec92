// SPDX-License-Identifier: Apache-2.0
#include <placement.h>

#include <objects.h>

#include <algorithm>
#include <cmath>

namespace raycontact::bullet {

namespace {

constexpr btScalar rigid_to = btScalar(1e-5); ///< Bullet's own float rotations are rigid to a few 1e-7
constexpr double drift = 1e-3;
constexpr int stretch_bits = 10;

bool is_rigid(const btTransform& transform) {
    const btMatrix3x3 square = transform.getBasis().transposeTimes(transform.getBasis());
    btScalar off = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) off += btFabs(square[i][j] - btScalar(i == j ? 1 : 0));
    const btVector3& t = transform.getOrigin();
    const bool placed = std::isfinite(t.x()) && std::isfinite(t.y()) && std::isfinite(t.z());
    return placed && off <= rigid_to && transform.getBasis().determinant() > 0; // a NaN is not
}

/// rotation^T * given, made symmetric.
Stretch stretch_between(const Pose& rigid, const Pose& given) {
    Stretch stretch;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            stretch[3 * i + j] = 0;
            for (std::size_t k = 0; k < 9; k += 3)
                stretch[3 * i + j] +=
                    (rigid.rotation[k + i] * given.rotation[k + j] + rigid.rotation[k + j] * given.rotation[k + i]) / 2;
        }
    return stretch;
}

} // namespace

Placement place(const btTransform& transform) {
    Placement placement{transform};
    if (is_rigid(transform)) return placement;
    const Pose given = to_pose(transform);
    Pose upright = given;
    if (transform.getBasis().determinant() < 0)
        for (double& x : upright.rotation) x = -x;
    const Pose rigid = nearest_rigid_pose(upright);
    const std::array<double, 9>& r = rigid.rotation;
    placement.pose.getBasis().setValue(btScalar(r[0]), btScalar(r[1]), btScalar(r[2]), btScalar(r[3]), btScalar(r[4]),
                                       btScalar(r[5]), btScalar(r[6]), btScalar(r[7]), btScalar(r[8]));
    Stretch stretch = stretch_between(rigid, given);
    double off = 0, largest = 0;
    for (std::size_t i = 0; i < 9; ++i) {
        off = std::max(off, std::fabs(stretch[i] - no_stretch[i]));
        largest = std::max(largest, std::fabs(stretch[i]));
    }
    placement.drifted = off <= drift;
    if (placement.drifted) return placement;
    const double step = std::ldexp(1, std::ilogb(largest) - stretch_bits);
    for (double& x : stretch) x = std::round(x / step) * step + 0.0; // no negative zeros: equal stretches are equal
    placement.stretch = stretch;
    return placement;
}

} // namespace raycontact::bullet
