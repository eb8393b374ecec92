// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/output.h>

#include <bench/peers/chart.h>
#include <raycontact/error.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

namespace raycontact::bench {

namespace {

using Json = nlohmann::ordered_json;

double per(std::uint64_t what, std::uint64_t of) {
    return static_cast<double>(what) / static_cast<double>(std::max<std::uint64_t>(of, 1));
}

double ns_per_ray(const Result& r) {
    return 1000 * r.us * static_cast<double>(r.pair_steps) / static_cast<double>(std::max<std::uint64_t>(r.rays, 1));
}

std::string heading(const Machine& m) {
    return fmt::format("{}, {}, {} cores, governor {}, load {:.2f}; built by {} from {}\n", m.date, m.cpu, m.cores,
                       m.governor, m.load, m.compiler, m.commit);
}

Json machine_json(const Machine& m) {
    return {{"date", m.date},         {"commit", m.commit},     {"cpu", m.cpu},  {"cores", m.cores},
            {"compiler", m.compiler}, {"governor", m.governor}, {"load", m.load}};
}

std::string quoted(const std::string& text) {
    std::string field = "\"";
    for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
    return field + '"';
}

constexpr const char* machine_columns = "date,commit,cpu,cores,compiler,governor,load";
std::string machine_fields(const Machine& m) {
    return fmt::format("{},{},{},{},{},{},{:.2f}", m.date, m.commit, quoted(m.cpu), m.cores, quoted(m.compiler),
                       m.governor, m.load);
}

std::string hash_of(const Result& r) {
    if (!r.agrees) return "DIFFERS from bvh";
    return r.peer == "basic" && r.ratio > 0 ? "same bits as bvh" : r.hash;
}

std::string csv(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results) {
    std::string text = fmt::format("{},work,source,peer,what,steps,pair_steps,us_per_pair_step,wall_us_per_pair_step,"
                                   "times_ours,rays,contacts,memory_bytes,memory_count,hash\n",
                                   machine_columns);
    for (const Result& r : results) {
        const auto work = std::find_if(works.begin(), works.end(), [&](const WorkNote& w) { return w.name == r.work; });
        text += fmt::format("{},{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{},{},{},{},{}\n", machine_fields(machine),
                            r.work, quoted(work == works.end() ? "" : work->source), r.peer, quoted(r.what), r.steps,
                            r.pair_steps, r.us, r.wall_us, r.ratio, r.rays, r.contacts, r.memory_bytes,
                            r.memory_is_own_count ? "own" : "heap", r.hash);
    }
    return text;
}

std::string csv(const Machine& machine, std::span<const GrowthRow> rows) {
    std::string text = fmt::format("{},part,size,steps,pairs,rays,contacts,narrow_ms,us_per_pair\n", machine_columns);
    for (const GrowthRow& r : rows)
        text += fmt::format("{},{},{},{},{:.2f},{:.2f},{:.2f},{:.5f},{:.4f}\n", machine_fields(machine), r.part, r.size,
                            r.steps, r.pairs, r.rays, r.contacts, r.narrow_ms, r.us_per_pair);
    return text;
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
    Panel bodies{"Avalanche",
                 "bodies",
                 "a step, one scale for all",
                 {{"pairs", {}}, {"rays", {}}, {"contacts", {}}, {"narrow phase, us", {}}}};
    Panel triangles{
        "Approaching pairs", "triangles a mesh", "a pair and step", {{"rays", {}}, {"contacts", {}}, {"us", {}}}};
    for (const GrowthRow& r : rows) {
        if (r.part == "bodies") {
            bodies.lines[0].points.emplace_back(r.size, r.pairs);
            bodies.lines[1].points.emplace_back(r.size, r.rays);
            bodies.lines[2].points.emplace_back(r.size, r.contacts);
            bodies.lines[3].points.emplace_back(r.size, 1000 * r.narrow_ms);
        } else {
            const double pairs = std::max(r.pairs, 1e-9);
            triangles.lines[0].points.emplace_back(r.size, r.rays / pairs);
            triangles.lines[1].points.emplace_back(r.size, r.contacts / pairs);
            triangles.lines[2].points.emplace_back(r.size, r.us_per_pair);
        }
    }
    return line_chart({bodies, triangles});
}

void write_file(const std::filesystem::path& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) throw InputError(file.string() + ": cannot be written; name another folder with --out");
}

std::filesystem::path write_both(const std::filesystem::path& folder, const Machine& machine, const std::string& name,
                                 const std::string& csv_text, const std::string& svg) {
    const std::filesystem::path where = folder / machine.slug;
    std::error_code error;
    std::filesystem::create_directories(where, error);
    if (error) throw InputError("--out " + folder.string() + ": cannot be made a folder; name another");
    std::filesystem::path file = where / (name + "-" + machine.date + ".csv");
    write_file(file, csv_text);
    write_file(where / (name + "-" + machine.date + ".svg"), svg);
    return file;
}

} // namespace

