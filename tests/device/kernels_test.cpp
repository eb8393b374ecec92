// SPDX-License-Identifier: Apache-2.0
// The kernels' text as OpenCL C, and as each CPU instruction set compiles it, leaves the same bytes in every buffer of
// a step.
#include "device/opencl.h"
#include "device/pipeline.h"

#include "device/cpu/device.h"
#include "device/cpu/kernel_table.h"
#include "kernels_opencl.h"
#include "rays/cast_standard.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

using namespace raycontact;
using namespace raycontact::device_test;

namespace {

// The devices whose float32 can give our bits.
std::vector<OpenClInfo> exact_devices() {
    std::vector<OpenClInfo> exact;
    for (const OpenClInfo& device : opencl_devices())
        if (device.lacks().empty()) exact.push_back(device);
    return exact;
}

std::unique_ptr<Device> open_exact(const OpenClInfo& device) {
    return open_opencl(device, opencl_text(), exact_options(device));
}

const Work& work() {
    static const Work made = make_work(60, true);
    return made;
}

const Outcome& expected() {
    static const Outcome made = run_on_cpu(work());
    return made;
}

TEST(opencl, some_device_rounds_as_we_need) {
    std::string report;
    for (const OpenClInfo& device : opencl_devices())
        report += device.name + ": " + (device.lacks().empty() ? "exact" : "lacks " + device.lacks()) + "\n";
    EXPECT_FALSE(exact_devices().empty()) << "No OpenCL device here can give our bits:\n" << report;
}

TEST(work, reaches_every_kernel_and_the_side_tests) {
    EXPECT_GT(expected().rays, 4000u);
    EXPECT_GT(expected().contacts.size(), 500u);
    EXPECT_GT(expected().side_tests, 0u);
    EXPECT_TRUE(same_bits(expected().contacts, expected().watched)) << "the methods differ";
    EXPECT_GT(expected().known_by_caps, 100u);
    for (std::size_t kernel = 0; kernel < static_cast<std::size_t>(KernelId::count); ++kernel) {
        bool launched = false;
        for (const Written& written : expected().trace)
            launched |= written.kernel == static_cast<KernelId>(kernel) && !written.bytes.empty();
        EXPECT_TRUE(launched) << kernel_name(static_cast<KernelId>(kernel));
    }
}

TEST(cpu, instruction_sets_leave_the_same_bytes) {
    for (const cpu::KernelTable* table : cpu::usable_tables()) {
        const Outcome outcome = run_on_cpu(work(), table->instruction_set);
        EXPECT_EQ(first_difference(expected().trace, outcome.trace), "") << table->instruction_set;
    }
}

TEST(opencl, every_device_leaves_the_same_bytes) {
    for (const OpenClInfo& device : exact_devices()) {
        const Outcome outcome = run_pipeline(*open_exact(device), work());
        EXPECT_EQ(first_difference(expected().trace, outcome.trace), "") << device.name;
        EXPECT_TRUE(same_bits(expected().contacts, outcome.contacts)) << device.name;
        EXPECT_TRUE(same_bits(expected().watched, outcome.watched)) << device.name;
    }
}

// The pairs in two halves, each on its own device and thread; joined they are the whole.
void expect_halves_make_the_whole(const OpenClInfo& one, const OpenClInfo& other) {
    const std::size_t half = work().pairs.size() / 2;
    const auto device_a = open_exact(one), device_b = open_exact(other);
    Outcome a, b;
    std::thread thread([&] { a = run_pipeline(*device_a, work(), 0, half); });
    b = run_pipeline(*device_b, work(), half, work().pairs.size());
    thread.join();
    EXPECT_GT(a.contacts.size(), 0u);
    EXPECT_GT(b.contacts.size(), 0u);
    EXPECT_EQ(a.rays + b.rays, expected().rays);
    EXPECT_EQ(a.side_tests + b.side_tests, expected().side_tests);
    std::vector<kernels::LocalContact> joined = a.contacts;
    joined.insert(joined.end(), b.contacts.begin(), b.contacts.end());
    EXPECT_TRUE(same_bits(expected().contacts, joined));
}

TEST(opencl, two_devices_share_the_pairs) {
    const std::vector<OpenClInfo> devices = exact_devices();
    ASSERT_GE(devices.size(), 2u) << "POCL_DEVICES=\"pthread pthread\" makes two";
    expect_halves_make_the_whole(devices[0], devices[1]);
}

TEST(opencl, parts_of_a_device_share_the_pairs) {
    const std::vector<OpenClInfo> devices = exact_devices();
    ASSERT_FALSE(devices.empty());
    const std::vector<OpenClInfo> parts = opencl_parts(devices[0]);
    ASSERT_GE(parts.size(), 2u);
    expect_halves_make_the_whole(parts[0], parts[1]);
}

// What the comparison is worth: the same text with contraction left to the compiler is another text.
TEST(opencl, contraction_is_noticed) {
    const std::vector<OpenClInfo> devices = exact_devices();
    ASSERT_FALSE(devices.empty());
    const std::string pragma = "#pragma OPENCL FP_CONTRACT OFF";
    std::string text = opencl_text();
    const std::size_t at = text.find(pragma);
    ASSERT_NE(at, std::string::npos);
    text.replace(at, pragma.size(), "");
    const auto device = open_opencl(devices[0], text, exact_options(devices[0]) + " -cl-mad-enable");
    EXPECT_NE(first_difference(expected().trace, run_pipeline(*device, work()).trace), "");
}

// Small enough for an interpreter that checks every access (oclgrind.sh).
TEST(small, leaves_the_same_bytes) {
    const std::vector<OpenClInfo> exact = exact_devices(), all = opencl_devices();
    ASSERT_FALSE(all.empty());
    const Work little = make_work(2, false);
    const Outcome outcome = run_pipeline(*open_exact(exact.empty() ? all[0] : exact[0]), little);
    const Outcome on_cpu = run_on_cpu(little);
    EXPECT_GT(on_cpu.contacts.size(), 0u);
    EXPECT_EQ(first_difference(on_cpu.trace, outcome.trace), "");
}

// Many rays at once, and what one costs; the CPU device on one thread, OpenCL on all its compute units.
TEST(opencl, many_rays_leave_the_same_hits) {
    const std::vector<OpenClInfo> devices = exact_devices();
    ASSERT_FALSE(devices.empty());
    const Work many = make_work(1200, true);
    const auto timed = [&](Device& device, const char* name) {
        ShapeStore store(device);
        for (const auto& shape : many.shapes) store.add(shape);
        Array<kernels::OrderedPair> pairs;
        pairs.write(device, std::span(many.pairs));
        RayQueue queue;
        queue.fill(device, store.arrays(), pairs, true);
        Array<kernels::Hit> hits;
        cast_standard(device, Caster::bvh, store.arrays(), pairs, queue.rays(), hits); // a first launch compiles
        device.queue().finish();
        const auto start = std::chrono::steady_clock::now();
        cast_standard(device, Caster::bvh, store.arrays(), pairs, queue.rays(), hits);
        device.queue().finish();
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        std::vector<kernels::Hit> host(hits.size());
        hits.read(device, host);
        std::printf("%.0f ns/ray, %zu rays: %s\n", time.count() / static_cast<double>(host.size()), host.size(), name);
        return host;
    };
    Executor executor(1);
    const auto cpu = cpu::open(executor, "");
    const std::vector<kernels::Hit> ours = timed(*cpu, cpu->info().driver.c_str());
    const std::vector<kernels::Hit> theirs = timed(*open_exact(devices[0]), devices[0].name.c_str());
    ASSERT_EQ(ours.size(), theirs.size());
    EXPECT_EQ(std::memcmp(ours.data(), theirs.data(), ours.size() * sizeof(kernels::Hit)), 0);
}

} // namespace

int main(int argc, char** argv) {
    // Read when the first platform is asked for: two devices of PoCL, with two compute units even on one core.
    setenv("POCL_DEVICES", "pthread pthread", 0);
    setenv("POCL_MAX_PTHREAD_COUNT", "2", 0);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
