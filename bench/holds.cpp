// SPDX-License-Identifier: Apache-2.0
// What holds: scenes that a user expects to stand, hang, turn or stop, in a Bullet world that differs by one line and
// its solver: RayContact with recommend(), the same with 1 000 iterations, GImpact and, where all that moves is convex,
// Bullet's own shapes, both with Bullet's own settings.
// Usage: raycontact_bench_holds [--only PART OF A NAME] [--finder ours|ours-1000|gimpact|convex] [--seconds S]
// [--patience S] [--recommended] [--speculative on|off] [--iterations N] [--slop METRES] [--hertz N] [--print FROM TO]
// [--out DIR]: at most S seconds a scene (20); a run ends early once its steps have taken S seconds; Bullet's finders
// get the recommended solver, too; contacts of the steps FROM to TO are printed.
#include <bench/peers/files.h>
#include <report/page.h>
#include <report/svg.h>
#include <scenes/holds/run.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace rc = raycontact;
using namespace rc::scenes;

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
    int iterations; ///< 0: as the solver has them
};
constexpr Variant variants[] = {{"ours", Finder::edges, 0},
                                {"ours-1000", Finder::edges, 1000},
                                {"gimpact", Finder::gimpact, 0},
                                {"convex", Finder::convex, 0}};

template <class... Values>
std::string text(const char* format, Values... values) {
    char out[400];
    std::snprintf(out, sizeof out, format, values...);
    return out;
}

std::string verdict(const HoldResult& result) {
    std::string words = result.holds() ? "holds" : "FAILS";
    for (std::size_t i = 0; i < result.failures.size(); ++i) words += (i == 0 ? ": " : ", ") + result.failures[i];
    if (result.ended_early) words += text(" (ended after %.1f s)", result.seconds);
    return words;
}

std::string asleep(const HoldResult& result) {
    return result.asleep < 0 ? "-" : text("%.1f", result.asleep);
}

void print_row(const Row& row) {
    const HoldResult& r = row.result;
    std::printf("%-36s %-8s %8.3f %5.1f %8.3f %4d %9.2f %9.2f %9.1f %6s %8.2f  %s\n", row.hold->name.c_str(),
                row.finder.c_str(), 1000 * r.deepest, r.deepest_time, 1000 * r.deepest_end, r.passed,
                1000 * r.speed_median, 1000 * r.speed_max, 1000 * r.drift, asleep(r).c_str(), r.step_ms,
                verdict(r).c_str());
    for (const Figure& figure : r.figures)
        std::printf("%-36s %-8s   %s %.4g %s\n", "", "", figure.name.c_str(), figure.value, figure.unit.c_str());
    std::fflush(stdout);
}

std::string csv_row(const rc::bench::Machine& machine, const Row& row) {
    const HoldResult& r = row.result;
    std::string figures;
    for (const Figure& figure : r.figures)
        figures +=
            (figures.empty() ? "" : "; ") + text("%s %.6g %s", figure.name.c_str(), figure.value, figure.unit.c_str());
    return rc::bench::machine_fields(machine) + "," + rc::bench::quoted(row.hold->name) + "," + row.finder
           + text(",%g,%g,%d,%.6f,%d,%.6f,%.6f,%.6f,%s,%.4f,", row.hold->hertz, r.seconds, r.holds() ? 1 : 0,
                  1000 * r.deepest, r.passed, 1000 * r.speed_median, 1000 * r.speed_max, 1000 * r.drift,
                  r.asleep < 0 ? "" : text("%.3f", r.asleep).c_str(), r.step_ms)
           + rc::bench::quoted(figures) + "," + rc::bench::quoted(verdict(r)) + "\n";
}

/// A plot for each scene, a line for each finder; then all figures.
std::string page(const std::vector<Row>& rows, const std::string& heading, const std::string& command) {
    rc::report::Page page;
    page.title = "It holds";
    page.summary =
        "Scenes that a user expects to stand, hang, turn or stop. Ours is RayContact with the solver settings "
        "of recommend(), ours-1000 with more iterations; gimpact and convex are Bullet's own, with Bullet's settings.";
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Row& row = rows[i];
        const HoldResult& r = row.result;
        if (i == 0 || rows[i - 1].hold != row.hold) {
            page.plots.push_back({row.hold->name, "mm/s", row.hold->means + ". Median speed of the bodies.", {}});
            page.plots.back().over = "time, s";
        }
        if (row.finder == "ours" || row.finder == "gimpact") { // a page has two colours
            rc::report::Line line{row.finder, {}};
            for (const auto& [time, speed] : r.speeds) line.points.emplace_back(time, 1000 * speed);
            page.plots.back().lines.push_back(line);
        }
        std::string figures =
            text("deepest %.3g mm, fastest %.3g mm/s, %.3g ms a step", 1000 * r.deepest, 1000 * r.speed_max, r.step_ms);
        for (const Figure& figure : r.figures)
            figures += text(", %s %.3g %s", figure.name.c_str(), figure.value, figure.unit.c_str());
        page.rows.push_back({row.hold->name + ": " + row.finder, r.holds() ? "holds" : "FAILS", "",
                             (r.holds() ? "" : verdict(r) + "; ") + figures});
    }
    page.command = command;
    page.footer = heading;
    return rc::report::make_page(page);
}

