// SPDX-License-Identifier: Apache-2.0
// Writes, reads, launches and scans: what reaches the driver, and when somebody waits.
#include "device/cuda/fake_machine.h"

#include "device/gpu/launches.h"
#include "device/launch.h"
#include "device/scan.h"

#include <cstring>
#include <numeric>

using namespace raycontact;

namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20;

class Queued : public cuda_test::FakeMachine {
protected:
    Queued() : device_(open()), queue_(device_->queue()) { forget(); }
    void forget() {
        cuda.calls.clear();
        cuda.launches.clear();
    }
    const cuda_test::Launch& launched(std::size_t i) const { return cuda.launches.at(i); }

    std::unique_ptr<Device> device_;
    Queue& queue_;
};

std::vector<kernels::uint> numbers(std::size_t size, kernels::uint first) {
    std::vector<kernels::uint> values(size);
    std::iota(values.begin(), values.end(), first);
    return values;
}

// The test driver copies when somebody waits, so what is not kept meanwhile is lost.
TEST_F(Queued, write_has_read_its_source_when_it_returns) {
    for (const std::size_t size : {std::size_t{1}, std::size_t{1000}, mebibyte / 4, mebibyte}) {
        Array<kernels::uint> array;
        array.resize(*device_, 12 * size);
        for (kernels::uint round = 0; round < 12; ++round) {
            std::vector<kernels::uint> source = numbers(size, round);
            queue_.write(*array.buffer(), round * size * sizeof(kernels::uint), source.data(), size * 4);
            std::fill(source.begin(), source.end(), 0xdeadbeefu);
        }
        std::vector<kernels::uint> found(12 * size);
        array.read(*device_, found);
        for (kernels::uint round = 0; round < 12; ++round)
            for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(found[round * size + i], round + i);
    }
}

TEST_F(Queued, write_waits_only_when_the_ring_is_full) {
    Array<kernels::uint> array;
    array.resize(*device_, mebibyte);
    const auto source = numbers(mebibyte / 4, 0);
    const auto write = [&] { queue_.write(*array.buffer(), 0, source.data(), mebibyte); };
    const auto waits = [&] { return cuda.count("cuEventSynchronize") + cuda.count("cuStreamSynchronize"); };
    for (int i = 0; i < 4; ++i) write();
    EXPECT_EQ(waits(), 0u);
    write();
    write();
    EXPECT_EQ(cuda.count("cuEventSynchronize"), 2u);
    queue_.finish();
    forget();
    for (int i = 0; i < 4; ++i) write();
    EXPECT_EQ(waits(), 0u) << "it is empty after every wait";
    queue_.write(*array.buffer(), 0, numbers(mebibyte / 2, 0).data(), 2 * mebibyte);
    EXPECT_EQ(waits(), 2u) << "a large one takes several parts";
}

TEST_F(Queued, read_of_several_pieces_waits_once) {
    Array<kernels::uint> array, none;
    array.write(*device_, std::vector<kernels::uint>{5, 6, 7, 8});
    kernels::uint last = 0;
    std::vector<kernels::uint> middle(2), nothing;
    const Piece pieces[] = {array.piece({&last, 1}, 3), none.piece(nothing), array.piece(middle, 1)};
    queue_.read(pieces);
    EXPECT_EQ(last, 8u);
    EXPECT_EQ(middle, (std::vector<kernels::uint>{6, 7}));
    EXPECT_EQ(cuda.count("cuMemcpyDtoHAsync_v2"), 2u);
    EXPECT_EQ(cuda.count("cuStreamSynchronize"), 1u);
}

TEST_F(Queued, read_of_more_than_the_staging_holds) {
    Array<kernels::uint> array;
    const auto values = numbers(6 * mebibyte, 3);
    array.write(*device_, values);
    std::vector<kernels::uint> all(values.size()), few(5), many(3 * mebibyte);
    const Piece pieces[] = {array.piece(few, 7), array.piece(all), array.piece(many, 1)};
    forget();
    queue_.read(pieces);
    EXPECT_EQ(all, values);
    EXPECT_EQ(few, numbers(5, 10));
    EXPECT_EQ(many, numbers(many.size(), 4));
    EXPECT_EQ(cuda.count("cuStreamSynchronize"), 3u) << "36 MiB by 16";
}

TEST_F(Queued, a_buffer_may_go_while_it_is_in_use) {
    Array<kernels::uint> kept;
    kept.resize(*device_, 1000);
    for (kernels::uint round = 1; round < 5; ++round) {
        Array<kernels::uint> gone;
        gone.write(*device_, numbers(1000, round));
        queue_.copy(*kept.buffer(), *gone.buffer(), 4000);
    }
    std::vector<kernels::uint> found(1000);
    kept.read(*device_, found);
    EXPECT_EQ(found, numbers(1000, 4));
}

