// SPDX-License-Identifier: Apache-2.0
#include "schedule/choice.h"

#include <array>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

// A machine on which a step takes so many milliseconds on each part.
struct Machine {
    double cpu = 1, gpu = 1;
    std::uint64_t pairs = 1000;

    double of(std::size_t part) const { return part == 0 ? cpu : gpu; }
};

const std::array<std::string, 2> names{"cpu", "cuda:0"};

// Returns how many of the steps were on the GPU.
int run(DeviceChoice& choice, const Machine& machine, int steps) {
    int on_gpu = 0;
    for (int i = 0; i < steps; ++i) {
        on_gpu += choice.part() == 1 ? 1 : 0;
        choice.record(machine.pairs, machine.of(choice.part()));
    }
    return on_gpu;
}

// The number of the first step on another part; -1: none within a million.
int run_to_move(DeviceChoice& choice, const Machine& machine) {
    const std::size_t before = choice.part();
    for (int i = 0; i < 1000000; ++i) {
        if (choice.part() != before) return i;
        choice.record(machine.pairs, machine.of(before));
    }
    return -1;
}

TEST(DeviceChoice, BeginsWithTheCpuAndTakesAFasterGpu) {
    DeviceChoice choice;
    EXPECT_EQ(choice.part(), 0u);
    EXPECT_EQ(choice.text(names), "cpu: not measured yet");
    EXPECT_EQ(run(choice, {10, 2}, 15), 0);
    EXPECT_EQ(choice.text(names), "cpu: 10 ms a step with 1000 pairs, too few steps so far to try cuda:0");
    run_to_move(choice, {10, 2});
    EXPECT_EQ(choice.part(), 1u);
    EXPECT_EQ(choice.text(names), "cuda:0: being tried, cpu takes 10 ms a step with 1000 pairs");
    EXPECT_EQ(run(choice, {10, 2}, 10000), 10000) << "nothing has changed since";
    EXPECT_EQ(choice.text(names), "cuda:0: 2 ms a step, cpu 10 ms, measured with 1000 pairs");
}

TEST(DeviceChoice, StaysWithTheCpuWhereTheGpuIsSlowerOrHardlyFaster) {
    for (const double gpu : {30.0, 10.0, 9.2}) {
        DeviceChoice choice;
        run_to_move(choice, {10, gpu});
        const int tried = run(choice, {10, gpu}, 10000);
        EXPECT_GT(tried, 5);
        EXPECT_LT(tried, 20);
        EXPECT_EQ(choice.part(), 0u);
        EXPECT_TRUE(choice.text(names).starts_with("cpu: 10 ms a step, cuda:0 ")) << choice.text(names);
    }
}

// What a trial's first steps take, and single steps that take long, decide nothing.
TEST(DeviceChoice, GoesByTheMedianAfterWarmUp) {
    DeviceChoice choice;
    run_to_move(choice, {10, 0});
    for (int i = 0; i < 2000; ++i)
        choice.record(1000, choice.part() == 0 ? (i % 4 == 0 ? 1 : 10) : i < 3 ? 1000 : i % 4 == 0 ? 300 : 5);
    EXPECT_EQ(choice.part(), 1u);
    EXPECT_EQ(choice.text(names), "cuda:0: 5 ms a step, cpu 10 ms, measured with 1000 pairs");
}

TEST(DeviceChoice, TriesNoGpuForStepsThatAreTooShort) {
    DeviceChoice choice;
    EXPECT_EQ(run_to_move(choice, {0.05, 0.001, 12}), -1);
    EXPECT_EQ(choice.text(names), "cpu: 0.05 ms a step with 12 pairs, too short for cuda:0 to gain");
    EXPECT_GE(run_to_move(choice, {5, 1, 3000}), 0) << "then there are more pairs";
}

// A scene that is over within the time that it takes to open a GPU opens none.
TEST(DeviceChoice, WaitsUntilAGpuCouldPay) {
    for (const double ms : {0.5, 2.0, 8.0}) {
        DeviceChoice choice;
        EXPECT_NEAR(run_to_move(choice, {ms, 1}), 200 / ms, 20) << ms;
    }
    DeviceChoice choice;
    EXPECT_LT(run_to_move(choice, {1000, 1}), 20) << "warm-up and a median";
}