int run_all(const Options& options) {
    const rc::bench::Machine machine = rc::bench::this_machine();
    // What cannot be written is known before the work.
    std::optional<rc::output::OutFolder> folder;
    const std::string csv_name = rc::bench::result_name(machine, "holds", ".csv");
    const std::string page_name = rc::bench::result_name(machine, "holds", ".html");
    if (!options.out.empty()) {
        folder.emplace(rc::bench::results_folder(options.out, machine));
        folder->claim(csv_name);
        folder->claim(page_name);
    }
    std::printf("%s\n%-36s %-8s %8s %5s %8s %4s %9s %9s %9s %6s %8s\n", rc::bench::heading(machine).c_str(), "scene",
                "finder", "deep mm", "at s", "end mm", "past", "med mm/s", "max mm/s", "moved mm", "asleep", "ms/step");
    std::string csv = std::string(rc::bench::machine_columns)
                      + ",scene,finder,hertz,seconds,holds,deepest_mm,passed,speed_median_mm_s,speed_max_mm_s,"
                        "moved_mm,asleep_s,step_ms,figures,verdict\n";
    const std::vector<Hold> holds = all_holds();
    std::vector<Row> rows;
    for (const Hold& hold : holds) {
        if (hold.name.find(options.only) == std::string::npos) continue;
        for (const Variant& variant : variants) {
            if (!options.finder.empty() && variant.name != options.finder) continue;
            if (variant.finder == Finder::convex && !hold.stack.convex()) continue;
            HoldOptions asked = options.hold;
            if (variant.iterations > 0) asked.iterations = variant.iterations;
            rows.push_back({&hold, variant.name, run_hold(hold, variant.finder, asked)});
            print_row(rows.back());
            csv += csv_row(machine, rows.back());
        }
    }
    if (folder) {
        folder->write(csv_name, csv);
        folder->write(page_name, page(rows, rc::bench::heading(machine), options.command));
        for (const auto& file : folder->keep()) std::printf("%s\n", file.c_str());
    }
    return 0;
}

Options parse(int count, char** words) {
    Options options;
    options.command = "raycontact_bench_holds";
    for (int i = 1; i < count; ++i) options.command += std::string(" ") + words[i];
    for (int i = 1; i < count; ++i) {
        const std::string word = words[i];
        if (word == "--recommended") {
            options.hold.recommended_for_all = true;
            continue;
        }
        if (i + 1 == count) throw std::runtime_error(word + ": unknown, or without a value");
        const std::string value = words[++i];
        if (word == "--seconds")
            options.hold.seconds = std::atof(value.c_str());
        else if (word == "--patience")
            options.hold.patience = std::atof(value.c_str());
        else if (word == "--iterations")
            options.hold.iterations = std::atoi(value.c_str());
        else if (word == "--slop")
            options.hold.slop = std::atof(value.c_str());
        else if (word == "--hertz")
            options.hold.hertz = std::atof(value.c_str());
        else if (word == "--speculative")
            options.hold.speculative = value != "off";
        else if (word == "--print" && i + 1 < count) {
            options.hold.print_from = std::atoi(value.c_str());
            options.hold.print_to = std::atoi(words[++i]);
        } else if (word == "--only")
            options.only = value;
        else if (word == "--finder")
            options.finder = value;
        else if (word == "--out")
            options.out = value;
        else
            throw std::runtime_error(word + ": unknown");
    }
    if (!(options.hold.seconds > 0)) throw std::runtime_error("--seconds: not above 0");
    return options;
}

} // namespace

int main(int count, char** words) {
    try {
        return run_all(parse(count, words));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "raycontact_bench_holds: %s\n", error.what());
        return 1;
    }
}
