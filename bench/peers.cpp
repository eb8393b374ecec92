// SPDX-License-Identifier: Apache-2.0
// peers, growth and sweep: what contacts cost elsewhere, at other sizes and with other thresholds.
#include "bench/commands.h"
#include "bench/options.h"

#include <bench/peers/approaching.h>
#include <bench/peers/contest.h>
#include <bench/peers/contest_output.h>
#include <bench/peers/entrants.h>
#include <bench/peers/growth.h>
#include <bench/peers/growth_output.h>
#include <bench/peers/seeds.h>
#include <bench/peers/swarm.h>
#include <bench/peers/sweep_output.h>
#include <bench/peers/thresholds.h>
#include <bench/peers/work.h>
#include <raycontact/error.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::bench {

namespace {

struct PeersOptions {
    std::string out, mesh, recording;
    std::vector<std::string> only, works;
    std::uint32_t runs = 5;
    ApproachOptions approach;
    AvalancheWorkOptions avalanche;
    // While the pile still lands and spreads (median speed 2.1 m/s at the first, 0.1 m/s at the last of 512 bodies).
    std::uint32_t moving_first = 60, moving_steps = 100;
    bool json = false;
};

struct SweepCommand {
    std::string recording, out;
    std::vector<std::string> only;
    std::uint32_t first = 0, steps = 600, swarm_steps = 120, bodies = 512, triangles = 20'000;
    std::uint64_t seed = 1;
    std::uint32_t seeds = 5;
    ThresholdOptions thresholds;
    bool json = false;
};

struct GrowthCommand {
    std::string out;
    GrowthOptions options;
    bool json = false;
};

bool chosen(const std::vector<std::string>& words, const std::string& word) {
    return words.empty() || std::find(words.begin(), words.end(), word) != words.end();
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) {
        if (!text.empty()) text += ", ";
        text += word;
    }
    return text;
}

void refuse_unknown(const std::string& option, const std::vector<std::string>& given,
                    const std::vector<std::string>& known) {
    const auto unknown = std::find_if(given.begin(), given.end(), [&](const std::string& word) {
        return std::find(known.begin(), known.end(), word) == known.end();
    });
    if (unknown != given.end())
        throw InputError(option + ": \"" + *unknown + "\" is not known; choose from " + joined(known));
}

std::vector<Entrant> choose_entrants(const std::vector<std::string>& only) {
    std::vector<Entrant> all = entrants(), some;
    std::vector<std::string> names;
    names.reserve(all.size());
    for (const Entrant& entrant : all) names.push_back(entrant.name);
    refuse_unknown("--only", only, names);
    for (Entrant& entrant : all) {
        if (!chosen(only, entrant.name)) continue;
        if (entrant.make)
            some.push_back(std::move(entrant));
        else if (!only.empty())
            throw InputError("--only: " + entrant.name + ": " + entrant.why_not);
    }
    return some;
}

/// Said at the end: one line is all that bad input may print.
void name_absent(const std::vector<std::string>& only) {
    if (!only.empty()) return;
    for (const Entrant& entrant : entrants())
        if (!entrant.make) std::cerr << "without " << entrant.name << ": " << entrant.why_not << '\n';
}

using MakeWork = std::function<Work()>;

/// Name and maker of each work; made one at a time, they are large.
std::vector<std::pair<std::string, MakeWork>> choose_works(const PeersOptions& options) {
    std::vector<std::pair<std::string, MakeWork>> works;
    const auto approach = [&](std::string name, const std::shared_ptr<const Shape>& shape, std::string source) {
        return approaching_pairs(std::move(name), shape, std::move(source), options.approach);
    };
    if (!options.mesh.empty()) {
        works.emplace_back(
            "mesh", [=] { return approach("mesh", one_metre_mesh(options.mesh), options.mesh + ", scaled to 1 m"); });
    } else {
        for (const std::uint32_t triangles : {902u, 3192u, 19996u}) {
            const std::string name = "pairs-" + std::to_string(triangles / 2 + 2);
            works.emplace_back(name, [=] {
                std::string source;
                const auto shape = bench_mesh(triangles, source);
                return approach(name, shape, source);
            });
        }
    }
    const auto avalanche = [&options](std::string name, const AvalancheWorkOptions& steps) {
        Work work = options.recording.empty() ? avalanche_work(steps) : recorded_work(options.recording, steps);
        work.name = std::move(name);
        return work;
    };
    works.emplace_back("avalanche", [=, &options] { return avalanche("avalanche", options.avalanche); });
    works.emplace_back("avalanche-moving", [=, &options] {
        AvalancheWorkOptions moving = options.avalanche;
        moving.first = options.moving_first;
        moving.steps = options.moving_steps;
        return avalanche("avalanche-moving", moving);
    });
    std::vector<std::string> names;
    names.reserve(works.size());
    for (const auto& work : works) names.push_back(work.first);
    refuse_unknown("--works", options.works, names);
    std::erase_if(works, [&](const auto& work) { return !chosen(options.works, work.first); });
    return works;
}

