// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include "executor/float_environment.h"
#include "mesh/check.h"
#include "mesh/degenerate.h"
#include "mesh/holes.h"
#include "mesh/input_file.h"
#include "mesh/lowest_equal.h"
#include "mesh/nesting.h"
#include "mesh/predicates.h"
#include "mesh/stitch.h"
#include "mesh/surface.h"
#include "mesh/unite.h"
#include "number_text.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

namespace raycontact {
namespace {

/// The triangles of the file over file vertices, the lowest of each place.
PreparedMesh weld(const Mesh& mesh) {
    std::vector<Vec3> places(mesh.vertices);
    for (Vec3& p : places) p = p + Vec3{}; // turns -0 into 0
    const std::vector<std::uint32_t> lowest = lowest_equal(places);
    PreparedMesh prepared;
    prepared.name = mesh.name;
    prepared.report.repairs = mesh.repairs;
    for (const auto& [a, b, c] : mesh.triangles) prepared.triangles.push_back({lowest[a], lowest[b], lowest[c]});
    prepared.triangle_index.resize(mesh.triangles.size());
    std::iota(prepared.triangle_index.begin(), prepared.triangle_index.end(), 0u);
    return prepared;
}

/// Drops what drop_degenerate() finds, and reports how many.
void drop_triangles(PreparedMesh& prepared, std::span<const Vec3> vertices) {
    const Dropped dropped = drop_degenerate(prepared.triangles, vertices);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < prepared.triangles.size(); ++i) {
        if (dropped.triangles[i]) continue;
        prepared.triangles[kept] = prepared.triangles[i];
        prepared.triangle_index[kept++] = prepared.triangle_index[i];
    }
    prepared.triangles.resize(kept);
    prepared.triangle_index.resize(kept);
    std::vector<std::string>& repairs = prepared.report.repairs;
    if (dropped.degenerate > 0) repairs.push_back("dropped " + counted(dropped.degenerate, "degenerate triangle"));
    if (dropped.duplicate > 0) repairs.push_back("dropped " + counted(dropped.duplicate, "duplicate triangle"));
    if (dropped.back_to_back > 0)
        repairs.push_back("dropped " + counted(dropped.back_to_back, "triangle") + " back to back with another");
    if (dropped.split > 0)
        repairs.push_back("split " + counted(dropped.split, "triangle") + " at a corner of another, in place of "
                          + counted(dropped.split, "degenerate triangle"));
}

/// Replaces file vertices by the distinct ones in use.
void number_vertices(const Mesh& mesh, PreparedMesh& prepared) {
    std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
    for (const Triangle& t : prepared.triangles) {
        for (const std::uint32_t v : t) number[v] = 1;
    }
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == 0) continue;
        number[v] = static_cast<std::uint32_t>(prepared.vertices.size());
        prepared.vertices.push_back(mesh.vertices[v]);
        prepared.vertex_index.push_back(static_cast<std::uint32_t>(v));
    }
    for (Triangle& t : prepared.triangles) {
        for (std::uint32_t& v : t) v = number[v];
    }
}

/// Welded by exact position; with `repair` without the triangles that are of no use.
PreparedMesh welded(const Mesh& mesh, bool repair) {
    PreparedMesh prepared = weld(mesh);
    prepared.report.file_vertices = mesh.vertices.size();
    prepared.report.file_triangles = mesh.triangles.size();
    if (repair) drop_triangles(prepared, mesh.vertices);
    number_vertices(mesh, prepared);
    return prepared;
}

bool has_border(std::span<const HalfEdge> edges) {
    bool any = false;
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) { any = any || sides.size() % 2 != 0; });
    return any;
}

/// Splits triangles at the T-junctions of borders, and reports how many; whether any. The pieces of a triangle have its
/// index.
bool stitch(PreparedMesh& prepared, std::span<const HalfEdge> edges, double within, Executor& executor) {
    const Stitched stitched = stitch_borders(prepared.triangles, prepared.vertices, edges, within, executor);
    std::vector<std::string>& repairs = prepared.report.repairs;
    if (stitched.given_up)
        repairs.push_back("left T-junctions as they are: too many vertices lie on borders of others");
    if (stitched.at == 0) return false;
    std::vector<std::uint32_t> index;
    for (const std::uint32_t t : stitched.of) index.push_back(prepared.triangle_index[t]);
    prepared.triangles = stitched.triangles;
    prepared.triangle_index = std::move(index);
    std::string text = "split " + counted(stitched.split, "triangle") + " at " + counted(stitched.at, "T-junction");
    if (stitched.farthest > 0) text += ", up to " + text_of(stitched.farthest) + " m beside its edge";
    repairs.push_back(text);
    return true;
}

