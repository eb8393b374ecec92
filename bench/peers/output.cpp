// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/output.h>

#include <bench/peers/chart.h>
#include <bench/peers/files.h>

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
            text += fmt::format(",{},{},{},{},{},{},{},{},{},{},{}\n", r.sums.rays_cast, r.sums.walks,
                                r.sums.walks_lost, r.sums.pairs_full, r.sums.pair_bytes, r.wrong->missed,
                                r.wrong->invented, r.wrong->other_triangle, r.wrong->total(), r.wrong->rays_compared,
                                r.wrong->contacts_compared);
        else
            text += ",,,,,,,,,,,\n";
    }
    return text;
}

std::string csv(const Machine& machine, std::span<const GrowthRow> rows) {
    std::string text =
        fmt::format("{},part,size,steps,pairs,rays,contacts,narrow_ms,us_per_pair,method,rays_cast,walks,"
                    "pace_median\n",
                    machine_columns);
    for (const GrowthRow& r : rows)
        text += fmt::format("{},{},{:g},{},{:.2f},{:.2f},{:.2f},{:.5f},{:.4f},{},{:.2f},{:.2f},{:.6f}\n",
                            machine_fields(machine), r.part, r.size, r.steps, r.pairs, r.rays, r.contacts, r.narrow_ms,
                            r.us_per_pair, to_string(r.method), r.rays_cast, r.walks, r.pace);
    return text;
}

const char* unit_of(const std::string& part) {
    if (part == "bodies") return "bodies";
    if (part == "displacement") return "displacement";
    return part == "contacts" ? "triangles, contacts alike," : "triangles";
}

std::string chart(std::span<const WorkNote> works, std::span<const Result> results) {
    std::vector<BarGroup> groups;
    for (const WorkNote& work : works) {
        BarGroup& group = groups.emplace_back();
        group.name = work.name;
        for (const Result& r : results)
            if (r.work == work.name && !r.rays_alone) group.bars.emplace_back(r.peer, r.us);
    }
    return bar_chart("Microseconds a pair and step, one thread", "us, logarithmic", groups);
}

std::string chart(std::span<const GrowthRow> rows) {
    Panel panels[] = {
        {"Avalanche", "bodies", "us a pair and step", {}},
        {"Approaching pairs", "triangles a mesh", "us a pair and step", {}},
        {"Rolling pairs, contacts alike", "triangles a mesh", "us a pair and step", {}},
        {"Rolling pairs, contacts alike", "displacement a step, part of the size", "us a pair and step", {}}};
    const std::string parts[] = {"bodies", "triangles", "contacts", "displacement"};
    for (std::size_t i = 0; i < std::size(parts); ++i) {
        for (const Method method : {Method::standard, Method::predictive, Method::certified}) {
            Line& line = panels[i].lines.emplace_back();
            line.name = to_string(method);
            for (const GrowthRow& r : rows)
                if (r.part == parts[i] && r.method == method) line.points.emplace_back(r.size, r.us_per_pair);
        }
        Line& contacts = panels[i].lines.emplace_back();
        contacts.name = "contacts a pair";
        for (const GrowthRow& r : rows)
            if (r.part == parts[i] && r.method == Method::standard)
                contacts.points.emplace_back(r.size, r.contacts / std::max(r.pairs, 1e-9));
    }
    return line_chart({std::begin(panels), std::end(panels)});
}

} // namespace

std::string table(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results) {
    std::string text = heading(machine);
    for (const WorkNote& work : works) {
        text += fmt::format("\n{}: {} steps, {} pair-steps; {}\na pair moves {:.3g} % of its size a step (median; most "
                            "{:.3g} %)\n",
                            work.name, work.steps, work.pair_steps, work.source, 100 * work.pace.median,
                            100 * work.pace.most);
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
                per(r.sums.rays_cast, r.pair_steps), per(r.sums.walks, r.pair_steps),
                per(r.sums.walks_lost, r.pair_steps), 50 * per(r.sums.pairs_full, r.pair_steps),
                static_cast<double>(r.sums.pair_bytes) / 1e6, r.wrong->missed, r.wrong->invented,
                r.wrong->other_triangle, r.wrong->total(), r.wrong->rays_compared, r.wrong->contacts_compared);
        }
    }
    return text
           + "\nTimes are of one processor, medians of the runs; ratios are over the steps that both were given; rays "
             "and "
             "contacts are a pair and step; memory is the growth of the C library's heap, * the library's own count. "
             "Of "
             "ours: rays cast and followed (walks), of these lost, pairs looked at in full, memory kept for pairs; "
             "wrong against standard with every ray cast: contacts missed, invented, on another triangle.\n";
}

