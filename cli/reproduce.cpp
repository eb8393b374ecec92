// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include "cli/out_option.h"
#include "cli/progress.h"

#include <reproduce/reproduce.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

namespace repro = raycontact::reproduce;

struct ReproduceCommand {
    std::string what = "all", out;
    bool quick = false, tiny = false;
    std::vector<double> constants;
    std::uint32_t seeds = 0;
};

std::string as_text(const repro::Table& table) {
    std::string text = table.title + "\n";
    std::vector<std::size_t> width(table.head.size());
    const auto each = [&](const auto& look) {
        look(table.head);
        for (const auto& row : table.rows) look(row);
    };
    each([&](const std::vector<std::string>& row) {
        for (std::size_t k = 0; k < row.size(); ++k) width[k] = std::max(width[k], row[k].size());
    });
    each([&](const std::vector<std::string>& row) {
        for (std::size_t k = 0; k < row.size(); ++k) text += fmt::format("{:<{}}  ", row[k], width[k]);
        text.erase(text.find_last_not_of(' ') + 1);
        text += '\n';
    });
    return text + '\n';
}

void reproduce(const ReproduceCommand& given) {
    repro::Options options;
    if (given.quick) options.plan = repro::quick_plan();
    if (given.tiny) options.plan = repro::tiny_plan();
    if (!given.constants.empty()) {
        repro::Constants& constants = options.plan.constants;
        constants.displacement_threshold = given.constants[0];
        constants.confidence = given.constants[1];
        constants.distance_extension = given.constants[2];
        raycontact::check_settings(repro::as_in_the_paper(raycontact::Method::predictive, constants));
    }
    if (given.seeds > 0 && given.seeds != options.plan.seeds) {
        options.plan.seeds = given.seeds;
        if (options.plan.is_full()) options.plan.name = "other seeds";
    }
    options.what = given.what;
    options.out = given.out;
    std::optional<Progress> bar;
    options.begin = [&](const std::string& name, std::uint32_t total) {
        if (total == 0) std::cerr << name << ": kept from an earlier run\n";
        bar.emplace(name, total, "", Progress::Elsewhere::lines);
    };
    options.progress = [&](std::uint32_t done) { bar->show(done); };
    options.end = [&] { bar->done(); };
    std::string text;
    options.table = [&](const repro::Table& table) { text += as_text(table); };
    const auto numbers = repro::reproduce(options);
    text += options.plan.is_full() ? "" : options.plan.warning() + "\n\n";
    for (const repro::Number& n : numbers)
        text += fmt::format("{:<28} paper {:>10.5g}   ours {:>10.5g}   {:<16} {}\n", n.id, n.paper, n.ours,
                            repro::to_string(n.verdict), n.unit);
    std::cout << text << "\nreport: " << (options.out / "report.html").string() << '\n';
}

} // namespace

void add_reproduce(CLI::App& app) {
    CLI::App* command = app.add_subcommand("reproduce", "The paper's figures and tables, with ours beside them");
    auto given = std::make_shared<ReproduceCommand>();
    std::string known;
    for (const std::string& name : repro::experiment_names()) known += (known.empty() ? "" : ", ") + name;
    command->add_option("WHAT", given->what, known)->capture_default_str();
    add_out(*command, "--out", given->out, "write report.html, results.json and cache/ there")
        ->type_name("DIR")
        ->required();
    const repro::Constants usual;
    command
        ->add_option("--constants", given->constants,
                     fmt::format("displacementThreshold (m), confidence, distanceExtension (m); {},{},{} unless given",
                                 usual.displacement_threshold, usual.confidence, usual.distance_extension))
        ->type_name("T,C,E")
        ->delimiter(',')
        ->expected(3);
    command->add_option("--seeds", given->seeds, "of table2 and lengths; 5 unless given, 1 with --quick")
        ->check(CLI::Range(1, 1000));
    command->add_flag("--quick", given->quick, "a short version: fewer bodies, steps, seeds and orientations");
    command->add_flag("--tiny", given->tiny, "for tests")->group("");
    command->footer("Results are kept in DIR/cache: a run that was ended goes on where it was, and nothing is done\n"
                    "twice. Exit status 0 whatever the verdicts, 1 the run failed, 2 bad usage or input.");
    command->callback([given] { reproduce(*given); });
}
