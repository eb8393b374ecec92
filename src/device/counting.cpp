// SPDX-License-Identifier: Apache-2.0
#include "device/counting.h"

#include <utility>

namespace raycontact {

DeviceWork CountingDevice::take_work() {
    const double busy = busy_ms();
    work_.busy_ms = busy - std::exchange(busy_before_, busy);
    return std::exchange(work_, {});
}

void CountingDevice::write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) {
    work_.bytes_up += bytes;
    inner().write(to, offset, from, bytes);
}

void CountingDevice::read(std::span<const Piece> pieces) {
    ++work_.reads;
    for (const Piece& piece : pieces) work_.bytes_down += piece.bytes;
    inner().read(pieces);
}

void CountingDevice::launch(KernelId kernel, Count count, std::span<const Argument> arguments) {
    ++work_.launches;
    inner().launch(kernel, count, arguments);
}

kernels::uint CountingDevice::scan(const ScanOf& scan) {
    const kernels::uint launches = inner().scan(scan);
    work_.launches += launches;
    return launches;
}

// Counts as a read: the host waits before it touches shared memory.
void CountingDevice::finish() {
    ++work_.reads;
    inner().finish();
}

} // namespace raycontact
