// SPDX-License-Identifier: Apache-2.0
#include "mesh/arrangement.h"

#include "interruption.h"
#include "mesh/near_places.h"
#include "mesh/predicates.h"
#include "mesh/triangle_pair.h"

#include <algorithm>
#include <cmath>

namespace raycontact {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

double largest_coordinate(std::span<const Vec3> vertices) {
    double size = 0;
    for (const Vec3& v : vertices) size = std::max({size, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
    return size;
}

} // namespace

Arrangement::Arrangement(const PreparedMesh& mesh, std::span<const Vec3> exact)
    : mesh_(mesh), exact_(exact), table_(largest_coordinate(exact)) {}

bool Arrangement::cut(std::span<const Pair> pairs) {
    work_ = std::min<std::size_t>(200'000'000 + 15'000 * pairs.size(), 4'000'000'000); // half a minute
    const InterruptionCheck check;
    for (const auto& [i, k] : pairs) {
        check();
        meet(i, k);
    }
    std::map<Pair, std::vector<std::uint32_t>> on_edges; // of the mesh's edges
    const auto edge_of = [&](std::uint32_t t, std::size_t k) {
        return Pair(std::minmax(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]));
    };
    for (auto& [t, subdivision] : subdivisions_) {
        check();
        subdivision.cross_segments();
        for (std::size_t k = 0; k < 3; ++k)
            for (const std::uint32_t p : subdivision.on_edge(k)) on_edges[edge_of(t, k)].push_back(p);
    }
    for (auto& [t, subdivision] : subdivisions_) {
        for (std::size_t k = 0; k < 3; ++k)
            if (const auto found = on_edges.find(edge_of(t, k)); found != on_edges.end())
                for (const std::uint32_t p : found->second) subdivision.add(p);
        check();
        pieces_[t] = subdivision.cut();
    }
    return work_ > 0;
}

CutMesh Arrangement::list(double tolerance) const {
    CutMesh result;
    result.vertices = mesh_.vertices;
    std::vector<Vec3> places(mesh_.vertices);
    for (std::uint32_t p = 0; p < table_.size(); ++p) places.push_back(table_[p].rough);
    const auto given = static_cast<std::uint32_t>(mesh_.vertices.size());
    NearPlaces near(places, places.size(), tolerance > 0 ? tolerance : 1);
    if (tolerance > 0)
        for (std::uint32_t v = 0; v < given; ++v) near.add(v);
    std::vector<std::uint32_t> number(places.size());
    for (std::uint32_t v = 0; v < given; ++v) number[v] = v;
    for (std::uint32_t p = 0; p < table_.size(); ++p) {
        const std::uint32_t place = given + p;
        if (const auto vertex = vertex_of_.find(p); vertex != vertex_of_.end()) {
            number[place] = vertex->second;
            continue;
        }
        const std::uint32_t stays = tolerance > 0 ? near.nearest(places[place], place) : place;
        if (stays != place) {
            number[place] = number[stays];
            continue;
        }
        if (tolerance > 0) near.add(place);
        number[place] = static_cast<std::uint32_t>(result.vertices.size());
        result.vertices.push_back(places[place]);
    }
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
        const auto cut = pieces_.find(t);
        if (cut == pieces_.end()) {
            result.triangles.push_back(mesh_.triangles[t]);
            result.of.push_back(t);
            continue;
        }
        for (const auto& [a, b, c] : cut->second) {
            result.triangles.push_back({number[given + a], number[given + b], number[given + c]});
            result.of.push_back(t);
        }
    }
    return result;
}

std::uint32_t Arrangement::point_of(std::uint32_t vertex) {
    const auto [found, is_new] = point_of_.try_emplace(vertex, 0);
    if (is_new) {
        found->second = table_.add(ExactPoint(exact_[vertex]));
        vertex_of_.emplace(found->second, vertex);
    }
    return found->second;
}

Subdivision& Arrangement::subdivision_of(std::uint32_t t) {
    const auto found = subdivisions_.find(t);
    if (found != subdivisions_.end()) return found->second;
    const auto [a, b, c] = mesh_.triangles[t];
    return subdivisions_.try_emplace(t, table_, Triangle{point_of(a), point_of(b), point_of(c)}, work_).first->second;
}

std::array<Vec3, 3> Arrangement::corners_of(std::uint32_t t) const {
    const auto [a, b, c] = mesh_.triangles[t];
    return {exact_[a], exact_[b], exact_[c]};
}

