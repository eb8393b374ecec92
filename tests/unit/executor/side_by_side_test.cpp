// SPDX-License-Identifier: Apache-2.0
#include "executor/side_by_side.h"

#include <array>
#include <atomic>
#include <chrono>
#include <exception>
#include <gtest/gtest.h>

#ifdef __linux__
#include <cstdlib>
#include <fstream>
#include <sys/resource.h>
#include <unistd.h>
#endif

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

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) // which need room themselves
/// Ends this process with 0 if the threads that there was room for have ended, too.
void make_more_than_there_is_room_for() {
    ::alarm(20);
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit limit{};
    ::getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + (rlim_t{64} << 20); // some 8 stacks
    ::setrlimit(RLIMIT_AS, &limit);
    try {
        const SideBySide many(1000);
    } catch (const std::exception&) { // of the system, or of memory
        std::_Exit(0);
    }
    std::_Exit(1);
}

TEST(SideBySideDeathTest, EndsThoseThereAreWhereTheSystemGivesNoMore) {
    ::testing::FLAGS_gtest_death_test_style = "threadsafe";
    EXPECT_EXIT(make_more_than_there_is_room_for(), ::testing::ExitedWithCode(0), "");
}
#endif

} // namespace
} // namespace raycontact
