// SPDX-License-Identifier: Apache-2.0
// What several devices gain over one of them: a recording replayed by turns on the first device of a list and on all of
// the list. Prints, for each method and schedule, medians over the runs of three ratios, one device over all: `device`,
// the time of kernels (in each step that of the device that takes longest), `part`, the same with the host's share of
// each device's work, and `narrow`, the whole narrow phase by the wall, with the merging of contacts.
#include "bench/commands.h"
#include "bench/options.h"

#include <raycontact/device.h>
#include <recording/replay.h>
#include <scenes/peers/clock.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace raycontact::bench {

namespace {

// Milliseconds of all steps.
struct Times {
    double device = 0, part = 0, narrow = 0;
    double moved = 0, bytes = 0; ///< pairs of a thousand, kilobytes, in a step
    std::string hash;
};

Times replay(const std::string& file, const Settings& settings) {
    recording::Reader reader(file);
    const recording::Replay result = recording::replay(reader, {settings, false, {}, {}});
    Times times;
    double pairs = 0;
    for (const recording::ReplayStep& step : result.steps) {
        double busy = 0, ms = 0;
        for (const DeviceWork& work : step.details.work) {
            busy = std::max(busy, work.busy_ms);
            ms = std::max(ms, work.ms);
        }
        times.device += busy;
        times.part += ms;
        times.narrow += step.narrow_ms;
        pairs += double(step.pairs);
        times.moved += double(step.details.pairs_moved);
        times.bytes += double(step.details.bytes_moved);
    }
    times.moved = 1000 * times.moved / std::max(1.0, pairs);
    times.bytes /= 1000 * double(result.steps.size());
    times.hash = result.hash;
    return times;
}

void compare(const std::string& file, const std::string& devices, Method method, Schedule schedule, int runs) {
    Settings alone, shared;
    alone.features = shared.features = Features::vertices;
    alone.method = shared.method = method;
    shared.execution.schedule = schedule;
    shared.execution.devices = devices;
    alone.execution.devices = devices.substr(0, devices.find(','));
    std::vector<double> device, part, narrow, one_ms, all_ms;
    Times all;
    for (int i = 0; i <= runs; ++i) { // the first is the warm-up
        const Times one = replay(file, alone);
        all = replay(file, shared);
        if (one.hash != all.hash) throw std::runtime_error("the hashes differ; this must not be");
        if (i == 0) continue;
        device.push_back(one.device / all.device);
        part.push_back(one.part / all.part);
        narrow.push_back(one.narrow / all.narrow);
        one_ms.push_back(one.narrow);
        all_ms.push_back(all.narrow);
    }
    std::printf("%-11s %-9s %8.2f %8.2f %8.2f   %.2f..%.2f %10.0f %8.0f %11.2f %9.1f\n",
                std::string(to_string(method)).c_str(), std::string(to_string(schedule)).c_str(), median(device),
                median(part), median(narrow), *std::ranges::min_element(narrow), *std::ranges::max_element(narrow),
                median(one_ms), median(all_ms), all.moved, all.bytes);
    std::fflush(stdout);
}

struct Options {
    std::string recording, devices;
    int runs = 5;
    std::vector<Method> methods = {Method::standard, Method::certified, Method::iterative, Method::predictive};
};

void run(const Options& options) {
    std::printf("%s, %d runs by turns, one device over all\n", options.devices.c_str(), options.runs);
    std::printf("%-11s %-9s %8s %8s %8s   %s %6s %8s %11s %9s\n", "method", "schedule", "device", "part", "narrow",
                "least..most", "one ms", "all ms", "moved/1000", "kB/step");
    for (const Method method : options.methods)
        for (const Schedule schedule : {Schedule::sticky, Schedule::balanced})
            compare(options.recording, options.devices, method, schedule, options.runs);
}

} // namespace

void add_several(CLI::App& app) {
    CLI::App* command = app.add_subcommand("several", "What several devices gain over the first of them");
    auto o = std::make_shared<Options>();
    command->add_option("recording", o->recording, "poses and pairs (run --record)")
        ->required()
        ->type_name("RECORDING");
    command->add_option("devices", o->devices, "a list, as cpu/0,cpu/1")->required()->type_name("DEVICES");
    add_number(*command, "runs", o->runs, "by turns; figures are medians", 1, 1000);
    add_values(*command, "methods", o->methods, method_from, "standard certified iterative predictive; without: all");
    command->callback([o] { run(*o); });
}

} // namespace raycontact::bench
