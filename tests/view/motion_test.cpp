// SPDX-License-Identifier: Apache-2.0
#include "program.h"
#include "reference/meshes.h"

#include <recording/writer.h>
#include <view/motion.h>

#include <cmath>
#include <gtest/gtest.h>

namespace raycontact::view {
namespace {

Pose turned(double angle, const Vec3& at) {
    Pose pose;
    pose.rotation = {std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1};
    pose.translation = at;
    return pose;
}

// Body 0 turns in a circle for `steps` steps; body 1 comes at step 5 and goes at step 9.
void record(const std::string& file, std::uint32_t steps) {
    recording::Info info;
    info.scene = "circle";
    recording::Writer writer(file, info);
    const auto shape = Shape::make(reference::l_prism_mesh());
    writer.add_shape(*shape);
    writer.add_body(0);
    BodyId second;
    for (std::uint32_t i = 0; i < steps; ++i) {
        if (i == 5) second = writer.add_body(0);
        if (i == 9) writer.remove_body(second);
        const double a = 0.1 * i;
        const std::vector<Pose> poses{turned(2 * a, {3 * std::cos(a), 3 * std::sin(a), 0.5}), turned(-a, {0, 0, a})};
        writer.step(poses, {});
    }
    writer.finish("0123456789abcdef");
}

double number(const Motion& motion, std::uint32_t body, std::uint32_t n, std::uint32_t k) {
    const double part = motion.numbers[(body * numbers_a_pose + n) * motion.kept + k] / 65535.0;
    return n < 3 ? motion.low[n] + part * (motion.high[n] - motion.low[n]) : 2 * part - 1;
}

TEST(Motion, KeepsPosesToHalfAStepOfSixteenBits) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "a.glb";
    record(file, 100);
    recording::Reader reader(file);
    for (const std::uint32_t stride : {1u, 7u}) {
        const Motion motion = read_motion(reader, stride, {});
        ASSERT_EQ(motion.kept, (100 + stride - 1) / stride);
        ASSERT_EQ(motion.bodies, 2u);
        for (std::uint32_t k = 0; k < motion.kept; ++k) {
            const double a = 0.1 * k * stride;
            const double place[3] = {3 * std::cos(a), 3 * std::sin(a), 0.5};
            for (std::uint32_t n = 0; n < 3; ++n)
                EXPECT_NEAR(number(motion, 0, n, k), place[n], (motion.high[n] - motion.low[n]) / 65535) << k;
            // About z by 2a: quaternion (0, 0, sin a, cos a), or its opposite.
            const double z = number(motion, 0, 5, k), w = number(motion, 0, 6, k);
            EXPECT_NEAR(std::fabs(z * std::sin(a) + w * std::cos(a)), 1, 1e-4) << k;
            EXPECT_NEAR(number(motion, 0, 3, k), 0, 2e-5);
            if (k > 0 && stride == 1) {
                EXPECT_GT(z * number(motion, 0, 5, k - 1) + w * number(motion, 0, 6, k - 1), 0) << "jumps at " << k;
            }
        }
    }
}

TEST(Motion, ABodyThatIsNotThereStandsWhereItWasOrWillBe) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "a.glb";
    record(file, 20);
    recording::Reader reader(file);
    const Motion motion = read_motion(reader, 1, {});
    const double step = (motion.high[2] - motion.low[2]) / 65535;
    for (std::uint32_t k = 0; k < 20; ++k)
        EXPECT_NEAR(number(motion, 1, 2, k), 0.1 * std::min(std::max(k, 5u), 8u), step) << k;
}

TEST(Motion, DifferencesAddUpAgain) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "a.glb";
    record(file, 30);
    recording::Reader reader(file);
    const Motion motion = read_motion(reader, 1, {});
    std::vector<std::uint16_t> sums = differences(motion);
    ASSERT_NE(sums, motion.numbers);
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (i % motion.kept != 0) sums[i] = static_cast<std::uint16_t>(sums[i] + sums[i - 1]);
    EXPECT_EQ(sums, motion.numbers);
}

TEST(Motion, TheStrideKeepsPosesWithinALimit) {
    EXPECT_EQ(stride_for(512, 600, 800'000), 1u);
    EXPECT_EQ(stride_for(500, 3000, 800'000), 2u);
    EXPECT_EQ(stride_for(4'000'000, 100, 800'000), 100u);
    EXPECT_EQ(stride_for(0, 100, 800'000), 1u);
}

} // namespace
} // namespace raycontact::view
