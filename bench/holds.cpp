// SPDX-License-Identifier: Apache-2.0
// Scenes with a verdict each, in a Bullet world that differs by one line and its solver: `holds`, what a user expects
// to stand, hang, turn or stop, and `motion`, what slides, rolls and bounces as it does on paper. RayContact with
// recommend() beside Bullet's own finders with Bullet's own settings.
#include "bench/commands.h"
#include "bench/options.h"

#include <report/page.h>
#include <tests/holds/run.h>
#include <tests/motion/motion.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace raycontact::bench {

using namespace scenes;

namespace {

struct Options {
    std::string only, finder, out, command;
    HoldOptions hold;
};

struct Row {
    const Hold* hold;
    std::string finder;
    HoldResult result;
};

struct Variant {
    const char* name;
    Finder finder;
    int iterations = 0; ///< 0: as the solver has them
    bool speculative = true;
};
constexpr Variant of_holds[] = {{"ours", Finder::edges},
                                {"ours-1000", Finder::edges, 1000},
                                {"gimpact", Finder::gimpact},
                                {"convex", Finder::convex}};
constexpr Variant of_motion[] = {{"ours", Finder::edges},
                                 {"ours-off", Finder::edges, 0, false},
                                 {"gimpact", Finder::gimpact},
                                 {"bvh", Finder::bvh},
                                 {"convex", Finder::convex}};

/// What a command runs and says.
struct Table {
    const char *name, *title, *summary;
    std::vector<Hold> (*scenes)();
    std::span<const Variant> variants;
    bool rests; ///< the columns of what should rest are printed
};
const Table holds_table{
    "holds",
    "It holds",
    "Scenes that a user expects to stand, hang, turn or stop. Ours is RayContact with the solver settings of "
    "recommend(), ours-1000 with more iterations; gimpact and convex are Bullet's own, with Bullet's settings.",
    all_holds,
    of_holds,
    true};
const Table motion_table{
    "motion",
    "In motion",
    "Bodies that slide, roll, coast and bounce, beside what is right on paper. Ours is RayContact with recommend(), "
    "ours-off the same without speculative contacts; gimpact, bvh (convex shapes on a btBvhTriangleMeshShape) and "
    "convex (on btBoxShapes) are Bullet's own, with Bullet's settings.",
    all_motions,
    of_motion,
    false};

/// Whether a finder can take part in a scene, and in motion does what no other does.
bool is_asked(const Variant& variant, const Table& table, const Hold& hold) {
    const Stack& stack = hold.stack;
    const bool takes_convex = variant.finder == Finder::convex || variant.finder == Finder::bvh;
    if (takes_convex && !stack.convex()) return false;
    if (table.rests) return true;
    const auto any = [&](auto&& test) {
        return std::ranges::any_of(stack.bodies,
                                   [&](const StackBody& body) { return test(body, stack.shapes[body.shape]); });
    };
    if (variant.finder == Finder::convex)
        return any(
            [](const StackBody& body, const StackShape& shape) { return body.fixed && shape.box && !shape.own; });
    if (variant.finder == Finder::gimpact)
        return any([](const StackBody& body, const StackShape& shape) { return !body.fixed && !shape.own; });
    return true;
}

std::string verdict(const HoldResult& result) {
    std::string words = result.holds() ? "holds" : "FAILS";
    for (std::size_t i = 0; i < result.failures.size(); ++i) words += (i == 0 ? ": " : ", ") + result.failures[i];
    if (result.ended_early) words += fmt::format(" (ended after {:.1f} s)", result.seconds);
    return words;
}

std::string bounds(const Figure& figure) {
    return std::isinf(figure.least) ? fmt::format(" [at most {:.4g}]", figure.most)
                                    : fmt::format(" [{:.4g} to {:.4g}]", figure.least, figure.most);
}

/// All of a scene's own; those that do not hold have a mark and their bounds.
std::string figures(const HoldResult& result, const char* between) {
    std::string text;
    for (const Figure& figure : result.figures)
        text += fmt::format("{}{}{} {:.6g} {}{}", text.empty() ? "" : between, figure.holds() ? "" : "!", figure.name,
                            figure.value, figure.unit, figure.holds() ? "" : bounds(figure));
    return text;
}

void print_row(const Row& row, const Table& table) {
    const HoldResult& r = row.result;
    if (!table.rests) {
        fmt::print("{:<72} {:<8} {:8.2f}  {}  {}\n", row.hold->name, row.finder, r.step_ms,
                   r.holds() ? "holds" : "FAILS", figures(r, ", "));
        std::fflush(stdout);
        return;
    }
    fmt::print("{:<36} {:<8} {:8.3f} {:5.1f} {:8.3f} {:4} {:9.2f} {:9.2f} {:9.1f} {:>6} {:8.2f}  {}\n", row.hold->name,
               row.finder, 1000 * r.deepest, r.deepest_time, 1000 * r.deepest_end, r.passed, 1000 * r.speed_median,
               1000 * r.speed_max, 1000 * r.drift, r.asleep < 0 ? "-" : fmt::format("{:.1f}", r.asleep), r.step_ms,
               verdict(r));
    if (!r.figures.empty()) fmt::print("{:48}{}\n", "", figures(r, fmt::format("\n{:48}", "").c_str()));
    std::fflush(stdout);
}

constexpr const char* columns = "scene,finder,hertz,seconds,holds,deepest_mm,passed,speed_median_mm_s,speed_max_mm_s,"
                                "moved_mm,asleep_s,step_ms,figures,verdict";
Json csv_row(const Row& row) {
    const HoldResult& r = row.result;
    return Json::array({row.hold->name, row.finder, row.hold->hertz, r.seconds, r.holds(), 1000 * r.deepest, r.passed,
                        1000 * r.speed_median, 1000 * r.speed_max, 1000 * r.drift,
                        r.asleep < 0 ? Json() : Json(r.asleep), r.step_ms, figures(r, "; "), verdict(r)});
}

/// A plot for each scene, a line for each finder; then all figures.
std::string page(const Table& table, const std::vector<Row>& rows, const std::string& heading,
                 const std::string& command) {
    report::Page page;
    page.title = table.title;
    page.summary = table.summary;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Row& row = rows[i];
        const HoldResult& r = row.result;
        if (i == 0 || rows[i - 1].hold != row.hold) {
            page.plots.push_back({row.hold->name, "mm/s", row.hold->means + ". Median speed of the bodies.", {}});
            page.plots.back().over = "time, s";
        }
        if (row.finder == "ours" || row.finder == "gimpact") { // a page has two colours
            report::Line line{row.finder, {}};
            for (const auto& [time, speed] : r.speeds) line.points.emplace_back(time, 1000 * speed);
            page.plots.back().lines.push_back(line);
        }
        page.rows.push_back({row.hold->name + ": " + row.finder, r.holds() ? "holds" : "FAILS", "",
                             fmt::format("{}deepest {:.3g} mm, fastest {:.3g} mm/s, {:.3g} ms a step{}{}",
                                         r.holds() ? "" : verdict(r) + "; ", 1000 * r.deepest, 1000 * r.speed_max,
                                         r.step_ms, r.figures.empty() ? "" : ", ", figures(r, ", "))});
    }
    page.command = command;
    page.footer = heading;
    return report::make_page(page);
}

