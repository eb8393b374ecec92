// SPDX-License-Identifier: Apache-2.0
#include "cli/reproduce.h"

#include "cli/out_option.h"
#include "cli/progress.h"

#include <reproduce/reproduce.h>

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <optional>
#include <string>

namespace {

namespace repro = raycontact::reproduce;

struct ReproduceCommand {
    std::string what = "all", out;
    bool quick = false, tiny = false;
};

void reproduce(const ReproduceCommand& given) {
    repro::Options options;
    if (given.quick) options.plan = repro::quick_plan();
    if (given.tiny) options.plan = repro::tiny_plan();
    options.what = given.what;
    options.out = given.out;
    std::optional<Progress> bar;
    options.begin = [&](const std::string& name, std::uint32_t total) {
        if (total == 0) std::cerr << name << ": kept from an earlier run\n";
        bar.emplace(name, total, "");
    };
    options.progress = [&](std::uint32_t done) { bar->show(done); };
    options.end = [&] { bar->done(); };
    const auto numbers = repro::reproduce(options);
    std::string text = options.plan.is_full() ? "" : options.plan.warning() + "\n\n";
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
    command->add_flag("--quick", given->quick, "a short version: fewer bodies, steps, seeds and orientations");
    command->add_flag("--tiny", given->tiny, "for tests")->group("");
    command->footer("Results are kept in DIR/cache: a run that was ended goes on where it was, and nothing is done\n"
                    "twice. Exit status 0 whatever the verdicts, 1 the run failed, 2 bad usage or input.");
    command->callback([given] { reproduce(*given); });
}
