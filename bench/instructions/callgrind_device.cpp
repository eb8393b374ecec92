// SPDX-License-Identifier: Apache-2.0
#include "bench/instructions/callgrind_device.h"

#include <cstdio>
#include <stdexcept>
#include <utility>
#include <valgrind/callgrind.h>

namespace raycontact::bench {

CallgrindDevice::CallgrindDevice(std::unique_ptr<Device> inner, std::string_view input)
    : ForwardingDevice(std::move(inner)) {
    if (!traits().shares_memory) throw std::logic_error("only a device on this thread can be counted");
    names_ = {
#define RAYCONTACT_KERNEL(name) #name,
#define RAYCONTACT_CPU_KERNEL(name) #name,
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
        "scan", "host"};
    for (std::string& name : names_) name.append(",").append(input);
}

// A dump sets the counters back to zero.
void CallgrindDevice::dump(std::size_t row) const {
    if (counts_) CALLGRIND_DUMP_STATS_AT(names_[row].c_str());
}

void CallgrindDevice::start() {
    counts_ = true;
    CALLGRIND_START_INSTRUMENTATION;
}

void CallgrindDevice::stop() {
    CALLGRIND_STOP_INSTRUMENTATION;
    dump(host_row);
    counts_ = false;
}

void CallgrindDevice::add_items(std::size_t row, const Count& count) {
    if (!counts_) return;
    items_[row] += count.buffer ? static_cast<const kernels::uint*>(count.buffer->host())[count.value] : count.value;
}

void CallgrindDevice::launch(KernelId kernel, Count count, std::span<const Argument> arguments) {
    const auto row = static_cast<std::size_t>(kernel);
    add_items(row, count);
    dump(host_row);
    inner().launch(kernel, count, arguments);
    dump(row);
}

kernels::uint CallgrindDevice::scan(const ScanOf& scan) {
    add_items(scan_row, scan.count);
    dump(host_row);
    const kernels::uint launches = inner().scan(scan);
    dump(scan_row);
    return launches;
}

void CallgrindDevice::print(std::uint64_t host_items) const {
    for (std::size_t row = 0; row < row_count; ++row) {
        const std::uint64_t items = row == host_row ? host_items : items_[row];
        if (items > 0) std::printf("%s,%llu\n", names_[row].c_str(), static_cast<unsigned long long>(items));
    }
}

} // namespace raycontact::bench
