// SPDX-License-Identifier: Apache-2.0
#include "reference/edges.h"

#include "reference/graph.h"
#include "reference/ray.h"
#include "reference/side.h"
#include "reference/solid_edges.h"
#include "reference/vector.h"

#include <scenes/random.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace raycontact::reference {

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

Vec3 shake(std::uint32_t vertex) {
    std::uint64_t state = vertex;
    double s[3];
    for (double& x : s) x = static_cast<double>(scenes::splitmix64(state) >> 11) * 0x1p-52 - 1;
    return {s[0], s[1], s[2]};
}

double angle(const Vec3& p, const Vec3& q) {
    return std::atan2(length(cross(p, q)), dot(p, q));
}

// A body of the pair, in the frame in which all is decided: that of b, about its centre.
struct Body {
    const Solid& solid;
    Pose pose; ///< in that frame
    std::vector<Edge> edges;
    std::vector<std::vector<const Edge*>> around; ///< each face
    std::vector<Vec3> vertices, normals;          ///< moved by a perturbation; of faces
    std::map<std::uint32_t, double> contact;      ///< vertices in contact: their depth
    RayCaster caster;

    Body(const Solid& s, const Pose& p, double perturbation, double shaken)
        : solid(s), pose(p), edges(edges_of(s)), around(s.triangles.size()), caster(s) {
        for (std::uint32_t v = 0; v < s.vertices.size(); ++v)
            vertices.push_back(p.translation
                               + rotate(p, s.vertices[v] + perturbation * (shaken * shake(v) - s.vertex_normals[v])));
        for (const Vec3& n : s.face_normals) normals.push_back(rotate(p, n));
        for (const Edge& e : edges)
            for (const std::uint32_t f : e.faces)
                if (f != none) around[f].push_back(&e);
    }
    Vec3 along(const Edge& e) const { return vertices[e.to] - vertices[e.from]; }
    std::array<Vec3, 2> normals_at(const Edge& e) const {
        return {normals[e.faces[0]], normals[e.faces[e.faces[1] == none ? 0 : 1]]};
    }
    Hit exit_along(const Vec3& from, const Vec3& way) {
        const Hit hit = caster.closest(rotate_back(pose, from - pose.translation), rotate_back(pose, way));
        return hit.triangle != Hit::none && hit.from_inside ? hit : Hit{Hit::none, 0, false};
    }
    const Edge* nearest_edge(std::uint32_t face, const Vec3& point) const {
        const auto away = [&](const Edge* e) { return length(cross(unit(along(*e)), point - vertices[e->from])); };
        return *std::min_element(around[face].begin(), around[face].end(),
                                 [&](const Edge* x, const Edge* y) { return away(x) < away(y); });
    }
    double area_at(const Edge& e) const {
        double area = 0;
        for (const std::uint32_t f : e.faces) {
            if (f == none) continue;
            const auto& [p, q, r] = solid.triangles[f];
            area += length(cross(solid.vertices[q] - solid.vertices[p], solid.vertices[r] - solid.vertices[p])) / 2;
        }
        return area;
    }
};

struct Crossing {
    std::size_t side; ///< whose edge: 0 a, 1 b
    const Edge* edge;
    std::uint32_t face; ///< of the other
    double at;          ///< along the edge
    bool leaves;
    Vec3 point;
    std::vector<std::size_t> links = {};
};

struct Link { ///< two crossings that follow each other, and the normals of a and b there
    std::size_t from, to;
    Vec3 n_a, n_b;
    bool seen = false;
};

struct Loop {
    std::vector<std::size_t> crossings;
    Vec3 area;
    bool closed = false;
};

struct Piece {
    std::size_t side;
    const Edge* edge;
    std::size_t crossing;
    Vec3 ends[2];
    bool through;
};

struct Region {
    Vec3 area;                              ///< S
    double areas = 0, whole = 0, flush = 0; ///< lengths of S; of loops; of those between flush faces
    double deepest = 0, told = 0;           ///< vertex; contact
    bool speaks = false;
    std::vector<Vec3> points, faces;

