// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/thresholds.h>

#include <bench/peers/reference.h>
#include <bench/peers/sums.h>
#include <scenes/peers/clock.h>

#include <cmath>

namespace raycontact::bench {

namespace {

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

} // namespace

std::vector<ThresholdRow> sweep_thresholds(const Work& work, const ThresholdOptions& options,
                                           const std::function<void(const std::string&)>& progress) {
    if (work.steps.empty()) return {};
    progress(work.name + ": what standard finds");
    Reference reference(work);
    const double size = body_size(work);
    std::vector<Contender> all;
    all.push_back(contender(work, Method::standard, {}, size));
    for (const Method method : {Method::iterative, Method::predictive, Method::certified}) {
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

} // namespace raycontact::bench
