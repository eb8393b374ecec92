// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include "interruption.h"
#include "mesh/check.h"
#include "mesh/lowest_equal.h"
#include "mesh/measure.h"
#include "mesh/stitch.h"
#include "number_text.h"
#include "printable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

namespace raycontact {
namespace {

/// Places, found by a grid: in a cell lie few, as no two are nearer than a length.
class Grid {
public:
    Grid(const std::vector<Vec3>& places, std::size_t count, double length)
        : places_(places), length_(length), first_(std::bit_ceil(count + 1), none), next_(places.size(), none) {}

    void add(std::uint32_t i) {
        const Vec3& p = places_[i];
        std::uint32_t& first = first_[slot({cell(p.x), cell(p.y), cell(p.z)})];
        next_[i] = std::exchange(first, i);
    }

    /// The nearest one that is nearer than the length, of several the first by its coordinates; else `otherwise`.
    std::uint32_t nearest(const Vec3& p, std::uint32_t otherwise) const {
        const std::array low{cell(p.x - length_), cell(p.y - length_), cell(p.z - length_)},
            high{cell(p.x + length_), cell(p.y + length_), cell(p.z + length_)};
        double least = length_;
        std::uint32_t found = otherwise;
        for (unsigned corner = 0; corner < 8; ++corner) {
            std::array<double, 3> at = low;
            bool again = false;
            for (unsigned k = 0; k < 3; ++k) {
                if ((corner >> k & 1) == 0) continue;
                at[k] = high[k];
                again = again || low[k] == high[k];
            }
            if (again) continue;
            for (std::uint32_t i = first_[slot(at)]; i != none; i = next_[i]) {
                const double distance = length(places_[i] - p);
                if (distance < least || (found != otherwise && distance == least && before(places_[i], places_[found])))
                    std::tie(least, found) = std::pair(distance, i);
            }
        }
        return found;
    }

    static bool before(const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

private:
    static constexpr std::uint32_t none = 0xffffffffu;
    /// Cells are so wide that what is near a place lies in two of them along an axis, mostly in one.
    double cell(double x) const { return std::floor(x / (8 * length_)) + 0.0; } // + 0: no -0
    std::size_t slot(const std::array<double, 3>& cell) const {
        return XXH3_64bits(cell.data(), sizeof cell) & (first_.size() - 1);
    }

    const std::vector<Vec3>& places_;
    double length_;
    std::vector<std::uint32_t> first_, next_; ///< lists of the places that share a slot
};

/// Where each of `some` places goes: to the nearest one before it, by their coordinates, that stays. So the order in
/// which a file has them does not matter, and of those that stay no two are nearer than the length. No two are equal.
std::vector<std::uint32_t> joined(const std::vector<Vec3>& places, std::vector<std::uint32_t> some, double length) {
    std::sort(some.begin(), some.end(),
              [&](std::uint32_t a, std::uint32_t b) { return Grid::before(places[a], places[b]); });
    std::vector<std::uint32_t> to(places.size());
    std::iota(to.begin(), to.end(), 0u);
    Grid grid(places, some.size(), length);
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

/// The edges with an odd number of triangles.
std::vector<Edge> border_of(std::span<const HalfEdge> edges) {
    std::vector<Edge> border;
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        if (sides.size() % 2 != 0) border.emplace_back(sides[0].lo, sides[0].hi);
    });
    return border;
}

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
    std::vector<Vec3> places(mesh.vertices);
    for (Vec3& p : places) p = p + Vec3{}; // turns -0 into 0
    const std::vector<std::uint32_t> lowest = lowest_equal(places),
                                     to = joined(places, in_use(mesh.triangles, lowest), length);
    std::size_t moved = 0;
    double farthest = 0;
    for (std::size_t v = 0; v < places.size(); ++v) {
        if (to[lowest[v]] == lowest[v]) continue;
        mesh.vertices[v] = places[to[lowest[v]]];
        farthest = std::max(farthest, raycontact::length(mesh.vertices[v] - places[v]));
        ++moved;
    }
    if (moved > 0)
        mesh.repairs.push_back("welded " + std::to_string(moved) + (moved == 1 ? " vertex" : " vertices")
                               + " to others nearer than " + text_of(length) + " m, which moved by at most "
                               + text_of(farthest) + " m");
    return mesh;
}

std::optional<Mesh> join_borders(const Mesh& mesh, const PreparedMesh& prepared, std::span<const HalfEdge> edges,
                                 double within) {
    std::vector<std::uint32_t> ends;
    for (const auto& [a, b] : border_of(edges)) ends.insert(ends.end(), {a, b});
    if (ends.empty()) return std::nullopt;
    std::ranges::sort(ends);
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    std::vector<Vec3> places(prepared.vertices);
    for (Vec3& p : places) p = p + Vec3{}; // turns -0 into 0
    const Box box = box_of(places);        // a small part of a large whole may be no longer than the last digit
    const double most = 1e-6 * length(box.high - box.low);
    const std::vector<std::uint32_t> to = joined(places, ends, std::min(within, most));
    const auto moves = [&](std::uint32_t v) { return to[v] != v; };
    const auto moved = static_cast<std::size_t>(std::ranges::count_if(ends, moves));
    if (moved == 0) return std::nullopt;
    Mesh result(mesh);
    double farthest = 0;
    std::map<std::array<double, 3>, std::uint32_t> moving; // by place: a file may have a vertex many times
    for (const std::uint32_t v : ends) {
        if (!moves(v)) continue;
        moving.emplace(std::array{places[v].x, places[v].y, places[v].z}, v);
        farthest = std::max(farthest, length(places[to[v]] - places[v]));
    }
    for (Vec3& vertex : result.vertices) {
        const Vec3 p = vertex + Vec3{};
        if (const auto found = moving.find({p.x, p.y, p.z}); found != moving.end()) vertex = places[to[found->second]];
    }
    result.repairs.push_back("joined " + std::to_string(moved) + (moved == 1 ? " vertex" : " vertices")
                             + " of borders with others, up to " + text_of(farthest) + " m away");
    return result;
}

std::optional<double> closing_weld(const PreparedMesh& mesh) {
    if (mesh.report.closed && mesh.report.holes == 0) return std::nullopt;
    const auto spanning = std::ranges::lower_bound(mesh.triangle_index, mesh.report.file_triangles);
    const std::vector<Triangle> triangles(mesh.triangles.begin(),
                                          mesh.triangles.begin() + (spanning - mesh.triangle_index.begin()));
    const std::vector<Edge> border = border_of(sorted_half_edges(triangles));
    if (border.empty()) return std::nullopt;
    std::vector<std::uint32_t> ends;
    for (const auto& [a, b] : border) ends.insert(ends.end(), {a, b});
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
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
