// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace raycontact::bench {

/// Passes everything on to a device that works on this thread, in memory that the host shares. While it counts, under
/// callgrind, what each kernel took is dumped as `KERNEL,INPUT`, that of prefix sums as `scan,INPUT`, and what ran in
/// between as `host,INPUT`: a dump for each time, to be added up.
class CallgrindDevice : public Device, private Queue {
public:
    CallgrindDevice(std::unique_ptr<Device> inner, std::string_view input);

    /// From start() to stop() it counts.
    void start();
    void stop();
    /// Prints `KERNEL,INPUT,ITEMS` of each kernel that ran since it was made, `host` by so many items.
    void print(std::uint64_t host_items) const;

    const DeviceInfo& info() const override { return inner_->info(); }
    const DeviceTraits& traits() const override { return inner_->traits(); }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override { return inner_->make_buffer(bytes); }
    Queue& queue() override { return *this; }

private:
    static constexpr std::size_t scan_row = static_cast<std::size_t>(KernelId::count), host_row = scan_row + 1,
                                 row_count = host_row + 1;

    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override {
        inner_->queue().write(to, offset, from, bytes);
    }
    void read(std::span<const Piece> pieces) override { inner_->queue().read(pieces); }
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override { inner_->queue().copy(to, from, bytes); }
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override;
    kernels::uint scan(const ScanOf& scan) override;
    void finish() override { inner_->queue().finish(); }
    double busy_ms() const override { return inner_->queue().busy_ms(); }

    void dump(std::size_t row) const;
    void add_items(std::size_t row, const Count& count);

    std::unique_ptr<Device> inner_;
    std::array<std::string, row_count> names_; ///< made beforehand, so that no dump counts it
    std::array<std::uint64_t, row_count> items_{};
    bool counts_ = false;
};

} // namespace raycontact::bench
