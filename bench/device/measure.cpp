// SPDX-License-Identifier: Apache-2.0
#include "bench/device/measure.h"

#include "bench/device/replayer.h"
#include "device/forwarding.h"

#include <scenes/peers/clock.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace raycontact::bench {

namespace {

/// How often a kernel ran, over how many items in all, and how long each launch took.
struct KernelTimes {
    std::uint64_t launches = 0, items = 0;
    std::vector<double> us; ///< by the device's own clock, one entry a launch; a scan of several launches is one
};

/// By KernelId, then prefix sums.
constexpr std::string_view row_names[] = {
#define RAYCONTACT_KERNEL(name) #name,
#define RAYCONTACT_CPU_KERNEL(name) #name,
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
    "scan"};

/// What a TimingDevice measures while `on`.
struct Timings {
    bool on = false;
    std::array<KernelTimes, std::size(row_names)> kernels;
};

/// Waits after each launch to see how long it took. Off, it only passes everything on. So one device, opened once,
/// serves both: whole steps, which waiting would disturb, and single kernels.
class TimingDevice : public ForwardingDevice {
public:
    /// The timings outlive the device, which a part takes for itself.
    TimingDevice(std::unique_ptr<Device> inner, std::shared_ptr<Timings> timings)
        : ForwardingDevice(std::move(inner)), timings_(std::move(timings)) {}

private:
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override {
        const double before = timings_->on ? inner().busy_ms() : 0;
        inner().launch(kernel, count, arguments);
        if (timings_->on) add(timings_->kernels[static_cast<std::size_t>(kernel)], count, 1, before);
    }
    kernels::uint scan(const ScanOf& scan) override {
        const double before = timings_->on ? inner().busy_ms() : 0;
        const kernels::uint launches = inner().scan(scan);
        if (timings_->on) add(timings_->kernels.back(), scan.count, launches, before);
        return launches;
    }

    void add(KernelTimes& times, const Count& count, std::uint64_t launches, double busy_before) {
        inner().finish();
        times.us.push_back(1e3 * (inner().busy_ms() - busy_before));
        times.launches += launches;
        kernels::uint items = count.value;
        if (count.buffer) {
            const Piece piece{&items, count.buffer, count.value * sizeof items, sizeof items};
            inner().read({&piece, 1});
        }
        times.items += items;
    }

