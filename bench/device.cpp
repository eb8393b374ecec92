// SPDX-License-Identifier: Apache-2.0
// Steps and kernels of each device.
#include "bench/commands.h"
#include "bench/options.h"

#include <bench/device/measure.h>
#include <bench/peers/work.h>
#include <raycontact/error.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace raycontact::bench {

namespace {

struct DeviceCommand {
    std::string recording, range = "200:260", devices = "all", out;
    std::uint32_t bodies = 512;
    DeviceOptions options;
    bool json = false;
};

/// A:B, from step A up to but not with step B.
std::pair<std::uint32_t, std::uint32_t> range_of(const std::string& text) {
    const std::size_t colon = std::min(text.find(':'), text.size());
    const auto first = read_number<std::uint32_t>(text.substr(0, colon));
    const auto last = read_number<std::uint32_t>(text.substr(std::min(colon + 1, text.size())));
    if (!first || !last || *last < *first + 2)
        throw InputError("--steps: \"" + text + "\" is no range; give A:B, steps A to B - 1, two or more");
    return {*first, *last};
}

Work make_work(const DeviceCommand& command) {
    const auto [first, last] = range_of(command.range);
    const AvalancheWorkOptions options{.bodies = command.bodies, .first = first, .steps = last - first};
    Work work = command.recording.empty() ? avalanche_work(options) : recorded_work(command.recording, options);
    if (work.steps.size() < options.steps)
        throw InputError(command.recording + ": ends after step " + std::to_string(first + work.steps.size())
                         + "; give a shorter range with --steps");
    return work;
}

void bench_device(DeviceCommand command) {
    DeviceOptions& options = command.options;
    Settings settings;
    settings.method = Method::standard;
    settings.execution.devices = command.devices;
    options.devices = chosen_devices(settings);
    options.first = range_of(command.range).first;

    Output out(command.out, {"device"}, {".csv"});
    tell("poses and pairs");
    const Work work = make_work(command);
    const DeviceResults results = measure_devices(work, options, tell);
    if (!out.finish(!results.results.empty())) return;
    out.print(command.json, table(work, options, results), json(work, options, results));
    out.write("device", ".csv", csv(out.machine, device_columns, csv_rows(work, options, results)));
    out.keep();
    if (!std::ranges::all_of(results.results, &DeviceResult::agrees))
        throw std::runtime_error("a device failed or gave other bits than the CPU; this must not be");
}

} // namespace

void add_device(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("device", "Whole steps and single kernels on each device, beside the CPU's contacts");
    auto c = std::make_shared<DeviceCommand>();
    command
        ->add_option("--recording", c->recording,
                     "poses and pairs (run --record); without: an avalanche, simulated beforehand")
        ->type_name("FILE");
    command->add_option("--steps", c->range, "its steps A to B - 1")->type_name("A:B")->capture_default_str();
    add_number(*command, "--bodies", c->bodies, "of the avalanche", 1u, 1'000'000u);
    command->add_option("--devices", c->devices, "each measured alone: all (every GPU, or the CPU), or a list")
        ->type_name("LIST")
        ->capture_default_str();
    add_values(*command, "--methods", c->options.methods, method_from,
               "standard,certified,iterative,predictive; without: all");
    add_values(*command, "--casters", c->options.casters, caster_from, "bvh,basic; without: both");
    add_number(*command, "--basic-steps", c->options.basic_steps, "of the steps, how many the caster basic gets", 2u,
               1'000'000u);
    add_number(*command, "--copies", c->options.copies, "of all bodies and pairs, to fill a large device", 1u,
               100'000u);
    add_number(*command, "--runs", c->options.runs, "figures are medians over runs and steps", 1u, 1000u);
    add_number(*command, "--threads", c->options.threads, "of the host, 0: one per core", 0u, 1024u);
    add_out(*command, "--out", c->out, "write DIR/<machine>/device-<date>.csv")->type_name("DIR");
    add_json(*command, c->json);
    command->footer("Single kernels are timed in a run of their own, each waited for, by the device's clock.\n"
                    "Exit status: 0 fine, 1 a device failed or its contacts are not the CPU's, 2 bad usage or input.");
    command->callback([c] { bench_device(*c); });
}

} // namespace raycontact::bench