    bool pierced() const { return length(area) <= areas / 4; }
    double highest(const Vec3& n) const {
        double high = -inf;
        for (const Vec3& p : points) high = std::max(high, dot(p, n));
        return high;
    }
    double depth(const Vec3& n) const { return highest(n) + highest(-n); }
    double least_depth() const {
        double least = inf;
        for (const Vec3& n : faces) least = std::min(least, depth(n));
        return least;
    }
    // Of the faces no deeper than that the one that looks most along a way, if it looks there more than `least`.
    Vec3 most_along(const Vec3& way, double deep, double least) const {
        Vec3 best;
        for (const Vec3& n : faces)
            if (dot(n, way) > (best == Vec3{} ? least : dot(best, way)) && depth(n) <= deep) best = n;
        return best;
    }
    Vec3 way(double perturbation) const {
        const double least = least_depth();
        const bool thin = least < depth(unit(area)) / 2 - 5 * perturbation;
        return thin ? most_along(unit(area), 1.1 * least + perturbation, -2) : unit(area);
    }
};

using Key = std::pair<const Edge*, const Edge*>; // of a, of b
struct Found {
    double depth;
    Vec3 point, way;
};

class PairOfBodies {
public:
    PairOfBodies(Body& a, Body& b, double perturbation) : bodies_{&a, &b}, perturbation_(perturbation) {
        for (const std::size_t side : {0u, 1u})
            for (const Edge& edge : bodies_[side]->edges) pierce(side, edge);
    }
    bool crosses() const { return !crossings_.empty(); }

    std::map<Key, Found> contacts() {
        find_loops();
        if (!bodies_[0]->contact.empty() || !bodies_[1]->contact.empty()) leave_out();
        cut_pieces();
        find_regions();
        std::map<Key, Found> all;
        pass_edges(all);
        give_deep(all, false);
        if (all.empty() && bodies_[0]->contact.empty() && bodies_[1]->contact.empty()) give_deep(all, true);
        return all;
    }

private:
    // On which side two edges pass each other, whichever asks.
    bool left(const Edge& of_a, const Edge& of_b) const {
        const auto &v = bodies_[0]->vertices, &w = bodies_[1]->vertices;
        return dot(v[of_a.to] - v[of_a.from], cross(w[of_b.from] - v[of_a.from], w[of_b.to] - v[of_a.from])) >= 0;
    }

    void pierce(std::size_t side, const Edge& edge) {
        const Body &own = *bodies_[side], &other = *bodies_[1 - side];
        const Vec3 p = own.vertices[edge.from], q = own.vertices[edge.to];
        const auto first = static_cast<std::ptrdiff_t>(crossings_.size());
        for (std::uint32_t f = 0; f < other.normals.size(); ++f) {
            const auto& t = other.solid.triangles[f];
            const Vec3 corner = other.vertices[t[0]];
            const Vec3 n = cross(other.vertices[t[1]] - corner, other.vertices[t[2]] - corner);
            const double from = dot(n, p - corner), to = dot(n, q - corner);
            if ((from >= 0) == (to >= 0)) continue;
            int lefts = 0;
            for (const Edge* e : other.around[f])
                lefts += (side == 0 ? left(edge, *e) : left(*e, edge)) == (e->faces[0] == f);
            if (lefts % 3 != 0) continue;
            crossings_.push_back({side, &edge, f, from / (from - to), from < 0, p + from / (from - to) * (q - p)});
        }
        std::sort(crossings_.begin() + first, crossings_.end(), [](auto& x, auto& y) { return x.at < y.at; });
    }

    void link() {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> on; // faces of a and b
        for (std::size_t i = 0; i < crossings_.size(); ++i) {
            const Crossing& c = crossings_[i];
            for (const std::uint32_t f : c.edge->faces)
                if (f != none) on[c.side == 0 ? std::pair(f, c.face) : std::pair(c.face, f)].push_back(i);
        }
        for (const auto& [faces, list] : on) {
            if (list.size() != 2) continue;
            for (const std::size_t i : list) crossings_[i].links.push_back(links_.size());
            links_.push_back({list[0], list[1], bodies_[0]->normals[faces.first], bodies_[1]->normals[faces.second]});
        }
    }

