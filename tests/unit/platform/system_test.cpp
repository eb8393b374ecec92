// SPDX-License-Identifier: Apache-2.0
// What is asked of the operating system is there, or said not to be.
#include "platform/system.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

namespace raycontact::platform {
namespace {

TEST(System, AThreadKeepsToTheCoresThatItIsGiven) {
    std::thread([] {
        const CoreSet all = thread_cores();
        if (all.none()) GTEST_SKIP() << "the system does not say on which cores a thread may run";
        CoreSet one;
        one.set(all._Find_first());
        if (!set_thread_cores(one)) GTEST_SKIP() << "the system refuses to pin threads";
        EXPECT_EQ(thread_cores(), one);
        EXPECT_FALSE(set_thread_cores({})) << "no core at all";
        EXPECT_EQ(thread_cores(), one) << "what is refused changes nothing";
        EXPECT_TRUE(set_thread_cores(all));
    }).join();
}

TEST(System, KnowsItsProcessorMemoryAndItself) {
    EXPECT_FALSE(processor_name().empty());
    EXPECT_GT(physical_memory(), std::uint64_t{1} << 26);
    EXPECT_NE(process_id(), 0u);
    trim_heap(); // at any moment
}

TEST(System, ALibraryThatIsNotThereIsToldApartFromOneThatLacksAFunction) {
    Library none("libraycontact-that-nobody-has.so.7");
    EXPECT_FALSE(none);
    const Function<int()> nothing(none, "any");
    EXPECT_TRUE(none.missing().empty()) << "of a library that is not there nothing is missing";
#ifdef __linux__
    Library c("libm.so.6");
    ASSERT_TRUE(c);
    const Function<double(double)> cosine(c, "cos");
    EXPECT_TRUE(c.missing().empty());
    EXPECT_EQ(cosine(0), 1);
    const Function<int()> lacking(c, "raycontact_no_such_function");
    EXPECT_EQ(c.missing(), "raycontact_no_such_function");
#endif
}

} // namespace
} // namespace raycontact::platform
