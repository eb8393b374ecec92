// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/device/bandwidth.h"

#include <bench/peers/work.h>

#include <raycontact/device.h>
#include <raycontact/settings.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace raycontact::bench {

struct DeviceOptions {
    std::vector<std::string> devices; ///< each measured alone
    std::vector<Method> methods = {Method::standard, Method::certified, Method::iterative, Method::predictive};
    std::vector<Caster> casters = {Caster::bvh, Caster::basic};
    std::uint32_t first = 200, steps = 60; ///< of the work
    std::uint32_t basic_steps = 4;         ///< of these, how many the slow caster gets
    std::uint32_t copies = 1;
    std::uint32_t runs = 5;
    std::uint32_t threads = 0; ///< of the host
};

struct KernelRow {
    std::string name;
    double launches = 0, items = 0; ///< a step
    double us = 0;                  ///< median of the launches, the device's own clock
    double share = 0;               ///< of the time of all kernels
};

/// A method and caster on a device. Figures are medians over the steps of all runs, but for the first of each, in which
/// every pair is new.
struct DeviceResult {
    std::string device;
    Method method = Method::standard;
    Caster caster = Caster::bvh;
    std::uint32_t steps = 0;
    double pairs = 0, rays_cast = 0, walks = 0, contacts = 0;
    double step_us = 0, narrow_us = 0; ///< wall clock; step: poses set, contacts found
    double busy_us = 0;                ///< of the device: its kernels
    double launches = 0, reads = 0, bytes_up = 0, bytes_down = 0;
    std::vector<KernelRow> kernels; ///< the longest first
    std::string hash;               ///< of a run
    std::string cpu_hash;           ///< what the CPU finds
    std::string fault;              ///< why the device did not come to the end; empty: it did

    bool agrees() const { return fault.empty() && hash == cpu_hash; }
};

struct MeasuredDevice {
    DeviceInfo info;
    Bandwidth bandwidth;
};

struct DeviceResults {
    std::vector<MeasuredDevice> devices;
    std::vector<DeviceResult> results;
};

/// The work must have two steps or more. tell: what is being done.
DeviceResults measure_devices(const Work& work, const DeviceOptions& options,
                              const std::function<void(const std::string&)>& tell);

} // namespace raycontact::bench