std::string table(const Machine& machine, std::span<const GrowthRow> rows) {
    std::string text = heading(machine);
    text += fmt::format("  {:<13}{:>9} {:<11}{:>10}{:>12}{:>11}{:>11}{:>9}{:>12}{:>10}{:>8}\n", "", "", "", "pairs",
                        "rays", "cast", "contacts", "walks", "narrow ms", "us/pair", "pace %");
    for (const GrowthRow& r : rows)
        text +=
            fmt::format("  {:<13}{:>9g} {:<11}{:>10.1f}{:>12.1f}{:>11.1f}{:>11.1f}{:>9.1f}{:>12.4f}{:>10.3f}{:>8.2f}\n",
                        r.part, r.size, to_string(r.method), r.pairs, r.rays, r.rays_cast, r.contacts, r.walks,
                        r.narrow_ms, r.us_per_pair, 100 * r.pace);
    for (const Slope& s : slopes(rows))
        text += fmt::format("us a pair grows as {} to the power of {:.2f} with {} ({:g} to {:g})\n", unit_of(s.part),
                            s.power, to_string(s.method), s.from, s.to);
    return text;
}

std::string json(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results) {
    Json out{{"machine", machine_json(machine)}, {"works", Json::array()}, {"results", Json::array()}};
    for (const WorkNote& w : works)
        out["works"].push_back({{"work", w.name},
                                {"source", w.source},
                                {"steps", w.steps},
                                {"pair_steps", w.pair_steps},
                                {"pace_median", w.pace.median},
                                {"pace_most", w.pace.most}});
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
        result["rays_cast"] = r.sums.rays_cast;
        result["walks"] = r.sums.walks;
        result["walks_lost"] = r.sums.walks_lost;
        result["pairs_full"] = r.sums.pairs_full;
        result["pair_bytes"] = r.sums.pair_bytes;
        result["wrong_rays"] = {{"total", r.wrong->total()},
                                {"missed", r.wrong->missed},
                                {"invented", r.wrong->invented},
                                {"other_triangle", r.wrong->other_triangle}};
        result["rays_compared"] = r.wrong->rays_compared;
        result["contacts_compared"] = r.wrong->contacts_compared;
    }
    return out.dump() + "\n";
}

std::string json(const Machine& machine, std::span<const GrowthRow> rows) {
    Json out{{"machine", machine_json(machine)}, {"rows", Json::array()}};
    for (const GrowthRow& r : rows)
        out["rows"].push_back({{"part", r.part},
                               {"size", r.size},
                               {"method", to_string(r.method)},
                               {"steps", r.steps},
                               {"pairs", r.pairs},
                               {"rays", r.rays},
                               {"contacts", r.contacts},
                               {"narrow_ms", r.narrow_ms},
                               {"us_per_pair", r.us_per_pair},
                               {"rays_cast", r.rays_cast},
                               {"walks", r.walks},
                               {"pace_median", r.pace}});
    out["slopes"] = Json::array();
    for (const Slope& s : slopes(rows))
        out["slopes"].push_back(
            {{"part", s.part}, {"method", to_string(s.method)}, {"power", s.power}, {"from", s.from}, {"to", s.to}});
    return out.dump() + "\n";
}

std::filesystem::path write_results(const std::filesystem::path& folder, const Machine& machine,
                                    std::span<const WorkNote> works, std::span<const Result> results) {
    return write_both(folder, machine, "peers", csv(machine, works, results), chart(works, results));
}

std::filesystem::path write_results(const std::filesystem::path& folder, const Machine& machine,
                                    std::span<const GrowthRow> rows) {
    return write_both(folder, machine, "growth", csv(machine, rows), chart(rows));
}

} // namespace raycontact::bench
