// SPDX-License-Identifier: Apache-2.0
#include "mesh/holes.h"

#include "mesh/measure.h"
#include "mesh/nesting.h"
#include "mesh/polygon.h"
#include "number_text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

namespace raycontact {
namespace {

struct Side {
    std::uint32_t from, to;
    friend auto operator<=>(const Side&,
                            const Side&) = default; // NOLINT(modernize-use-nullptr): of clang-tidy 14
};

/// The sides that triangles need that span the holes, sorted. As many lead to a vertex as away from it.
std::vector<Side> missing_sides(std::span<const HalfEdge> edges) {
    std::vector<Side> missing;
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        int balance = balance_of(sides);
        for (; balance > 0; --balance) missing.push_back({sides[0].hi, sides[0].lo});
        for (; balance < 0; ++balance) missing.push_back({sides[0].lo, sides[0].hi});
    });
    std::ranges::sort(missing);
    return missing;
}

/// Follows sides until a vertex comes again, and takes what lies between off as a hole.
class HoleFinder {
public:
    HoleFinder(std::vector<Side> sides, std::span<const Triangle> triangles, std::span<const Vec3> vertices)
        : sides_(std::move(sides)), triangles_(triangles), vertices_(vertices) {
        for (std::size_t i = 0; i < sides_.size(); ++i)
            if (i == 0 || sides_[i].from != sides_[i - 1].from) places_.push_back({sides_[i].from, i, i});
        for (std::size_t p = 0; p < places_.size(); ++p)
            places_[p].end = p + 1 < places_.size() ? places_[p + 1].begin : sides_.size();
        find_normals();
    }

    std::vector<Hole> find() {
        std::vector<Hole> holes;
        std::vector<std::size_t> path; // places
        for (std::size_t start = 0; start < places_.size(); ++start) {
            path.assign(1, start);
            places_[start].on_path = 0;
            while (places_[path.back()].begin < places_[path.back()].end) {
                const std::size_t next = take_next(path);
                if (places_[next].on_path == none) {
                    places_[next].on_path = path.size();
                    path.push_back(next);
                    continue;
                }
                Hole& hole = holes.emplace_back();
                const std::size_t first = places_[next].on_path;
                for (std::size_t i = first; i < path.size(); ++i) {
                    hole.corners.push_back(places_[path[i]].vertex);
                    if (i > first) places_[path[i]].on_path = none;
                }
                path.resize(first + 1);
            }
            places_[start].on_path = none;
        }
        return holes;
    }

private:
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    static constexpr std::size_t most_sides = 64; ///< at one vertex, of which the next is chosen; so no file takes long
    /// A vertex and the sides from there that no hole has yet.
    struct Place {
        std::uint32_t vertex;
        std::size_t begin, end;
        std::size_t on_path = none;
        Vec3 normal{}; ///< of the triangles around it, where several sides lead away
    };

    std::size_t place_of(std::uint32_t vertex) const {
        return static_cast<std::size_t>(std::ranges::lower_bound(places_, vertex, {}, &Place::vertex)
                                        - places_.begin());
    }

    void find_normals() {
        const auto branches = [](const Place& place) { return place.end - place.begin > 1; };
        if (std::ranges::none_of(places_, branches)) return;
        for (const auto& [a, b, c] : triangles_) {
            const Vec3 normal = cross(vertices_[b] - vertices_[a], vertices_[c] - vertices_[a]);
            for (const std::uint32_t v : {a, b, c}) {
                const std::size_t place = place_of(v);
                if (place == places_.size() || places_[place].vertex != v || !branches(places_[place])) continue;
                places_[place].normal = places_[place].normal + normal;
            }
        }
    }