std::string table(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results) {
    std::string text = heading(machine);
    for (const WorkNote& work : works) {
        text += fmt::format("\n{}: {} steps, {} pair-steps; {}\n", work.name, work.steps, work.pair_steps, work.source);
        text += fmt::format("  {:<12}{:>12}{:>10}{:>9}{:>11}{:>11}{:>11}  {}\n", "", "us/pair", "wall us", "x ours",
                            "rays/pair", "contacts", "memory MB", "hash");
        for (const Result& r : results) {
            if (r.work != work.name || r.rays_alone) continue;
            text +=
                fmt::format("  {:<12}{:>12.2f}{:>10.2f}{:>9.2f}{:>11.1f}{:>11.2f}{:>10.2f}{} {}\n", r.peer, r.us,
                            r.wall_us, r.ratio, per(r.rays, r.pair_steps), per(r.contacts, r.pair_steps),
                            static_cast<double>(r.memory_bytes) / 1e6, r.memory_is_own_count ? '*' : ' ', hash_of(r));
        }
        for (const Result& r : results) {
            if (r.work != work.name || !r.rays_alone) continue;
            text += fmt::format("  {:<12}{:>9.1f} ns a ray{:>11.2f}{:>11.1f}{:>11.2f}\n", r.peer, ns_per_ray(r),
                                r.ratio, per(r.rays, r.pair_steps), per(r.contacts, r.pair_steps));
        }
    }
    return text
           + "\nTimes are of one processor, medians of the runs; rays and contacts are a pair and step; memory is "
             "the growth of the C library's heap, * the library's own count.\n";
}

std::string table(const Machine& machine, std::span<const GrowthRow> rows) {
    std::string text = heading(machine);
    text += fmt::format("  {:<10}{:>9}{:>11}{:>12}{:>11}{:>12}{:>10}\n", "", "", "pairs", "rays", "contacts",
                        "narrow ms", "us/pair");
    for (const GrowthRow& r : rows)
        text += fmt::format("  {:<10}{:>9}{:>11.1f}{:>12.1f}{:>11.1f}{:>12.4f}{:>10.3f}\n", r.part, r.size, r.pairs,
                            r.rays, r.contacts, r.narrow_ms, r.us_per_pair);
    return text;
}

std::string json(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results) {
    Json out{{"machine", machine_json(machine)}, {"works", Json::array()}, {"results", Json::array()}};
    for (const WorkNote& w : works)
        out["works"].push_back(
            {{"work", w.name}, {"source", w.source}, {"steps", w.steps}, {"pair_steps", w.pair_steps}});
    for (const Result& r : results)
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
    return out.dump() + "\n";
}

std::string json(const Machine& machine, std::span<const GrowthRow> rows) {
    Json out{{"machine", machine_json(machine)}, {"rows", Json::array()}};
    for (const GrowthRow& r : rows)
        out["rows"].push_back({{"part", r.part},
                               {"size", r.size},
                               {"steps", r.steps},
                               {"pairs", r.pairs},
                               {"rays", r.rays},
                               {"contacts", r.contacts},
                               {"narrow_ms", r.narrow_ms},
                               {"us_per_pair", r.us_per_pair}});
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
