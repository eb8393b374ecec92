// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/contest.h>

#include <bench/peers/reference.h>
#include <raycontact/contact.h>
#include <report/plot.h>
#include <scenes/peers/clock.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace raycontact::bench {

namespace {

/// Bytes the C library's allocator has handed out and not got back; 0 where it cannot be asked.
std::uint64_t heap_in_use() {
#if defined(__GLIBC__)
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
#else
    return 0;
#endif
}

/// An entrant at work.
struct Runner {
    const Entrant* entrant = nullptr;
    std::unique_ptr<Peer> peer;
    std::vector<std::size_t> steps;        ///< of the work, that it is given
    std::vector<std::vector<Times>> times; ///< of each run, of each of these
    Found found;
    std::uint64_t memory = 0;
    StepStats sums;
    std::vector<std::string> hashes; ///< of each of its steps; ours only
    std::string hash;
    std::optional<recording::WrongRays> wrong;

    void run(const Work& work, bool first) {
        std::vector<Times>& row = times.emplace_back();
        peer->restart(work.steps[steps.front()]);
        for (const std::size_t k : steps) {
            peer->prepare(work.steps[k]);
            const Times start = now();
            const Found one = peer->detect(work.steps[k]);
            const Times end = now();
            row.push_back({end.cpu - start.cpu, end.wall - start.wall});
            if (!first) continue;
            found.rays += one.rays;
            found.contacts += one.contacts;
            found.depth_sum += one.depth_sum;
        }
    }

    /// One run that is not timed: what was done, and whether it was right.
    void check(const Work& work, Reference& reference) {
        const Scene* scene = peer->scene();
        if (!scene) return;
        ContactHash all;
        wrong.emplace();
        peer->restart(work.steps[steps.front()]);
        for (const std::size_t k : steps) {
            peer->prepare(work.steps[k]);
            peer->detect(work.steps[k]);
            add(sums, scene->stats());
            reference.compare(k, scene->contacts(), *wrong);
            all.add(static_cast<std::uint32_t>(k), scene->contacts());
            ContactHash one;
            one.add(static_cast<std::uint32_t>(k), scene->contacts());
            hashes.push_back(one.hex());
        }
        hash = all.hex();
    }

    /// Median over the runs, of those of its steps that `other` was given too; nothing where there are none.
    std::optional<double> total(const Runner& other, double Times::*which) const {
        std::vector<double> totals;
        for (const auto& row : times) {
            std::optional<double> sum;
            for (std::size_t i = 0; i < row.size(); ++i)
                if (std::binary_search(other.steps.begin(), other.steps.end(), steps[i]))
                    sum = sum.value_or(0) + row[i].*which;
            if (!sum) return {};
            totals.push_back(*sum);
        }
        return median(totals);
    }

