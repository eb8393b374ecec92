// SPDX-License-Identifier: Apache-2.0
#include "mesh/unite.h"

#include "interruption.h"
#include "mesh/degenerate.h"
#include "mesh/input_file.h"
#include "mesh/nesting.h"
#include "mesh/predicates.h"
#include "mesh/self_intersection.h"
#include "mesh/subdivision.h"
#include "mesh/triangle_pair.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <unordered_map>

namespace raycontact {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// The pairs of triangles that meet elsewhere than in what they share, sorted; nothing if they are more than `most`.
std::optional<std::vector<Pair>> crossing_pairs(const PreparedMesh& mesh, std::span<const Vec3> exact,
                                                const MeshTree& tree, Executor& executor, std::size_t most) {
    std::vector<Pair> pairs;
    std::mutex mutex;
    const bool too_many = tree.any_pair(executor, [&](std::uint32_t i, std::uint32_t k) {
        if (!triangles_meet(exact, mesh.triangles[i], mesh.triangles[k])) return false;
        const std::lock_guard lock(mutex);
        pairs.push_back(std::minmax(i, k));
        return pairs.size() > most;
    });
    if (too_many) return std::nullopt;
    std::ranges::sort(pairs);
    return pairs;
}

/// Cuts the triangles of a mesh at each other.
class Arrangement {
public:
    Arrangement(const PreparedMesh& mesh, std::span<const Vec3> exact)
        : mesh_(mesh), exact_(exact), table_(size_of(exact)) {}

