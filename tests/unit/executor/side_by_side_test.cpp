// SPDX-License-Identifier: Apache-2.0
#include "executor/side_by_side.h"

#include <array>
#include <atomic>
#include <chrono>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

TEST(SideBySide, RunsAllAtOnceEachOnItsOwnThread) {
    SideBySide threads(4);
    std::array<std::thread::id, 4> first{};
    for (int run = 0; run < 50; ++run) {
        std::atomic<int> there{0};
        std::array<std::thread::id, 4> ids{};
        if (run % 3 == 0) threads.wake();
        if (run % 9 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2)); // they fall asleep again
        threads.run([&](std::size_t i) {
            ids[i] = std::this_thread::get_id();
            ++there;
            while (there < 4) std::this_thread::yield(); // ends only if all run at the same time
        });
        if (run == 0) first = ids;
        EXPECT_EQ(ids, first);
        EXPECT_EQ(ids[0], std::this_thread::get_id());
    }
    for (std::size_t i = 1; i < 4; ++i) EXPECT_NE(first[i], first[i - 1]);
}

TEST(SideBySide, EndsUnused) {
    const SideBySide one(1), three(3);
}

} // namespace
} // namespace raycontact
