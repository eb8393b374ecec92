// SPDX-License-Identifier: Apache-2.0
#include "device/trace.h"

#include <algorithm>

namespace raycontact::device_test {

const char* kernel_name(KernelId kernel) {
    switch (kernel) {
#define RAYCONTACT_KERNEL(name)                                                                                        \
    case KernelId::name:                                                                                               \
        return #name;
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
    case KernelId::count:
        break;
    }
    return "no kernel";
}

std::string first_difference(const std::vector<Written>& expected, const std::vector<Written>& actual) {
    for (std::size_t i = 0; i < std::min(expected.size(), actual.size()); ++i) {
        const Written &e = expected[i], &a = actual[i];
        const std::string where = "buffer " + std::to_string(i) + " of the trace, argument "
                                  + std::to_string(e.argument) + " of " + kernel_name(e.kernel);
        if (e.kernel != a.kernel || e.argument != a.argument) return where + ": another launch";
        if (e.bytes.size() != a.bytes.size()) return where + ": another size";
        const auto differ = std::mismatch(e.bytes.begin(), e.bytes.end(), a.bytes.begin());
        if (differ.first != e.bytes.end())
            return where + ": byte " + std::to_string(differ.first - e.bytes.begin()) + " of "
                   + std::to_string(e.bytes.size());
    }
    if (expected.size() != actual.size())
        return "a trace of " + std::to_string(actual.size()) + " buffers, not " + std::to_string(expected.size());
    return "";
}

std::unique_ptr<Buffer> TracingDevice::make_buffer(std::size_t bytes) {
    auto buffer = inner_.make_buffer(bytes);
    const std::vector<std::byte> zeros(buffer->bytes());
    inner_.queue().write(*buffer, 0, zeros.data(), zeros.size());
    return buffer;
}

void TracingDevice::write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) {
    inner_.queue().write(to, offset, from, bytes);
}

void TracingDevice::read(void* to, const Buffer& from, std::size_t offset, std::size_t bytes) {
    inner_.queue().read(to, from, offset, bytes);
}

void TracingDevice::copy(Buffer& to, const Buffer& from, std::size_t bytes) {
    inner_.queue().copy(to, from, bytes);
}

void TracingDevice::launch(KernelId kernel, kernels::uint count, std::span<const Argument> arguments) {
    inner_.queue().launch(kernel, count, arguments);
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        if (!arguments[i].buffer) continue;
        Written& written = trace_.emplace_back();
        written.kernel = kernel;
        written.argument = i;
        written.bytes.resize(arguments[i].buffer->bytes());
        inner_.queue().read(written.bytes.data(), *arguments[i].buffer, 0, written.bytes.size());
    }
}

} // namespace raycontact::device_test