    /// False if that is too much work.
    bool cut(std::span<const Pair> pairs) {
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

    /// Vertices and triangles, uncut ones and pieces. A point that is nearer than `tolerance` to one before it is that.
    void list(double tolerance, United& result) const {
        result.vertices = mesh_.vertices;
        std::map<std::array<double, 3>, std::vector<std::uint32_t>> cells;
        const auto find = [&](const Vec3& p, std::uint32_t number) {
            const auto cell = [&](double x) { return std::floor(x / (8 * tolerance)) + 0.0; }; // + 0: no -0
            for (const double x : {cell(p.x - tolerance), cell(p.x + tolerance)})
                for (const double y : {cell(p.y - tolerance), cell(p.y + tolerance)})
                    for (const double z : {cell(p.z - tolerance), cell(p.z + tolerance)})
                        if (const auto found = cells.find({x, y, z}); found != cells.end())
                            for (const std::uint32_t v : found->second)
                                if (length(result.vertices[v] - p) < tolerance) return v;
            cells[{cell(p.x), cell(p.y), cell(p.z)}].push_back(number);
            return number;
        };
        if (tolerance > 0)
            for (std::uint32_t v = 0; v < mesh_.vertices.size(); ++v) find(mesh_.vertices[v], v);
        std::vector<std::uint32_t> number(table_.size());
        for (std::uint32_t p = 0; p < table_.size(); ++p) {
            if (const auto vertex = vertex_of_.find(p); vertex != vertex_of_.end()) {
                number[p] = vertex->second;
                continue;
            }
            const auto next = static_cast<std::uint32_t>(result.vertices.size());
            number[p] = tolerance > 0 ? find(table_[p].rough, next) : next;
            if (number[p] == next) result.vertices.push_back(table_[p].rough);
        }
        for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            const auto cut = pieces_.find(t);
            if (cut == pieces_.end()) {
                result.triangles.push_back(mesh_.triangles[t]);
                result.of.push_back(t);
                continue;
            }
            for (const Triangle& piece : cut->second) {
                result.triangles.push_back(as_wound(t, {number[piece[0]], number[piece[1]], number[piece[2]]}));
                result.of.push_back(t);
            }
        }
    }

private:
    static double size_of(std::span<const Vec3> vertices) {
        double size = 0;
        for (const Vec3& v : vertices) size = std::max({size, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
        return size;
    }

    /// Turned so that corners of the triangle are where it has them.
    Triangle as_wound(std::uint32_t t, Triangle piece) const {
        for (std::size_t turns = 0; turns < 3; ++turns) {
            for (std::size_t k = 0; k < 3; ++k)
                if (piece[k] == mesh_.triangles[t][k]) return piece;
            std::rotate(piece.begin(), piece.begin() + 1, piece.end());
        }
        return piece;
    }

    std::uint32_t point_of(std::uint32_t vertex) {
        const auto [found, is_new] = point_of_.try_emplace(vertex, 0);
        if (is_new) {
            found->second = table_.add(ExactPoint(exact_[vertex]));
            vertex_of_.emplace(found->second, vertex);
        }
        return found->second;
    }

    Subdivision& subdivision_of(std::uint32_t t) {
        const auto found = subdivisions_.find(t);
        if (found != subdivisions_.end()) return found->second;
        const auto [a, b, c] = mesh_.triangles[t];
        return subdivisions_.try_emplace(t, table_, Triangle{point_of(a), point_of(b), point_of(c)}, work_)
            .first->second;
    }

    std::array<Vec3, 3> corners_of(std::uint32_t t) const {
        const auto [a, b, c] = mesh_.triangles[t];
        return {exact_[a], exact_[b], exact_[c]};
    }

    /// Adds what two triangles share to both.
    void meet(std::uint32_t i, std::uint32_t k) {
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

    /// Where the edges of one triangle cross another, in whose plane they do not lie all.
    void add_crossings(std::uint32_t t, const std::array<int, 3>& sides, std::uint32_t other,
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
                const Dyadic height = dot(area_normal(target[0], target[1], target[2]), ExactVec3(p) - target[0]);
                return height.sign() < 0 ? Dyadic() - height : height;
            };
            found.push_back(table_.add(
                between(ExactPoint(corners[k]), ExactPoint(corners[next]), away(corners[k]), away(corners[next]))));
        }
    }

    /// Adds to a triangle what of the edges of another one in its plane lies in it.
    void overlap(std::uint32_t t, std::uint32_t other) {
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
                if (point_in_triangle(target[end], corners, drop))
                    shared.push_back(point_of(mesh_.triangles[other][end]));
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 &p = corners[k], &q = corners[(k + 1) % 3];
                if (on(from, to, p)) shared.push_back(point_of(mesh_.triangles[t][k]));
                if (turn(from, to, p) * turn(from, to, q) >= 0 || turn(p, q, from) * turn(p, q, to) >= 0) continue;
                const ExactPoint line_p(p), line_q(q), edge_from(from), edge_to(to);
                const auto away = [&](const ExactPoint& point) {
                    const Dyadic area = area_of(line_p, line_q, point, drop);
                    return area.sign() < 0 ? Dyadic() - area : area;
                };
                shared.push_back(table_.add(between(edge_from, edge_to, away(edge_from), away(edge_to))));
            }
            add_line(shared, subdivision_of(t));
        }
    }

    /// Points on one line, of which a triangle has what lies between them.
    void add_line(std::vector<std::uint32_t>& points, Subdivision& to) {
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

    const PreparedMesh& mesh_;
    std::span<const Vec3> exact_;
    PointTable table_;
    std::size_t work_ = 0;                                                  ///< what may still be done
    std::unordered_map<std::uint32_t, std::uint32_t> point_of_, vertex_of_; ///< of vertices, and back
    std::map<std::uint32_t, Subdivision> subdivisions_;                     ///< by triangle
    std::map<std::uint32_t, std::vector<Triangle>> pieces_;
};

/// Which patches of pieces are the surface of what has a winding number of at least 1.
class Classifier {
public:
    Classifier(const PreparedMesh& mesh, const United& cut, const Patches& patches, const MeshTree& tree,
               std::span<const Pair> pairs, std::span<const Vec3> exact)
        : mesh_(mesh), cut_(cut), winding_(mesh, tree), by_patch_(patches.list.size()) {
        for (const auto& [i, k] : pairs) {
            const Triangle& own = mesh.triangles[i];
            const auto flat = [&](std::uint32_t t) {
                return std::ranges::all_of(mesh.triangles[t], [&](std::uint32_t v) {
                    return orient3d(exact[own[0]], exact[own[1]], exact[own[2]], exact[v]) == 0;
                });
            };
            if (!flat(k)) continue;
            beside_[i].push_back(k);
            beside_[k].push_back(i);
        }
        for (std::uint32_t p = 0; p < cut.triangles.size(); ++p) by_patch_[patches.of[p]].push_back(p);
    }

