// SPDX-License-Identifier: Apache-2.0
#include "mesh/check.h"

#include <raycontact/error.h>

#include "mesh/disjoint_sets.h"
#include "mesh/input_file.h"
#include "mesh/nesting.h"
#include "mesh/self_intersection.h"
#include "number_text.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

/// Whether the mesh is closed, manifold and oriented, and its number of components.
void fill_topology(MeshReport& report, std::span<const Triangle> triangles, std::span<const HalfEdge> edges) {
    report.manifold = report.oriented = true;
    report.border_edges = 0;
    // Corners of triangles that follow each other around a vertex end in one set: a fan.
    std::size_t fan_count = 3 * triangles.size();
    DisjointSets fans, components;
    fans.reset(fan_count);
    components.reset(report.vertices);
    report.components = report.vertices;
    const auto corner_at = [&](const HalfEdge& side, std::uint32_t vertex) {
        const std::uint32_t start = side.corner, end = side.corner - side.corner % 3 + (side.corner % 3 + 1) % 3;
        return triangles[side.triangle()][start % 3] == vertex ? start : end;
    };
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        for (const HalfEdge& side : sides) {
            if (&side == &sides[0]) continue;
            if (fans.join(corner_at(side, side.lo), corner_at(sides[0], side.lo))) --fan_count;
            if (fans.join(corner_at(side, side.hi), corner_at(sides[0], side.hi))) --fan_count;
        }
        report.border_edges += sides.size() % 2;
        report.manifold = report.manifold && sides.size() <= 2;
        // As many sides run one way as the other; of an odd number one is left over. A border always agrees.
        report.oriented = report.oriented && std::abs(balance_of(sides)) <= static_cast<int>(sides.size() % 2);
        if (components.join(sides[0].lo, sides[0].hi)) --report.components;
    });
    report.closed = report.border_edges == 0;
    report.solid = report.closed && report.oriented;
    report.manifold = report.manifold && fan_count == report.vertices;
}

std::string point(const Vec3& p) {
    return full_text_of(p.x) + " " + full_text_of(p.y) + " " + full_text_of(p.z);
}

} // namespace

void check_mesh(const Mesh& mesh, const std::string& name) {
    const auto fail = [&](const std::string& what) { throw InputError(name + ": " + what); };
    if (mesh.triangles.empty()) {
        std::string others; // what the file has instead
        for (const std::string& repair : mesh.repairs) others += (others.empty() ? " (" : ", ") + repair;
        constexpr std::size_t most = 200;
        std::size_t cut = others.size();
        if (cut > most)
            for (cut = most; (others[cut] & 0xc0) == 0x80;) --cut; // no half of a UTF-8 character
        if (cut < others.size()) others = others.substr(0, cut) + "...";
        fail("has no triangles" + others + (others.empty() ? "" : ")") + "; export a triangle mesh");
    }
    if (mesh.triangles.size() > most_triangles || mesh.vertices.size() > most_vertices)
        fail("has more than " + std::to_string(most_triangles) + " triangles or " + std::to_string(most_vertices)
             + " vertices; split or reduce it");
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        if (!is_finite(mesh.vertices[i])) fail("vertex " + std::to_string(i) + " (counted from 0) is not finite");
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t v : mesh.triangles[i]) {
            if (v >= mesh.vertices.size())
                fail("triangle " + std::to_string(i) + ": " + no_vertex(v, mesh.vertices.size()));
        }
    }
}

void check_reach(const Mesh& mesh, const std::string& name) {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const auto& [x, y, z] = mesh.vertices[i];
        if (std::max({std::fabs(x), std::fabs(y), std::fabs(z)}) > greatest_coordinate)
            throw InputError(name + ": vertex " + std::to_string(i) + " (counted from 0)"
                             + " is further than 1e9 m from the origin; scale the mesh");
    }
}

void check_size(std::span<const Vec3> vertices, const std::string& name) {
    const Box box = box_of(vertices);
    for (const double end : {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z}) {
        if (std::fabs(end) > 1.001 * greatest_coordinate) // a recorded one may be off by a rounding
            throw InputError(name + ": reaches further than 1e9 m from the origin; scale the mesh");
    }
    const Vec3 extent = box.high - box.low;
    const double longest = std::max({extent.x, extent.y, extent.z});
    if (longest >= least_size) return;
    throw InputError(name + ": its box is " + text_of(longest) + " m long, less than the " + text_of(least_size)
                     + " m that rays need; scale the mesh");
}

