// SPDX-License-Identifier: Apache-2.0
// The surface of what is left of a body is what of its own lies outside of the other, and what of the other's lies
// inside of it, joined along the loops. So each loop is one number; which of them hang together is found by walking
// over either surface, from vertex to vertex along edges that nothing crosses.
#include "clash/parting.h"

#include "mesh/disjoint_sets.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace raycontact::clash {

namespace {

class Pieces {
public:
    Pieces(const PairMeshes& pair, const Loops& loops) : pair_(pair), loops_(loops), count_(loops.loops().size()) {
        loop_of_.resize(loops.crossings().size());
        for (std::uint32_t l = 0; l < count_; ++l) {
            const Loop& loop = loops.loops()[l];
            std::fill_n(loop_of_.begin() + loop.first, loop.count, l);
        }
        by_edge_.resize(loop_of_.size());
        std::iota(by_edge_.begin(), by_edge_.end(), 0u);
        std::ranges::sort(by_edge_, {}, [&](std::uint32_t i) {
            const Crossing& c = loops.crossings()[i];
            return std::tie(c.side, c.edge, c.at, c.face);
        });
        for (const std::uint32_t i : by_edge_) {
            const Crossing& c = loops.crossings()[i];
            const auto [p, q] = ends_of(pair.shape(c.side), c.edge);
            crossed_[c.side].insert(std::minmax(p, q));
        }
    }

    /// Of the rest of the body `side`.
    std::size_t of_rest(std::size_t side) {
        start();
        for (const std::size_t s : {side, 1 - side}) {
            const bool outside = s == side;
            join_along_edges(s, outside);
            join_within_faces(s, outside);
            walk(s, true);
        }
        return pieces();
    }

    /// Of the body itself.
    std::size_t of_body(std::size_t side) {
        if (pair_.shape(side).component_vertices.size() == 1) return 1;
        start();
        for (std::uint32_t i = 0; i < loop_of_.size(); ++i) {
            const Crossing& c = loops_.crossings()[i];
            const ShapeData& shape = pair_.shape(side);
            sets_.join(loop_of_[i],
                       vertex_node(c.side == side ? ends_of(shape, c.edge)[0] : shape.mesh.triangles[c.face][0]));
        }
        walk(side, false);
        return pieces();
    }

private:
    void start() {
        sets_.reset(count_);
        nodes_.clear();
        waiting_.clear();
    }

    std::size_t pieces() {
        std::set<std::uint32_t> found;
        for (std::uint32_t l = 0; l < count_; ++l) found.insert(sets_.of(l));
        return found.size();
    }

    std::uint32_t vertex_node(std::uint32_t vertex) {
        const auto [at, is_new] = nodes_.try_emplace(vertex, 0u);
        if (is_new) {
            at->second = sets_.add();
            waiting_.push_back(vertex);
        }
        return at->second;
    }

    std::span<const std::uint32_t> crossings_of(std::size_t side, std::uint32_t edge) const {
        const std::pair sought(std::uint32_t(side), edge);
        const auto of = [&](std::uint32_t i) {
            return std::pair(loops_.crossings()[i].side, loops_.crossings()[i].edge);
        };
        return {std::ranges::lower_bound(by_edge_, sought, {}, of), std::ranges::upper_bound(by_edge_, sought, {}, of)};
    }

    /// Of the interval of an edge before its k-th crossing; of none: what an edge without crossings has.
    std::uint32_t interval_node(std::size_t side, std::uint32_t edge, std::span<const std::uint32_t> cut,
                                std::size_t k) {
        const auto [from, to] = ends_of(pair_.shape(side), edge);
        if (k == 0) return vertex_node(from);
        return k == cut.size() ? vertex_node(to) : loop_of_[cut[k - 1]];
    }

    void join_along_edges(std::size_t side, bool outside) {
        nodes_.clear();
        for (std::size_t i = 0; i < by_edge_.size();) {
            const Crossing& first = loops_.crossings()[by_edge_[i]];
            const auto cut = crossings_of(first.side, first.edge);
            i += cut.size();
            if (first.side != side) continue;
            for (std::size_t k = 0; k < cut.size(); ++k) {
                const bool after = loops_.crossings()[cut[k]].leaves == outside;
                if (after && k + 1 < cut.size())
                    sets_.join(loop_of_[cut[k]], loop_of_[cut[k + 1]]);
                else
                    sets_.join(loop_of_[cut[k]], interval_node(side, first.edge, cut, after ? k + 1 : k));
            }
        }
    }

