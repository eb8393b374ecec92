// SPDX-License-Identifier: Apache-2.0
#include "executor/executor.h"

#include <raycontact/error.h>

#include <atomic>
#include <gtest/gtest.h>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace raycontact {
namespace {

TEST(Executor, EveryIndexOnce) {
    for (const std::uint32_t threads : {1u, 2u, 3u, 7u}) {
        Executor executor(threads);
        for (const std::uint32_t count : {0u, 1u, 5u, 1000u, 100003u}) {
            std::vector<std::atomic<int>> seen(count);
            executor.run(count, 16, [&](std::uint32_t begin, std::uint32_t end) {
                for (std::uint32_t i = begin; i < end; ++i) ++seen[i];
            });
            for (const auto& times : seen) ASSERT_EQ(times, 1);
        }
    }
}

TEST(Executor, ThrowsWhatASliceThrows) {
    Executor executor(3);
    const auto fail = [](std::uint32_t, std::uint32_t) { throw std::runtime_error("slice"); };
    EXPECT_THROW(executor.run(1000, 10, fail), std::runtime_error);
    std::atomic<std::uint32_t> done{0};
    executor.run(1000, 10, [&](std::uint32_t begin, std::uint32_t end) { done += end - begin; });
    EXPECT_EQ(done, 1000u) << "the pool works on after a failure";
}

TEST(Executor, RefusesMoreThreadsThanAnyoneNeeds) {
    EXPECT_EQ(Executor(1024, 0).threads(), 1u);
    EXPECT_THROW(Executor(1025), InputError);
    EXPECT_THROW(Executor(1025, 0), InputError);
    EXPECT_EQ(threads_for(511, 3), 1u) << "few are done before others wake";
    EXPECT_EQ(threads_for(512, 3), 3u);
    EXPECT_THROW(threads_for(1, 1025), InputError);
}

TEST(Executor, OneCoreRunsEverything) {
    Executor executor(4, 0);
    EXPECT_EQ(executor.threads(), 1u);
    std::uint32_t sum = 0;
    executor.run(100, 1, [&](std::uint32_t begin, std::uint32_t end) { sum += end - begin; });
    EXPECT_EQ(sum, 100u);
}

} // namespace
} // namespace raycontact
