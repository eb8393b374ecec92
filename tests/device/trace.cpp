// SPDX-License-Identifier: Apache-2.0
#include "device/trace.h"

#include <algorithm>

namespace raycontact::device_test {

std::span<const char* const> kernel_names() {
    static constexpr const char* names[] = {
#define RAYCONTACT_KERNEL(name) #name,
#define RAYCONTACT_CPU_KERNEL(name) RAYCONTACT_KERNEL(name)
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
    };
    return names;
}

std::string first_difference(const Trace& expected, const Trace& actual) {
    for (std::size_t i = 0; i < std::min(expected.size(), actual.size()); ++i) {
        const Written &e = expected[i], &a = actual[i];
        const std::string where =
            "buffer " + std::to_string(i) + " of the trace, argument " + std::to_string(e.argument) + " of " + e.kernel;
        if (e.kernel != a.kernel || e.argument != a.argument) return where + ": another launch";
        if (e.bytes->size() != a.bytes->size()) return where + ": another size";
        const auto differ = std::mismatch(e.bytes->begin(), e.bytes->end(), a.bytes->begin());
        if (differ.first != e.bytes->end())
            return where + ": byte " + std::to_string(differ.first - e.bytes->begin()) + " of "
                   + std::to_string(e.bytes->size());
    }
    if (expected.size() != actual.size())
        return "a trace of " + std::to_string(actual.size()) + " buffers, not " + std::to_string(expected.size());
    return "";
}

std::size_t launches_of(const Trace& trace, std::string_view kernel) {
    std::size_t launches = 0;
    bool in_launch = false;
    for (std::size_t i = 0; i < trace.size(); ++i) {
        const bool same = trace[i].kernel == kernel;
        const bool begins = same && (!in_launch || trace[i].argument <= trace[i - 1].argument);
        launches += begins;
        in_launch = same;
    }
    return launches;
}

std::unique_ptr<Buffer> TracingDevice::make_buffer(std::size_t bytes) {
    auto buffer = ForwardingDevice::make_buffer(bytes);
    const std::vector<std::byte> zeros(buffer->bytes());
    inner().write(*buffer, 0, zeros.data(), zeros.size());
    last_.erase(buffer.get()); // another may have lain there
    return buffer;
}

void TracingDevice::keep(std::string_view kernel, std::size_t argument, const Buffer* buffer) {
    if (!buffer) return;
    std::vector<std::byte> now(buffer->bytes());
    const Piece piece{now.data(), buffer, 0, now.size()};
    inner().read({&piece, 1});
    auto& last = last_[buffer];
    if (!last || *last != now) last = std::make_shared<const std::vector<std::byte>>(std::move(now));
    trace_->push_back({std::string(kernel), argument, last});
}

void TracingDevice::launch(KernelId kernel, Count count, std::span<const Argument> arguments) {
    inner().launch(kernel, count, arguments);
    for (std::size_t i = 0; i < arguments.size(); ++i)
        keep(kernel_names()[static_cast<std::size_t>(kernel)], i, arguments[i].buffer);
}

kernels::uint TracingDevice::scan(const ScanOf& scan) {
    const kernels::uint launches = inner().scan(scan);
    keep("scan", 0, scan.values);
    keep("scan", 1, scan.firsts);
    keep("scan", 2, scan.totals);
    return launches;
}

} // namespace raycontact::device_test