    void find_loops() {
        link();
        std::vector<bool> seen(crossings_.size());
        for (const std::size_t links : {0u, 1u, 2u}) // curves that end begin at an end
            for (std::size_t i = 0; i < crossings_.size(); ++i)
                if (!seen[i] && crossings_[i].links.size() == links) walk(i, seen);
    }

    void walk(std::size_t begin, std::vector<bool>& seen) {
        Loop loop;
        Vec3 normals; // T
        double runs = 0;
        for (std::size_t at = begin; !loop.closed;) {
            seen[at] = true;
            loop.crossings.push_back(at);
            const auto& links = crossings_[at].links;
            const auto next = std::find_if(links.begin(), links.end(), [&](auto l) { return !links_[l].seen; });
            if (next == links.end()) break;
            Link& l = links_[*next];
            l.seen = true;
            const std::size_t to = l.from == at ? l.to : l.from;
            const Vec3 p = crossings_[at].point, q = crossings_[to].point, origin = crossings_[begin].point;
            loop.area = loop.area + 0.5 * cross(p - origin, q - origin);
            normals = normals + length(q - p) * (l.n_b - l.n_a);
            runs += dot(q - p, cross(l.n_b, l.n_a));
            loop.closed = to == begin;
            at = to;
        }
        if (runs < 0) loop.area = -loop.area;
        if (length(normals) > 0 && dot(unit(loop.area), unit(normals)) < 0.5)
            loop.area = length(loop.area) * unit(normals);
        loops_.push_back(loop);
    }

    // Loops that no edge crosses which hides much; or, beside a vertex in contact, very much.
    void leave_out() {
        std::vector<Crossing> kept;
        for (const Loop& loop : loops_) {
            const auto counts = [&](std::size_t i) {
                const Edge& e = *crossings_[i].edge;
                const auto& contact = bodies_[crossings_[i].side]->contact;
                return e.hides > (contact.contains(e.from) || contact.contains(e.to) ? 1e6 : 1e5) * perturbation_;
            };
            if (!std::any_of(loop.crossings.begin(), loop.crossings.end(), counts)) continue;
            for (const std::size_t i : loop.crossings) kept.push_back(crossings_[i]);
        }
        std::sort(kept.begin(), kept.end(),
                  [](auto& x, auto& y) { return std::tie(x.side, x.edge, x.at) < std::tie(y.side, y.edge, y.at); });
        for (Crossing& c : kept) c.links.clear();
        crossings_ = kept;
        links_.clear();
        loops_.clear();
        find_loops();
    }

    void cut_pieces() {
        for (std::size_t i = 0; i < crossings_.size(); ++i) {
            const Crossing& c = crossings_[i];
            const Body& own = *bodies_[c.side];
            if (!bodies_[1 - c.side]->solid.closed) continue;
            const bool first = i == 0 || crossings_[i - 1].edge != c.edge;
            const bool last = i + 1 == crossings_.size() || crossings_[i + 1].edge != c.edge;
            if (c.leaves && first) pieces_.push_back({c.side, c.edge, i, {own.vertices[c.edge->from], c.point}, false});
            if (!c.leaves && last) pieces_.push_back({c.side, c.edge, i, {c.point, own.vertices[c.edge->to]}, false});
            if (c.leaves && !first && !crossings_[i - 1].leaves)
                pieces_.push_back({c.side, c.edge, i, {crossings_[i - 1].point, c.point}, true});
        }
    }

