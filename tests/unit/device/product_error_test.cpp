// SPDX-License-Identifier: Apache-2.0
// What rounding took from a product: in double, as a processor without fused operations has it, with the bits of a
// fused one, whatever the floats and the signs of zeros.
#include "device/host_kernels.h"
#include "reference/random.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

std::uint32_t bits_of(float a, float b) {
    const float p = a * b;
    return std::bit_cast<std::uint32_t>(kernels::prototype::product_error(a, b, p));
}

std::uint32_t fused_bits_of(float a, float b) {
    const float p = a * b;
    return std::bit_cast<std::uint32_t>(std::fma(a, b, -p));
}

TEST(ProductError, HasTheBitsOfAFusedOperation) {
    for (const float a : {0.0F, -0.0F, 1.0F, -1.0F, 2.0F, -0.5F, 3.0F, 4097.0F, -1.0e-3F, 0.1F})
        for (const float b : {0.0F, -0.0F, 1.0F, -1.0F, 2.0F, -0.5F, 3.0F, 4097.0F, -1.0e-3F, 0.1F})
            EXPECT_EQ(bits_of(a, b), fused_bits_of(a, b)) << a << " * " << b;
    reference::Random random(15);
    std::uint64_t inexact = 0;
    for (int i = 0; i < 1000000; ++i) {
        const auto a = static_cast<float>(random.uniform(-1, 1) * std::pow(10.0, random.uniform(-6, 6)));
        const auto b = static_cast<float>(random.uniform(-1, 1) * std::pow(10.0, random.uniform(-6, 6)));
        ASSERT_EQ(bits_of(a, b), fused_bits_of(a, b)) << a << " * " << b;
        inexact += (bits_of(a, b) & 0x7fffffffU) != 0;
    }
    EXPECT_GT(inexact, 900000U);
}

// Products that overflow, or lose bits to denormals, and operands of every exponent.
TEST(ProductError, HasThemForEveryFloat) {
    const auto same = [](std::uint32_t a, std::uint32_t b) {
        return a == b || (std::isnan(std::bit_cast<float>(a)) && std::isnan(std::bit_cast<float>(b)));
    };
    reference::Random random(16);
    std::uint64_t tiny = 0, huge = 0;
    for (int i = 0; i < 4000000; ++i) {
        const auto a = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
        auto b = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
        const int exponent = std::clamp(std::ilogb(a), -200, 200); // 0 and NaN have extreme ones
        // Half of them with a product near the least float, where the error itself is rounded, or near the greatest.
        if (i % 4 == 0) b = std::ldexp(1 + static_cast<float>(random.uniform()), -130 - exponent);
        if (i % 4 == 1) b = std::ldexp(1 + static_cast<float>(random.uniform()), 127 - exponent);
        ASSERT_TRUE(same(bits_of(a, b), fused_bits_of(a, b))) << a << " * " << b;
        tiny += std::fabs(a * b) < 1e-30F && bits_of(a, b) != 0;
        huge += std::isinf(a * b);
    }
    EXPECT_GT(tiny, 100000U);
    EXPECT_GT(huge, 100000U);
    EXPECT_EQ(bits_of(1e35F, 2), fused_bits_of(1e35F, 2));
}

} // namespace
} // namespace raycontact