    /// Where holes meet in a vertex, the next side is the first one across the hole, which is on the left.
    std::size_t take_next(const std::vector<std::size_t>& path) {
        Place& place = places_[path.back()];
        std::size_t best = place.begin;
        const std::size_t sides = place.end - place.begin;
        if (sides > 1 && sides <= most_sides && path.size() > 1) {
            const Vec3 &here = vertices_[place.vertex], &last = vertices_[places_[path[path.size() - 2]].vertex];
            const Vec3 back = last - here, aside = cross(back, place.normal);
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t i = place.begin; i < place.end; ++i) {
                const Vec3 way = vertices_[sides_[i].to] - here;
                double turn = turn_of(dot(way, back) * length(place.normal), dot(way, aside));
                if (turn == 0) turn = 4; // back the same way: last
                if (turn < least) std::tie(least, best) = std::pair(turn, i);
            }
        }
        std::swap(sides_[best], sides_[place.begin]);
        return place_of(sides_[place.begin++].to);
    }

    std::vector<Side> sides_;
    std::span<const Triangle> triangles_;
    std::span<const Vec3> vertices_;
    std::vector<Place> places_; ///< by vertex
};

/// The triangles over the corners of a hole that have the least area together, and as few without one as can be.
std::vector<Triangle> least_area(std::span<const Vec3> corners) {
    const auto count = static_cast<std::uint32_t>(corners.size());
    const Box box = box_of(corners);
    const double penalty = dot(box.high - box.low, box.high - box.low);
    std::vector<double> least(std::size_t{count} * count, 0);
    std::vector<std::uint32_t> tip(least.size(), 0);
    const auto at = [&](std::uint32_t i, std::uint32_t k) { return std::size_t{i} * count + k; };
    for (std::uint32_t span = 2; span < count; ++span) {
        for (std::uint32_t i = 0; i + span < count; ++i) {
            const std::uint32_t k = i + span;
            double best = std::numeric_limits<double>::infinity();
            for (std::uint32_t m = i + 1; m < k; ++m) {
                const double area = 0.5 * length(cross(corners[m] - corners[i], corners[k] - corners[i]));
                const double sum = least[at(i, m)] + least[at(m, k)] + (area > 1e-9 * penalty ? area : penalty);
                if (sum < best) std::tie(best, tip[at(i, k)]) = std::pair(sum, m);
            }
            least[at(i, k)] = best;
        }
    }
    std::vector<Triangle> triangles;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{0, count - 1}};
    while (!open.empty()) {
        const auto [i, k] = open.back();
        open.pop_back();
        if (k - i < 2) continue;
        const std::uint32_t m = tip[at(i, k)];
        triangles.push_back({i, m, k});
        open.insert(open.end(), {{i, m}, {m, k}});
    }
    return triangles;
}

bool is_flat(std::span<const Vec3> corners, double size) {
    Vec3 normal;
    for (std::size_t i = 2; i < corners.size(); ++i)
        normal = normal + cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
    normal = unit(normal);
    return normal != Vec3{} && std::ranges::all_of(corners, [&](const Vec3& corner) {
               return std::fabs(dot(corner - corners[0], normal)) <= 1e-3 * size;
           });
}

std::vector<Vec3> places_of(const Hole& hole, std::span<const Vec3> vertices) {
    std::vector<Vec3> places;
    for (const std::uint32_t corner : hole.corners) places.push_back(vertices[corner]);
    return places;
}

/// Fills `triangles` and `flat`. work: triangles that may still be looked at for the least area, which takes the cube
/// of the corners.
void span(Hole& hole, std::span<const Vec3> vertices, std::size_t& work) {
    const std::vector<Vec3> places = places_of(hole, vertices);
    const std::size_t count = places.size();
    hole.flat = is_flat(places, size_of(hole, vertices));
    const auto by_area = [&] {
        if (count > 1000 || count * count * count / 6 > work) return std::vector<Triangle>{};
        work -= count * count * count / 6;
        return least_area(places);
    };
    hole.triangles = hole.flat ? cut_polygon(places) : by_area();
    if (hole.triangles.empty()) hole.triangles = hole.flat ? by_area() : cut_polygon(places);
    for (std::uint32_t i = 2; hole.triangles.size() + 2 < count; ++i) hole.triangles.push_back({0, i - 1, i});
    for (Triangle& t : hole.triangles)
        for (std::uint32_t& corner : t) corner = hole.corners[corner];
}

/// Seen from a point, as a part of the sphere around it; above 0 where its back is seen.
double part_of_sphere(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double la = length(a), lb = length(b), lc = length(c);
    const double angle =
        2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(a, c) * lb);
    return angle / (4 * std::numbers::pi);
}