/// Makes the windings of each orientable patch agree with the majority, then turns closed patches as told. Returns
/// whether any triangle was turned.
bool mend_windings(PreparedMesh& prepared, const Patches& patches, const LazyTree& tree, Nesting nesting) {
    std::vector<Triangle>& triangles = prepared.triangles;
    const std::vector<Triangle> before(triangles);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Patch& patch = patches.list[patches.of[i]];
        const bool fewer_against = 2 * std::uint64_t{patch.turned} <= patch.size;
        if (patch.orientable && (patches.against[i] != 0) == fewer_against) std::swap(triangles[i][1], triangles[i][2]);
    }
    const auto [contradicts, unknown] = patches_to_turn(prepared, patches, tree, nesting);
    std::size_t mended = 0, turned_whole = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const std::uint32_t p = patches.of[i];
        if (contradicts[p]) std::swap(triangles[i][1], triangles[i][2]);
        if (patches.list[p].turned > 0 && triangles[i] != before[i]) ++mended;
    }
    for (std::size_t p = 0; p < patches.list.size(); ++p) {
        if (contradicts[p] && patches.list[p].turned == 0) ++turned_whole;
    }
    if (mended > 0)
        prepared.report.repairs.push_back("turned " + counted(mended, "triangle") + " to make windings agree");
    if (turned_whole > 0) {
        prepared.report.repairs.push_back(
            "turned " + counted(turned_whole, "component") + " of " + std::to_string(patches.list.size())
            + (nesting == Nesting::cavities ? " whose winding contradicts its nesting" : " that wound inward"));
    }
    if (unknown > 0)
        prepared.report.repairs.push_back("left " + counted(unknown, "component")
                                          + " as wound: too many lie in each other to tell which are cavities");
    return triangles != before;
}

/// Spans the holes that `which` names, and reports them. The surface as it is then; nothing if there are no holes.
std::optional<Surface> span_holes(PreparedMesh& prepared, std::span<const HalfEdge> edges, std::span<const Vec3> exact,
                                  Holes which, Executor& executor) {
    std::vector<Hole> holes = find_holes(prepared.triangles, exact, edges);
    if (holes.empty()) return std::nullopt;
    MeshReport& report = prepared.report;
    const std::size_t first = prepared.triangles.size();
    const auto append = [&] {
        for (const Hole& hole : holes)
            prepared.triangles.insert(prepared.triangles.end(), hole.triangles.begin(), hole.triangles.end());
        report.holes = holes.size();
        report.spanning = prepared.triangles.size() - first;
    };
    append();
    std::optional<Surface> surface(std::in_place, prepared.triangles, exact, executor);
    if (!is_solid(prepared, first, surface->tree(), executor)) {
        prepared.triangles.resize(first);
        const double small = 0.1 * length(box_of(exact).high - box_of(exact).low);
        std::erase_if(holes, [&](const Hole& hole) {
            return which != Holes::of_all || !(hole.flat || size_of(hole, exact) <= small);
        });
        append();
        surface.emplace(prepared.triangles, exact, executor);
        if (holes.empty()) return surface;
    }
    const std::size_t number = report.file_triangles;
    for (std::size_t i = 0; i < report.spanning; ++i)
        prepared.triangle_index.push_back(static_cast<std::uint32_t>(number + i));
    report.repairs.push_back("spanned " + counted(holes.size(), "hole") + " with "
                             + counted(report.spanning, "triangle") + ", numbered from " + std::to_string(number)
                             + " on");
    constexpr std::size_t most_named = 20;
    for (std::size_t i = 0; i < std::min(holes.size(), most_named); ++i)
        report.repairs.push_back("spanned a " + text_of(holes[i], exact));
    return surface;
}

/// Replaces a mesh by the union of its solids; reports that, the first time.
void take(PreparedMesh& prepared, const United& united, bool first) {
    std::vector<Vec3> places(united.vertices);
    for (Vec3& p : places) p = p + Vec3{};
    const std::vector<std::uint32_t> lowest = lowest_equal(places);
    constexpr std::uint32_t none = 0xffffffffu;
    std::vector<std::uint32_t> number(places.size(), none);
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> triangle_index;
    for (std::size_t i = 0; i < united.triangles.size(); ++i) {
        const auto [a, b, c] = united.triangles[i];
        const Triangle t{lowest[a], lowest[b], lowest[c]};
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue; // rounded away
        for (const std::uint32_t v : t) number[v] = 0;
        triangles.push_back(t);
        triangle_index.push_back(prepared.triangle_index[united.of[i]]);
    }
    const std::size_t given = prepared.vertices.size(), file_vertices = prepared.report.file_vertices;
    std::size_t next = std::max<std::size_t>(file_vertices, prepared.vertex_index.back() + std::size_t{1});
    std::vector<Vec3> vertices;
    std::vector<std::uint32_t> vertex_index;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == none) continue;
        number[v] = static_cast<std::uint32_t>(vertices.size());
        vertices.push_back(united.vertices[v]);
        vertex_index.push_back(v < given ? prepared.vertex_index[v] : static_cast<std::uint32_t>(next++));
    }
    for (Triangle& t : triangles)
        for (std::uint32_t& v : t) v = number[v];
    prepared.vertices = std::move(vertices);
    prepared.vertex_index = std::move(vertex_index);
    prepared.triangles = std::move(triangles);
    prepared.triangle_index = std::move(triangle_index);
    std::string text = "united parts that lie in each other: split " + counted(united.split, "triangle") + ", dropped "
                       + counted(united.buried, "buried one");
    if (next > file_vertices) text += "; vertices from " + std::to_string(file_vertices) + " on are where they cross";
    if (first) prepared.report.repairs.push_back(text);
}

} // namespace

