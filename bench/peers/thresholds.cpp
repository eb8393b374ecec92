// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/thresholds.h>

#include <bench/peers/reference.h>
#include <report/plot.h>
#include <scenes/peers/clock.h>

#include <fmt/format.h>

#include <cmath>

namespace raycontact::bench {

namespace {

constexpr Method swept[] = {Method::iterative, Method::predictive, Method::certified};
constexpr double least = 1e-4, most = 1e-1; // of the body's size

struct Contender {
    ThresholdRow row;
    std::unique_ptr<Scene> scene;
    std::vector<double> cpu, wall; // microseconds a step, of each run

    /// Not timed: contacts compared, counts taken, and everything warm.
    void check(const Work& work, Reference& reference) {
        rest(*scene, work.steps.front());
        for (std::size_t k = 0; k < work.steps.size(); ++k) {
            place(*scene, work.steps[k]);
            reference.compare(k, scene->find_contacts(work.steps[k].pairs), row.wrong);
            add(row.sums, scene->stats());
        }
    }

    void run(const Work& work) {
        rest(*scene, work.steps.front());
        const Times start = now();
        for (const WorkStep& step : work.steps) {
            place(*scene, step);
            scene->find_contacts(step.pairs);
        }
        const Times end = now();
        const auto steps = static_cast<double>(work.steps.size());
        cpu.push_back((end.cpu - start.cpu) / steps);
        wall.push_back((end.wall - start.wall) / steps);
    }
};

Contender contender(const Work& work, Method method, std::optional<double> fraction, double size) {
    Contender one;
    one.row.work = work.name;
    one.row.method = method;
    one.row.fraction = fraction;
    one.row.size = size;
    one.row.steps = static_cast<std::uint32_t>(work.steps.size());
    one.row.pair_steps = work.pair_steps();
    Settings settings = one_thread(method);
    if (fraction) {
        settings.paper.displacement_threshold = *fraction * size;
    }
    one.scene = make_scene(work, settings);
    return one;
}

std::string fraction_of(const ThresholdRow& row) {
    if (row.method == Method::standard) return "none";
    return row.fraction ? fmt::format("{:.3g}", *row.fraction) : "auto";
}

std::string say(const ThresholdRow* row) {
    if (!row) return "none";
    return fmt::format("{} with {:.1f} us a step and {} wrong", fraction_of(*row), row->us, row->wrong.total());
}

} // namespace

std::vector<ThresholdRow> sweep_thresholds(const Work& work, const ThresholdOptions& options,
                                           const Progress& progress) {
    if (work.steps.empty()) return {};
    progress(work.name + ": what standard finds");
    Reference reference(work);
    const double size = body_size(work);
    std::vector<Contender> all;
    all.push_back(contender(work, Method::standard, {}, size));
    for (const Method method : swept) {
        for (std::uint32_t i = 0; i < options.values; ++i) {
            const double part = options.values > 1 ? i / (options.values - 1.0) : 0.5;
            all.push_back(contender(work, method, least * std::pow(most / least, part), size));
        }
        all.push_back(contender(work, method, {}, size));
    }
    std::size_t done = 0;
    const auto tell = [&](const std::string& what, const Contender& one) {
        progress(work.name + ": " + what + " " + std::string(to_string(one.row.method)) + ", " + std::to_string(++done)
                 + " of " + std::to_string(all.size() * (options.runs + 1)));
    };
    for (Contender& one : all) {
        tell("comparing", one);
        one.check(work, reference);
    }
    for (std::uint32_t run = 0; run < options.runs; ++run) {
        for (Contender& one : all) {
            tell("timing", one);
            one.run(work);
        }
    }
    std::vector<ThresholdRow> rows;
    for (Contender& one : all) {
        one.row.us = median(one.cpu);
        one.row.wall_us = median(one.wall);
        rows.push_back(one.row);
    }
    return rows;
}

std::vector<Verdict> verdicts(std::span<const ThresholdRow> rows) {
    std::vector<Verdict> all;
    for (const ThresholdRow& chosen : rows) {
        if (chosen.fraction || chosen.method == Method::standard) continue;
        Verdict verdict;
        verdict.work = chosen.work;
        verdict.method = chosen.method;
        verdict.chosen = &chosen;
        for (const ThresholdRow& row : rows) {
            if (row.work != chosen.work || row.method != chosen.method || !row.fraction) continue;
            const std::uint64_t wrong = row.wrong.total();
            if (!verdict.fastest || row.us < verdict.fastest->us) verdict.fastest = &row;
            if (wrong <= chosen.wrong.total() && (!verdict.as_right || row.us < verdict.as_right->us))
                verdict.as_right = &row;
            const ThresholdRow* best = verdict.rightest;
            if (!best || wrong < best->wrong.total() || (wrong == best->wrong.total() && row.us < best->us))
                verdict.rightest = &row;
        }
        if (verdict.fastest) all.push_back(verdict);
    }
    return all;
}

std::string table(const Json& works, std::span<const ThresholdRow> rows) {
    std::string text;
    for (const Json& note : works) {
        const auto work = note["work"].get<std::string>();
        text += heading_of(note);
        text += fmt::format("  {:<12}{:>10}{:>12}{:>12}{:>12}{:>12}{:>12} | {:>9}{:>9}{:>9}{:>9}\n", "", "threshold",
                            "us/step", "full tests", "cast", "walks", "lost", "missed", "invented", "other", "wrong");
        for (const ThresholdRow& r : rows) {
            if (r.work != work) continue;
            text += fmt::format("  {:<12}{:>10}{:>12.1f}{:>12}{:>12}{:>12}{:>12} | {:>9}{:>9}{:>9}{:>9}\n",
                                to_string(r.method), fraction_of(r), r.us, r.sums.details.pairs_full,
                                r.sums.details.rays_cast, r.sums.details.walks, r.sums.details.walks_lost,
                                r.wrong.missed, r.wrong.invented, r.wrong.other_triangle, r.wrong.total());
        }
        for (const ThresholdRow& r : rows)
            if (r.work == work && r.method == Method::standard)
                text += fmt::format("  wrong of {} rays and {} contacts; thresholds in parts of {:.3g} m\n",
                                    r.wrong.rays_compared, r.wrong.contacts_compared, r.size);
        for (const Verdict& v : verdicts(rows)) {
            if (v.work != work) continue;
            text += fmt::format(
                "  {}: {}\n    fastest fixed: {} (auto takes {:.2f} of its time)\n    fastest fixed with no more "
                "wrong: {}{}\n    fewest wrong: {} (auto takes {:.2f} of its time)\n",
                to_string(v.method), say(v.chosen), say(v.fastest), v.chosen->us / v.fastest->us, say(v.as_right),
                v.as_right ? fmt::format(" (auto takes {:.2f} of its time)", v.chosen->us / v.as_right->us) : "",
                say(v.rightest), v.chosen->us / v.rightest->us);
        }
    }
    return text + "\nTimes are of one processor, medians of the runs; counts are over all steps.\n";
}

Json json(const ThresholdRow& r) {
    Json row{{"work", r.work},
             {"method", to_string(r.method)},
             {"threshold", fraction_of(r)},
             {"size", r.size},
             {"size_m", r.size},
             {"steps", r.steps},
             {"pair_steps", r.pair_steps},
             {"us_per_step", r.us},
             {"wall_us_per_step", r.wall_us}};
    put_counts(row, r.sums, r.wrong);
    return row;
}

Json json(const Verdict& v) {
    return {{"work", v.work},
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
            {"rightest_wrong", v.rightest->wrong.total()}};
}

std::string chart(const Json& works, std::span<const ThresholdRow> rows) {
    std::vector<report::Plot> plots;
    for (const Json& note : works) {
        const auto work = note["work"].get<std::string>();
        const std::string over = "displacement threshold, part of the size";
        report::Plot time{work, "us a step", "Dashed: with thresholds that the method chose.", {}, over, true};
        report::Plot wrong{work, "wrong rays a million", "Where none was wrong there is no point.", {}, over, true};
        for (std::size_t m = 0; m < std::size(swept); ++m) {
            report::Line line_time{std::string(to_string(swept[m])), {}, m}, line_wrong = line_time;
            for (const ThresholdRow& row : rows) {
                if (row.work != work || row.method != swept[m] || !row.fraction) continue;
                line_time.points.emplace_back(*row.fraction, row.us);
                line_wrong.points.emplace_back(*row.fraction, 1e4 * row.wrong.percent());
            }
            const auto ends = [&](double value) {
                report::Line line{line_time.name + ", chosen", {}, m, true};
                if (line_time.points.empty()) return line;
                line.points = {{line_time.points.front().first, value}, {line_time.points.back().first, value}};
                return line;
            };
            for (const ThresholdRow& row : rows) {
                if (row.work != work || row.method != swept[m] || row.fraction) continue;
                time.lines.push_back(line_time);
                time.lines.push_back(ends(row.us));
                wrong.lines.push_back(line_wrong);
                wrong.lines.push_back(ends(1e4 * row.wrong.percent()));
            }
        }
        plots.push_back(time);
        plots.push_back(wrong);
    }
    return report::plot_svg(plots);
}

} // namespace raycontact::bench
