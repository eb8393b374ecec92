// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/sweep_output.h>

#include <bench/peers/files.h>
#include <report/bars.h>
#include <report/plot.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

namespace raycontact::bench {

namespace {

using Json = nlohmann::ordered_json;
using recording::WrongRays;

constexpr Method swept[] = {Method::iterative, Method::predictive, Method::certified};

constexpr const char* work_columns = "rays,rays_cast,walks,walks_lost,walk_casts,predictions,pairs_full,pairs_skipped,"
                                     "pair_bytes,contacts,missed,invented,other_triangle,wrong,rays_compared,"
                                     "contacts_compared";
std::string work_fields(const StepStats& s, const WrongRays& w) {
    return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", s.details.rays, s.details.rays_cast,
                       s.details.walks, s.details.walks_lost, s.details.walk_casts, s.details.predictions,
                       s.details.pairs_full, s.details.pairs_skipped, s.pair_bytes, s.contacts, w.missed, w.invented,
                       w.other_triangle, w.total(), w.rays_compared, w.contacts_compared);
}

std::string fraction_of(const ThresholdRow& row) {
    if (row.method == Method::standard) return "none";
    return row.fraction ? fmt::format("{:.3g}", *row.fraction) : "auto";
}

double wrong_a_million(const WrongRays& wrong) {
    return 1e6 * static_cast<double>(wrong.total())
           / static_cast<double>(std::max<std::uint64_t>(wrong.rays_compared, 1));
}

std::string say(const ThresholdRow* row) {
    if (!row) return "none";
    return fmt::format("{} with {:.1f} us a step and {} wrong", fraction_of(*row), row->us, row->wrong.total());
}

const char* setting_of(bool fixed) {
    return fixed ? "fixed" : "auto";
}

std::string chart(std::span<const WorkNote> works, std::span<const ThresholdRow> rows) {
    std::vector<report::Plot> plots;
    for (const WorkNote& work : works) {
        const std::string over = "displacement threshold, part of the size";
        report::Plot time{work.name, "us a step", "Dashed: with thresholds that the method chose.", {}, over, true};
        report::Plot wrong{work.name, "wrong rays a million", "Where none was wrong there is no point.", {}, over,
                           true};
        for (std::size_t m = 0; m < std::size(swept); ++m) {
            report::Line line_time{std::string(to_string(swept[m])), {}, m}, line_wrong = line_time;
            for (const ThresholdRow& row : rows) {
                if (row.work != work.name || row.method != swept[m] || !row.fraction) continue;
                line_time.points.emplace_back(*row.fraction, row.us);
                line_wrong.points.emplace_back(*row.fraction, wrong_a_million(row.wrong));
            }
            const auto ends = [&](double value) {
                report::Line line{line_time.name + ", chosen", {}, m, true};
                if (line_time.points.empty()) return line;
                line.points = {{line_time.points.front().first, value}, {line_time.points.back().first, value}};
                return line;
            };
            for (const ThresholdRow& row : rows) {
                if (row.work != work.name || row.method != swept[m] || row.fraction) continue;
                time.lines.push_back(line_time);
                time.lines.push_back(ends(row.us));
                wrong.lines.push_back(line_wrong);
                wrong.lines.push_back(ends(wrong_a_million(row.wrong)));
            }
        }
        plots.push_back(time);
        plots.push_back(wrong);
    }
    return report::plot_svg(plots);
}

std::string name_of(const SeedRow& row) {
    return std::string(to_string(row.method)) + ", " + setting_of(row.fixed)
           + (row.method == Method::predictive && !row.cast_lost_walks ? ", lost walks given up" : "");
}

} // namespace

