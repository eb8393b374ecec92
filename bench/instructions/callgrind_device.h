// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/forwarding.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace raycontact::bench {

/// Over a device that works on this thread, in memory that the host shares. While it counts, under callgrind, what each
/// kernel took is dumped as `KERNEL,INPUT`, that of prefix sums as `scan,INPUT`, and what ran in between as
/// `host,INPUT`: a dump for each time, to be added up.
class CallgrindDevice : public ForwardingDevice {
public:
    CallgrindDevice(std::unique_ptr<Device> inner, std::string_view input);

    /// From start() to stop() it counts.
    void start();
    void stop();
    /// Prints `KERNEL,INPUT,ITEMS` of each kernel that ran since it was made, `host` by so many items.
    void print(std::uint64_t host_items) const;

private:
    static constexpr std::size_t scan_row = static_cast<std::size_t>(KernelId::count), host_row = scan_row + 1,
                                 row_count = host_row + 1;

    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override;
    kernels::uint scan(const ScanOf& scan) override;

    void dump(std::size_t row) const;
    void add_items(std::size_t row, const Count& count);

    std::array<std::string, row_count> names_; ///< made beforehand, so that no dump counts it
    std::array<std::uint64_t, row_count> items_{};
    bool counts_ = false;
};

} // namespace raycontact::bench
