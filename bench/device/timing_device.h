// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/forwarding.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

namespace raycontact::bench {

/// How often a kernel ran, over how many items in all, and how long each launch took.
struct KernelTimes {
    std::uint64_t launches = 0, items = 0;
    std::vector<double> us; ///< by the device's own clock, one entry a launch; a scan of several launches is one
};

/// What a TimingDevice measures while `on`: by KernelId, then prefix sums.
struct Timings {
    static constexpr std::size_t rows = static_cast<std::size_t>(KernelId::count) + 1;
    bool on = false;
    std::array<KernelTimes, rows> kernels;
};

std::string_view name_of_row(std::size_t row);

/// Waits after each launch to see how long it took. Off, it only passes everything on. So one device, opened once,
/// serves both: whole steps, which waiting would disturb, and single kernels.
class TimingDevice : public ForwardingDevice {
public:
    /// The timings outlive the device, which a part takes for itself.
    TimingDevice(std::unique_ptr<Device> inner, std::shared_ptr<Timings> timings)
        : ForwardingDevice(std::move(inner)), timings_(std::move(timings)) {}

private:
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override;
    kernels::uint scan(const ScanOf& scan) override;

    void add(std::size_t row, const Count& count, std::uint64_t launches, double busy_before);

    std::shared_ptr<Timings> timings_;
};

} // namespace raycontact::bench
