// SPDX-License-Identifier: Apache-2.0
#include "mesh/unite.h"

#include "mesh/input_file.h"
#include "mesh/nesting.h"
#include "mesh/predicates.h"
#include "mesh/self_intersection.h"

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

/// Which patches of pieces are the surface of what has a winding number of at least 1.
class Classifier {
public:
    Classifier(const PreparedMesh& mesh, const CutMesh& cut, const Patches& patches, const MeshTree& tree,
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
    const CutMesh& cut_;
    Winding winding_;
    std::vector<std::vector<std::uint32_t>> by_patch_;
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> beside_; ///< triangles in the plane of another
};

using Answers = std::vector<Classifier::Answer>;

/// Decides about patches that are too small to see, or too near to others: what stays is closed, so an edge of which
/// all other patches are known tells. False if that is not so in the end.
bool close(const Patches& patches, std::span<const HalfEdge> edges, Answers& answers) {
    using enum Classifier::Answer;
    const auto balance_of_those_that_stay = [&](std::span<const HalfEdge> sides) {
        int balance = 0;
        for (const HalfEdge& side : sides)
            if (answers[patches.of[side.triangle()]] == stays) balance += side.forward ? 1 : -1;
        return balance;
    };
    constexpr int most_passes = 64; // of chains of patches that wait for each other
    bool changed = true;
    for (int pass = 0; changed && pass < most_passes; ++pass) {
        changed = false;
        for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
            const auto is_open = [&](const HalfEdge& side) { return answers[patches.of[side.triangle()]] == unclear; };
            if (std::ranges::count_if(sides, is_open) != 1) return;
            const std::uint32_t patch = patches.of[std::ranges::find_if(sides, is_open)->triangle()];
            answers[patch] = balance_of_those_that_stay(sides) != 0 ? stays : goes;
            changed = true;
        });
    }
    std::ranges::replace(answers, unclear, goes);
    bool closed = true;
    for_each_edge(edges,
                  [&](std::span<const HalfEdge> sides) { closed = closed && balance_of_those_that_stay(sides) == 0; });
    return closed;
}

/// Of the pieces those that are the surface of the union; nothing where rays and edges cannot tell.
std::optional<United> surface_of(CutMesh cut, const PreparedMesh& mesh, std::span<const Vec3> exact,
                                 const MeshTree& tree, std::span<const Pair> pairs, Executor& executor) {
    const std::vector<HalfEdge> edges = sorted_half_edges(cut.triangles);
    const Patches patches = find_patches(cut.triangles, edges);
    const Classifier classifier(mesh, cut, patches, tree, pairs, exact);
    Answers answers(patches.list.size());
    executor.each(answers.size(), 1, [&](std::uint32_t p) { answers[p] = classifier.of(p); });
    constexpr double most_unclear = 0.1; // of the area
    if (classifier.is_too_much() || classifier.share_of(Classifier::Answer::unclear, answers) > most_unclear
        || !close(patches, edges, answers))
        return std::nullopt;

    United united{.done = United::Done::stays};
    std::vector<std::uint32_t> pieces(mesh.triangles.size(), 0), kept(mesh.triangles.size(), 0);
    for (std::uint32_t p = 0; p < cut.triangles.size(); ++p) {
        ++pieces[cut.of[p]];
        if (answers[patches.of[p]] == Classifier::Answer::goes) continue;
        ++kept[cut.of[p]];
        united.cut.triangles.push_back(cut.triangles[p]);
        united.cut.of.push_back(cut.of[p]);
    }
    if (united.cut.triangles.empty()) return united;
    for (std::size_t t = 0; t < pieces.size(); ++t) {
        united.split += pieces[t] > 1;
        united.buried += kept[t] == 0;
    }
    united.done = United::Done::union_;
    united.cut.vertices = std::move(cut.vertices);
    return united;
}

} // namespace

United unite(const PreparedMesh& mesh, const Patches& patches, std::span<const Vec3> exact, const MeshTree& tree,
             double near, bool again, Executor& executor) {
    United given_up{.done = United::Done::given_up};
    const auto pairs = crossing_pairs(mesh, exact, tree, executor, 4 * mesh.triangles.size() + 20'000);
    if (!pairs) return given_up;
    if (pairs->empty() && winds_outward(mesh, patches, tree)) return {};
    if (pairs->empty() && again) return {.done = United::Done::stays};
    Arrangement arrangement(mesh, exact);
    if (!arrangement.cut(*pairs)) return given_up;
    for (const double tolerance : {again ? near : 0, near}) {
        CutMesh cut = arrangement.list(tolerance);
        if (cut.triangles.size() > most_triangles) return given_up;
        if (auto united = surface_of(std::move(cut), mesh, exact, tree, *pairs, executor)) return std::move(*united);
        if (again) break;
    }
    return given_up;
}

} // namespace raycontact