    void find_regions() {
        Graph graph; // crossings, vertices of a, of b
        const std::size_t first[2] = {crossings_.size(), crossings_.size() + bodies_[0]->vertices.size()};
        for (std::size_t i = 0; i < first[1] + bodies_[1]->vertices.size(); ++i) graph.add();
        const auto join = [&](std::size_t i, std::size_t k) {
            graph.join(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k));
        };
        for (const Link& l : links_) join(l.from, l.to);
        std::set<std::pair<std::size_t, std::uint32_t>> corners; // at the end of a piece, or in contact
        for (const Piece& p : pieces_) {
            const std::uint32_t v = crossings_[p.crossing].leaves ? p.edge->from : p.edge->to;
            join(p.crossing, p.through ? p.crossing - 1 : first[p.side] + v);
            if (!p.through) corners.emplace(p.side, v);
        }
        std::set<const Edge*> crossed;
        for (const Crossing& c : crossings_) crossed.insert(c.edge);
        for (const std::size_t side : {0u, 1u}) {
            const auto& contact = bodies_[side]->contact;
            for (const auto& [v, depth] : contact) corners.emplace(side, v);
            for (const Edge& e : bodies_[side]->edges)
                if (contact.contains(e.from) && contact.contains(e.to) && !crossed.contains(&e))
                    join(first[side] + e.from, first[side] + e.to);
        }
        region_ = graph.flood();
        for (std::size_t i = 0; i < crossings_.size(); ++i) regions_[region_[i]].points.push_back(crossings_[i].point);
        for (const auto& [side, v] : corners) {
            Region& region = regions_[region_[first[side] + v]];
            region.points.push_back(bodies_[side]->vertices[v]);
            const auto at = bodies_[side]->contact.find(v);
            if (at == bodies_[side]->contact.end()) continue;
            region.speaks = true;
            region.told = region.deepest = std::max(region.deepest, at->second);
        }
        for (const Loop& loop : loops_) {
            Region& region = regions_[region_[loop.crossings[0]]];
            region.area = region.area + loop.area;
            region.areas += length(loop.area);
        }
        for (const Link& l : links_) {
            Region& region = regions_[region_[l.from]];
            const double part = length(crossings_[l.to].point - crossings_[l.from].point);
            const bool flush = dot(l.n_a, l.n_b) > 0.98;
            region.whole += part;
            region.flush += flush ? part : 0;
            if (!flush) region.faces.insert(region.faces.end(), {l.n_b, -l.n_a});
        }
    }

    void pass_edges(std::map<Key, Found>& all) {
        std::map<Key, Region*> regions;
        for (const Loop& loop : loops_) {
            std::vector<const Crossing*> sharp;
            for (const std::size_t i : loop.crossings)
                if (crossings_[i].edge->sharp) sharp.push_back(&crossings_[i]);
            for (std::size_t i = loop.closed ? 0 : 1; i < sharp.size(); ++i) {
                const Crossing *x = sharp[(i + sharp.size() - 1) % sharp.size()], *y = sharp[i];
                if (x->side == y->side) continue;
                if (x->side == 1) std::swap(x, y);
                Region& region = regions_[region_[loop.crossings[0]]];
                const auto found = pass(unit(loop.area), region, *x, *y);
                const Key key{x->edge, y->edge};
                if (!found || (all.contains(key) && all[key].depth <= found->depth)) continue;
                all[key] = *found;
                regions[key] = &region;
            }
        }
        for (const auto& [key, region] : regions) {
            region->speaks = true;
            region->told = std::max(region->told, all[key].depth);
        }
    }

    std::optional<Found> pass(const Vec3& s, const Region& region, const Crossing& x, const Crossing& y) const {
        if (region.pierced() || x.edge->concave || y.edge->concave) return {};
        const auto n_a = bodies_[0]->normals_at(*x.edge), n_b = bodies_[1]->normals_at(*y.edge);
        const Vec3 whole = bodies_[0]->along(*x.edge), gap = y.point - x.point;
        const Vec3 e_a = unit(whole), e_b = unit(bodies_[1]->along(*y.edge)), out = n_b[0] + n_b[1];
        const Vec3 n = (dot(cross(e_a, e_b), out) < 0 ? -1 : 1) * unit(cross(e_a, e_b));
        Found found{dot(gap, n), x.point, n};
        if (length(cross(e_a, e_b)) > 0.05 && dot(n, s) >= 0.5 && angle(n, out) < angle(n_b[0], out) + 0.1
            && angle(-n, n_a[0] + n_a[1]) < angle(n_a[0], n_a[0] + n_a[1]) + 0.1) {
            if (dot(n, region.way(perturbation_)) <= 0.1) return {};
            const Vec3 start = bodies_[0]->vertices[x.edge->from], across = cross(e_b, n);
            const double at = dot(y.point - start, across) / dot(whole, across); // nearest to b's line
            found.point = start + std::clamp(at, x.leaves ? 0.0 : x.at, x.leaves ? x.at : 1.0) * whole;
        } else {
            found.way = {};
            for (const Vec3& face : {n_b[0], n_b[1], -n_a[0], -n_a[1]})
                if (dot(face, s) > std::max(0.8, dot(found.way, s))) found.way = face;
            found.depth = std::min({dot(gap, found.way), length(cross(gap, e_a)), length(cross(gap, e_b))});
        }
        if (found.depth <= 0.1 * perturbation_ || found.depth < region.deepest / 2) return {};
        if (region.least_depth() < found.depth / (region.flush > region.whole / 10 ? 1.25 : 2) - 5 * perturbation_)
            return {};
        return found;
    }

    // From a little inside the piece.
    Hit exit_along(const Piece& piece, const Vec3& point, const Vec3& way) const {
        const Vec3 from = point + 1e-3 * (0.5 * (piece.ends[0] + piece.ends[1]) - point);
        return bodies_[1 - piece.side]->exit_along(from, piece.side == 0 ? way : -way);
    }

    void give_deep(std::map<Key, Found>& all, bool all_speak) {
        for (const auto& entry : regions_) {
            const Region& region = entry.second;
            std::vector<Piece> pieces;
            for (const Piece& p : pieces_)
                if (region_[p.crossing] == entry.first && (all_speak || (p.edge->sharp && !p.edge->concave)))
                    pieces.push_back(p);
            std::vector<std::pair<Key, Found>> deep;
            const auto add = [&](const Piece& piece, const Vec3& point, const Vec3& way, double depth, const Hit& hit) {
                if (depth <= std::max(region.told, 0.1 * perturbation_) || hit.triangle == Hit::none) return;
                const Vec3 out = point + (piece.side == 0 ? depth : -depth) * way;
                const Edge* other = bodies_[1 - piece.side]->nearest_edge(hit.triangle, out);
                deep.push_back(piece.side == 0 ? std::pair(Key{piece.edge, other}, Found{depth, point, way})
                                               : std::pair(Key{other, piece.edge}, Found{depth, out, way}));
            };
            if (!region.pierced())
                ask_deeper(region, pieces, add);
            else if (!region.speaks)
                ask_pierced(region, pieces, add);
            double most = 0;
            for (const auto& [key, found] : deep) most = std::max(most, found.depth);
            for (const auto& [key, found] : deep)
                if (found.depth >= most / 2 && (!all.contains(key) || all[key].depth < found.depth)) all[key] = found;
        }
    }

    template <class Add>
    void ask_deeper(const Region& region, const std::vector<Piece>& pieces, Add add) const {
        Vec3 way = region.way(perturbation_);
        if (region.told >= region.depth(way) / 2) return;
        const Vec3 face = region.most_along(way, region.depth(way), 0.8);
        if (region.flush > region.whole / 10 && face != Vec3{}) way = face;
        for (const Piece& piece : pieces) {
            std::vector<Vec3> points;
            if (piece.through) points.push_back(0.5 * (piece.ends[0] + piece.ends[1]));
            if (!region.speaks) points.insert(points.end(), {piece.ends[0], piece.ends[1]});
            const auto normals = bodies_[piece.side]->normals_at(*piece.edge);
            const Vec3 out = (piece.side == 0 ? -1 : 1) * unit(normals[0] + normals[1]);
            for (const Vec3& p : points) {
                const double most =
                    piece.side == 0 ? region.highest(way) - dot(p, way) : region.highest(-way) + dot(p, way);
                const Hit hit = exit_along(piece, p, way), in = exit_along(piece, p, out);
                add(piece, p, way, std::min({most, hit.distance, in.triangle == Hit::none ? inf : in.distance}), hit);
            }
        }
    }

    template <class Add>
    void ask_pierced(const Region& region, const std::vector<Piece>& pieces, Add add) const {
        const Vec3 preferred{0.31, 0.53, 0.79};
        Vec3 way;
        double least = inf;
        for (const Vec3& face : region.faces)
            for (const Vec3& n : {face, -face}) {
                double most = 0;
                for (const Piece& piece : pieces)
                    for (const Vec3& end : piece.ends) most = std::max(most, exit_along(piece, end, n).distance);
                if (most <= 0 || most > 1.001 * least) continue;
                if (most >= 0.999 * least && dot(n, preferred) <= dot(way, preferred)) continue;
                way = n;
                least = std::min(least, most);
            }
        for (const Piece& piece : pieces)
            for (const Vec3& end : piece.ends) {
                const Hit hit = exit_along(piece, end, way);
                add(piece, end, way, hit.distance, hit);
            }
    }

    std::array<Body*, 2> bodies_;
    double perturbation_;
    std::vector<Crossing> crossings_; ///< of an edge in a row, along it
    std::vector<Link> links_;
    std::vector<Loop> loops_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> region_; ///< by crossing, then vertices of a and b
    std::map<std::uint32_t, Region> regions_;
};

