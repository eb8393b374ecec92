// SPDX-License-Identifier: Apache-2.0
#include "mesh/degenerate.h"

#include "interruption.h"
#include "mesh/disjoint_sets.h"
#include "mesh/lowest_equal.h"
#include "mesh/predicates.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace raycontact {
namespace {

bool has_repeated(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

Triangle sorted(Triangle t) {
    std::ranges::sort(t);
    return t;
}

/// The lowest vertex first, the same winding.
Triangle turned(Triangle t) {
    std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    return t;
}

constexpr std::uint32_t none = 0xffffffffu;

class Dropper {
public:
    Dropper(std::vector<Triangle>& triangles, std::span<const Vec3> vertices)
        : triangles_(triangles), vertices_(vertices) {
        result_.triangles.assign(triangles.size(), 0);
    }

    Dropped find() {
        find_candidates();
        if (candidates_.empty()) return std::move(result_);
        drop_pairs();
        find_edges();
        drop_groups();
        drop_singles();
        drop_groups();
        split_instead();
        return std::move(result_);
    }

private:
    bool dropped(std::uint32_t t) const { return result_.triangles[t] != 0; }

    void drop(std::uint32_t t) {
        result_.triangles[t] = 1;
        ++(flat_[t] ? result_.degenerate : result_.duplicate);
    }

    /// A triangle that has a vertex twice meets one edge twice and goes at once.
    void find_candidates() {
        std::vector<std::uint32_t> copies;
        flat_.resize(triangles_.size());
        std::vector<Triangle> wound(triangles_);
        for (Triangle& t : wound) t = sorted(t);
        std::vector<std::uint32_t> lowest = lowest_equal(wound);
        std::vector<std::uint32_t> own(lowest.size());
        std::iota(own.begin(), own.end(), 0u);
        if (lowest != own) {
            drop_backs(lowest);
            for (std::size_t t = 0; t < wound.size(); ++t) wound[t] = turned(triangles_[t]);
            lowest = lowest_equal(wound);
        }
        const InterruptionCheck check;
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            check();
            flat_[t] = is_degenerate(triangles_[t], vertices_);
            if (dropped(t)) continue;
            if (has_repeated(triangles_[t]))
                drop(t);
            else if (flat_[t])
                candidates_.push_back(t);
            else if (lowest[t] != t)
                copies.push_back(t);
        }
        if (copies.empty()) return;
        // Where the surface is open, doubling does not close it: there copies go at once.
        std::vector<char> open(triangles_.size(), 0);
        spread(open, 2);
        for (const std::uint32_t t : copies) {
            if (open[t])
                drop(t);
            else
                candidates_.push_back(t);
        }
    }

    /// Of a part, connected over edges, whose triangles all lie back to back with one other, the later ones go where
    /// the rest is closed. same: of each triangle the first with its vertices.
    void drop_backs(std::span<const std::uint32_t> same) {
        std::vector<std::uint32_t> back(triangles_.size(), none); // of the first its only other, of that the first
        std::vector<char> stays(triangles_.size(), 0);
        for (std::uint32_t t = 0; t < same.size(); ++t) {
            const std::uint32_t first = same[t];
            if (first == t) continue;
            Triangle other = triangles_[t];
            std::swap(other[1], other[2]);
            const bool is_back = back[first] == none && turned(other) == turned(triangles_[first]);
            if (!is_back) stays[first] = stays[t] = 1;
            back[t] = first;
            back[first] = t;
        }
        for (std::uint32_t t = 0; t < triangles_.size(); ++t)
            if (back[t] == none || has_repeated(triangles_[t])) stays[t] = 1;
        spread(stays, 4);
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            if (stays[t] || back[t] > t) continue;
            result_.triangles[t] = 1;
            ++result_.back_to_back;
        }
    }

