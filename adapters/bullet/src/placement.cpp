// SPDX-License-Identifier: Apache-2.0
#include <placement.h>

#include <objects.h>

#include <algorithm>
#include <cmath>

namespace raycontact::bullet {

namespace {

constexpr btScalar rigid_to = btScalar(1e-5); ///< Bullet's own float rotations are rigid to a few 1e-7
constexpr double drift = 1e-3;
constexpr int first_bits = 10, most_bits = 30; ///< of a rounded stretch
constexpr double rounded_to = 2e-3, kept_to = 3e-3;

bool is_rigid(const btTransform& transform) {
    const btMatrix3x3 square = transform.getBasis().transposeTimes(transform.getBasis());
    btScalar off = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) off += btFabs(square[i][j] - btScalar(i == j ? 1 : 0));
    const btVector3& t = transform.getOrigin();
    const bool placed = std::isfinite(t.x()) && std::isfinite(t.y()) && std::isfinite(t.z());
    return placed && off <= rigid_to && transform.getBasis().determinant() > 0; // a NaN is not
}

/// In double: the volume of a small scale is no float.
bool is_mirrored(const Pose& pose) {
    const std::array<double, 9>& r = pose.rotation;
    return r[0] * (r[4] * r[8] - r[5] * r[7]) + r[1] * (r[5] * r[6] - r[3] * r[8]) + r[2] * (r[3] * r[7] - r[4] * r[6])
           < 0;
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

/// How far the ratio of two stretches is from 1, in all directions together.
double difference(const Stretch& a, const Stretch& b) {
    const Stretch i = inverse(a);
    Stretch ratio = no_stretch; // less the identity
    for (std::size_t r = 0; r < 9; r += 3)
        for (std::size_t c = 0; c < 3; ++c)
            ratio[r + c] = i[r] * b[c] + i[r + 1] * b[c + 3] + i[r + 2] * b[c + 6] - no_stretch[r + c];
    double squares = 0; // of its eigenvalues: the trace of its square
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 3; ++c) squares += ratio[3 * r + c] * ratio[3 * c + r];
    return std::sqrt(std::max(squares, 0.0));
}

/// Of an entry: by the lengths of its two axes.
double step_of(const Stretch& stretch, std::size_t entry, int bits) {
    const double size = std::sqrt(std::fabs(stretch[4 * (entry / 3)] * stretch[4 * (entry % 3)]));
    return std::ldexp(1, std::ilogb(size) - bits);
}

/// Rounding is half a step off at most.
bool is_within_a_step(const Stretch& stretch, const Stretch& kept) {
    for (std::size_t i = 0; i < 9; ++i)
        if (std::fabs(stretch[i] - kept[i]) > step_of(kept, i, first_bits)) return false;
    return difference(kept, stretch) <= kept_to;
}

/// Each entry by the lengths of its two axes, so that thin directions are as exact as long ones; finer where the thin
/// direction is none of the axes.
Stretch round_stretch(const Stretch& stretch) {
    Stretch rounded = stretch;
    for (int bits = first_bits; bits <= most_bits; ++bits) {
        for (std::size_t i = 0; i < 9; ++i) {
            const double step = step_of(stretch, i, bits);
            rounded[i] = std::round(stretch[i] / step) * step + 0.0; // no negative zeros: equal stretches are equal
        }
        if (difference(stretch, rounded) <= rounded_to) return rounded;
    }
    return stretch;
}

} // namespace

Stretch inverse(const Stretch& s) {
    Stretch adjugate;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t r = 3 * ((j + 1) % 3), q = 3 * ((j + 2) % 3), c = (i + 1) % 3, d = (i + 2) % 3;
            adjugate[3 * i + j] = s[r + c] * s[q + d] - s[r + d] * s[q + c];
        }
    const double determinant = s[0] * adjugate[0] + s[1] * adjugate[3] + s[2] * adjugate[6];
    for (double& x : adjugate) x /= determinant;
    return adjugate;
}

Placement place(const btTransform& transform, const Stretch& kept) {
    Placement placement{transform};
    if (is_rigid(transform)) return placement;
    const Pose given = to_pose(transform);
    Pose upright = given;
    if (is_mirrored(given))
        for (double& x : upright.rotation) x = -x;
    const Pose rigid = nearest_rigid_pose(upright);
    const std::array<double, 9>& r = rigid.rotation;
    placement.pose.getBasis().setValue(btScalar(r[0]), btScalar(r[1]), btScalar(r[2]), btScalar(r[3]), btScalar(r[4]),
                                       btScalar(r[5]), btScalar(r[6]), btScalar(r[7]), btScalar(r[8]));
    const Stretch stretch = stretch_between(rigid, given);
    placement.unrounded = stretch;
    if (kept != no_stretch && is_within_a_step(stretch, kept)) {
        placement.stretch = kept;
        return placement;
    }
    double off = 0;
    for (std::size_t i = 0; i < 9; ++i) off = std::max(off, std::fabs(stretch[i] - no_stretch[i]));
    placement.drifted = off <= drift;
    if (placement.drifted)
        placement.unrounded = no_stretch;
    else
        placement.stretch = round_stretch(stretch);
    return placement;
}

} // namespace raycontact::bullet