// Buffers of each of its pointers, a number in each of its scalars, and null for an empty array.
template <typename Function>
struct Some;
template <typename... Parameters>
struct Some<void (*)(kernels::Range, kernels::uint, Parameters...)> {
    static std::vector<Argument> arguments(Device& device, std::vector<std::unique_ptr<Buffer>>& buffers) {
        std::vector<Argument> made;
        const auto add = [&](bool pointer) {
            const auto at = static_cast<kernels::uint>(made.size());
            if (pointer && at % 4 != 1) buffers.push_back(device.make_buffer(64));
            made.push_back(pointer ? Argument{at % 4 != 1 ? buffers.back().get() : nullptr}
                                   : Argument{nullptr, at, true});
        };
        (add(std::is_pointer_v<Parameters>), ...);
        return made;
    }
};

template <KernelId id>
void expect_launch(Device& device, cuda_test::FakeCuda& cuda, const char* name) {
    std::vector<std::unique_ptr<Buffer>> buffers;
    const std::vector<Argument> given = Some<typename Prototype<id>::type>::arguments(device, buffers);
    const auto counts = device.make_buffer(64);
    cuda.launches.clear();
    device.queue().launch(id, 1000, given);
    device.queue().launch(id, {counts.get(), 3, 0x7fffffff}, given);
    ASSERT_EQ(cuda.launches.size(), 2u) << name;
    const unsigned items = is_over_vertices(id) ? 16000 : 1000;
    EXPECT_EQ(cuda.launches[0].groups, (items + 127) / 128) << name;
    EXPECT_EQ(cuda.launches[1].groups, 132u * 32u) << name << ": the capacity says nothing";
    for (const auto& launch : cuda.launches) {
        EXPECT_EQ(launch.kernel, name);
        EXPECT_EQ(launch.group_size, 128u);
        ASSERT_EQ(launch.arguments.size(), given.size() + 2) << name;
        for (std::size_t i = 0; i < given.size(); ++i) {
            const std::uint64_t value = launch.arguments[i + 2];
            if (given[i].is_scalar)
                EXPECT_EQ(value, given[i].scalar) << name;
            else
                EXPECT_EQ(value != 0, given[i].buffer != nullptr) << name; // the driver knows that memory
        }
    }
    EXPECT_EQ(cuda.launches[0].arguments[0], 0u);
    EXPECT_EQ(cuda.launches[0].arguments[1], 1000u);
    EXPECT_NE(cuda.launches[1].arguments[0], 0u);
    EXPECT_EQ(cuda.launches[1].arguments[1], 3u);
}

TEST_F(Queued, launches_carry_kernel_grid_and_arguments) {
#define RAYCONTACT_KERNEL(name) expect_launch<KernelId::name>(*device_, cuda, #name);
#define RAYCONTACT_CPU_KERNEL(name) EXPECT_THROW(queue_.launch(KernelId::name, 1, {}), std::logic_error);
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
    const double before = queue_.busy_ms();
    cuda.launches.clear();
    queue_.launch(KernelId::write_contacts, 1, gpu::Nothing<Prototype<KernelId::write_contacts>::type>::arguments);
    queue_.finish();
    EXPECT_EQ(cuda.launches.at(0).groups, 1u);
    EXPECT_GE(queue_.busy_ms(), before + 0.5);
}

TEST_F(Queued, scans_take_one_kernel_or_three) {
    Columns table;
    table.resize(*device_, 2, 300000);
    Array<kernels::Totals> totals;
    totals.resize(*device_, 3);
    const auto scan = [&](std::size_t items) {
        forget();
        return queue_.scan(
            {items, 2, table.stride(), table.values().buffer(), table.firsts().buffer(), totals.buffer(), 1, 77, 5});
    };
    const auto expect = [&](std::size_t i, const char* kernel, unsigned groups, std::size_t parameters) {
        EXPECT_EQ(launched(i).kernel, kernel);
        EXPECT_EQ(launched(i).groups, groups);
        EXPECT_EQ(launched(i).group_size, 1024u);
        EXPECT_EQ(launched(i).arguments.size(), parameters);
    };
    EXPECT_EQ(scan(SCAN_AT_ONCE), 1u);
    ASSERT_EQ(cuda.launches.size(), 1u);
    expect(0, "scan_at_once", 1, 10);
    EXPECT_EQ(launched(0).arguments[2], 2u);
    EXPECT_EQ(launched(0).arguments[3], 300000u);
    EXPECT_EQ(launched(0).arguments[7], 1u);
    EXPECT_EQ(launched(0).arguments[8], 77u);
    EXPECT_EQ(launched(0).arguments[9], 5u);
    EXPECT_EQ(scan(300000), 3u);
    ASSERT_EQ(cuda.launches.size(), 3u);
    const unsigned blocks = 37; // of 8 items for each of 1024 threads
    expect(0, "scan_blocks", blocks, 6);
    expect(1, "scan_sums", 1, 9);
    expect(2, "scan_firsts", blocks, 5);
    EXPECT_EQ(launched(1).arguments[3], blocks);
    EXPECT_EQ(launched(0).arguments[5], launched(1).arguments[4]) << "the sums of blocks";
    EXPECT_EQ(launched(0).arguments[5], launched(2).arguments[3]);
    EXPECT_EQ(launched(0).arguments[4], launched(2).arguments[2]) << "the values";
}

} // namespace
