// SPDX-License-Identifier: Apache-2.0
// What the host fills arrives, and what a kernel wrote is read, whether or not the device's memory is the host's.
#include "device/launch.h"
#include "device/staged.h"

#include "device/cpu/device.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <numeric>

namespace raycontact {
namespace {

// Memory that only copies reach; it cannot launch.
class FarDevice : public Device, private Queue {
public:
    const DeviceInfo& info() const override { return info_; }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override { return std::make_unique<Far>(bytes); }
    Queue& queue() override { return *this; }
    int copies = 0;

private:
    struct Far : Buffer {
        explicit Far(std::size_t size) : data(size) {}
        std::size_t bytes() const override { return data.size(); }
        std::vector<char> data;
    };
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override {
        ++copies;
        std::memcpy(static_cast<Far&>(to).data.data() + offset, from, bytes);
    }
    void read(void* to, const Buffer& from, std::size_t offset, std::size_t bytes) override {
        ++copies;
        std::memcpy(to, static_cast<const Far&>(from).data.data() + offset, bytes);
    }
    void copy(Buffer&, const Buffer&, std::size_t) override { FAIL(); }
    void launch(KernelId, kernels::uint, std::span<const Argument>) override { FAIL(); }
    void finish() override {}
    DeviceInfo info_;
};

void fill_and_read(Device& device) {
    Staged<kernels::uint> staged;
    staged.send(device);
    EXPECT_TRUE(staged.fill(device, 0).empty());
    staged.send(device);
    EXPECT_TRUE(staged.read(device).empty());
    for (const std::size_t size : {5U, 3U, 100U, 1U}) {
        const auto values = staged.fill(device, size);
        ASSERT_EQ(values.size(), size);
        std::iota(values.begin(), values.end(), kernels::uint(size));
        staged.send(device);
        std::vector<kernels::uint> there(staged.size());
        staged.array().read(device, there);
        EXPECT_TRUE(std::ranges::equal(there, values));
        std::ranges::reverse(there);
        staged.array().write(device, there); // as a kernel would
        EXPECT_TRUE(std::ranges::equal(staged.read(device), there));
    }
}

TEST(Staged, InPlaceWhereTheMemoryIsTheHosts) {
    Executor executor(1);
    const auto device = cpu::open(executor, "");
    fill_and_read(*device);
    Staged<kernels::uint> staged;
    const auto values = staged.fill(*device, 4);
    EXPECT_EQ(staged.read(*device).data(), values.data());
}

TEST(Staged, ByCopiesElsewhere) {
    FarDevice device;
    fill_and_read(device);
    EXPECT_EQ(device.copies, 4 * 4);
}

} // namespace
} // namespace raycontact
