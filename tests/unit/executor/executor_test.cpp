// SPDX-License-Identifier: Apache-2.0
#include "executor/executor.h"
#include "executor/row_slices.h"
#include "executor/sum_up.h"
#include "reference/random.h"

#include <raycontact/error.h>

#include <atomic>
#include <gtest/gtest.h>
#include <numeric>
#include <stdexcept>
#include <thread>
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

/// A job system: its threads take jobs in any order.
struct Jobs {
    std::atomic<int> runs = 0;
    std::uint32_t leaves_out = 0; ///< jobs, which is a fault
    TaskSystem system() {
        return {[](void* user, std::uint32_t count, TaskSystem::Job job, void* data) {
                    Jobs& own = *static_cast<Jobs*>(user);
                    ++own.runs;
                    std::vector<std::jthread> threads;
                    for (std::uint32_t t = 0; t < 3; ++t)
                        threads.emplace_back([&, t] {
                            for (std::uint32_t i = t; i + own.leaves_out < count; i += 3) job(data, count - 1 - i);
                        });
                },
                this};
    }
};

TEST(Executor, RunsOnAUsersThreads) {
    Jobs jobs;
    Executor executor(3, -1, Executor::Priority::normal, jobs.system());
    for (const std::uint32_t count : {0u, 1u, 5u, 1000u, 100003u}) {
        std::vector<std::atomic<int>> seen(count);
        executor.run(count, 16, [&](std::uint32_t begin, std::uint32_t end) {
            for (std::uint32_t i = begin; i < end; ++i) ++seen[i];
        });
        for (const auto& times : seen) ASSERT_EQ(times, 1);
    }
    EXPECT_EQ(jobs.runs, 2) << "a piece alone is done at once";
    EXPECT_THROW(executor.run(1000, 10, [](std::uint32_t, std::uint32_t) { throw std::runtime_error("slice"); }),
                 std::runtime_error);
    jobs.leaves_out = 1;
    EXPECT_THROW(executor.run(1000, 10, [](std::uint32_t, std::uint32_t) {}), std::logic_error);
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

TEST(Executor, SumsUpAsOneThreadDoes) {
    for (const std::uint32_t threads : {1u, 3u}) {
        Executor executor(threads);
        for (const std::size_t size : {0u, 1u, 1000u, 32768u, 32769u, 100003u, 400000u}) {
            std::vector<std::uint64_t> numbers(size), expected(size);
            for (std::size_t i = 0; i < size; ++i) numbers[i] = i * 2654435761u % 100;
            std::partial_sum(numbers.begin(), numbers.end(), expected.begin());
            sum_up(executor, std::span(numbers));
            ASSERT_EQ(numbers, expected) << size;
        }
    }
}

// Rows of all lengths, some longer than a slice.
TEST(Executor, SlicesHaveWholeRows) {
    reference::Random random(1);
    for (const std::size_t size : {0u, 1u, 99u, 100u, 101u, 5000u}) {
        std::vector<std::uint32_t> rows(size);
        std::uint32_t row = 0;
        for (std::size_t i = 0; i < size; ++i) rows[i] = row += random.below(i / 1000 % 2 == 0 ? 3 : 300) == 1;
        const RowSlices slices{size, 100};
        std::vector<std::atomic<int>> seen(size);
        std::vector<std::atomic<int>> of_slice(slices.count());
        Executor executor(3);
        slices.each(
            executor, [&](std::size_t i) { return rows[i] == rows[i - 1]; },
            [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
                ++of_slice[slice];
                EXPECT_TRUE(begin == 0 || rows[begin - 1] != rows[begin]);
                EXPECT_TRUE(end == size || rows[end - 1] != rows[end]);
                for (std::size_t i = begin; i < end; ++i) ++seen[i];
            });
        for (const auto& times : seen) ASSERT_EQ(times, 1);
        for (const auto& times : of_slice) ASSERT_LE(times, 1);
    }
}

} // namespace
} // namespace raycontact
