// SPDX-License-Identifier: Apache-2.0
#include "real_text.h"

#include <raycontact/mesh.h>

#include <nlohmann/json.hpp>

#include <utility>
#include <vector>

namespace raycontact {
namespace {

std::string point(const Vec3& p) {
    return full_text_of(p.x) + " " + full_text_of(p.y) + " " + full_text_of(p.z);
}

} // namespace

std::string to_text(const MeshReport& report) {
    const auto yes = [](bool value) { return value ? "yes" : "no"; };
    std::string text;
    const auto line = [&](const char* key, const std::string& value) {
        text += key;
        text += value + "\n";
    };
    line("vertices           ",
         std::to_string(report.vertices) + " (file: " + std::to_string(report.file_vertices) + ")");
    line("triangles          ",
         std::to_string(report.triangles) + " (file: " + std::to_string(report.file_triangles) + ")");
    line("closed             ", yes(report.closed));
    if (!report.closed) line("border edges       ", std::to_string(report.border_edges));
    line("manifold           ", yes(report.manifold));
    line("oriented           ", yes(report.oriented));
    line("self-intersecting  ", yes(report.self_intersecting));
    line("outward            ", yes(report.outward));
    line("components         ", std::to_string(report.components));
    line("volume             ", report.closed ? full_text_of(report.volume) + " m^3" : "none, not closed");
    line("area               ", full_text_of(report.area) + " m^2");
    line("box                ", point(report.box_min) + "  to  " + point(report.box_max) + " m");
    if (report.repairs.empty()) line("repairs            ", "none");
    for (const std::string& repair : report.repairs) line("repair             ", repair);
    return text;
}

std::string to_json(const MeshReport& report) {
    nlohmann::ordered_json json;
    json["vertices"] = report.vertices;
    json["triangles"] = report.triangles;
    json["file_vertices"] = report.file_vertices;
    json["file_triangles"] = report.file_triangles;
    json["closed"] = report.closed;
    json["border_edges"] = report.border_edges;
    json["manifold"] = report.manifold;
    json["oriented"] = report.oriented;
    json["self_intersecting"] = report.self_intersecting;
    json["outward"] = report.outward;
    json["components"] = report.components;
    json["volume"] = report.closed ? nlohmann::ordered_json(report.volume) : nlohmann::ordered_json();
    json["area"] = report.area;
    json["box"] = {{report.box_min.x, report.box_min.y, report.box_min.z},
                   {report.box_max.x, report.box_max.y, report.box_max.z}};
    json["repairs"] = report.repairs;
    return json.dump();
}

Verdict verdict_of(const MeshReport& report) {
    const auto edges = [&] {
        return std::to_string(report.border_edges) + (report.border_edges == 1 ? " border edge" : " border edges");
    };
    std::vector<std::pair<std::string, std::string>> faults; // and what follows from them, or what to do
    if (!report.closed)
        faults.emplace_back("open", edges() + ", so it has no inside; close it, or use it as a one-sided sheet");
    if (!report.oriented)
        faults.emplace_back("badly wound", "triangles at an edge disagree on which side is out; turn some over");
    if (report.self_intersecting)
        faults.emplace_back("self-intersecting",
                            "where its surfaces overlap the closest face decides what is inside; unite its parts");
    if (faults.empty() && !report.outward && report.volume < 0)
        faults.emplace_back("inside out", "its triangles face inward; turn them over");
    else if (faults.empty() && !report.outward)
        faults.emplace_back("nested", "a part in a part is a solid of its own, and the closest face decides what is "
                                      "inside; make it a cavity (--cavities make) or a mesh of its own");
    if (faults.empty()) return {true, "good for contacts"};
    std::string text = faults[0].first + ": " + faults[0].second;
    for (std::size_t i = 1; i < faults.size(); ++i) text += (i == 1 ? "; also " : ", ") + faults[i].first;
    return {false, text};
}

} // namespace raycontact
