// SPDX-License-Identifier: Apache-2.0
// peers and growth: what contacts cost elsewhere, and at other sizes.
#include "bench/commands.h"
#include "bench/options.h"

#include <bench/peers/contest.h>
#include <bench/peers/growth.h>
#include <bench/peers/motion.h>
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

struct GrowthCommand {
    std::string out;
    GrowthOptions options;
    bool json = false;
};

bool chosen(const std::vector<std::string>& words, const std::string& word) {
    return words.empty() || std::find(words.begin(), words.end(), word) != words.end();
}

std::vector<Entrant> choose_entrants(const std::vector<std::string>& only) {
    std::vector<Entrant> some;
    for (Entrant& entrant : entrants()) {
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
    std::erase_if(works, [&](const auto& work) { return !chosen(options.works, work.first); });
    if (works.empty()) throw InputError("--works: there are none of these with --mesh, or only with it");
    return works;
}

void bench_peers(const PeersOptions& options) {
    const std::vector<Entrant> who = choose_entrants(options.only);
    Output out(options.out, {"peers"});
    Json notes = Json::array();
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
    if (!out.finish(!results.empty())) return;
    name_absent(options.only);
    const Json rows = json_list(results);
    out.print(options.json, table(notes, results), {{"works", notes}, {"results", rows}});
    out.write("peers", ".csv", csv(out.machine, result_columns, rows, notes));
    out.write("peers", ".svg", chart(notes, results));
    out.keep();
    if (std::any_of(results.begin(), results.end(), [](const Result& r) { return !r.agrees; }))
        throw std::runtime_error("basic or certified gave other bits than bvh; this must not be");
}

void bench_growth(const GrowthCommand& command) {
    Output out(command.out, {"growth"});
    const std::vector<GrowthRow> rows = growth(command.options, tell);
    if (!out.finish(!rows.empty())) return;
    out.print(command.json, table(rows), {{"rows", json_list(rows)}, {"slopes", json_list(slopes(rows))}});
    out.write("growth", ".csv", csv(out.machine, growth_columns, json_list(rows)));
    out.write("growth", ".svg", chart(rows));
    out.keep();
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
    std::vector<std::string> names;
    for (const Entrant& entrant : entrants()) names.push_back(entrant.name);
    add_words(*command, "--only", o->only, names,
              "who: bvh,basic,iterative,iterative-basic,predictive,certified (all of vertices alone), edges "
              "(certified with edges), gimpact,fcl,ode,embree,rays,grid-rays,embree-rays");
    add_words(*command, "--works", o->works,
              {"pairs-453", "pairs-1598", "pairs-10000", "avalanche", "avalanche-moving", "mesh"},
              "what: pairs-453,pairs-1598,pairs-10000,avalanche,avalanche-moving");
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
    add_json(*command, o->json);
    command->callback([o] { bench_peers(*o); });
}

void add_growth(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("growth", "How the narrow phase grows with bodies, with triangles a mesh and with speed");
    auto c = std::make_shared<GrowthCommand>();
    add_out(*command, "--out", c->out, "write DIR/<machine>/growth-<date>.csv and .svg")->type_name("DIR");
    add_words(*command, "--only", c->options.parts, {std::begin(growth_parts), std::end(growth_parts)},
              "parts: triangles,contacts,creeping,still,displacement,bodies");
    add_number(*command, "--bodies", c->options.bodies, "largest avalanche, 64 and its doubles up to here; 0: none", 0u,
               1'000'000u);
    add_number(*command, "--steps", c->options.steps, "of each avalanche; the last fifth is measured", 1u, 100'000u);
    add_number(*command, "--triangles", c->options.triangles, "largest mesh; 0: none", 0u, 2'000'000u);
    add_number(*command, "--pairs", c->options.pairs, "of that mesh, at each size", 1u, 10'000u);
    add_number(*command, "--contacts", c->options.contacts, "of each rolling pair, about", 1u, 10'000u);
    add_number(*command, "--threads", c->options.threads, "0: one per core", 0u, 1024u);
    add_json(*command, c->json);
    command->callback([c] { bench_growth(*c); });
}

} // namespace raycontact::bench
