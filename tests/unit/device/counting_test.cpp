// SPDX-License-Identifier: Apache-2.0
#include "device/counting.h"

#include "device/launch.h"
#include "device/scan.h"

#include <gtest/gtest.h>

namespace raycontact {
namespace {

TEST(CountingDevice, CountsWhatItPassesOn) {
    OpenDevice opened = open_device("cpu", 1);
    CountingDevice device(std::move(opened.device));
    Array<kernels::uint> values;
    values.write(device, std::vector<kernels::uint>(10, 1));
    Columns table;
    table.resize(device, 1, 100000);
    Array<kernels::Totals> totals;
    totals.resize(device, 1);
    table.scan(device, 10, totals, 0, 10);     // one kernel
    table.scan(device, 100000, totals, 0, 10); // three
    Array<kernels::Ray> rays;
    Array<kernels::uint> ranges;
    rays.resize(device, 4);
    ranges.resize(device, 4);
    launch<KernelId::find_ranges>(device, 0, rays, ranges); // nothing to do
    std::vector<kernels::uint> host(10);
    values.read(device, host);
    device.queue().finish();

    const DeviceWork work = device.take_work();
    EXPECT_EQ(work.launches, 4u);
    EXPECT_EQ(work.reads, 2u) << "a read, and a wait for shared memory";
    EXPECT_EQ(work.bytes_up, 40u);
    EXPECT_EQ(work.bytes_down, 40u);
    EXPECT_GT(work.busy_ms, 0.0);
    EXPECT_EQ(device.take_work().launches, 0u) << "since the last call";
}

// The source may change as soon as write() has returned.
TEST(Queue, WriteHasReadItsSourceWhenItReturns) {
    const OpenDevice opened = open_device("cpu", 1);
    std::vector<kernels::uint> source(1000, 7), there(1000);
    Array<kernels::uint> array;
    array.write(*opened.device, source);
    source.assign(1000, 8);
    array.read(*opened.device, there);
    EXPECT_EQ(there, std::vector<kernels::uint>(1000, 7));
}

} // namespace
} // namespace raycontact