void run_all(const Table& table, const Options& options) {
    Output out(options.out, {table.name}, {".csv", ".html"});
    if (!table.rests)
        fmt::print("{}\n{:<72} {:<8} {:>8}\n", heading(out.machine), "scene", "finder", "ms/step");
    else
        fmt::print("{}\n{:<36} {:<8} {:>8} {:>5} {:>8} {:>4} {:>9} {:>9} {:>9} {:>6} {:>8}\n", heading(out.machine),
                   "scene", "finder", "deep mm", "at s", "end mm", "past", "med mm/s", "max mm/s", "moved mm", "asleep",
                   "ms/step");
    const std::vector<Hold> holds = table.scenes();
    std::vector<Row> rows;
    Json fields = Json::array();
    until_stopped([&] {
        for (const Hold& hold : holds) {
            if (hold.name.find(options.only) == std::string::npos) continue;
            for (const Variant& variant : table.variants) {
                if (!options.finder.empty() && variant.name != options.finder) continue;
                if (!is_asked(variant, table, hold)) continue;
                end_if_stopped();
                HoldOptions asked = options.hold;
                if (variant.iterations > 0) asked.iterations = variant.iterations;
                if (!variant.speculative) asked.speculative = false;
                rows.push_back({&hold, variant.name, run_hold(hold, variant.finder, asked)});
                print_row(rows.back(), table);
                fields.push_back(csv_row(rows.back()));
            }
        }
    });
    out.finish();
    out.write(table.name, ".csv", csv(out.machine, columns, fields));
    out.write(table.name, ".html", page(table, rows, heading(out.machine), options.command));
    out.keep();
}

/// As it was typed, but for the order of the options.
std::string command_line(const CLI::App& command) {
    std::string line = "raycontact-bench " + command.get_name();
    for (const CLI::Option* option : command.get_options()) {
        if (option->count() == 0) continue;
        line += " " + option->get_name();
        for (const std::string& word : option->results())
            if (option->get_expected_min() > 0) line += " " + word;
    }
    return line;
}

void add_table(CLI::App& app, const Table& table, const std::string& about) {
    CLI::App* command = app.add_subcommand(table.name, about);
    std::string finders;
    for (const Variant& variant : table.variants) finders += (finders.empty() ? "" : ", ") + std::string(variant.name);
    auto o = std::make_shared<Options>();
    scenes::HoldOptions& hold = o->hold;
    add_world_options(*command, hold.seconds, o->only, o->finder, finders);
    add_number(*command, "--patience", hold.patience, "of the computer's time after which a run ends early", 0.0, 1e9)
        ->type_name("S");
    command->add_flag("--recommended", hold.recommended_for_all, "Bullet's finders get the recommended solver, too");
    command
        ->add_option_function<std::string>(
            "--speculative", [&hold](const std::string& word) { hold.speculative = word != "off"; },
            "contacts before anything touches")
        ->type_name("on|off")
        ->check(CLI::IsMember({"on", "off"}));
    add_number(*command, "--iterations", hold.iterations, "of the solver, 0: as recommended", 0, 100'000);
    add_number(*command, "--slop", hold.slop, "that the solver leaves; without: the scene's", 0.0, 1.0);
    add_number(*command, "--hertz", hold.hertz, "steps a second, 0: the scene's", 0.0, 1e6)->type_name("HZ");
    command
        ->add_option_function<std::pair<int, int>>(
            "--print", [&hold](const std::pair<int, int>& steps) { std::tie(hold.print_from, hold.print_to) = steps; },
            "print the contacts of these steps")
        ->type_name("FROM TO");
    add_out(*command, "--out", o->out, fmt::format("write DIR/<machine>/{}-<date>.csv and .html", table.name))
        ->type_name("DIR");
    command->callback([o, command, &table] {
        o->command = command_line(*command);
        run_all(table, *o);
    });
}

} // namespace

void add_holds(CLI::App& app) {
    add_table(app, holds_table,
              "What a user expects to stand, hang, turn or stop, beside plain Bullet, with a verdict for each");
}

void add_motion(CLI::App& app) {
    add_table(app, motion_table, "What slides, rolls and bounces as it does on paper, beside plain Bullet");
}

} // namespace raycontact::bench
