// SPDX-License-Identifier: Apache-2.0
#include "device/cpu/kernel_table.h"
#include "executor/float_environment.h"

#include <raycontact/error.h>
#include <raycontact/scene.h>

#include "scenes/models/model.h"

#include <cstdlib>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

TEST(KernelTable, BaselineIsAlwaysThere) {
    ASSERT_FALSE(cpu::usable_tables().empty());
    EXPECT_EQ(cpu::usable_tables().back()->instruction_set, "baseline");
}

void fill(Scene& scene) {
    const auto shape = Shape::make(scenes::scene_model("knot", 902).mesh);
    for (int i = 0; i < 6; ++i) scene.add(shape, pose_from_quaternion({0.2 * i, 0.1 * (i % 3), 0.05 * i}, 1, i, 2, -i));
}

std::string hash_of_step(Scene& scene) {
    ContactHash hash;
    hash.add(0, scene.find_contacts());
    EXPECT_GT(scene.stats().contacts, 100u);
    return hash.hex();
}

std::string hash_of_a_scene() {
    Scene scene;
    fill(scene);
    return hash_of_step(scene);
}

TEST(KernelTable, EveryInstructionSetGivesTheSameBits) {
    std::string first;
    for (const cpu::KernelTable* table : cpu::usable_tables()) {
        setenv("RAYCONTACT_INSTRUCTION_SET", std::string(table->instruction_set).c_str(), 1);
        const std::string hash = hash_of_a_scene();
        if (first.empty()) first = hash;
        EXPECT_EQ(hash, first) << table->instruction_set;
    }
    setenv("RAYCONTACT_INSTRUCTION_SET", "abacus", 1);
    EXPECT_THROW(hash_of_a_scene(), InputError);
    unsetenv("RAYCONTACT_INSTRUCTION_SET");
}

#if defined(__x86_64__)
TEST(FloatEnvironment, CallersRulesChangeNothingAndComeBack) {
    Scene scene;
    fill(scene);
    const std::string expected = hash_of_step(scene);
    const unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040u | 0x6000u); // flush denormals, read them as zero, round towards zero
    const unsigned odd = _mm_getcsr();
    {
        const FloatEnvironment environment;
        EXPECT_EQ(_mm_getcsr() & 0xe040u, 0u);
    }
    EXPECT_EQ(_mm_getcsr() & ~0x3fu, odd & ~0x3fu);
    const std::string under_odd_rules = hash_of_step(scene);
    _mm_setcsr(before);
    EXPECT_EQ(under_odd_rules, expected);
}
#endif

} // namespace
} // namespace raycontact