    bool is_too_much() const { return winding_.is_too_much(); }

    enum class Answer : char { unclear, stays, goes };
    Answer of(std::uint32_t patch) const {
        std::vector<std::pair<double, std::uint32_t>> largest;
        for (const std::uint32_t p : by_patch_[patch]) largest.emplace_back(-area_of(p), p);
        constexpr std::size_t most = 64; // some of a patch may lie so near to others that rays cannot tell
        const auto end = largest.begin() + static_cast<std::ptrdiff_t>(std::min(most, largest.size()));
        std::partial_sort(largest.begin(), end, largest.end());
        for (auto at = largest.begin(); at != end; ++at)
            if (const Answer answer = of_piece(at->second); answer != Answer::unclear) return answer;
        return largest.empty() || largest[0].first == 0 ? Answer::stays
                                                        : Answer::unclear; // without area it bounds nothing
    }

    /// The share of the area that has this answer.
    double share_of(Answer which, std::span<const Answer> answers) const {
        double own = 0, all = 0;
        for (std::size_t patch = 0; patch < answers.size(); ++patch)
            for (const std::uint32_t piece : by_patch_[patch]) {
                all += area_of(piece);
                own += answers[patch] == which ? area_of(piece) : 0;
            }
        return all > 0 ? own / all : 0;
    }

private:
    Vec3 corner(std::uint32_t piece, std::size_t k) const { return cut_.vertices[cut_.triangles[piece][k]]; }
    Vec3 normal_of(std::uint32_t piece) const {
        return cross(corner(piece, 1) - corner(piece, 0), corner(piece, 2) - corner(piece, 0));
    }
    double area_of(std::uint32_t piece) const { return length(normal_of(piece)); }

    Answer of_piece(std::uint32_t piece) const {
        const std::uint32_t own = cut_.of[piece];
        const Vec3 point = (1.0 / 3) * (corner(piece, 0) + corner(piece, 1) + corner(piece, 2));
        const Vec3 normal = normal_of_triangle(own);
        // Those that lie on the piece, with the same front or with the other one.
        std::vector<std::uint32_t> stack{own};
        int behind = 1;
        bool first = true;
        if (const auto beside = beside_.find(own); beside != beside_.end())
            for (const std::uint32_t other : beside->second) {
                const std::optional<bool> covers = covers_point(other, point, normal);
                if (!covers) return Answer::unclear;
                if (!*covers) continue;
                stack.push_back(other);
                const bool same = dot(normal_of_triangle(other), normal) > 0;
                behind += same ? 1 : -1;
                first = first && !(same && other < own);
            }
        const std::optional<int> in_front = winding_.in_front_of(own, point, stack);
        if (!in_front) return Answer::unclear;
        return first && *in_front < 1 && *in_front + behind >= 1 ? Answer::stays : Answer::goes;
    }

    Vec3 normal_of_triangle(std::uint32_t t) const {
        const auto [a, b, c] = mesh_.triangles[t];
        return cross(mesh_.vertices[b] - mesh_.vertices[a], mesh_.vertices[c] - mesh_.vertices[a]);
    }

    /// Of a triangle in the plane of the point; nothing where rounding could change it.
    std::optional<bool> covers_point(std::uint32_t t, const Vec3& point, const Vec3& normal) const {
        bool left = true, clear = true;
        const double way = dot(normal_of_triangle(t), normal) > 0 ? 1 : -1;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &p = mesh_.vertices[mesh_.triangles[t][k]], &q = mesh_.vertices[mesh_.triangles[t][(k + 1) % 3]];
            const double turn = way * dot(normal, cross(q - p, point - p));
            const double error = 1e-12 * length(normal) * length(q - p) * (length(point - p) + length(point));
            if (turn < -error) return false;
            left = left && turn > 0;
            clear = clear && std::fabs(turn) > error;
        }
        return clear ? std::optional(left) : std::nullopt;
    }