TEST(DeviceChoice, MeasuresAgainOncePairsOrTimesHaveDoubledOrHalved) {
    const Machine few{3, 4, 1000};
    const Machine changes[] = {{3, 4, 2100}, {3, 4, 450}, {7, 4, 1000}, {1, 4, 1000}};
    for (const Machine& then : changes) {
        DeviceChoice choice;
        run_to_move(choice, few);
        run(choice, few, 2000);
        EXPECT_EQ(choice.part(), 0u);
        EXPECT_EQ(run(choice, {3.5, 4, 1500}, 10000), 0) << "less than doubled";
        EXPECT_EQ(run(choice, few, 2000), 0);
        EXPECT_GE(run_to_move(choice, then), 0) << then.pairs;
        run(choice, then, 100);
        EXPECT_EQ(choice.part(), then.cpu > then.gpu ? 1u : 0u);
    }
    // From the GPU back, even where its steps are short.
    DeviceChoice choice;
    run_to_move(choice, {10, 2, 9000});
    run(choice, {10, 2, 9000}, 100);
    EXPECT_EQ(choice.part(), 1u);
    run(choice, {0.01, 0.08, 20}, 20000);
    EXPECT_EQ(choice.part(), 0u);
    EXPECT_EQ(choice.text(names), "cpu: 0.01 ms a step, cuda:0 0.08 ms, measured with 20 pairs");
}

// Pairs that come and go for ever, in every rhythm: trials, and what moves take, are a fiftieth of the time.
TEST(DeviceChoice, SpendsLittleOnTrialsWherePairsFluctuate) {
    for (const int period : {5, 20, 100, 1000})
        for (const double move : {0.0, 30.0}) {
            DeviceChoice choice;
            double all = 0, lost = 0;
            std::size_t last = 0;
            for (int i = 0; i < 200000; ++i) {
                const Machine machine = i / period % 2 == 0 ? Machine{1, 15, 100} : Machine{4, 40, 5000};
                if (choice.part() != last) {
                    choice.record_move(move);
                    lost += move;
                    last = choice.part();
                }
                const double ms = machine.of(choice.part());
                choice.record(machine.pairs, ms);
                all += ms;
                lost += ms - machine.cpu;
            }
            EXPECT_GT(lost, 0) << "it has tried";
            EXPECT_LT(lost, 0.03 * all) << period << ", " << move;
        }
}

TEST(DeviceChoice, GoesOnWithWhatIsLeft) {
    DeviceChoice absent;
    run_to_move(absent, {10, 2});
    absent.exclude(1, "there is no GPU");
    EXPECT_EQ(run_to_move(absent, {10, 2}), -1);
    EXPECT_EQ(absent.text({"cpu", "a GPU"}), "cpu: there is no GPU");

    DeviceChoice tried; // lost in its trial
    run_to_move(tried, {10, 2});
    run(tried, {10, 2}, 5);
    EXPECT_EQ(tried.part(), 1u);
    tried.exclude(1, "cuda:0 failed");
    EXPECT_EQ(tried.part(), 0u);
    EXPECT_EQ(run(tried, {10, 2}, 10000), 0);
    EXPECT_EQ(tried.text(names), "cpu: cuda:0 failed");

    DeviceChoice chosen;
    run_to_move(chosen, {10, 2});
    run(chosen, {10, 2}, 1000);
    chosen.exclude(1, "cuda:0 failed");
    EXPECT_EQ(run(chosen, {10, 2}, 10000), 0);

    DeviceChoice without_cpu;
    run(without_cpu, {10, 2}, 5);
    without_cpu.exclude(0, "cpu failed");
    EXPECT_EQ(run(without_cpu, {10, 2}, 1000), 1000);
    EXPECT_EQ(without_cpu.text(names), "cuda:0: cpu failed");
}

TEST(DeviceChoice, MeasuresAgainWithOtherSettings) {
    DeviceChoice choice;
    run_to_move(choice, {10, 2});
    run(choice, {10, 2}, 1000);
    choice.forget();
    EXPECT_EQ(choice.part(), 1u) << "what was best stays until more is known";
    EXPECT_EQ(choice.text(names), "cuda:0: not measured yet");
    run(choice, {1, 2}, 1000);
    EXPECT_EQ(choice.part(), 0u);

    run(choice, {10, 20}, 1000);
    DeviceChoice amid; // of a trial
    run_to_move(amid, {10, 2});
    amid.forget();
    EXPECT_EQ(amid.part(), 0u);
    EXPECT_GE(run_to_move(amid, {10, 2}), 0);
}

// Settings that change all the time, too, are tried no more than is paid for.
TEST(DeviceChoice, SpendsLittleOnTrialsWhereSettingsChange) {
    for (const int period : {3, 13, 20, 60, 500}) {
        DeviceChoice choice;
        const Machine machine{1, 30};
        double all = 0, lost = 0;
        for (int i = 0; i < 100000; ++i) {
            if (i % period == 0) choice.forget();
            const double ms = machine.of(choice.part());
            choice.record(machine.pairs, ms);
            all += ms;
            lost += ms - machine.cpu;
        }
        EXPECT_LT(lost, 0.03 * all) << period;
    }
}

} // namespace
} // namespace raycontact
