// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/growth_output.h>

#include <bench/peers/files.h>
#include <report/plot.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace raycontact::bench {

namespace {

using Json = nlohmann::ordered_json;

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

std::string unit_of(const std::string& part) {
    if (only_mesh_grows(part)) return "triangles (" + part + ")";
    return part;
}

std::string chart(std::span<const GrowthRow> rows) {
    struct Part {
        const char *part, *title, *over;
    };
    std::vector<report::Plot> plots;
    for (const Part& part :
         {Part{"bodies", "Avalanche", "bodies"}, Part{"triangles", "Approaching pairs", "triangles a mesh"},
          Part{"contacts", "Rolling pairs, contacts alike", "triangles a mesh"},
          Part{"creeping", "Creeping pairs, contacts alike", "triangles a mesh"},
          Part{"still", "The same pairs, still", "triangles a mesh"},
          Part{"displacement", "Rolling pairs, contacts alike", "displacement a step, part of the size"}}) {
        report::Plot& plot = plots.emplace_back();
        plot.title = part.title;
        plot.unit = "us a pair and step";
        plot.over = part.over;
        plot.logarithmic = true;
        for (const Method method : {Method::standard, Method::predictive, Method::certified}) {
            report::Line& line = plot.lines.emplace_back();
            line.name = to_string(method);
            for (const GrowthRow& r : rows)
                if (r.part == part.part && r.method == method) line.points.emplace_back(r.size, r.us_per_pair);
        }
        report::Line& contacts = plot.lines.emplace_back();
        contacts.name = "contacts a pair";
        for (const GrowthRow& r : rows)
            if (r.part == part.part && r.method == Method::standard)
                contacts.points.emplace_back(r.size, r.contacts / std::max(r.pairs, 1e-9));
    }
    return report::plot_svg(plots);
}

} // namespace

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

void write_results(output::OutFolder& folder, const Machine& machine, std::span<const GrowthRow> rows) {
    write_both(folder, machine, "growth", csv(machine, rows), chart(rows));
}

} // namespace raycontact::bench
