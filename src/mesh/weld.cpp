// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include "interruption.h"
#include "mesh/check.h"
#include "mesh/lowest_equal.h"
#include "mesh/near_places.h"
#include "mesh/stitch.h"
#include "number_text.h"
#include "printable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

namespace raycontact {
namespace {

/// Where each of `some` places goes: to the nearest one before it, by their coordinates, that stays. So the order in
/// which a file has them does not matter, and of those that stay no two are nearer than the length. No two are equal.
std::vector<std::uint32_t> joined(const std::vector<Vec3>& places, std::vector<std::uint32_t> some, double length) {
    std::sort(some.begin(), some.end(),
              [&](std::uint32_t a, std::uint32_t b) { return NearPlaces::before(places[a], places[b]); });
    std::vector<std::uint32_t> to(places.size());
    std::iota(to.begin(), to.end(), 0u);
    NearPlaces grid(places, some.size(), length);
    const InterruptionCheck check;
    for (const std::uint32_t i : some) {
        check();
        to[i] = grid.nearest(places[i], i);
        if (to[i] == i) grid.add(i);
    }
    return to;
}

/// The vertices of triangles, of equal ones the lowest: a vertex of no triangle joins nothing.
std::vector<std::uint32_t> in_use(const std::vector<Triangle>& triangles, const std::vector<std::uint32_t>& lowest) {
    std::vector<char> used(lowest.size(), 0);
    for (const Triangle& t : triangles)
        for (const std::uint32_t v : t) used[lowest[v]] = 1;
    std::vector<std::uint32_t> list;
    for (std::uint32_t v = 0; v < used.size(); ++v)
        if (used[v]) list.push_back(v);
    return list;
}

double power_of_ten(int power) {
    double value = 1;
    for (int i = 0; i < std::abs(power); ++i) value *= 10;
    return power < 0 ? 1 / value : value;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Whether no edge is left an odd number of times once its ends are joined.
bool closes(const std::vector<Edge>& border, const std::vector<std::uint32_t>& to) {
    std::vector<Edge> edges;
    for (const auto& [a, b] : border)
        if (to[a] != to[b]) edges.emplace_back(std::minmax(to[a], to[b]));
    std::sort(edges.begin(), edges.end());
    for (auto at = edges.begin(); at != edges.end();) {
        const auto end = std::upper_bound(at, edges.end(), *at);
        if ((end - at) % 2 != 0) return false;
        at = end;
    }
    return true;
}

std::vector<Vec3> without_minus_zero(std::vector<Vec3> places) {
    for (Vec3& p : places) p = p + Vec3{};
    return places;
}

/// Moves the vertices of a mesh, of each place the `lowest` of which says where `to`. How many, and how far at most.
std::pair<std::size_t, double> move(Mesh& mesh, const std::vector<std::uint32_t>& lowest,
                                    const std::vector<std::uint32_t>& to) {
    const std::vector<Vec3> places(mesh.vertices);
    std::size_t moved = 0;
    double farthest = 0;
    for (std::size_t v = 0; v < places.size(); ++v) {
        if (to[lowest[v]] == lowest[v]) continue;
        mesh.vertices[v] = places[to[lowest[v]]];
        farthest = std::max(farthest, length(mesh.vertices[v] - places[v]));
        ++moved;
    }
    return {moved, farthest};
}

std::string said(std::size_t moved) {
    return std::to_string(moved) + (moved == 1 ? " vertex" : " vertices");
}

/// How far the numbers lie apart that the largest coordinate is one of.
double step_of(const std::vector<Vec3>& places) {
    double most = 0;
    for (const auto& [x, y, z] : places) most = std::max({most, std::fabs(x), std::fabs(y), std::fabs(z)});
    return std::nextafter(most, std::numeric_limits<double>::infinity()) - most;
}

} // namespace

Mesh weld_mesh(Mesh mesh, double length) {
    const std::string name = mesh.name.empty() ? "mesh" : printable(mesh.name);
    if (!(length >= 1e-12 && length <= greatest_coordinate))
        throw InputError(name + ": cannot be welded by " + text_of(length) + " m; give a length from 1e-12 to 1e9");
    check_mesh(mesh, name);
    // So cells of the grid have numbers of their own, too, however far the mesh is from the origin.
    if (const double step = step_of(mesh.vertices); length < step)
        throw InputError(name + ": cannot be welded by " + text_of(length) + " m: as far from the origin as it is, "
                         + "coordinates have no digits below " + text_of(step) + " m; give a greater length");
    const std::vector<Vec3> places = without_minus_zero(mesh.vertices);
    const std::vector<std::uint32_t> lowest = lowest_equal(places),
                                     to = joined(places, in_use(mesh.triangles, lowest), length);
    const auto [moved, farthest] = move(mesh, lowest, to);
    if (moved > 0)
        mesh.repairs.push_back("welded " + said(moved) + " to others nearer than " + text_of(length)
                               + " m, which moved by at most " + text_of(farthest) + " m");
    return mesh;
}

std::optional<Mesh> join_borders(const Mesh& mesh, const std::vector<std::uint32_t>& vertices, double within) {
    const std::vector<Vec3> places = without_minus_zero(mesh.vertices);
    const std::vector<std::uint32_t> to = joined(places, vertices, within);
    if (std::ranges::all_of(vertices, [&](std::uint32_t v) { return to[v] == v; })) return std::nullopt;
    Mesh result(mesh);
    const auto [moved, farthest] = move(result, lowest_equal(places), to);
    result.repairs.push_back("joined " + said(moved) + " of borders with others, up to " + text_of(farthest)
                             + " m away");
    return result;
}

std::optional<double> closing_weld(const PreparedMesh& mesh) {
    if (mesh.report.closed && mesh.report.holes == 0) return std::nullopt;
    const auto spanning = std::ranges::lower_bound(mesh.triangle_index, mesh.report.file_triangles);
    const std::vector<Triangle> triangles(mesh.triangles.begin(),
                                          mesh.triangles.begin() + (spanning - mesh.triangle_index.begin()));
    const std::vector<HalfEdge> edges = sorted_half_edges(triangles);
    const std::vector<Edge> border = border_edges(edges);
    if (border.empty()) return std::nullopt;
    const std::vector<std::uint32_t> ends = border_vertices(edges);
    // Further apart than that, corners differ in more than their last digits.
    const double most = 1e-4 * raycontact::length(mesh.report.box_max - mesh.report.box_min);
    const double step = step_of(mesh.vertices);
    for (int power = -12; power_of_ten(power) <= most; ++power) {
        const double length = power_of_ten(power);
        if (length < std::max(1e-6 * most, step) || !closes(border, joined(mesh.vertices, ends, length))) continue;
        // Vertices away from the border may have a say, too.
        const Mesh welded = weld_mesh({mesh.name, mesh.vertices, triangles}, length);
        if (prepare_mesh(welded, {.holes = Holes::none, .overlaps = Overlaps::leave, .check = Check::topology})
                .report.closed)
            return length;
    }
    return std::nullopt;
}

} // namespace raycontact