// Adds what two triangles share to both.
void Arrangement::meet(std::uint32_t i, std::uint32_t k) {
    const std::array<Vec3, 3> a = corners_of(i), b = corners_of(k);
    std::array<int, 3> side_a{}, side_b{};
    for (std::size_t c = 0; c < 3; ++c) {
        side_a[c] = orient3d(b[0], b[1], b[2], a[c]);
        side_b[c] = orient3d(a[0], a[1], a[2], b[c]);
    }
    if (std::ranges::all_of(side_a, [](int s) { return s == 0; })) {
        overlap(i, k);
        overlap(k, i);
        return;
    }
    std::vector<std::uint32_t> shared;
    add_crossings(i, side_a, k, shared);
    add_crossings(k, side_b, i, shared);
    add_line(shared, subdivision_of(i));
    add_line(shared, subdivision_of(k));
}

// Where the edges of one triangle cross another, in whose plane they do not lie all.
void Arrangement::add_crossings(std::uint32_t t, const std::array<int, 3>& sides, std::uint32_t other,
                                std::vector<std::uint32_t>& found) {
    const std::array<Vec3, 3> corners = corners_of(t), target = corners_of(other);
    const std::size_t drop = drop_axis(target);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        if (sides[k] == 0 && point_in_triangle(corners[k], target, drop))
            found.push_back(point_of(mesh_.triangles[t][k]));
        if (sides[k] * sides[next] >= 0) continue;
        if (!segment_meets_triangle(corners[k], corners[next], sides[k], sides[next], target)) continue;
        const auto away = [&](const Vec3& p) {
            return abs(dot(area_normal(target[0], target[1], target[2]), ExactVec3(p) - target[0]));
        };
        found.push_back(table_.add(
            between(ExactPoint(corners[k]), ExactPoint(corners[next]), away(corners[k]), away(corners[next]))));
    }
}

// Adds to a triangle what of the edges of another one in its plane lies in it.
void Arrangement::overlap(std::uint32_t t, std::uint32_t other) {
    const std::array<Vec3, 3> corners = corners_of(t), target = corners_of(other);
    const std::size_t drop = drop_axis(corners);
    const auto turn = [&](const Vec3& p, const Vec3& q, const Vec3& r) { return orient2d(p, q, r, drop); };
    const auto on = [&](const Vec3& p, const Vec3& q, const Vec3& r) { // r, on the line of p and q, between them
        if (turn(p, q, r) != 0) return false;
        const std::size_t k = order(p, q, (drop + 1) % 3) != 0 ? (drop + 1) % 3 : (drop + 2) % 3;
        return order(p, r, k) == order(r, q, k) && order(p, r, k) != 0;
    };
    for (std::size_t e = 0; e < 3; ++e) {
        const Vec3 &from = target[e], &to = target[(e + 1) % 3];
        std::vector<std::uint32_t> shared;
        for (const std::size_t end : {e, (e + 1) % 3})
            if (point_in_triangle(target[end], corners, drop)) shared.push_back(point_of(mesh_.triangles[other][end]));
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &p = corners[k], &q = corners[(k + 1) % 3];
            if (on(from, to, p)) shared.push_back(point_of(mesh_.triangles[t][k]));
            if (turn(from, to, p) * turn(from, to, q) >= 0 || turn(p, q, from) * turn(p, q, to) >= 0) continue;
            const ExactPoint line_p(p), line_q(q), edge_from(from), edge_to(to);
            const auto away = [&](const ExactPoint& point) { return abs(area_of(line_p, line_q, point, drop)); };
            shared.push_back(table_.add(between(edge_from, edge_to, away(edge_from), away(edge_to))));
        }
        add_line(shared, subdivision_of(t));
    }
}

// Points on one line, of which a triangle has what lies between them.
void Arrangement::add_line(std::vector<std::uint32_t>& points, Subdivision& to) {
    std::ranges::sort(points);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    std::ranges::sort(points, [&](std::uint32_t p, std::uint32_t q) {
        for (std::size_t k = 0; k < 3; ++k)
            if (const int o = order(table_[p], table_[q], k); o != 0) return o < 0;
        return false;
    });
    if (points.size() == 1) to.add(points[0]);
    for (std::size_t i = 1; i < points.size(); ++i) to.add({points[i - 1], points[i]});
}

} // namespace raycontact