// The vertex of a source that is farthest inside; in the frame of the pair.
std::optional<ReferenceContact> inside(const Body& source, const Body& target, Side body) {
    std::optional<ReferenceContact> found;
    for (std::uint32_t v = 0; v < source.vertices.size() && target.solid.closed; ++v) {
        const Vec3 p = rotate_back(target.pose, source.vertices[v] - target.pose.translation);
        if (source.solid.vertex_areas[v] <= 0 || winding_number(target.solid, p) < 0.5) continue;
        ReferenceContact c{body, FeatureKind::inside, source.solid.vertex_index[v], 0, source.vertices[v], {}, inf,
                           inf};
        c.weight = source.solid.vertex_areas[v];
        for (std::uint32_t f = 0; f < target.normals.size(); ++f) {
            const auto& [x, y, z] = target.solid.triangles[f];
            const auto& at = target.solid.vertices;
            const Vec3 out = closest_on_triangle(p, at[x], at[y], at[z]) - p;
            if (length(out) >= c.depth) continue;
            c.depth = c.ray_length = length(out);
            c.normal = rotate(target.pose, unit(body == Side::a ? -out : out));
            c.triangle = target.solid.triangle_index[f];
        }
        if (!found || found->depth < c.depth) found = c;
    }
    return found;
}

} // namespace

