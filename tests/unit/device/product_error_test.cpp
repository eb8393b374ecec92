// SPDX-License-Identifier: Apache-2.0
// What rounding took from a product: by splitting, as a processor without fused operations has it, with the bits of a
// fused one, the signs of zeros too.
#include "device/host_kernels.h"
#include "reference/random.h"

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

} // namespace
} // namespace raycontact
