// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <raycontact/pose.h>

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace raycontact {
namespace {

using Matrix = std::array<double, 16>;

TEST(Pose, MatrixIsRowMajor) {
    const Pose pose = pose_from_matrix(Matrix{0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1});
    EXPECT_EQ(transform_point(pose, {1, 0, 0}), (Vec3{5, 7, 7}));
}

TEST(Pose, NearlyRigidBecomesRigid) {
    const Pose pose = pose_from_matrix(Matrix{1, 3e-5, 0, 0, 0, 1, 0, 0, 0, 0, 1.00002, 0, 0, 0, 0, 1});
    const auto& r = pose.rotation;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(r[i] * r[j] + r[3 + i] * r[3 + j] + r[6 + i] * r[6 + j], i == j, 1e-14);
    EXPECT_NEAR(r[1], 1.5e-5, 1e-9);
}

TEST(Pose, RefusesWhatIsNotRigid) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Matrix bad[] = {{1, 1e-3, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, // sheared
                          {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1},    // scaled
                          {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},   // mirrored
                          {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1},    // projective
                          {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1},    // transposed
                          {1, 0, 0, nan, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},  // not a number
                          {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}};   // flat
    for (const Matrix& m : bad) EXPECT_THROW(pose_from_matrix(m), InputError);
    EXPECT_THROW(pose_from_quaternion({}, 0, 0, 0, 0), InputError);
    EXPECT_THROW(pose_from_quaternion({nan, 0, 0}, 1, 0, 0, 0), InputError);
    EXPECT_THROW(pose_from_quaternion({}, nan, 0, 0, 0), InputError);
    EXPECT_THROW(pose_from_quaternion({}, 1e-200, 0, 0, 0), InputError) << "its square is 0";
    EXPECT_THROW(pose_from_quaternion({}, 1e200, 0, 0, 0), InputError) << "its square is infinite";
    for (const double length : {1e-150, 1e150})
        EXPECT_NEAR(pose_from_quaternion({}, length, 0, 0, length).rotation[3], 1, 1e-12) << length;
}

TEST(Pose, TheNearestRigidPoseDropsDriftAndScale) {
    const Pose turned = pose_from_quaternion({1, 2, 3}, 1, 2, 3, 4);
    EXPECT_EQ(nearest_rigid_pose({}), Pose{});
    // rotation * stretch, of symmetric stretches
    for (const std::array<double, 9>& s : {std::array<double, 9>{1, 1e-3, 0, 1e-3, 1, 0, 0, 0, 1.001},
                                           std::array<double, 9>{1.01, 0, 0, 0, 1.01, 0, 0, 0, 1.01},
                                           std::array<double, 9>{1e-6, 0, 0, 0, 1e-6, 0, 0, 0, 1e-6},
                                           std::array<double, 9>{1e9, 0, 0, 0, 1e9, 0, 0, 0, 1e9},
                                           std::array<double, 9>{100, 0, 0, 0, 1, 0, 0, 0, 0.1}}) {
        Pose given = turned;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                given.rotation[3 * i + j] = 0;
                for (std::size_t k = 0; k < 3; ++k)
                    given.rotation[3 * i + j] += turned.rotation[3 * i + k] * s[3 * k + j];
            }
        const Pose mended = nearest_rigid_pose(given);
        EXPECT_EQ(mended.translation, turned.translation);
        for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(mended.rotation[i], turned.rotation[i], 1e-12);
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Pose& bad : {Pose{{-1, 0, 0, 0, 1, 0, 0, 0, 1}, {}}, Pose{{1, 0, 0, 0, 1, 0, 0, 0, 0}, {}},
                            Pose{{0, 0, 0, 0, 0, 0, 0, 0, 0}, {}}, Pose{{nan, 0, 0, 0, 1, 0, 0, 0, 1}, {}},
                            Pose{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {nan, 0, 0}}})
        EXPECT_THROW(nearest_rigid_pose(bad), InputError);
}

TEST(Pose, RelativePoseUndoesTheOuter) {
    const Pose a = pose_from_quaternion({1, 2, 3}, 1, 2, 3, 4), b = pose_from_quaternion({-4, 0, 9}, 4, -3, 2, 1);
    const Vec3 p{0.3, -0.7, 0.2};
    const Vec3 there = transform_point(a, transform_point(relative_pose(a, b), p)), here = transform_point(b, p);
    EXPECT_NEAR(there.x, here.x, 1e-14);
    EXPECT_NEAR(there.y, here.y, 1e-14);
    EXPECT_NEAR(there.z, here.z, 1e-14);
}

} // namespace
} // namespace raycontact