    /// A loop within one face meets no edge of it: along a line out of the loop another one comes next, or the face's
    /// edge.
    void join_within_faces(std::size_t side, bool outside) {
        for (std::uint32_t l = 0; l < count_; ++l) {
            const Loop& loop = loops_.loops()[l];
            const auto own = loops_.crossings().subspan(loop.first, loop.count);
            if (std::ranges::any_of(own, [&](const Crossing& c) { return c.side == side; })) continue;
            const std::uint32_t face = own[0].face;
            const Vec3 corner = pair_.corner(side, face, 0);
            const Vec3 along = unit(pair_.corner(side, face, 1) - corner);
            const Vec3 up = unit(cross(cross(along, pair_.corner(side, face, 2) - corner), along));
            const auto last = std::ranges::max_element(own, {}, [&](const Crossing& c) { return dot(c.point, along); });
            const auto j = static_cast<std::uint32_t>(last - own.begin());
            const auto way = [&](std::uint32_t segment) {
                const Vec3& n = loops_.segments()[loop.first_segment + segment].normals[1 - side];
                return unit(dot(n, along) * along + dot(n, up) * up);
            };
            const bool out = dot(way(j) + way((j + loop.count - 1) % loop.count), along) > 0;
            if (out == outside) sets_.join(l, next_along(side, face, l, last->point, along, up));
        }
    }

    std::uint32_t next_along(std::size_t side, std::uint32_t face, std::uint32_t loop, const Vec3& from,
                             const Vec3& along, const Vec3& up) {
        double nearest = std::numeric_limits<double>::infinity();
        std::uint32_t found = loop;
        const auto distance_to = [&](const Vec3& p, const Vec3& q) {
            const double before = dot(p - from, up), after = dot(q - from, up);
            if ((before > 0) == (after > 0)) return -1.0;
            return dot(p - from, along) + before / (before - after) * dot(q - p, along);
        };
        for (const LoopSegment& s : loops_.segments()) {
            const std::uint32_t other = loop_of_[s.from];
            const Crossing &p = loops_.crossings()[s.from], &q = loops_.crossings()[s.to];
            if (other == loop || !lies_in(side, face, p, q)) continue;
            const double away = distance_to(p.point, q.point);
            if (!(away > 0 && away < nearest)) continue;
            nearest = away;
            found = other;
        }
        if (found != loop) return found;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const Vec3 p = pair_.corner(side, face, k), q = pair_.corner(side, face, (k + 1) % 3);
            if (!(distance_to(p, q) > 0)) continue;
            const std::uint32_t edge = edge_of(pair_.shape(side), face, k);
            const Vec3 start = pair_.vertex(side, ends_of(pair_.shape(side), edge)[0]);
            const double at = length(from + distance_to(p, q) * along - start) / length(q - p);
            const auto cut = crossings_of(side, edge);
            const auto before = static_cast<std::size_t>(
                std::ranges::count_if(cut, [&](std::uint32_t i) { return loops_.crossings()[i].at < at; }));
            return interval_node(side, edge, cut, before);
        }
        return loop;
    }

    /// Whether the way between two crossings that follow each other lies in a face.
    bool lies_in(std::size_t side, std::uint32_t face, const Crossing& p, const Crossing& q) const {
        const auto touches = [&](const Crossing& c) {
            if (c.side != side) return c.face == face;
            const EdgeFaces faces = faces_of(pair_.shape(side), c.edge);
            return faces.own == face || faces.across == face;
        };
        return touches(p) && touches(q);
    }

    // Around each vertex; of one on a border or in several fans, the one that its lowest triangle is in.
    void walk(std::size_t side, bool ends_at_crossings) {
        const ShapeData& shape = pair_.shape(side);
        for (std::size_t visited = 1; !waiting_.empty(); ++visited) {
            const std::uint32_t own = waiting_.back();
            waiting_.pop_back();
            const std::uint32_t begin = shape.vertex_triangle[own];
            std::uint32_t t = begin;
            do {
                const auto& corners = shape.mesh.triangles[t];
                const std::size_t c = corners[0] == own ? 0 : corners[1] == own ? 1 : 2;
                for (const std::uint32_t other : {corners[(c + 1) % 3], corners[(c + 2) % 3]})
                    if (!ends_at_crossings || !crossed_[side].contains(std::minmax(own, other)))
                        sets_.join(nodes_.at(own), vertex_node(other));
                t = shape.neighbours[t][c];
            } while (t != begin && t != NONE);
            constexpr std::size_t now_and_then = 1024;
            if (visited % now_and_then == 0 && pieces() == 1) waiting_.clear();
        }
        nodes_.clear();
    }

    const PairMeshes& pair_;
    const Loops& loops_;
    std::size_t count_;
    std::vector<std::uint32_t> loop_of_, by_edge_; ///< by crossing; crossings, those of an edge along it
    std::array<std::set<std::pair<std::uint32_t, std::uint32_t>>, 2> crossed_; ///< edges, by their vertices
    DisjointSets sets_;                                                        ///< loops, then vertices
    std::unordered_map<std::uint32_t, std::uint32_t> nodes_;                   ///< by vertex, of one side
    std::vector<std::uint32_t> waiting_;                                       ///< vertices
};

} // namespace

bool falls_apart(const PairMeshes& pair, const Loops& loops, std::size_t side) {
    if (loops.loops().size() < 2) return false; // the loop is in one piece
    Pieces pieces(pair, loops);
    const std::size_t rest = pieces.of_rest(side);
    return rest > 1 && rest > pieces.of_body(side);
}

} // namespace raycontact::clash
