// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/results.h>

#include <raycontact/device.h>
#include <raycontact/settings.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace raycontact {
class Device;
}

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

/// The medians by the names that the JSON gives them.
inline constexpr std::pair<const char*, double DeviceResult::*> device_figures[] = {
    {"pairs", &DeviceResult::pairs},          {"rays_cast", &DeviceResult::rays_cast},
    {"walks", &DeviceResult::walks},          {"contacts", &DeviceResult::contacts},
    {"step_us", &DeviceResult::step_us},      {"narrow_us", &DeviceResult::narrow_us},
    {"busy_us", &DeviceResult::busy_us},      {"launches", &DeviceResult::launches},
    {"reads", &DeviceResult::reads},          {"bytes_up", &DeviceResult::bytes_up},
    {"bytes_down", &DeviceResult::bytes_down}};

/// What a device's memory, bus and driver allow, measured: medians of nine.
struct Bandwidth {
    double write = 0, read = 0; ///< GB/s between host and device, through Queue::write and read
    double copy = 0;            ///< GB/s within the device, every byte counted twice: read and written
    double launch_us = 0;       ///< an empty launch, as one of a hundred in a row
    double wait_us = 0;         ///< an empty launch and the wait for it
};
Bandwidth measure_bandwidth(Device& device);

struct MeasuredDevice {
    DeviceInfo info;
    Bandwidth bandwidth;
};

struct DeviceResults {
    std::vector<MeasuredDevice> devices;
    std::vector<DeviceResult> results;
};

/// The work must have two steps or more.
DeviceResults measure_devices(const Work& work, const DeviceOptions& options, const Progress& tell);

/// For a person.
std::string table(const Work& work, const DeviceOptions& options, const DeviceResults& results);
Json json(const KernelRow& row);
Json json(const DeviceResult& result);
Json json(const Work& work, const DeviceOptions& options, const DeviceResults& results);
/// For each device, method and caster a row of the step and one of each kernel; for each device a row of each
/// bandwidth.
Json csv_rows(const Work& work, const DeviceOptions& options, const DeviceResults& results);
inline constexpr const char* device_columns =
    "device,device_name,driver,first,copies,bodies,method,caster,steps,what,pairs,rays_cast,walks,contacts,launches,"
    "items,us,share,narrow_us,busy_us,reads,bytes_up,bytes_down,gb_per_s,hash,agrees,fault";

} // namespace raycontact::bench