std::string table(const Machine& machine, std::span<const WorkNote> works, std::span<const ThresholdRow> rows) {
    std::string text = heading(machine);
    for (const WorkNote& work : works) {
        text += heading(work);
        text += fmt::format("  {:<12}{:>10}{:>12}{:>12}{:>12}{:>12}{:>12} | {:>9}{:>9}{:>9}{:>9}\n", "", "threshold",
                            "us/step", "full tests", "cast", "walks", "lost", "missed", "invented", "other", "wrong");
        for (const ThresholdRow& r : rows) {
            if (r.work != work.name) continue;
            text += fmt::format("  {:<12}{:>10}{:>12.1f}{:>12}{:>12}{:>12}{:>12} | {:>9}{:>9}{:>9}{:>9}\n",
                                to_string(r.method), fraction_of(r), r.us, r.sums.details.pairs_full,
                                r.sums.details.rays_cast, r.sums.details.walks, r.sums.details.walks_lost,
                                r.wrong.missed, r.wrong.invented, r.wrong.other_triangle, r.wrong.total());
        }
        for (const ThresholdRow& r : rows)
            if (r.work == work.name && r.method == Method::standard)
                text += fmt::format("  wrong of {} rays and {} contacts; thresholds in parts of {:.3g} m\n",
                                    r.wrong.rays_compared, r.wrong.contacts_compared, r.size);
        for (const Verdict& v : verdicts(rows)) {
            if (v.work != work.name) continue;
            text += fmt::format(
                "  {}: {}\n    fastest fixed: {} (auto takes {:.2f} of its time)\n    fastest fixed with "
                "no more wrong: {}{}\n    fewest wrong: {} (auto takes {:.2f} of its time)\n",
                to_string(v.method), say(v.chosen), say(v.fastest), v.chosen->us / v.fastest->us, say(v.as_right),
                v.as_right ? fmt::format(" (auto takes {:.2f} of its time)", v.chosen->us / v.as_right->us) : "",
                say(v.rightest), v.chosen->us / v.rightest->us);
        }
    }
    return text + "\nTimes are of one processor, medians of the runs; counts are over all steps.\n";
}

std::string table(const Machine& machine, std::span<const SeedRow> rows) {
    std::string text = heading(machine);
    text +=
        fmt::format("fixed: displacement threshold {:g} of the size, confidence {:g}; auto: as the library chooses\n",
                    fixed_displacement, fixed_confidence);
    text += fmt::format("  {:>6} {:<42}{:>9}{:>9}{:>9}{:>9}{:>14}{:>12}\n", "seed", "", "missed", "invented", "other",
                        "wrong", "of rays", "of contacts");
    for (const SeedRow& r : rows)
        text += fmt::format("  {:>6} {:<42}{:>9}{:>9}{:>9}{:>9}{:>14}{:>12}\n", r.seed, name_of(r), r.wrong.missed,
                            r.wrong.invented, r.wrong.other_triangle, r.wrong.total(), r.wrong.rays_compared,
                            r.wrong.contacts_compared);
    for (const Reduction& r : reductions(rows)) {
        if (r.of_seeds.empty()) continue;
        text += fmt::format("fewer wrong rays, 1 - predictive / iterative, {}, lost walks {}: median {:.3f}, {:.3f} to "
                            "{:.3f} over {} seeds\n",
                            setting_of(r.fixed), r.cast_lost_walks ? "cast" : "given up", r.median, r.least, r.most,
                            r.of_seeds.size());
    }
    return text;
}

