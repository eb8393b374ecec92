// SPDX-License-Identifier: Apache-2.0
#include "device/scan.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>
#include <numeric>
#include <random>

namespace raycontact {
namespace {

TEST(Scan, AgreesWithTheStandardLibrary) {
    std::mt19937 random(3);
    for (const std::uint32_t threads : {1u, 2u, 5u}) {
        const OpenDevice opened = open_device("cpu", threads);
        Device& device = *opened.device;
        Columns table;
        Array<kernels::Totals> totals;
        totals.resize(device, 3);
        for (const std::size_t count : {1u, 1023u, 16384u, 16385u, 100000u, 3u}) {
            constexpr std::size_t columns = 3;
            table.resize(device, columns, count);
            std::vector<kernels::uint> values(columns * count), expected(count), firsts(count);
            for (auto& value : values) value = static_cast<kernels::uint>(random() % 7);
            std::exclusive_scan(values.begin(), values.begin() + std::ptrdiff_t(count), expected.begin(), 0u);
            device.queue().write(*table.values().buffer(), 0, values.data(), values.size() * sizeof(kernels::uint));
            table.scan(device, count, totals, 1, 10 * count);
            table.firsts().read(device, firsts);
            EXPECT_EQ(firsts, expected);
            kernels::Totals total;
            const Piece piece = totals.piece({&total, 1}, 1);
            device.queue().read({&piece, 1});
            for (std::size_t c = 0; c < columns; ++c)
                EXPECT_EQ(total.sums[c], std::accumulate(values.begin() + std::ptrdiff_t(c * count),
                                                         values.begin() + std::ptrdiff_t((c + 1) * count), 0u));
            EXPECT_EQ(total.results, total.sums[0]);
            EXPECT_EQ(total.items, total.sums[0] > 0 ? count : 0);
            // As many items as the device knows, not the host.
            table.scan(device, items_of(totals, 1, count), totals, 2, 10 * count);
            kernels::Totals again;
            const Piece second = totals.piece({&again, 1}, 2);
            device.queue().read({&second, 1});
            EXPECT_EQ(again.sums[0], total.sums[0]);
        }
    }
}

TEST(Scan, NothingIsWrittenWhereThereIsNoRoom) {
    const OpenDevice opened = open_device("cpu", 1);
    Device& device = *opened.device;
    Columns table;
    Array<kernels::Totals> totals;
    totals.resize(device, 1);
    kernels::Totals total;
    const std::vector<kernels::uint> values{3, 0, 4};
    const auto scan = [&](const Count& count, std::size_t room) {
        table.resize(device, 1, values.size());
        device.queue().write(*table.values().buffer(), 0, values.data(), sizeof(kernels::uint) * values.size());
        table.scan(device, count, totals, 0, room);
        totals.read(device, {&total, 1});
    };
    scan(3, 7);
    EXPECT_EQ(total.items, 3u);
    EXPECT_EQ(total.results, 7u);
    scan(3, 6);
    EXPECT_EQ(total.items, 0u);
    EXPECT_EQ(total.results, 0u);
    EXPECT_EQ(total.sums[0], 7u) << "what would have been needed";
    scan(0, 7);
    EXPECT_EQ(total.items, 0u);
    EXPECT_EQ(total.sums[0], 0u);
}

TEST(Scan, SumsBeyond32BitsAreRefused) {
    const OpenDevice opened = open_device("cpu", 2);
    Device& device = *opened.device;
    Columns table;
    table.resize(device, 2, 3);
    Array<kernels::Totals> totals;
    totals.resize(device, 1);
    const std::vector<kernels::uint> values{1, 1, 1, 0x80000000u, 0x7fffffffu, 5};
    device.queue().write(*table.values().buffer(), 0, values.data(), sizeof(kernels::uint) * values.size());
    table.scan(device, 3, totals, 0, 100);
    kernels::Totals total;
    totals.read(device, {&total, 1});
    EXPECT_EQ(total.results, 3u);
    EXPECT_EQ(total.sums[1], NONE);
    EXPECT_THROW(check_sums({&total, 1}), InputError);
    EXPECT_THROW(Count(std::size_t{1} << 32), InputError);
}

} // namespace
} // namespace raycontact