std::vector<ReferenceContact> find_edges(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                                         Direction direction) {
    if (!a.closed && !b.closed) return {};
    Pose a_in_b;
    a_in_b.translation = rotate_back(pose_b, (pose_a.translation - pose_b.translation)
                                                 + (rotate(pose_a, a.centre) - rotate(pose_b, b.centre)));
    for (std::size_t i = 0; i < 9; ++i) {
        a_in_b.rotation[i] = 0;
        for (std::size_t k = 0; k < 3; ++k)
            a_in_b.rotation[i] += pose_b.rotation[3 * k + i / 3] * pose_a.rotation[3 * k + i % 3];
    }
    const double perturbation = 1e-7 * std::min(a.diagonal, b.diagonal);
    Body of_a(a, a_in_b, perturbation, 0.01), of_b(b, {}, perturbation, -0.01);
    for (const CastRay& r : cast_all(a, pose_a, b, pose_b))
        if (r.contact) of_a.contact[r.vertex] = r.depth;
    for (const CastRay& r : cast_all(b, pose_b, a, pose_a))
        if (r.contact) of_b.contact[r.vertex] = r.depth;
    std::vector<ReferenceContact> contacts;
    PairOfBodies pair(of_a, of_b, perturbation);
    if (pair.crosses()) {
        for (const auto& [edges, c] : pair.contacts())
            contacts.push_back({Side::a, FeatureKind::edges, edges.first->number, edges.second->number, c.point, -c.way,
                                c.depth, c.depth, (of_a.area_at(*edges.first) + of_b.area_at(*edges.second)) / 12});
    } else if (of_a.contact.empty() && of_b.contact.empty()) {
        if (const auto c = inside(of_a, of_b, Side::a)) contacts.push_back(*c);
        if (const auto c = inside(of_b, of_a, Side::b)) contacts.push_back(*c);
    }
    for (ReferenceContact& c : contacts) {
        c.point = pose_b.translation + rotate(pose_b, b.centre + c.point);
        c.normal = rotate(pose_b, c.normal);
        if (direction != Direction::weighted) c.weight = 1;
    }
    return contacts;
}

} // namespace raycontact::reference
