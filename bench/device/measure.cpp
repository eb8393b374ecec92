// SPDX-License-Identifier: Apache-2.0
#include "bench/device/measure.h"

#include "bench/device/replayer.h"
#include "bench/device/timing_device.h"

#include <bench/peers/stopped.h>
#include <scenes/peers/clock.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace raycontact::bench {

namespace {

struct Way {
    Method method;
    Caster caster;
    std::uint32_t steps;
    std::string cpu_hash;
};

Settings settings_of(const Way& way, const DeviceOptions& options) {
    Settings settings;
    settings.features = Features::vertices;
    settings.method = way.method;
    settings.paper.caster = way.caster;
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

/// Medians of what a step is, over steps and runs.
class Medians {
public:
    void add(const Replayer& replayer) {
        const StepStats& stats = replayer.stats();
        const DeviceWork& work = stats.details.work.front();
        const double values[] = {static_cast<double>(stats.pairs),
                                 static_cast<double>(stats.details.rays_cast),
                                 static_cast<double>(stats.details.walks),
                                 static_cast<double>(stats.contacts),
                                 replayer.step_us(),
                                 1e3 * stats.narrow_ms,
                                 1e3 * work.busy_ms,
                                 static_cast<double>(work.launches),
                                 static_cast<double>(work.reads),
                                 static_cast<double>(work.bytes_up),
                                 static_cast<double>(work.bytes_down)};
        for (std::size_t i = 0; i < count; ++i) all_[i].push_back(values[i]);
    }
    void put(DeviceResult& r) const {
        double* const places[] = {&r.pairs,   &r.rays_cast, &r.walks, &r.contacts, &r.step_us,   &r.narrow_us,
                                  &r.busy_us, &r.launches,  &r.reads, &r.bytes_up, &r.bytes_down};
        for (std::size_t i = 0; i < count; ++i) *places[i] = median(all_[i]);
    }

private:
    static constexpr std::size_t count = 11;
    std::vector<double> all_[count];
};

std::vector<KernelRow> rows_of(const Timings& timings, std::uint32_t steps) {
    std::vector<std::pair<double, KernelRow>> found;
    double all = 0;
    for (std::size_t row = 0; row < Timings::rows; ++row) {
        const KernelTimes& times = timings.kernels[row];
        if (times.us.empty()) continue;
        const double sum = std::accumulate(times.us.begin(), times.us.end(), 0.0);
        all += sum;
        found.push_back({sum,
                         {std::string(name_of_row(row)), static_cast<double>(times.launches) / steps,
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
    Medians medians;
    for (std::uint32_t i = 0; i < options.runs; ++i)
        take(run(replayer, settings, way.steps, [&](std::uint32_t k) {
            if (k > 0) medians.add(replayer);
        }));
    medians.put(result);

    timings.kernels = {};
    take(run(replayer, settings, way.steps, [&](std::uint32_t k) { timings.on = k + 1 < way.steps; }));
    result.kernels = rows_of(timings, way.steps - 1);
}

void measure_all(const Work& work, const DeviceOptions& options, const std::function<void(const std::string&)>& tell,
                 DeviceResults& all) {
    std::vector<Way> ways = ways_of(work, options);
    {
        Settings settings;
        settings.execution.threads = options.threads;
        Replayer cpu(work, options.copies, settings, open_device("cpu", options.threads));
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
        Settings settings;
        settings.execution.threads = options.threads;
        Replayer replayer(work, options.copies, settings, std::move(opened));
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

DeviceResults measure_devices(const Work& work, const DeviceOptions& options,
                              const std::function<void(const std::string&)>& tell) {
    DeviceResults all;
    try {
        measure_all(work, options, tell, all);
    } catch (const Stopped&) {
        // What was measured before counts.
    }
    return all;
}

} // namespace raycontact::bench