    std::shared_ptr<Timings> timings_;
};

struct Way {
    Method method;
    Caster caster;
    std::uint32_t steps;
    std::string cpu_hash;
};

Settings settings_of(const Way& way, const DeviceOptions& options) {
    Settings settings = one_thread(way.method, way.caster);
    settings.execution.threads = options.threads;
    return settings;
}

/// One run over all steps; calls seen() after each. Returns the hash.
template <class Seen>
std::string run(Replayer& replayer, const Settings& settings, std::uint32_t steps, Seen&& seen) {
    replayer.rest(settings);
    ContactHash hash(settings.direction);
    for (std::uint32_t k = 0; k < steps; ++k) {
        replayer.step(k);
        hash.add(k, replayer.contacts());
        seen(k);
    }
    return hash.hex();
}

std::vector<Way> ways_of(const Work& work, const DeviceOptions& options) {
    std::vector<Way> ways;
    const auto all = static_cast<std::uint32_t>(work.steps.size());
    for (const Caster caster : options.casters)
        for (const Method method : options.methods)
            ways.push_back({method, caster, caster == Caster::basic ? std::min(all, options.basic_steps) : all, ""});
    return ways;
}

/// Of a step, in the order of device_figures.
using StepFigures = std::array<double, std::size(device_figures)>;

StepFigures figures_of(const Replayer& replayer) {
    const StepStats& stats = replayer.stats();
    const DeviceWork& work = stats.details.work.front();
    return {double(stats.pairs), double(stats.details.rays_cast), double(stats.details.walks), double(stats.contacts),
            replayer.step_us(),  1e3 * stats.narrow_ms,           1e3 * work.busy_ms,          double(work.launches),
            double(work.reads),  double(work.bytes_up),           double(work.bytes_down)};
}

std::vector<KernelRow> rows_of(const Timings& timings, std::uint32_t steps) {
    std::vector<std::pair<double, KernelRow>> found;
    double all = 0;
    for (std::size_t row = 0; row < timings.kernels.size(); ++row) {
        const KernelTimes& times = timings.kernels[row];
        if (times.us.empty()) continue;
        const double sum = std::accumulate(times.us.begin(), times.us.end(), 0.0);
        all += sum;
        found.push_back({sum,
                         {std::string(row_names[row]), static_cast<double>(times.launches) / steps,
                          static_cast<double>(times.items) / steps, median(times.us), 0}});
    }
    std::ranges::sort(found, [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<KernelRow> rows;
    for (auto& [sum, row] : found) {
        row.share = all > 0 ? sum / all : 0;
        rows.push_back(std::move(row));
    }
    return rows;
}

void measure(Replayer& replayer, Timings& timings, const Way& way, const DeviceOptions& options, DeviceResult& result) {
    const Settings settings = settings_of(way, options);
    const auto take = [&](const std::string& hash) {
        // Every run must find the same: one that differs is what is kept.
        if (result.hash.empty() || hash != way.cpu_hash) result.hash = hash;
    };
    std::vector<StepFigures> figures; // of all runs
    for (std::uint32_t i = 0; i < options.runs; ++i)
        take(run(replayer, settings, way.steps, [&](std::uint32_t k) {
            if (k > 0) figures.push_back(figures_of(replayer));
        }));
    for (std::size_t i = 0; i < std::size(device_figures); ++i) {
        std::vector<double> values;
        values.reserve(figures.size());
        for (const StepFigures& one : figures) values.push_back(one[i]);
        result.*device_figures[i].second = median(values);
    }

    timings.kernels = {};
    take(run(replayer, settings, way.steps, [&](std::uint32_t k) { timings.on = k + 1 < way.steps; }));
    result.kernels = rows_of(timings, way.steps - 1);
}

void measure_all(const Work& work, const DeviceOptions& options, const Progress& tell, DeviceResults& all) {
    std::vector<Way> ways = ways_of(work, options);
    {
        Replayer cpu(work, options.copies, settings_of(ways.front(), options), open_device("cpu", options.threads));
        for (Way& way : ways) {
            tell("cpu: hash of " + std::string(to_string(way.method)) + " " + std::string(to_string(way.caster)));
            way.cpu_hash = run(cpu, settings_of(way, options), way.steps, [](std::uint32_t) {});
        }
    }
    for (const std::string& id : options.devices) {
        tell(id + ": bandwidth");
        OpenDevice opened = open_device(id, options.threads);
        all.devices.push_back({opened.device->info(), measure_bandwidth(*opened.device)});
        const auto timings = std::make_shared<Timings>();
        opened.device = std::make_unique<TimingDevice>(std::move(opened.device), timings);
        Replayer replayer(work, options.copies, settings_of(ways.front(), options), std::move(opened));
        for (const Way& way : ways) {
            tell(id + ": " + std::string(to_string(way.method)) + " " + std::string(to_string(way.caster)));
            DeviceResult& result = all.results.emplace_back();
            result.device = id;
            result.method = way.method;
            result.caster = way.caster;
            result.steps = way.steps;
            result.cpu_hash = way.cpu_hash;
            try {
                measure(replayer, *timings, way, options, result);
            } catch (const DeviceError& error) {
                result.fault = error.what();
                timings->on = false;
            }
        }
    }
}

} // namespace

DeviceResults measure_devices(const Work& work, const DeviceOptions& options, const Progress& tell) {
    DeviceResults all;
    until_stopped([&] { measure_all(work, options, tell, all); });
    return all;
}

} // namespace raycontact::bench