    double ratio_to(const Runner* other) const {
        if (!other) return 0;
        const auto own = total(*other, &Times::cpu), theirs = other->total(*this, &Times::cpu);
        return own && theirs && *theirs > 0 ? *own / *theirs : 0;
    }
};

/// The hashes of the steps that both saw are the same.
bool same_bits(const Runner& one, const Runner& other) {
    for (std::size_t i = 0; i < one.hashes.size(); ++i) {
        const auto at = std::lower_bound(other.steps.begin(), other.steps.end(), one.steps[i]) - other.steps.begin();
        const auto j = static_cast<std::size_t>(at);
        if (j < other.hashes.size() && other.steps[j] == one.steps[i] && one.hashes[i] != other.hashes[j]) return false;
    }
    return true;
}

const Runner* find(const std::vector<Runner>& runners, const std::string& name) {
    const auto it =
        std::find_if(runners.begin(), runners.end(), [&](const Runner& r) { return r.entrant->name == name; });
    return it == runners.end() ? nullptr : &*it;
}

Result figures(const Work& work, const Runner& runner, const std::vector<Runner>& runners) {
    Result r;
    r.work = work.name;
    r.peer = runner.entrant->name;
    r.what = runner.entrant->what;
    r.rays_alone = runner.entrant->rays_alone;
    r.steps = static_cast<std::uint32_t>(runner.steps.size());
    for (const std::size_t k : runner.steps) r.pair_steps += work.steps[k].pairs.size();
    const double pair_steps = static_cast<double>(std::max<std::uint64_t>(r.pair_steps, 1));
    r.us = runner.total(runner, &Times::cpu).value_or(0) / pair_steps;
    r.wall_us = runner.total(runner, &Times::wall).value_or(0) / pair_steps;
    const Runner* ours = find(runners, r.rays_alone ? "rays" : "bvh");
    r.ratio = runner.ratio_to(ours);
    for (std::size_t m = 0; m < coherent_methods.size() && !r.rays_alone; ++m)
        r.method_ratios[m] = runner.ratio_to(find(runners, coherent_methods[m]));
    r.agrees = !runner.entrant->exact || !ours || same_bits(runner, *ours);
    r.rays = runner.found.rays;
    r.contacts = runner.found.contacts;
    r.depth_sum = runner.found.depth_sum;
    r.memory_bytes = runner.memory + runner.peer->shared_memory();
    if (const auto own = runner.peer->own_memory()) {
        r.memory_bytes = *own;
        r.memory_is_own_count = true;
    }
    r.hash = runner.hash;
    r.sums = runner.sums;
    r.wrong = runner.wrong;
    return r;
}

double per(std::uint64_t what, std::uint64_t of) {
    return static_cast<double>(what) / static_cast<double>(std::max<std::uint64_t>(of, 1));
}

double ns_per_ray(const Result& r) {
    return 1000 * r.us * static_cast<double>(r.pair_steps) / static_cast<double>(std::max<std::uint64_t>(r.rays, 1));
}

std::string hash_of(const Result& r) {
    if (!r.agrees) return "DIFFERS from bvh";
    return r.peer == "basic" && r.ratio > 0 ? "same bits as bvh" : r.hash;
}

} // namespace

std::vector<Result> contest(const Work& work, const std::vector<Entrant>& entrants, std::uint32_t runs,
                            const Progress& progress) {
    if (work.steps.empty()) return {};
    progress(work.name + ": what standard finds");
    std::map<Features, Reference> references; // by what is asked, made when somebody needs it
    std::vector<Runner> runners;
    for (const Entrant& entrant : entrants) {
        if (!entrant.make) continue;
        progress(work.name + ": " + entrant.name + ", warming up");
        Runner& runner = runners.emplace_back();
        runner.entrant = &entrant;
        for (std::size_t k = 0; k < work.steps.size(); ++k)
            if (is_given(entrant, work, k)) runner.steps.push_back(k);
        const std::uint64_t before = heap_in_use();
        runner.peer = entrant.make(work);
        // The first, a middle and the last of its steps: pages touched, arrays grown, algorithms made.
        const std::size_t count = runner.steps.size();
        for (const std::size_t i : {std::size_t{0}, count / 2, count - 1}) {
            const WorkStep& step = work.steps[runner.steps[i]];
            runner.peer->prepare(step);
            runner.peer->detect(step);
        }
        const std::uint64_t after = heap_in_use();
        runner.memory = after > before ? after - before : 0;
        if (const Scene* scene = runner.peer->scene()) {
            const Features asked = scene->settings().features;
            runner.check(work, references.try_emplace(asked, work, asked).first->second);
        }
    }
    for (std::uint32_t run = 0; run < runs; ++run) {
        for (Runner& runner : runners) {
            progress(work.name + ": run " + std::to_string(run + 1) + " of " + std::to_string(runs) + ", "
                     + runner.entrant->name);
            runner.run(work, run == 0);
        }
    }
    std::vector<Result> results;
    results.reserve(runners.size());
    for (const Runner& runner : runners) results.push_back(figures(work, runner, runners));
    return results;
}