WorkNote note_of(const Work& work) {
    return {work.name, work.source, static_cast<std::uint32_t>(work.steps.size()), work.pair_steps(), pace(work)};
}

void bench_peers(const PeersOptions& options) {
    const std::vector<Entrant> who = choose_entrants(options.only);
    Machine machine = this_machine();
    BenchFiles files(options.out, machine, {"peers"});
    std::vector<WorkNote> notes;
    std::vector<Result> results;
    until_stopped([&] {
        for (const auto& [name, make] : choose_works(options)) {
            tell(name + ": poses and pairs");
            const Work work = make();
            const std::vector<Result> some = contest(work, who, options.runs, tell);
            notes.push_back(note_of(work));
            results.insert(results.end(), some.begin(), some.end());
        }
    });
    finish(machine);
    if (results.empty() && machine.cut_short) return;
    name_absent(options.only);
    std::cout << (options.json ? json(machine, notes, results) : table(machine, notes, results)) << std::flush;
    if (files) {
        write_results(files.folder(), machine, notes, results);
        files.keep(machine);
    }
    if (std::any_of(results.begin(), results.end(), [](const Result& r) { return !r.agrees; }))
        throw std::runtime_error("basic or certified gave other bits than bvh; this must not be");
}

void bench_growth(const GrowthCommand& command) {
    refuse_unknown("--only", command.options.parts, {std::begin(growth_parts), std::end(growth_parts)});
    Machine machine = this_machine();
    BenchFiles files(command.out, machine, {"growth"});
    const std::vector<GrowthRow> rows = growth(command.options, tell);
    finish(machine);
    if (rows.empty() && machine.cut_short) return;
    std::cout << (command.json ? json(machine, rows) : table(machine, rows)) << std::flush;
    if (files) {
        write_results(files.folder(), machine, rows);
        files.keep(machine);
    }
}

std::vector<MakeWork> choose_sweeps(const SweepCommand& command) {
    AvalancheWorkOptions steps;
    steps.bodies = command.bodies;
    steps.seed = command.seed;
    steps.first = command.first;
    steps.steps = command.steps;
    if (!command.recording.empty()) return {[=] { return recorded_work(command.recording, steps); }};
    SwarmOptions swarm;
    swarm.steps = command.swarm_steps;
    swarm.triangles = command.triangles;
    swarm.seed = command.seed;
    return {[=] { return avalanche_work(steps); }, [=] { return swarm_work(swarm); }};
}

void bench_sweep(const SweepCommand& command) {
    refuse_unknown("--only", command.only, {"thresholds", "seeds"});
    if (!command.recording.empty() && !command.only.empty() && chosen(command.only, "seeds"))
        throw InputError("--only seeds: simulates its avalanches itself; give no recording");
    Machine machine = this_machine();
    BenchFiles files(command.out, machine, {"sweep-thresholds", "sweep-seeds"});
    std::vector<WorkNote> notes;
    std::vector<ThresholdRow> thresholds;
    std::vector<SeedRow> seeds;
    if (chosen(command.only, "thresholds")) {
        until_stopped([&] {
            for (const MakeWork& make : choose_sweeps(command)) {
                tell("poses and pairs");
                const Work work = make();
                const std::vector<ThresholdRow> some = sweep_thresholds(work, command.thresholds, tell);
                notes.push_back(note_of(work));
                thresholds.insert(thresholds.end(), some.begin(), some.end());
            }
        });
    }
    if (command.recording.empty() && chosen(command.only, "seeds"))
        seeds = sweep_seeds({command.seed, command.seeds, command.bodies, command.steps}, tell);
    finish(machine);
    if (thresholds.empty() && seeds.empty() && machine.cut_short) return;
    if (command.json) {
        std::cout << json(machine, notes, thresholds, seeds);
    } else {
        if (!thresholds.empty()) std::cout << table(machine, notes, thresholds);
        if (!thresholds.empty() && !seeds.empty()) std::cout << '\n';
        if (!seeds.empty()) std::cout << table(machine, seeds);
    }
    std::cout.flush();
    if (files) {
        if (!thresholds.empty()) write_results(files.folder(), machine, notes, thresholds);
        if (!seeds.empty()) write_results(files.folder(), machine, seeds);
        files.keep(machine);
    }
    const bool wrong =
        std::any_of(thresholds.begin(), thresholds.end(),
                    [](const ThresholdRow& r) { return r.method == Method::certified && r.wrong.total() > 0; })
        || std::any_of(seeds.begin(), seeds.end(),
                       [](const SeedRow& r) { return r.method == Method::certified && r.wrong.total() > 0; });
    if (wrong) throw std::runtime_error("certified gave other contacts than standard; this must not be");
}

} // namespace