    /// Marks the whole of each part, connected over edges, that has a triangle that is marked, or an edge whose number
    /// of triangles is no multiple of one.
    void spread(std::vector<char>& marks, std::size_t multiple) const {
        DisjointSets parts;
        parts.reset(triangles_.size());
        std::vector<std::uint32_t> others;
        const std::vector<HalfEdge> edges = sorted_half_edges(triangles_);
        for_each_edge(edges, [&](std::span<const HalfEdge> sides) {
            for (const HalfEdge& side : sides) parts.join(side.triangle(), sides[0].triangle());
            if (sides.size() % multiple != 0) others.push_back(sides[0].triangle());
        });
        for (const std::uint32_t t : others) marks[parts.of(t)] = 1;
        for (std::uint32_t t = 0; t < triangles_.size(); ++t)
            if (marks[t]) marks[parts.of(t)] = 1;
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) marks[t] = marks[parts.of(t)];
    }

    /// Two candidates with the same vertices: no edge turns odd without them. Of degenerate ones the winding means
    /// nothing. Sorts them, so that the order of the file decides nothing but which of equal ones goes.
    void drop_pairs() {
        const auto key = [&](std::uint32_t t) { return flat_[t] ? sorted(triangles_[t]) : turned(triangles_[t]); };
        std::ranges::sort(candidates_, [&](std::uint32_t a, std::uint32_t b) {
            return std::tuple(flat_[a], key(a), a) < std::tuple(flat_[b], key(b), b);
        });
        std::vector<std::uint32_t> left;
        for (const std::uint32_t t : candidates_) {
            if (!left.empty() && flat_[left.back()] == flat_[t] && key(left.back()) == key(t)) {
                drop(left.back());
                drop(t);
                left.pop_back();
            } else {
                left.push_back(t);
            }
        }
        candidates_ = std::move(left);
    }

    using Edge = std::uint64_t;
    static Edge edge(std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }
    std::array<Edge, 3> edges_of(std::uint32_t t) const {
        const auto [a, b, c] = triangles_[t];
        return {edge(a, b), edge(b, c), edge(c, a)};
    }

    /// The triangles at each edge of a candidate.
    void find_edges() {
        is_candidate_.assign(triangles_.size(), 0);
        for (const std::uint32_t t : candidates_) {
            is_candidate_[t] = 1;
            for (const Edge e : edges_of(t)) at_[e];
        }
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            if (dropped(t)) continue;
            for (const Edge e : edges_of(t)) {
                const auto found = at_.find(e);
                if (found != at_.end()) found->second.push_back(t);
            }
        }
        constexpr std::size_t most = 64; // no real mesh has so many at an edge, and they are looked through often
        std::erase_if(candidates_, [&](std::uint32_t t) {
            const bool many = std::ranges::any_of(edges_of(t), [&](Edge e) { return at_.at(e).size() > most; });
            if (many) is_candidate_[t] = 0;
            return many;
        });
    }

    bool closed(Edge e) const { return at_.at(e).size() % 2 == 0; }

    void remove(std::uint32_t t) {
        drop(t);
        is_candidate_[t] = 0;
        for (const Edge e : edges_of(t)) std::erase(at_.at(e), t);
    }

    /// Whether an edge that is closed would open without the chosen ones.
    bool opens(Edge e) const {
        return closed(e) && std::ranges::count_if(at_.at(e), [&](std::uint32_t t) { return chosen_[t] != 0; }) % 2 != 0;
    }

    /// Candidates that are connected over edges go together where no closed edge opens.
    void drop_groups() {
        chosen_ = is_candidate_;
        // Those that would open more edges than they keep closed are left out: a fin of two on a doubled surface.
        std::vector<std::uint32_t> open(candidates_.rbegin(), candidates_.rend());
        while (!open.empty()) {
            const std::uint32_t t = open.back();
            open.pop_back();
            if (!chosen_[t] || std::ranges::count_if(edges_of(t), [&](Edge e) { return opens(e); }) < 2) continue;
            chosen_[t] = 0;
            for_each_neighbour(t, chosen_, [&](std::uint32_t other) { open.push_back(other); });
        }
        std::vector<std::uint32_t> group;
        for (const std::uint32_t seed : candidates_) {
            if (!chosen_[seed]) continue;
            group.assign(1, seed);
            bool any = false;
            chosen_[seed] = 2; // seen
            for (std::size_t i = 0; i < group.size(); ++i) {
                any = any || std::ranges::any_of(edges_of(group[i]), [&](Edge e) { return opens(e); });
                for_each_neighbour(group[i], chosen_, [&](std::uint32_t other) {
                    if (chosen_[other] == 1) group.push_back(other);
                    chosen_[other] = 2;
                });
            }
            for (const std::uint32_t t : group) {
                chosen_[t] = 0;
                if (!any) remove(t);
            }
        }
    }

    /// Visits those across the edges of a triangle, itself included, that are marked.
    template <class Visit>
    void for_each_neighbour(std::uint32_t t, const std::vector<char>& marked, Visit&& visit) const {
        for (const Edge e : edges_of(t))
            for (const std::uint32_t other : at_.at(e))
                if (marked[other]) visit(other);
    }

    /// One alone goes where more edges close than open: it hangs on a surface, or lies on its border.
    void drop_singles() {
        std::vector<std::uint32_t> open(candidates_.rbegin(), candidates_.rend());
        while (!open.empty()) {
            const std::uint32_t t = open.back();
            open.pop_back();
            if (!is_candidate_[t] || std::ranges::count_if(edges_of(t), [&](Edge e) { return closed(e); }) > 1)
                continue;
            remove(t);
            for_each_neighbour(t, is_candidate_, [&](std::uint32_t other) { open.push_back(other); });
        }
    }

    /// a and c are the ends of the line, b lies between them. The triangle across the long edge, a c p, becomes a b p,
    /// and the degenerate one b c p.
    void split_instead() {
        std::vector<std::uint32_t> open(candidates_.rbegin(), candidates_.rend());
        while (!open.empty()) {
            const std::uint32_t t = open.back();
            open.pop_back();
            if (!is_candidate_[t] || !flat_[t]) continue;
            Triangle line = triangles_[t];
            std::ranges::sort(line, [&](std::uint32_t i, std::uint32_t k) {
                const Vec3 &p = vertices_[i], &q = vertices_[k];
                return std::tuple(p.x, p.y, p.z) < std::tuple(q.x, q.y, q.z);
            });
            const auto [a, b, c] = line;
            const std::vector<std::uint32_t>& across = at_.at(edge(a, c));
            if (across.size() != 2) continue;
            const std::uint32_t other = across[0] == t ? across[1] : across[0];
            if (flat_[other] || other == t) continue; // its turn may come
            Triangle whole = triangles_[other];       // turned until its edge from or to a comes first
            while (edge(whole[0], whole[1]) != edge(a, c)) std::rotate(whole.begin(), whole.begin() + 1, whole.end());
            const auto [from, to, apex] = whole;
            at_.at(edge(a, c)).clear();
            replace(edge(from, b), t, other);
            replace(edge(to, apex), other, t);
            const auto cut = at_.find(edge(b, apex));
            if (cut != at_.end()) cut->second.insert(cut->second.end(), {t, other});
            triangles_[other] = {from, b, apex};
            triangles_[t] = {b, to, apex};
            is_candidate_[t] = 0;
            flat_[t] = false;
            ++result_.split;
            for (const Edge e : {edge(a, b), edge(b, c)})
                for (const std::uint32_t next : at_.at(e))
                    if (is_candidate_[next]) open.push_back(next);
        }
    }

    void replace(Edge e, std::uint32_t old, std::uint32_t with) {
        const auto found = at_.find(e);
        if (found != at_.end()) std::ranges::replace(found->second, old, with);
    }

    std::vector<Triangle>& triangles_;
    std::span<const Vec3> vertices_;
    std::vector<bool> flat_;
    std::vector<std::uint32_t> candidates_;
    std::vector<char> is_candidate_;
    std::vector<char> chosen_; ///< 1: to be dropped in a group, 2: seen
    std::unordered_map<Edge, std::vector<std::uint32_t>> at_;
    Dropped result_;
};

} // namespace

bool is_degenerate(const Triangle& triangle, std::span<const Vec3> vertices) {
    const auto [a, b, c] = triangle;
    return has_repeated(triangle) || collinear(snapped(vertices[a]), snapped(vertices[b]), snapped(vertices[c]));
}

std::vector<std::uint32_t> triangles_with_area(std::span<const Triangle> triangles, std::span<const Vec3> vertices) {
    std::vector<std::uint32_t> with_area;
    for (std::uint32_t i = 0; i < triangles.size(); ++i)
        if (!is_degenerate(triangles[i], vertices)) with_area.push_back(i);
    return with_area;
}

Dropped drop_degenerate(std::vector<Triangle>& triangles, std::span<const Vec3> vertices) {
    return Dropper(triangles, vertices).find();
}

} // namespace raycontact
