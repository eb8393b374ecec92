// SPDX-License-Identifier: Apache-2.0
#include "device/cpu/device.h"
#include "device/cpu/kernel_table.h"
#include "platform/system.h"

#include <raycontact/error.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <new>
#include <numeric>
#include <string>

namespace raycontact::cpu {

namespace {

constexpr std::align_val_t line{64};

class HostBuffer : public Buffer {
public:
    explicit HostBuffer(std::size_t bytes) : data_(::operator new(bytes, line)), bytes_(bytes) {}
    ~HostBuffer() override { ::operator delete(data_, line); }
    HostBuffer(const HostBuffer&) = delete;
    HostBuffer& operator=(const HostBuffer&) = delete;
    std::size_t bytes() const override { return bytes_; }
    void* host() const override { return data_; }
    std::byte* data() const { return static_cast<std::byte*>(data_); }

private:
    void* data_;
    std::size_t bytes_;
};

std::byte* bytes_of(const Buffer& buffer) {
    return static_cast<const HostBuffer&>(buffer).data();
}
kernels::uint* words_of(const Buffer* buffer) {
    return buffer ? reinterpret_cast<kernels::uint*>(bytes_of(*buffer)) : nullptr;
}
kernels::uint number_of(const Count& count) {
    return count.buffer ? words_of(count.buffer)[count.value] : count.value;
}

// With one thread: a step has too few items for two. Beyond 2^32 the firsts are wrong, but then there is no room.
void scan_here(const ScanOf& scan) {
    const kernels::uint count = number_of(scan.count);
    const kernels::uint* values = words_of(scan.values);
    std::exclusive_scan(values, values + count, words_of(scan.firsts), scan.before);
    std::array<std::uint64_t, MOST_COLUMNS> sums{};
    for (std::size_t c = 0; c < scan.columns; ++c, values += scan.stride)
        sums[c] = std::accumulate(values, values + count, std::uint64_t{0});
    kernels::Totals& totals = reinterpret_cast<kernels::Totals*>(words_of(scan.totals))[scan.at];
    const std::uint64_t results = scan.before + sums[0];
    const bool fits = results <= scan.room;
    totals.items = fits && sums[0] > 0 ? count : 0;
    totals.results = fits ? static_cast<kernels::uint>(results) : 0;
    for (std::size_t c = 0; c < MOST_COLUMNS; ++c)
        totals.sums[c] = static_cast<kernels::uint>(std::min<std::uint64_t>(sums[c], NONE));
}

using Clock = std::chrono::steady_clock;

// Adds its own lifetime to a sum.
class Busy {
public:
    explicit Busy(Clock::duration& sum) : sum_(sum) {}
    ~Busy() { sum_ += Clock::now() - start_; }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;

private:
    Clock::duration& sum_;
    Clock::time_point start_ = Clock::now();
};

// The least number of items in a thread's slice: a ray costs a hundred times as much as an element of a scan.
kernels::uint grain_of(KernelId kernel) {
    switch (kernel) {
    case KernelId::cast_rays_basic:
    case KernelId::follow_rays_basic:
        return 4;
    case KernelId::cast_rays_bvh:
    case KernelId::cast_edges:
    case KernelId::hold_rays:
    case KernelId::follow_rays_bvh:
        return 128;
    case KernelId::test_candidates:
    case KernelId::count_digits:
    case KernelId::move_keys:
        return 16;
    case KernelId::count_clusters:
    case KernelId::write_clusters:
    case KernelId::begin_candidates:
    case KernelId::count_rays:
    case KernelId::count_edges:
    case KernelId::count_near_rays:
    case KernelId::fill_nodes:
    case KernelId::count_partners:
    case KernelId::write_partners:
        return 64;
    case KernelId::make_boxes:
    case KernelId::make_keys:
    case KernelId::count_changed_pairs:
    case KernelId::write_changed_pairs:
    case KernelId::place_pairs:
    case KernelId::write_contacts:
    case KernelId::find_margins:
    case KernelId::count_inside:
    case KernelId::write_edges:
    case KernelId::write_candidate_rays:
    case KernelId::write_near_rays:
    case KernelId::copy_cached_rays:
    case KernelId::count_cached_rays:
    case KernelId::write_cached_rays:
        return 256;
    default:
        return 4096;
    }
}

class HostDevice : public Device, private Queue {
public:
    HostDevice(Executor& executor, const KernelTable& table, std::string_view id)
        : info_(describe()), executor_(executor), table_(table) {
        info_.id = id;
        info_.cores = executor.threads();
        info_.driver = "native, " + std::string(table.instruction_set);
    }

    const DeviceInfo& info() const override { return info_; }
    const DeviceTraits& traits() const override { return traits_; }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override { return std::make_unique<HostBuffer>(bytes); }
    Queue& queue() override { return *this; }

private:
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override {
        std::memcpy(bytes_of(to) + offset, from, bytes);
    }
    void read(std::span<const Piece> pieces) override {
        for (const Piece& piece : pieces)
            if (piece.bytes > 0) std::memcpy(piece.to, bytes_of(*piece.from) + piece.offset, piece.bytes);
    }
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override {
        std::memcpy(bytes_of(to), bytes_of(from), bytes);
    }
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override {
        const Busy busy(busy_);
        const Entry entry = table_.entries[static_cast<std::size_t>(kernel)];
        const kernels::uint all = number_of(count);
        executor_.run(all, grain_of(kernel), [&](kernels::uint begin, kernels::uint end) {
            entry({begin, end}, all, arguments.data());
        });
    }
    kernels::uint scan(const ScanOf& scan) override {
        const Busy busy(busy_);
        scan_here(scan);
        return scan.count.most > SCAN_AT_ONCE ? 3 : 1;
    }
    void finish() override {}
    double busy_ms() const override { return std::chrono::duration<double, std::milli>(busy_).count(); }

    DeviceInfo info_;
    DeviceTraits traits_{.has_double = true, .shares_memory = true};
    Executor& executor_;
    const KernelTable& table_;
    Clock::duration busy_{};
};

} // namespace

void* address_of(const Argument& argument) {
    return argument.buffer ? bytes_of(*argument.buffer) : nullptr;
}

DeviceInfo describe() {
    static const std::string name = platform::processor_name(); // Linux writes a text of every core for each question
    DeviceInfo info;
    info.id = "cpu";
    info.kind = "cpu";
    info.type = "cpu";
    info.name = name;
    info.driver = "native, " + std::string(usable_tables().front()->instruction_set);
    info.cores = usable_cores();
    info.memory_bytes = platform::physical_memory();
    info.exact = true;
    info.usable = true;
    return info;
}

std::unique_ptr<Device> open(Executor& executor, std::string_view instruction_set, std::string_view id) {
    std::string known;
    for (const KernelTable* table : usable_tables()) {
        if (instruction_set.empty() || table->instruction_set == instruction_set)
            return std::make_unique<HostDevice>(executor, *table, id);
        known += (known.empty() ? "" : ", ") + std::string(table->instruction_set);
    }
    throw InputError("instruction set '" + std::string(instruction_set)
                     + "' is unknown or not this processor's; use one of: " + known);
}

} // namespace raycontact::cpu