void add_peers(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "peers", "The same poses and pairs through ours, Bullet GImpact, FCL, ODE and Embree, one thread each");
    auto o = std::make_shared<PeersOptions>();
    add_out(*command, "--out", o->out, "write DIR/<machine>/peers-<date>.csv and .svg")->type_name("DIR");
    add_number(*command, "--steps", o->approach.steps, "steps of the approaching pairs", 1u, 100'000u);
    add_number(*command, "--pairs", o->approach.pairs, "approaching pairs, all in one step", 1u, 10'000u);
    add_number(*command, "--depth", o->approach.depth, "metres that they are pushed in beyond first touch", 0.0, 0.5);
    add_number(*command, "--runs", o->runs, "of everyone in turn; figures are medians", 1u, 1000u);
    command
        ->add_option("--only", o->only,
                     "who: bvh,basic,iterative,iterative-basic,predictive,certified (all of vertices alone), edges "
                     "(certified with edges), gimpact,fcl,ode,embree,rays,grid-rays,embree-rays")
        ->type_name("NAMES")
        ->delimiter(',');
    command->add_option("--works", o->works, "what: pairs-453,pairs-1598,pairs-10000,avalanche,avalanche-moving")
        ->type_name("NAMES")
        ->delimiter(',');
    command->add_option("--mesh", o->mesh, "approaching pairs of this mesh instead, scaled to 1 m (work \"mesh\")")
        ->type_name("FILE");
    command->add_option("--recording", o->recording, "take the avalanche's poses and pairs from there (run --record)")
        ->type_name("FILE");
    add_number(*command, "--bodies", o->avalanche.bodies, "of the avalanche", 1u, 1'000'000u);
    add_number(*command, "--avalanche-first", o->avalanche.first, "first of its steps", 0u, 1'000'000u);
    add_number(*command, "--avalanche-steps", o->avalanche.steps, "steps of the avalanche", 1u, 1'000'000u);
    add_number(*command, "--avalanche-stride", o->avalanche.stride,
               "of those, every Nth for the others; 1 takes minutes a run", 1u, 1'000'000u);
    add_number(*command, "--moving-first", o->moving_first, "first step of the work avalanche-moving", 0u, 1'000'000u);
    add_number(*command, "--moving-steps", o->moving_steps, "its steps", 1u, 1'000'000u);
    command->add_flag("--json", o->json, "print one JSON object on stdout");
    command->callback([o] { bench_peers(*o); });
}

void add_growth(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("growth", "How the narrow phase grows with bodies, with triangles a mesh and with speed");
    auto c = std::make_shared<GrowthCommand>();
    add_out(*command, "--out", c->out, "write DIR/<machine>/growth-<date>.csv and .svg")->type_name("DIR");
    command->add_option("--only", c->options.parts, "parts: triangles,contacts,creeping,still,displacement,bodies")
        ->type_name("NAMES")
        ->delimiter(',');
    add_number(*command, "--bodies", c->options.bodies, "largest avalanche, 64 and its doubles up to here; 0: none", 0u,
               1'000'000u);
    add_number(*command, "--steps", c->options.steps, "of each avalanche; the last fifth is measured", 1u, 100'000u);
    add_number(*command, "--triangles", c->options.triangles, "largest mesh; 0: none", 0u, 2'000'000u);
    add_number(*command, "--pairs", c->options.pairs, "of that mesh, at each size", 1u, 10'000u);
    add_number(*command, "--contacts", c->options.contacts, "of each rolling pair, about", 1u, 10'000u);
    add_number(*command, "--threads", c->options.threads, "0: one per core", 0u, 1024u);
    command->add_flag("--json", c->json, "print one JSON object on stdout");
    command->callback([c] { bench_growth(*c); });
}

void add_sweep(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "sweep", "Every displacement threshold, and the library's choice: time, and rays that are wrong");
    auto c = std::make_shared<SweepCommand>();
    command
        ->add_option("recording", c->recording,
                     "poses and pairs (run --record); without: an avalanche, and a few fast, large bodies")
        ->type_name("RECORDING");
    add_out(*command, "--out", c->out, "write DIR/<machine>/sweep-thresholds-<date>.csv and .svg, sweep-seeds too")
        ->type_name("DIR");
    command->add_option("--only", c->only, "parts: thresholds,seeds")->type_name("NAMES")->delimiter(',');
    add_number(*command, "--first", c->first, "first step of the thresholds' avalanche or recording", 0u, 1'000'000u);
    add_number(*command, "--steps", c->steps, "of each avalanche, or of the recording", 1u, 1'000'000u);
    add_number(*command, "--swarm-steps", c->swarm_steps, "of the few, fast bodies", 1u, 1'000'000u);
    add_number(*command, "--bodies", c->bodies, "of each avalanche", 1u, 1'000'000u);
    add_number(*command, "--triangles", c->triangles, "of each fast body; even", 60u, 1'000'000u);
    add_number(*command, "--seed", c->seed, "first seed", std::uint64_t{0}, ~std::uint64_t{0} >> 1);
    add_number(*command, "--seeds", c->seeds, "avalanches of the part seeds", 1u, 1000u);
    add_number(*command, "--values", c->thresholds.values, "fixed thresholds, 1e-4 to 1e-1 of the size", 1u, 100u);
    add_number(*command, "--runs", c->thresholds.runs, "of all settings in turn; times are medians", 1u, 1000u);
    command->add_flag("--json", c->json, "print one JSON object on stdout");
    command->callback([c] { bench_sweep(*c); });
}

} // namespace raycontact::bench