void fill_report(PreparedMesh& prepared, std::span<const HalfEdge> edges) {
    MeshReport& report = prepared.report;
    report.vertices = prepared.vertices.size();
    report.triangles = prepared.triangles.size();
    fill_topology(report, prepared.triangles, edges);
    report.volume = report.solid ? volume_of(prepared.vertices, prepared.triangles) : 0;
    LongSum area;
    for (const auto& [a, b, c] : prepared.triangles) {
        const Vec3& corner = prepared.vertices[a];
        area.add(length(cross(prepared.vertices[b] - corner, prepared.vertices[c] - corner)) / 2);
    }
    report.area = area.value();
    const Box box = box_of(prepared.vertices);
    report.box_min = box.low;
    report.box_max = box.high;
}

void check_surface(PreparedMesh& prepared, const Patches& patches, std::span<const Vec3> snapped_vertices,
                   const MeshTree& tree, Executor& executor) {
    MeshReport& report = prepared.report;
    report.self_intersecting = tree.any_pair(executor, [&](std::uint32_t i, std::uint32_t k) { // typically O(n log n)
        return triangles_meet(snapped_vertices, prepared.triangles[i], prepared.triangles[k]);
    });
    report.outward =
        report.closed && report.oriented && !report.self_intersecting && winds_outward(prepared, patches, tree);
    report.checked = true;
}

std::string kind_of(const MeshReport& report) {
    if (!report.solid) return "sheet";
    return report.spanning > 0 ? "solid with holes" : "solid";
}

std::string to_text(const MeshReport& report) {
    const auto yes = [](bool value) { return value ? "yes" : "no"; };
    std::string text;
    const auto line = [&](const std::string& key, const std::string& value) { text += key + value + "\n"; };
    line("vertices           ",
         std::to_string(report.vertices) + " (file: " + std::to_string(report.file_vertices) + ")");
    line("triangles          ",
         std::to_string(report.triangles) + " (file: " + std::to_string(report.file_triangles) + ")");
    line("closed             ", yes(report.closed));
    if (!report.closed) line("border edges       ", std::to_string(report.border_edges));
    line("kind               ", kind_of(report));
    line("manifold           ", yes(report.manifold));
    line("oriented           ", yes(report.oriented));
    line("self-intersecting  ", yes(report.self_intersecting));
    line("outward            ", yes(report.outward));
    line("components         ", std::to_string(report.components));
    line("volume             ", report.solid ? full_text_of(report.volume) + " m^3" : "none, a sheet");
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
    json["kind"] = kind_of(report);
    json["holes"] = report.holes;
    json["spanning"] = report.spanning;
    json["manifold"] = report.manifold;
    json["oriented"] = report.oriented;
    json["self_intersecting"] = report.self_intersecting;
    json["outward"] = report.outward;
    json["components"] = report.components;
    json["volume"] = report.solid ? nlohmann::ordered_json(report.volume) : nlohmann::ordered_json();
    json["area"] = report.area;
    json["box"] = {{report.box_min.x, report.box_min.y, report.box_min.z},
                   {report.box_max.x, report.box_max.y, report.box_max.z}};
    json["repairs"] = report.repairs;
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace); // repairs may be any bytes
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
    if (report.closed && report.oriented && !report.solid)
        faults.emplace_back("hollow",
                            "walls back to back that hold nothing, so it has no inside; use it as a one-sided "
                            "sheet, or give its walls a thickness");
    if (report.self_intersecting)
        faults.emplace_back("self-intersecting",
                            "where its surfaces overlap the closest face decides what is inside; unite its parts");
    if (faults.empty() && !report.outward && report.volume < 0)
        faults.emplace_back("inside out", "its triangles face inward; turn them over");
    else if (faults.empty() && !report.outward)
        faults.emplace_back("nested", "a part in a part is a solid of its own, and the closest face decides what is "
                                      "inside; make it a cavity (--cavities make) or a mesh of its own");
    if (faults.empty() && report.holes > 0)
        return {true, "good for contacts: a solid, of which " + counted(report.holes, "hole")
                          + (report.holes == 1 ? " is" : " are") + " spanned"};
    if (faults.empty()) return {true, "good for contacts"};
    std::string text = faults[0].first + ": " + faults[0].second;
    for (std::size_t i = 1; i < faults.size(); ++i) text += (i == 1 ? "; also " : ", ") + faults[i].first;
    return {false, text};
}

} // namespace raycontact