std::string json(const Machine& machine, std::span<const WorkNote> works, std::span<const ThresholdRow> thresholds,
                 std::span<const SeedRow> seeds) {
    Json out{{"machine", machine_json(machine)}, {"works", works_json(works)}, {"thresholds", Json::array()},
             {"verdicts", Json::array()},        {"seeds", Json::array()},     {"reductions", Json::array()}};
    for (const ThresholdRow& r : thresholds) {
        Json row{{"work", r.work},   {"method", to_string(r.method)}, {"threshold", fraction_of(r)},  {"size", r.size},
                 {"steps", r.steps}, {"us_per_step", r.us},           {"wall_us_per_step", r.wall_us}};
        put_counts(row, r.sums, r.wrong);
        out["thresholds"].push_back(row);
    }
    for (const Verdict& v : verdicts(thresholds))
        out["verdicts"].push_back({{"work", v.work},
                                   {"method", to_string(v.method)},
                                   {"auto_us", v.chosen->us},
                                   {"auto_wrong", v.chosen->wrong.total()},
                                   {"fastest", fraction_of(*v.fastest)},
                                   {"fastest_us", v.fastest->us},
                                   {"fastest_wrong", v.fastest->wrong.total()},
                                   {"auto_over_fastest", v.chosen->us / v.fastest->us},
                                   {"as_right", v.as_right ? Json(fraction_of(*v.as_right)) : Json()},
                                   {"as_right_us", v.as_right ? Json(v.as_right->us) : Json()},
                                   {"rightest", fraction_of(*v.rightest)},
                                   {"rightest_us", v.rightest->us},
                                   {"rightest_wrong", v.rightest->wrong.total()}});
    for (const SeedRow& r : seeds) {
        Json row{{"seed", r.seed},
                 {"method", to_string(r.method)},
                 {"setting", setting_of(r.fixed)},
                 {"cast_lost_walks", r.cast_lost_walks},
                 {"steps", r.steps}};
        put_counts(row, r.sums, r.wrong);
        out["seeds"].push_back(row);
    }
    for (const Reduction& r : reductions(seeds))
        if (!r.of_seeds.empty())
            out["reductions"].push_back({{"setting", setting_of(r.fixed)},
                                         {"cast_lost_walks", r.cast_lost_walks},
                                         {"of_seeds", r.of_seeds},
                                         {"median", r.median},
                                         {"least", r.least},
                                         {"most", r.most}});
    return out.dump() + "\n";
}

void write_results(output::OutFolder& folder, const Machine& machine, std::span<const WorkNote> works,
                   std::span<const ThresholdRow> rows) {
    std::string csv = fmt::format("{},work,source,pace_median,pace_most,size_m,method,threshold,steps,pair_steps,"
                                  "us_per_step,wall_us_per_step,{}\n",
                                  machine_columns, work_columns);
    for (const ThresholdRow& r : rows) {
        const auto work = std::find_if(works.begin(), works.end(), [&](const WorkNote& w) { return w.name == r.work; });
        const WorkNote note = work == works.end() ? WorkNote() : *work;
        csv += fmt::format("{},{},{},{:.6f},{:.6f},{:.6g},{},{},{},{},{:.3f},{:.3f},{}\n", machine_fields(machine),
                           r.work, quoted(note.source), note.pace.median, note.pace.most, r.size, to_string(r.method),
                           fraction_of(r), r.steps, r.pair_steps, r.us, r.wall_us, work_fields(r.sums, r.wrong));
    }
    write_both(folder, machine, "sweep-thresholds", csv, chart(works, rows));
}

void write_results(output::OutFolder& folder, const Machine& machine, std::span<const SeedRow> rows) {
    std::string csv = fmt::format("{},seed,method,setting,cast_lost_walks,steps,{}\n", machine_columns, work_columns);
    std::vector<report::BarGroup> groups;
    std::set<std::uint64_t> seeds;
    for (const SeedRow& r : rows) {
        csv += fmt::format("{},{},{},{},{},{},{}\n", machine_fields(machine), r.seed, to_string(r.method),
                           setting_of(r.fixed), r.cast_lost_walks ? 1 : 0, r.steps, work_fields(r.sums, r.wrong));
        if (seeds.insert(r.seed).second) groups.push_back({"seed " + std::to_string(r.seed), {}});
        groups.back().bars.emplace_back(name_of(r), wrong_a_million(r.wrong));
    }
    write_both(folder, machine, "sweep-seeds", csv,
               report::bar_chart("Wrong rays over the avalanche", "a million rays, logarithmic; none: no bar", groups));
}

} // namespace raycontact::bench