    const PreparedMesh& mesh_;
    const United& cut_;
    Winding winding_;
    std::vector<std::vector<std::uint32_t>> by_patch_;
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> beside_; ///< triangles in the plane of another
};

using Answers = std::vector<Classifier::Answer>;

/// Decides about patches that are too small to see, or too near to others: what stays is closed, so an edge of which
/// all other patches are known tells. False if that is not so in the end.
bool close(const Patches& patches, std::span<const HalfEdge> edges, Answers& answers) {
    using enum Classifier::Answer;
    constexpr int most_passes = 64; // of chains of patches that wait for each other
    bool changed = true;
    for (int pass = 0; changed && pass < most_passes; ++pass) {
        changed = false;
        for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
            int balance = 0;
            std::optional<std::uint32_t> open;
            for (const HalfEdge& side : sides) {
                const std::uint32_t patch = patches.of[side.triangle()];
                if (answers[patch] == stays) balance += side.forward ? 1 : -1;
                if (answers[patch] != unclear) continue;
                if (open) return; // two are unknown, or one that meets itself
                open = patch;
            }
            if (!open) return;
            answers[*open] = balance != 0 ? stays : goes;
            changed = true;
        });
    }
    std::ranges::replace(answers, unclear, goes);
    bool closed = true;
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
        int balance = 0;
        for (const HalfEdge& side : sides)
            if (answers[patches.of[side.triangle()]] == stays) balance += side.forward ? 1 : -1;
        closed = closed && balance == 0;
    });
    return closed;
}

} // namespace

United unite(const PreparedMesh& mesh, const Patches& whole, std::span<const Vec3> exact, const MeshTree& tree,
             double tolerance, Executor& executor) {
    const auto given_up = [] { return United{.done = United::Done::given_up}; };
    const auto pairs = crossing_pairs(mesh, exact, tree, executor, 4 * mesh.triangles.size() + 20'000);
    if (!pairs) return given_up();
    if (pairs->empty() && winds_outward(mesh, whole, tree)) return {};
    if (pairs->empty() && tolerance > 0) return {.done = United::Done::stays};
    Arrangement arrangement(mesh, exact);
    if (!arrangement.cut(*pairs)) return given_up();
    United cut;
    arrangement.list(tolerance, cut);
    if (cut.triangles.size() > most_triangles) return given_up();
    const std::vector<HalfEdge> edges = sorted_half_edges(cut.triangles);
    const Patches patches = find_patches(cut.triangles, edges);
    const Classifier classifier(mesh, cut, patches, tree, *pairs, exact);
    Answers answers(patches.list.size());
    executor.each(answers.size(), 1, [&](std::uint32_t p) { answers[p] = classifier.of(p); });
    if (classifier.is_too_much() || classifier.share_of(Classifier::Answer::unclear, answers) > 0.1
        || !close(patches, edges, answers))
        return given_up();

    if (std::ranges::count(answers, Classifier::Answer::stays) == 0) return {.done = United::Done::stays};
    United united{.done = United::Done::union_, .vertices = std::move(cut.vertices)};
    std::vector<std::uint32_t> pieces(mesh.triangles.size(), 0), kept(mesh.triangles.size(), 0);
    for (std::uint32_t p = 0; p < cut.triangles.size(); ++p) {
        ++pieces[cut.of[p]];
        if (answers[patches.of[p]] == Classifier::Answer::goes) continue;
        ++kept[cut.of[p]];
        united.triangles.push_back(cut.triangles[p]);
        united.of.push_back(cut.of[p]);
    }
    for (std::size_t t = 0; t < pieces.size(); ++t) {
        united.split += pieces[t] > 1;
        united.buried += kept[t] == 0;
    }
    return united;
}

} // namespace raycontact
