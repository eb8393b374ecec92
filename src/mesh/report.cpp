// SPDX-License-Identifier: Apache-2.0
#include "real_text.h"

#include <raycontact/mesh.h>

#include <nlohmann/json.hpp>

namespace raycontact {
namespace {

std::string point(const Vec3& p) {
    return text_of(p.x) + " " + text_of(p.y) + " " + text_of(p.z);
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
    line("manifold           ", yes(report.manifold));
    line("oriented           ", yes(report.oriented));
    line("self-intersecting  ", yes(report.self_intersecting));
    line("outward            ", yes(report.outward));
    line("components         ", std::to_string(report.components));
    line("volume             ", report.closed ? text_of(report.volume) + " m^3" : "none, not closed");
    line("area               ", text_of(report.area) + " m^2");
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
    json["manifold"] = report.manifold;
    json["oriented"] = report.oriented;
    json["self_intersecting"] = report.self_intersecting;
    json["outward"] = report.outward;
    json["components"] = report.components;
    json["volume"] = report.volume;
    json["area"] = report.area;
    json["box"] = {{report.box_min.x, report.box_min.y, report.box_min.z},
                   {report.box_max.x, report.box_max.y, report.box_max.z}};
    json["repairs"] = report.repairs;
    return json.dump();
}

} // namespace raycontact