/// Triangles at even steps of the area of the first `count`.
std::vector<std::uint32_t> sampled(const PreparedMesh& mesh, std::size_t count, std::size_t samples) {
    std::vector<double> before(count + 1, 0); // the area of those before each
    for (std::size_t t = 0; t < count; ++t) {
        const auto [a, b, c] = mesh.triangles[t];
        const Vec3& corner = mesh.vertices[a];
        before[t + 1] = before[t] + length(cross(mesh.vertices[b] - corner, mesh.vertices[c] - corner));
    }
    std::vector<std::uint32_t> chosen;
    for (std::size_t i = 0; i < samples; ++i) {
        const double at = (double(i) + 0.5) / double(samples) * before[count];
        const auto next = std::upper_bound(before.begin() + 1, before.end() - 1, at);
        chosen.push_back(static_cast<std::uint32_t>(next - before.begin() - 1));
    }
    return chosen;
}

/// The i-th of points that are spread over a triangle.
Vec3 point_of(const Triangle& t, std::span<const Vec3> vertices, std::uint32_t i) {
    double u = std::fmod(0.5 + 0.7548776662466927 * i, 1), v = std::fmod(0.5 + 0.5698402909980532 * i, 1);
    if (u + v > 1) std::tie(u, v) = std::pair(1 - u, 1 - v);
    const Vec3& corner = vertices[t[0]];
    return corner + u * (vertices[t[1]] - corner) + v * (vertices[t[2]] - corner);
}

} // namespace

std::vector<Hole> find_holes(std::span<const Triangle> triangles, std::span<const Vec3> vertices,
                             std::span<const HalfEdge> edges) {
    std::vector<Hole> holes = HoleFinder(missing_sides(edges), triangles, vertices).find();
    std::size_t work = 30'000'000; // a tenth of a second
    for (Hole& hole : holes) span(hole, vertices, work);
    return holes;
}

double size_of(const Hole& hole, std::span<const Vec3> vertices) {
    const Box box = box_of(places_of(hole, vertices));
    return length(box.high - box.low);
}

std::string text_of(const Hole& hole, std::span<const Vec3> vertices) {
    const Vec3 middle = box_of(places_of(hole, vertices)).middle();
    return std::string(hole.flat ? "flat " : "") + "hole of " + counted(hole.corners.size(), "edge") + ", "
           + text_of(size_of(hole, vertices)) + " m across, about (" + text_of(middle.x) + ", " + text_of(middle.y)
           + ", " + text_of(middle.z) + ")";
}

bool is_solid(const PreparedMesh& spanned, std::size_t first_spanning, const MeshTree& tree, Executor& executor) {
    const auto spanning = std::span(spanned.triangles).subspan(first_spanning);
    const std::size_t samples = std::clamp<std::size_t>(10'000'000 / (1 + spanning.size()), 60, 300);
    const std::vector<std::uint32_t> chosen = sampled(spanned, first_spanning, samples);
    enum Answer : char { unclear, broken, outer, inner };
    std::vector<Answer> answers(samples, unclear);
    const Winding winding(spanned, tree);
    executor.each(samples, 1, [&](std::uint32_t i) {
        const std::span<const Vec3> at(spanned.vertices);
        const Vec3 point = point_of(spanned.triangles[chosen[i]], at, i);
        double missing = 0;
        for (const auto& [a, b, c] : spanning) missing += part_of_sphere(at[a] - point, at[b] - point, at[c] - point);
        if (!(std::fabs(missing) <= 0.15)) {
            answers[i] = broken;
            return;
        }
        const std::optional<int> in_front = winding.in_front_of(chosen[i], point, std::span(&chosen[i], 1));
        if (in_front) answers[i] = *in_front + 1 >= 1 ? inner : outer; // not between faces that lie on each other
    });
    if (winding.is_too_much()) return false;
    const auto count = [&](Answer which) { return std::size_t(std::ranges::count(answers, which)); };
    const std::size_t clear = samples - count(unclear), whole = count(inner) + count(outer);
    return 2 * clear >= samples && 10 * whole >= 9 * clear && 2 * count(inner) >= clear;
}

} // namespace raycontact
