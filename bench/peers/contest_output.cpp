// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/contest_output.h>

#include <bench/peers/files.h>
#include <report/bars.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace raycontact::bench {

namespace {

using Json = nlohmann::ordered_json;

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

std::string csv(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results) {
    // The columns of earlier results come first, so that both can be read alike.
    std::string text = fmt::format("{},work,source,peer,what,steps,pair_steps,us_per_pair_step,wall_us_per_pair_step,"
                                   "times_ours,rays,contacts,memory_bytes,memory_count,hash,times_iterative,"
                                   "times_predictive,times_certified,pace_median,pace_most,rays_cast,walks,walks_lost,"
                                   "pairs_full,pair_bytes,missed,invented,other_triangle,wrong,rays_compared,"
                                   "contacts_compared\n",
                                   machine_columns);
    for (const Result& r : results) {
        const auto work = std::find_if(works.begin(), works.end(), [&](const WorkNote& w) { return w.name == r.work; });
        const Pace pace = work == works.end() ? Pace() : work->pace;
        text +=
            fmt::format("{},{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{:.6f},{:.6f}",
                        machine_fields(machine), r.work, quoted(work == works.end() ? "" : work->source), r.peer,
                        quoted(r.what), r.steps, r.pair_steps, r.us, r.wall_us, r.ratio, r.rays, r.contacts,
                        r.memory_bytes, r.memory_is_own_count ? "own" : "heap", r.hash, r.method_ratios[0],
                        r.method_ratios[1], r.method_ratios[2], pace.median, pace.most);
        if (r.wrong)
            text += fmt::format(",{},{},{},{},{},{},{},{},{},{},{}\n", r.sums.details.rays_cast, r.sums.details.walks,
                                r.sums.details.walks_lost, r.sums.details.pairs_full, r.sums.pair_bytes,
                                r.wrong->missed, r.wrong->invented, r.wrong->other_triangle, r.wrong->total(),
                                r.wrong->rays_compared, r.wrong->contacts_compared);
        else
            text += ",,,,,,,,,,,\n";
    }
    return text;
}

std::string chart(std::span<const WorkNote> works, std::span<const Result> results) {
    std::vector<report::BarGroup> groups;
    for (const WorkNote& work : works) {
        report::BarGroup& group = groups.emplace_back();
        group.name = work.name;
        for (const Result& r : results)
            if (r.work == work.name && !r.rays_alone) group.bars.emplace_back(r.peer, r.us);
    }
    return report::bar_chart("Microseconds a pair and step, one thread", "us, logarithmic", groups);
}

} // namespace

std::string table(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results) {
    std::string text = heading(machine);
    for (const WorkNote& work : works) {
        text += heading(work);
        text += fmt::format("  {:<16}{:>10}{:>10} | {:>8}{:>13}{:>12}{:>12} | {:>10}{:>10}{:>11}  {}\n", "", "us/pair",
                            "wall us", "x bvh", "x iterative", "x predict.", "x certif.", "rays/pair", "contacts",
                            "memory MB", "hash");
        for (const Result& r : results) {
            if (r.work != work.name || r.rays_alone) continue;
            text +=
                fmt::format("  {:<16}{:>10.3f}{:>10.3f} | {:>8.2f}{:>13.2f}{:>12.2f}{:>12.2f} | "
                            "{:>10.2f}{:>10.3f}{:>10.2f}{} {}\n",
                            r.peer, r.us, r.wall_us, r.ratio, r.method_ratios[0], r.method_ratios[1],
                            r.method_ratios[2], per(r.rays, r.pair_steps), per(r.contacts, r.pair_steps),
                            static_cast<double>(r.memory_bytes) / 1e6, r.memory_is_own_count ? '*' : ' ', hash_of(r));
        }
        for (const Result& r : results) {
            if (r.work != work.name || !r.rays_alone) continue;
            text +=
                fmt::format("  {:<16}{:>7.1f} ns a ray, {:.2f} x rays, {:.1f} rays and {:.2f} contacts a pair\n",
                            r.peer, ns_per_ray(r), r.ratio, per(r.rays, r.pair_steps), per(r.contacts, r.pair_steps));
        }
        if (std::none_of(results.begin(), results.end(),
                         [&](const Result& r) { return r.work == work.name && r.wrong.has_value(); }))
            continue;
        text += fmt::format("  {:<16}{:>10}{:>10}{:>10}{:>10}{:>10} | {:>8}{:>9}{:>8}{:>8}{:>14}{:>12}\n", "ours",
                            "cast/pair", "walks", "lost", "full %", "kept MB", "missed", "invented", "other", "wrong",
                            "of rays", "of contacts");
        for (const Result& r : results) {
            if (r.work != work.name || !r.wrong) continue;
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
             "and "
             "contacts are a pair and step; memory is the growth of the C library's heap, * the library's own count. "
             "Of "
             "ours: rays cast and followed (walks), of these lost, pairs tested in full, memory kept for pairs; "
             "wrong against standard with every ray cast: contacts missed, invented, on another triangle.\n";
}

std::string json(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results) {
    Json out{{"machine", machine_json(machine)}, {"works", works_json(works)}, {"results", Json::array()}};
    for (const Result& r : results) {
        out["results"].push_back({{"work", r.work},
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
                                  {"agrees", r.agrees}});
        Json& result = out["results"].back();
        for (std::size_t m = 0; m < coherent_methods.size(); ++m)
            result[std::string("times_") + coherent_methods[m]] = r.method_ratios[m];
        if (!r.wrong) continue;
        put_counts(result, r.sums, *r.wrong);
    }
    return out.dump() + "\n";
}

void write_results(output::OutFolder& folder, const Machine& machine, std::span<const WorkNote> works,
                   std::span<const Result> results) {
    write_both(folder, machine, "peers", csv(machine, works, results), chart(works, results));
}

} // namespace raycontact::bench
