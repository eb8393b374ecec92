// SPDX-License-Identifier: Apache-2.0
// The kernels' text as OpenCL C, as CUDA C++ where a GPU is, and as each CPU instruction set compiles it, leaves the
// same bytes in every buffer of every step.
#include "device/work.h"

#include "device/cpu/kernel_table.h"
#include "device/opencl/device.h"
#include "device/opencl/program.h"

#include <gtest/gtest.h>

#include <set>

using namespace raycontact;
using namespace raycontact::device_test;

namespace {

const Work& work() {
    static const Work made = make_work(30, true);
    return made;
}

const Outcome& expected() {
    static const Outcome made = run_on_cpu(work(), every_way());
    return made;
}

const Outcome& expected_of_cpu() {
    static const Outcome made = run_on_cpu(work(), cpu_ways());
    return made;
}

TEST(work, reaches_every_kernel_and_the_side_tests) {
    EXPECT_GT(expected().rays, 4000u);
    EXPECT_GT(expected().contacts.size(), 4000u);
    EXPECT_GT(expected().side_tests, 0u);
    std::set<std::string> launched;
    for (const Outcome* outcome : {&expected(), &expected_of_cpu()})
        for (const Written& written : outcome->trace)
            if (!written.bytes->empty()) launched.insert(written.kernel);
    for (const char* kernel : kernel_names()) EXPECT_TRUE(launched.contains(kernel)) << kernel;
    EXPECT_TRUE(launched.contains("scan"));
}

TEST(cpu, instruction_sets_leave_the_same_bytes) {
    for (const cpu::KernelTable* table : cpu::usable_tables()) {
        EXPECT_EQ(first_difference(expected().trace, run_on_cpu(work(), every_way(), table->instruction_set).trace), "")
            << table->instruction_set;
        EXPECT_EQ(
            first_difference(expected_of_cpu().trace, run_on_cpu(work(), cpu_ways(), table->instruction_set).trace), "")
            << table->instruction_set;
    }
}

TEST(devices, every_exact_one_leaves_the_same_bytes) {
    std::size_t exact = 0;
    for (const DeviceInfo& info : list_devices()) {
        if (info.kind == "cpu" || !info.usable) continue;
        ++exact;
        const Outcome outcome = run_work(open_device(info.id, 1), work(), every_way());
        EXPECT_EQ(first_difference(expected().trace, outcome.trace), "") << info.id << ": " << info.name;
        EXPECT_TRUE(same(outcome.contacts, expected().contacts)) << info.id << ": " << info.name;
    }
    EXPECT_GT(exact, 0u) << "no exact device but the CPU here; on Debian: apt-get install pocl-opencl-icd";
}

// A CPU's driver is given a block of vertices an item; a GPU's items are single vertices.
TEST(opencl, a_vertex_an_item_leaves_the_same_bytes) {
    const auto single = [](opencl::Source& source) { source.vertices_at_once = 1; };
    const Outcome outcome =
        run_work({std::make_unique<Executor>(1), opencl::open("opencl:0", false, single)}, work(), every_way());
    EXPECT_EQ(first_difference(expected().trace, outcome.trace), "");
}

// Blocks, rays and contacts, in this order, have no room in the first step; each time all is done again.
TEST(devices, what_has_no_room_is_done_again) {
    const Work heap = make_heap(20);
    const std::vector<Way> standard = {{Method::standard, Caster::bvh, false}};
    const Outcome on_cpu = run_on_cpu(heap, standard),
                  outcome = run_work(open_device(tested_device(), 1), heap, standard);
    EXPECT_EQ(launches_of(on_cpu.trace, "place_pairs"), 4u) << "once a step";
    EXPECT_GE(launches_of(on_cpu.trace, "count_rays"), 4u + 2u) << "blocks, then rays";
    EXPECT_GE(launches_of(on_cpu.trace, "write_contacts"), launches_of(on_cpu.trace, "count_rays") + 1u) << "contacts";
    EXPECT_GE(launches_of(on_cpu.trace, "count_edges"), 4u + 2u) << "blocks of edges, then edges or faces";
    EXPECT_EQ(first_difference(on_cpu.trace, outcome.trace), "");
    EXPECT_TRUE(same(outcome.contacts, on_cpu.contacts));
    EXPECT_GT(outcome.contacts.size(), 10000u);
}

// Small enough for an interpreter that checks every access (oclgrind.sh), on a device that need not be exact.
TEST(small, leaves_the_same_bytes) {
    const Work little = make_work(2, false);
    const Outcome on_cpu = run_on_cpu(little, every_way());
    const Outcome outcome = run_work(open_device(tested_device(), 1, true), little, every_way());
    EXPECT_GT(on_cpu.contacts.size(), 0u);
    EXPECT_EQ(first_difference(on_cpu.trace, outcome.trace), "");
}

} // namespace
