// SPDX-License-Identifier: Apache-2.0
#include "bench/device/timing_device.h"

namespace raycontact::bench {

std::string_view name_of_row(std::size_t row) {
    static constexpr std::array<std::string_view, Timings::rows> names = {
#define RAYCONTACT_KERNEL(name) #name,
#define RAYCONTACT_CPU_KERNEL(name) #name,
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
        "scan"};
    return names[row];
}

void TimingDevice::add(std::size_t row, const Count& count, std::uint64_t launches, double busy_before) {
    inner().finish();
    KernelTimes& times = timings_->kernels[row];
    times.us.push_back(1e3 * (inner().busy_ms() - busy_before));
    times.launches += launches;
    kernels::uint items = count.value;
    if (count.buffer) {
        const Piece piece{&items, count.buffer, count.value * sizeof items, sizeof items};
        inner().read({&piece, 1});
    }
    times.items += items;
}

void TimingDevice::launch(KernelId kernel, Count count, std::span<const Argument> arguments) {
    const double before = timings_->on ? inner().busy_ms() : 0;
    inner().launch(kernel, count, arguments);
    if (timings_->on) add(static_cast<std::size_t>(kernel), count, 1, before);
}

kernels::uint TimingDevice::scan(const ScanOf& scan) {
    const double before = timings_->on ? inner().busy_ms() : 0;
    const kernels::uint launches = inner().scan(scan);
    if (timings_->on) add(Timings::rows - 1, scan.count, launches, before);
    return launches;
}

} // namespace raycontact::bench
