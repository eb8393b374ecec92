// SPDX-License-Identifier: Apache-2.0
// By how much more threads shorten a step: the same steps of an avalanche by one thread and by more, step by step in
// turns, so that what else runs on the machine disturbs all alike.
#include "bench/commands.h"
#include "bench/options.h"

#include <bench/device/replayer.h>
#include <bench/peers/work.h>
#include <scenes/peers/clock.h>

#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

namespace raycontact::bench {

namespace {

struct Options {
    std::string recording;
    AvalancheWorkOptions work{.bodies = 512, .first = 160, .steps = 100};
    std::uint32_t rounds = 3, copies = 1;
};

std::vector<std::uint32_t> thread_counts() {
    std::vector<std::uint32_t> counts;
    for (std::uint32_t count = 1; count < usable_cores(); count *= 2) counts.push_back(count);
    counts.push_back(usable_cores());
    return counts;
}

void measure(const Work& work, const Options& options, Features features) {
    Settings settings;
    settings.features = features;
    const std::vector<std::uint32_t> counts = thread_counts();
    std::vector<std::unique_ptr<Replayer>> replayers;
    for (const std::uint32_t count : counts) {
        settings.execution.threads = count;
        replayers.push_back(std::make_unique<Replayer>(work, options.copies, settings, open_device("cpu", count)));
    }
    std::vector<std::vector<double>> times(counts.size()), ratios(counts.size()); // us; of one thread's
    for (std::uint32_t round = 0; round < options.rounds; ++round) {
        for (auto& replayer : replayers) replayer->rest(settings);
        for (std::size_t k = 0; k < work.steps.size(); ++k) {
            end_if_stopped();
            for (std::size_t i = 0; i < counts.size(); ++i) {
                replayers[i]->step(k);
                if (k == 0) continue; // all pairs are new
                times[i].push_back(replayers[i]->step_us());
                ratios[i].push_back(times[0].back() / times[i].back());
            }
        }
    }
    for (std::size_t i = 0; i < counts.size(); ++i)
        std::printf("%-8s %7llu pairs %3u threads %9.3f ms a step, %5.2f times as fast as one\n",
                    std::string(to_string(features)).c_str(),
                    static_cast<unsigned long long>(replayers[i]->stats().pairs), counts[i],
                    1e-3 * peers::median(times[i]), peers::median(ratios[i]));
    std::fflush(stdout);
}

void run(const Options& options) {
    const Work work =
        options.recording.empty() ? avalanche_work(options.work) : recorded_work(options.recording, options.work);
    for (const Features features : {Features::vertices, Features::edges}) measure(work, options, features);
}

} // namespace

void add_threads(CLI::App& app) {
    CLI::App* command = app.add_subcommand("threads", "By how much more threads shorten a step of an avalanche");
    auto options = std::make_shared<Options>();
    command
        ->add_option("--recording", options->recording,
                     "poses and pairs (run --record); without: an avalanche, simulated beforehand")
        ->type_name("FILE");
    add_number(*command, "--bodies", options->work.bodies, "of the avalanche", 1u, 1'000'000u);
    add_number(*command, "--first", options->work.first, "step", 0u, 1'000'000u);
    add_number(*command, "--steps", options->work.steps, "from there on", 2u, 1'000'000u);
    add_number(*command, "--copies", options->copies, "of all bodies and pairs", 1u, 100'000u);
    add_number(*command, "--rounds", options->rounds, "figures are medians over rounds and steps", 1u, 1000u);
    command->callback([options] { run(*options); });
}

} // namespace raycontact::bench
