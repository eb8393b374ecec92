// SPDX-License-Identifier: Apache-2.0
#include "cli/bench.h"

#include <bench/peers/contest.h>
#include <bench/peers/growth.h>
#include <bench/peers/machine.h>
#include <bench/peers/output.h>
#include <bench/peers/work.h>
#include <raycontact/error.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <unistd.h>

namespace {

using namespace raycontact::bench;
using raycontact::InputError;

struct PeersOptions {
    std::string out, mesh, recording;
    std::vector<std::string> only, works;
    std::uint32_t runs = 5;
    ApproachOptions approach;
    AvalancheWorkOptions avalanche;
    bool json = false;
};

struct GrowthCommand {
    std::string out;
    GrowthOptions options;
    bool json = false;
};

/// One line that says what is being done, on a terminal only.
void tell(const std::string& what) {
    if (isatty(STDERR_FILENO)) std::cerr << "\r\033[K" << what << std::flush;
}

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
    const auto approach = [&](std::string name, const std::shared_ptr<const raycontact::Shape>& shape,
                              std::string source) {
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
    works.emplace_back("avalanche", [&options] {
        return options.recording.empty() ? avalanche_work(options.avalanche)
                                         : recorded_work(options.recording, options.avalanche);
    });
    std::vector<std::string> names;
    names.reserve(works.size());
    for (const auto& work : works) names.push_back(work.first);
    refuse_unknown("--works", options.works, names);
    std::erase_if(works, [&](const auto& work) { return !chosen(options.works, work.first); });
    return works;
}

void bench_peers(const PeersOptions& options) {
    const std::vector<Entrant> who = choose_entrants(options.only);
    Machine machine = this_machine();
    std::vector<WorkNote> notes;
    std::vector<Result> results;
    for (const auto& [name, make] : choose_works(options)) {
        tell(name + ": poses and pairs");
        const Work work = make();
        notes.push_back({work.name, work.source, static_cast<std::uint32_t>(work.steps.size()), work.pair_steps()});
        const std::vector<Result> some = contest(work, who, options.runs, tell);
        results.insert(results.end(), some.begin(), some.end());
    }
    machine.load = this_machine().load;
    tell("");
    name_absent(options.only);
    if (!options.out.empty())
        std::cerr << "written: " << write_results(options.out, machine, notes, results).string() << " and .svg\n";
    std::cout << (options.json ? json(machine, notes, results) : table(machine, notes, results));
    if (std::any_of(results.begin(), results.end(), [](const Result& r) { return !r.agrees; }))
        throw std::runtime_error("basic and bvh gave different bits; this must not be");
}

void bench_growth(const GrowthCommand& command) {
    Machine machine = this_machine();
    const std::vector<GrowthRow> rows = growth(command.options, tell);
    machine.load = this_machine().load;
    tell("");
    if (!command.out.empty())
        std::cerr << "written: " << write_results(command.out, machine, rows).string() << " and .svg\n";
    std::cout << (command.json ? json(machine, rows) : table(machine, rows));
}

template <class Number>
void add_number(CLI::App& command, const std::string& name, Number& value, const std::string& help, Number least,
                Number most) {
    command.add_option(name, value, help)
        ->type_name(std::is_integral_v<Number> ? "N" : "METRES")
        ->capture_default_str()
        ->check(CLI::Range(least, most));
}

void add_peers(CLI::App& bench) {
    CLI::App* command = bench.add_subcommand(
        "peers", "The same poses and pairs through ours, Bullet GImpact, FCL, ODE and Embree, one thread each");
    auto o = std::make_shared<PeersOptions>();
    command->add_option("--out", o->out, "write DIR/<machine>/peers-<date>.csv and .svg")->type_name("DIR");
    add_number(*command, "--steps", o->approach.steps, "steps of the approaching pairs", 1u, 100'000u);
    add_number(*command, "--pairs", o->approach.pairs, "approaching pairs, all in one step", 1u, 10'000u);
    add_number(*command, "--depth", o->approach.depth, "metres that they are pushed in beyond first touch", 0.0, 0.5);
    add_number(*command, "--runs", o->runs, "of everyone in turn; figures are medians", 1u, 1000u);
    command->add_option("--only", o->only, "who: bvh,basic,gimpact,fcl,ode,embree,rays,grid-rays,embree-rays")
        ->type_name("NAMES")
        ->delimiter(',');
    command->add_option("--works", o->works, "what: pairs-453,pairs-1598,pairs-10000,avalanche")
        ->type_name("NAMES")
        ->delimiter(',');
    command->add_option("--mesh", o->mesh, "approaching pairs of this mesh instead, scaled to 1 m (work \"mesh\")")
        ->type_name("FILE");
    command->add_option("--recording", o->recording, "take the avalanche's poses and pairs from there (run --record)")
        ->type_name("FILE");
    add_number(*command, "--bodies", o->avalanche.bodies, "of the avalanche", 1u, 1'000'000u);
    add_number(*command, "--avalanche-first", o->avalanche.first, "first of its steps", 0u, 1'000'000u);
    add_number(*command, "--avalanche-steps", o->avalanche.steps, "steps of the avalanche", 1u, 1'000'000u);
    add_number(*command, "--avalanche-stride", o->avalanche.stride, "of those, every Nth; 1 takes minutes a run", 1u,
               1'000'000u);
    command->add_flag("--json", o->json, "print one JSON object on stdout");
    command->callback([o] { bench_peers(*o); });
}

void add_growth(CLI::App& bench) {
    CLI::App* command =
        bench.add_subcommand("growth", "How the narrow phase grows with bodies and with triangles a mesh");
    auto c = std::make_shared<GrowthCommand>();
    command->add_option("--out", c->out, "write DIR/<machine>/growth-<date>.csv and .svg")->type_name("DIR");
    add_number(*command, "--bodies", c->options.bodies, "largest avalanche, 64 and its doubles up to here; 0: none", 0u,
               1'000'000u);
    add_number(*command, "--steps", c->options.steps, "of each avalanche; the last fifth is measured", 1u, 100'000u);
    add_number(*command, "--triangles", c->options.triangles, "largest mesh; 0: none", 0u, 2'000'000u);
    add_number(*command, "--pairs", c->options.pairs, "of that mesh, at each size", 1u, 10'000u);
    add_number(*command, "--threads", c->options.threads, "0: one per core", 0u, 1024u);
    command->add_flag("--json", c->json, "print one JSON object on stdout");
    command->callback([c] { bench_growth(*c); });
}

} // namespace

void add_bench(CLI::App& app) {
    CLI::App* bench = app.add_subcommand("bench", "What contacts cost: against other libraries, and at other sizes");
    bench->require_subcommand(0, 1); // none is refused below, with the names to choose from
    bench->callback([bench] {
        if (bench->get_subcommands().empty())
            throw InputError("bench: a subcommand is required: peers or growth (see raycontact bench --help)");
    });
    add_peers(*bench);
    add_growth(*bench);
}