std::string table(const Json& works, std::span<const Result> results) {
    std::string text;
    for (const Json& note : works) {
        const auto work = note["work"].get<std::string>();
        text += heading_of(note);
        text += fmt::format("  {:<16}{:>10}{:>10} | {:>8}{:>13}{:>12}{:>12} | {:>10}{:>10}{:>11}  {}\n", "", "us/pair",
                            "wall us", "x bvh", "x iterative", "x predict.", "x certif.", "rays/pair", "contacts",
                            "memory MB", "hash");
        for (const Result& r : results) {
            if (r.work != work || r.rays_alone) continue;
            text += fmt::format(
                "  {:<16}{:>10.3f}{:>10.3f} | {:>8.2f}{:>13.2f}{:>12.2f}{:>12.2f} | {:>10.2f}{:>10.3f}{:>10.2f}{} {}\n",
                r.peer, r.us, r.wall_us, r.ratio, r.method_ratios[0], r.method_ratios[1], r.method_ratios[2],
                per(r.rays, r.pair_steps), per(r.contacts, r.pair_steps), static_cast<double>(r.memory_bytes) / 1e6,
                r.memory_is_own_count ? '*' : ' ', hash_of(r));
        }
        for (const Result& r : results) {
            if (r.work != work || !r.rays_alone) continue;
            text +=
                fmt::format("  {:<16}{:>7.1f} ns a ray, {:.2f} x rays, {:.1f} rays and {:.2f} contacts a pair\n",
                            r.peer, ns_per_ray(r), r.ratio, per(r.rays, r.pair_steps), per(r.contacts, r.pair_steps));
        }
        if (std::none_of(results.begin(), results.end(),
                         [&](const Result& r) { return r.work == work && r.wrong.has_value(); }))
            continue;
        text += fmt::format("  {:<16}{:>10}{:>10}{:>10}{:>10}{:>10} | {:>8}{:>9}{:>8}{:>8}{:>14}{:>12}\n", "ours",
                            "cast/pair", "walks", "lost", "full %", "kept MB", "missed", "invented", "other", "wrong",
                            "of rays", "of contacts");
        for (const Result& r : results) {
            if (r.work != work || !r.wrong) continue;
            text += fmt::format(
                "  {:<16}{:>10.3f}{:>10.3f}{:>10.4f}{:>10.2f}{:>10.2f} | {:>8}{:>9}{:>8}{:>8}{:>14}{:>12}\n", r.peer,
                per(r.sums.details.rays_cast, r.pair_steps), per(r.sums.details.walks, r.pair_steps),
                per(r.sums.details.walks_lost, r.pair_steps), 50 * per(r.sums.details.pairs_full, r.pair_steps),
                static_cast<double>(r.sums.pair_bytes) / 1e6, r.wrong->missed, r.wrong->invented,
                r.wrong->other_triangle, r.wrong->total(), r.wrong->rays_compared, r.wrong->contacts_compared);
        }
    }
    return text
           + "\nTimes are of one processor, medians of the runs; ratios are over the steps that both were given; rays "
             "and contacts are a pair and step; memory is the growth of the C library's heap, * the library's own "
             "count. Of ours: rays cast and followed (walks), of these lost, pairs tested in full, memory kept for "
             "pairs; wrong against standard with every ray cast: contacts missed, invented, on another triangle.\n";
}

Json json(const Result& r) {
    Json row{{"work", r.work},
             {"peer", r.peer},
             {"what", r.what},
             {"steps", r.steps},
             {"pair_steps", r.pair_steps},
             {"us_per_pair_step", r.us},
             {"wall_us_per_pair_step", r.wall_us},
             {"times_ours", r.ratio},
             {"rays", r.rays},
             {"contacts", r.contacts},
             {"memory_bytes", r.memory_bytes},
             {"memory_count", r.memory_is_own_count ? "own" : "heap"},
             {"hash", r.hash},
             {"agrees", r.agrees}};
    for (std::size_t m = 0; m < coherent_methods.size(); ++m)
        row[std::string("times_") + coherent_methods[m]] = r.method_ratios[m];
    if (r.wrong) put_counts(row, r.sums, *r.wrong);
    return row;
}

std::string chart(const Json& works, std::span<const Result> results) {
    std::vector<report::BarGroup> groups;
    for (const Json& work : works) {
        report::BarGroup& group = groups.emplace_back();
        group.name = work["work"];
        for (const Result& r : results)
            if (r.work == group.name && !r.rays_alone) group.bars.emplace_back(r.peer, r.us);
    }
    return report::bar_chart("Microseconds a pair and step, one thread", "us, logarithmic", groups);
}

} // namespace raycontact::bench