PreparedMesh prepare_mesh(const Mesh& mesh, const PrepareOptions& options) {
    const FloatEnvironment environment; // the predicates need rounding to nearest
    const std::string name = mesh.name.empty() ? "mesh" : printable(mesh.name);
    check_mesh(mesh, name);
    check_reach(mesh, name);
    const bool repair = options.repair == Repair::allowed;
    PreparedMesh prepared = welded(mesh, repair);
    Executor executor(threads_for(prepared.triangles.size(), options.threads));
    std::vector<HalfEdge> edges = sorted_half_edges(prepared.triangles);
    if (repair && has_border(edges)) {
        const double within = border_tolerance(prepared.vertices);
        if (const auto joined = join_borders(mesh, prepared, edges, within)) {
            prepared = welded(*joined, true);
            edges = sorted_half_edges(prepared.triangles);
        }
        if (stitch(prepared, edges, within, executor)) edges = sorted_half_edges(prepared.triangles);
    }

    std::vector<Vec3> exact = snapped(prepared.vertices);
    std::optional<Surface> surface(std::in_place, prepared.triangles, exact, executor);
    if (surface->is_empty()) throw InputError(name + ": no triangle has an area");
    check_size(prepared.vertices, name);
    Patches patches = find_patches(prepared.triangles, edges);
    if (repair) {
        const auto tree = [&]() -> const MeshTree& { return surface->tree(); };
        if (mend_windings(prepared, patches, tree, options.nesting)) edges = sorted_half_edges(prepared.triangles);
    }
    if (repair && options.holes != Holes::none) {
        if (std::optional<Surface> spanned = span_holes(prepared, edges, exact, options.holes, executor)) {
            surface.emplace(std::move(*spanned));
            edges = sorted_half_edges(prepared.triangles);
            patches = find_patches(prepared.triangles, edges);
        }
    }
    fill_report(prepared, edges);
    prepared.report.checked = options.check == Check::full;
    if (repair && options.overlaps == Overlaps::unite && prepared.report.closed && prepared.report.oriented) {
        // What is rounded may cross itself again: then what is nearer than doubles can tell is drawn together.
        const double near = 1e-12 * length(prepared.report.box_max - prepared.report.box_min);
        for (int round = 0; round < 5; ++round) {
            const United united = unite(prepared, patches, exact, surface->tree(), round > 0 ? near : 0, executor);
            if (united.done == United::Done::nothing) {
                prepared.report.outward = prepared.report.checked = true;
                return prepared;
            }
            if (united.done == United::Done::empty) break;
            if (united.done == United::Done::given_up) {
                prepared.report.repairs.emplace_back("left parts that cross as they are: too many, or too near");
                break;
            }
            take(prepared, united, round == 0);
            exact = snapped(prepared.vertices);
            surface.emplace(prepared.triangles, exact, executor);
            if (surface->is_empty()) throw InputError(name + ": nothing is left of parts that lie in each other");
            edges = sorted_half_edges(prepared.triangles);
            patches = find_patches(prepared.triangles, edges);
            fill_report(prepared, edges);
        }
    }
    if (options.check == Check::full) check_surface(prepared, patches, exact, surface->tree(), executor);
    return prepared;
}

MeshReport measured_report(const PreparedMesh& mesh, Executor& executor) {
    const FloatEnvironment environment;
    PreparedMesh measured(mesh);
    const std::vector<HalfEdge> edges = sorted_half_edges(mesh.triangles);
    fill_report(measured, edges);
    const std::vector<Vec3> exact = snapped(mesh.vertices);
    const Surface surface(mesh.triangles, exact, executor);
    if (surface.is_empty()) throw InputError("no triangle has an area");
    check_surface(measured, find_patches(mesh.triangles, edges), exact, surface.tree(), executor);
    return measured.report;
}

MeshReport measured_report(const PreparedMesh& mesh) {
    Executor executor(0);
    return measured_report(mesh, executor);
}

} // namespace raycontact
