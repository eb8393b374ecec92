// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <array>
#include <bit>
#include <cstdint>
#include <gtest/gtest.h>
#include <tuple>

namespace raycontact::device_test {

/// The bits of a contact's numbers; == would take -0 for 0.
inline std::array<std::uint64_t, 8> bits(const Contact& c) {
    const auto of = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value)}; };
    return {of(c.normal.x),
            of(c.normal.y),
            of(c.normal.z),
            of(c.ray_length),
            of(c.weight),
            std::bit_cast<std::uint64_t>(c.point().x),
            std::bit_cast<std::uint64_t>(c.point().y),
            std::bit_cast<std::uint64_t>(c.point().z)};
}

/// All contacts, bit for bit.
inline ::testing::AssertionResult same(std::span<const Contact> found, std::span<const Contact> expected) {
    if (found.size() != expected.size())
        return ::testing::AssertionFailure() << found.size() << " contacts, not " << expected.size();
    for (std::size_t i = 0; i < found.size(); ++i) {
        const Contact &a = found[i], &b = expected[i];
        if (std::tie(a.body_a, a.body_b, a.feature) != std::tie(b.body_a, b.body_b, b.feature) || bits(a) != bits(b))
            return ::testing::AssertionFailure() << "contact " << i << " differs";
    }
    return ::testing::AssertionSuccess();
}

} // namespace raycontact::device_test
