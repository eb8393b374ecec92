// SPDX-License-Identifier: Apache-2.0
#include "device/scan.h"

#include <gtest/gtest.h>
#include <numeric>
#include <random>

namespace raycontact {
namespace {

TEST(Scan, AgreesWithTheStandardLibrary) {
    std::mt19937 random(3);
    Scan scan;
    for (const std::uint32_t threads : {1u, 2u, 5u}) {
        const OpenDevice opened = open_device("cpu", threads);
        for (const std::size_t count : {0u, 1u, 1023u, 1024u, 1025u, 100000u, 3u}) {
            std::vector<kernels::uint> values(count), expected(count), firsts(count);
            for (auto& value : values) value = static_cast<kernels::uint>(random() % 7);
            std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0u);
            Array<kernels::uint> on_device, result;
            on_device.write(*opened.device, values);
            EXPECT_EQ(scan.run(*opened.device, on_device, result), std::accumulate(values.begin(), values.end(), 0u));
            EXPECT_EQ(scan.total(*opened.device, on_device), std::accumulate(values.begin(), values.end(), 0u));
            if (count > 0) result.read(*opened.device, firsts);
            EXPECT_EQ(firsts, expected);
        }
    }
}

} // namespace
} // namespace raycontact
