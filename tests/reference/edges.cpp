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
    const auto next = [&] { return static_cast<double>(scenes::splitmix64(state) >> 11) * 0x1p-52 - 1; };
    const double x = next();
    const double y = next();
    return {x, y, next()};
}

// A body of the pair, in the frame in which all is decided: that of b, about its centre.
struct Body {
    const Solid& solid;
    Pose pose;  ///< in that frame
    Pose world; ///< of that frame
    std::vector<Edge> edges;
    std::vector<Vec3> vertices, normals;     ///< moved by a hair; of faces
    std::map<std::uint32_t, double> contact; ///< vertices in contact: their depth
    RayCaster caster;

    Body(const Solid& s, const Pose& p, const Pose& w, double hair, double shaken)
        : solid(s), pose(p), world(w), edges(edges_of(s)), caster(s) {
        for (std::uint32_t v = 0; v < s.vertices.size(); ++v)
            vertices.push_back(pose.translation
                               + rotate(pose, s.vertices[v] + hair * (shaken * shake(v) - s.vertex_normals[v])));
        for (const Vec3& n : s.face_normals) normals.push_back(rotate(pose, n));
    }

    std::array<Vec3, 2> faces_at(const Edge& e) const {
        return {normals[e.faces[0]], normals[e.faces[e.faces[1] == none ? 0 : 1]]};
    }
    Vec3 along(const Edge& e) const { return vertices[e.to] - vertices[e.from]; }
    bool speaks(const Edge& e) const { return e.sharp && !e.concave; }

    double area_at(const Edge& e) const {
        double area = 0;
        for (const std::uint32_t f : e.faces) {
            if (f == none) continue;
            const auto& t = solid.triangles[f];
            area +=
                length(cross(solid.vertices[t[1]] - solid.vertices[t[0]], solid.vertices[t[2]] - solid.vertices[t[0]]))
                / 2;
        }
        return area;
    }

    // How far it is from a point inside to the way out.
    Hit way_out(const Vec3& from, const Vec3& way) {
        const Hit hit = caster.closest(rotate_back(pose, from - pose.translation), rotate_back(pose, way));
        return hit.triangle != Hit::none && hit.from_inside ? hit : Hit{Hit::none, 0, false};
    }

    // Of a face that whose line is nearest to a point.
    const Edge& nearest_edge(std::uint32_t face, const Vec3& point) const {
        const Edge* nearest = nullptr;
        double least = inf;
        for (const Edge& e : edges) {
            if (e.faces[0] != face && e.faces[1] != face) continue;
            const double away = length(cross(unit(along(e)), point - vertices[e.from]));
            if (away >= least) continue;
            least = away;
            nearest = &e;
        }
        return *nearest;
    }
};

struct Crossing {
    std::size_t side; ///< whose edge: 0 a, 1 b
    const Edge* edge;
    std::uint32_t face; ///< of the other
    double at;          ///< 0 to 1
    bool leaves;
    Vec3 point;
    std::vector<std::size_t> links = {};
};

// Two crossings that follow each other.
struct Link {
    std::size_t from, to;
    std::uint32_t faces[2]; ///< of a, of b
    bool seen = false;
};

struct Loop {
    std::vector<std::size_t> crossings, links;
    bool closed = false;
    Vec3 area; ///< S
};

struct Piece {
    std::size_t side;
    const Edge* edge;
    std::size_t crossing;
    Vec3 ends[2];
    bool through;
};

struct Extent {
    double low = inf, high = -inf;
    double deep() const { return high - low; }
};

struct Region {
    Vec3 area;
    double areas = 0, whole = 0, flush = 0; ///< lengths of S; of loops; of those between flush faces
    double deepest = 0, told = 0;           ///< vertex; contact
    bool speaks = false;
    std::vector<Vec3> points, faces;

    bool pierced() const { return length(area) <= areas / 4; }
    Extent extent(const Vec3& n) const {
        Extent e;
        for (const Vec3& p : points) e = {std::min(e.low, dot(p, n)), std::max(e.high, dot(p, n))};
        return e;
    }
    double thinnest() const {
        double least = inf;
        for (const Vec3& n : faces) least = std::min(least, extent(n).deep());
        return least;
    }
    Vec3 way(double hair) const {
        const Vec3 along = unit(area);
        const double thin = thinnest();
        if (thin >= extent(along).deep() / 2 - 5 * hair) return along;
        Vec3 best;
        for (const Vec3& n : faces)
            if (extent(n).deep() <= 1.1 * thin + hair && (best == Vec3{} || dot(n, along) > dot(best, along))) best = n;
        return best;
    }
};

class PairOfBodies {
public:
    PairOfBodies(Body& a, Body& b, double hair) : bodies_{&a, &b}, hair_(hair) {}

    bool cross() {
        for (const std::size_t side : {0u, 1u})
            for (const Edge& edge : bodies_[side]->edges) cross(side, edge);
        return !crossings_.empty();
    }

    using Key = std::pair<const Edge*, const Edge*>;
    struct Told {
        double depth;
        Vec3 point, normal;
    };

    std::map<Key, Told> contacts() {
        link();
        find_loops();
        cut_pieces();
        find_regions();
        std::map<Key, Told> all;
        pass_edges(all);
        give_deep(all, false);
        if (all.empty() && bodies_[0]->contact.empty() && bodies_[1]->contact.empty()) give_deep(all, true);
        return all;
    }

private:
    struct Deep {
        Key key;
        Told told;
    };

    // The volume that two edges span: its sign says on which side they pass each other, whichever asks.
    double volume(const Edge& of_a, const Edge& of_b) const {
        const auto &v = bodies_[0]->vertices, &w = bodies_[1]->vertices;
        return dot(v[of_a.to] - v[of_a.from], reference::cross(w[of_b.from] - v[of_a.from], w[of_b.to] - v[of_a.from]));
    }

    void cross(std::size_t side, const Edge& edge) {
        const Body &own = *bodies_[side], &other = *bodies_[1 - side];
        const Vec3 p = own.vertices[edge.from], q = own.vertices[edge.to];
        const auto first = static_cast<std::ptrdiff_t>(crossings_.size());
        for (std::uint32_t f = 0; f < other.normals.size(); ++f) {
            const auto& t = other.solid.triangles[f];
            const Vec3 a = other.vertices[t[0]], b = other.vertices[t[1]], c = other.vertices[t[2]];
            const Vec3 n = reference::cross(b - a, c - a);
            const double from = dot(n, p - a), to = dot(n, q - a);
            if ((from >= 0) == (to >= 0)) continue;
            int left = 0;
            for (const Edge* e : edges_around(1 - side, f)) {
                left += ((side == 0 ? volume(edge, *e) : volume(*e, edge)) >= 0) == (e->faces[0] == f);
            }
            if (left != 0 && left != 3) continue;
            crossings_.push_back({side, &edge, f, from / (from - to), from < 0, p + from / (from - to) * (q - p)});
        }
        std::sort(crossings_.begin() + first, crossings_.end(),
                  [](const Crossing& x, const Crossing& y) { return x.at < y.at; });
    }

    const std::array<const Edge*, 3>& edges_around(std::size_t side, std::uint32_t face) {
        auto& around = around_[side];
        if (around.empty()) {
            around.resize(bodies_[side]->normals.size());
            std::vector<std::size_t> count(around.size());
            for (const Edge& e : bodies_[side]->edges)
                for (const std::uint32_t f : e.faces)
                    if (f != none) around[f][count[f]++] = &e;
        }
        return around[face];
    }

    void link() {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> on; // triangles of a and b
        for (std::size_t i = 0; i < crossings_.size(); ++i)
            for (const std::uint32_t f : crossings_[i].edge->faces)
                if (f != none)
                    on[crossings_[i].side == 0 ? std::pair(f, crossings_[i].face) : std::pair(crossings_[i].face, f)]
                        .push_back(i);
        for (const auto& [faces, list] : on) {
            if (list.size() != 2) continue;
            for (const std::size_t i : list) crossings_[i].links.push_back(links_.size());
            links_.push_back({list[0], list[1], {faces.first, faces.second}});
        }
    }

    void find_loops() {
        std::vector<bool> seen(crossings_.size());
        for (const std::size_t links : {0u, 1u, 2u}) // curves that end begin at an end
            for (std::size_t i = 0; i < crossings_.size(); ++i) {
                if (seen[i] || crossings_[i].links.size() != links) continue;
                Loop loop;
                for (std::size_t at = i; !loop.closed;) {
                    seen[at] = true;
                    loop.crossings.push_back(at);
                    const auto& out = crossings_[at].links;
                    const auto next = std::find_if(out.begin(), out.end(), [&](auto l) { return !links_[l].seen; });
                    if (next == out.end()) break;
                    Link& l = links_[*next];
                    l.seen = true;
                    if (l.from != at) std::swap(l.from, l.to);
                    loop.links.push_back(*next);
                    at = l.to;
                    loop.closed = at == i;
                }
                measure(loop);
                loops_.push_back(loop);
            }
    }

    void measure(Loop& loop) const {
        const Vec3 origin = crossings_[loop.crossings[0]].point;
        Vec3 normals;
        double runs = 0;
        for (const std::size_t l : loop.links) {
            const Vec3 p = crossings_[links_[l].from].point, q = crossings_[links_[l].to].point;
            const Vec3 n_a = bodies_[0]->normals[links_[l].faces[0]], n_b = bodies_[1]->normals[links_[l].faces[1]];
            loop.area = loop.area + 0.5 * reference::cross(p - origin, q - origin);
            normals = normals + length(q - p) * (n_b - n_a);
            runs += dot(q - p, reference::cross(n_b, n_a));
        }
        if (runs < 0) loop.area = -loop.area;
        if (length(normals) > 0 && dot(unit(loop.area), unit(normals)) < 0.5)
            loop.area = length(loop.area) * unit(normals);
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
        Graph graph;
        for (std::size_t i = 0; i < crossings_.size(); ++i) graph.add();
        std::uint32_t first[2]; // vertices
        for (const std::size_t side : {0u, 1u})
            for (std::size_t v = 0; v < bodies_[side]->vertices.size(); ++v) {
                const std::uint32_t node = graph.add();
                if (v == 0) first[side] = node;
            }
        const auto node = [](std::size_t i) { return static_cast<std::uint32_t>(i); };
        for (const Link& l : links_) graph.join(node(l.from), node(l.to));
        std::set<std::pair<std::size_t, std::uint32_t>> speaking; // vertices at the end of a piece, or in contact
        for (const Piece& p : pieces_) {
            if (p.through) {
                graph.join(node(p.crossing), node(p.crossing - 1));
                continue;
            }
            const std::uint32_t v = crossings_[p.crossing].leaves ? p.edge->from : p.edge->to;
            graph.join(node(p.crossing), first[p.side] + v);
            speaking.emplace(p.side, v);
        }
        std::set<const Edge*> crossed;
        for (const Crossing& c : crossings_) crossed.insert(c.edge);
        for (const std::size_t side : {0u, 1u}) {
            const auto& contact = bodies_[side]->contact;
            for (const auto& [v, depth] : contact) speaking.emplace(side, v);
            for (const Edge& e : bodies_[side]->edges)
                if (contact.contains(e.from) && contact.contains(e.to) && !crossed.contains(&e))
                    graph.join(first[side] + e.from, first[side] + e.to);
        }
        region_ = graph.flood();
        for (std::size_t i = 0; i < crossings_.size(); ++i) regions_[region_[i]].points.push_back(crossings_[i].point);
        for (const auto& [side, v] : speaking) {
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
            const Vec3 n_a = bodies_[0]->normals[l.faces[0]], n_b = bodies_[1]->normals[l.faces[1]];
            region.whole += part;
            if (dot(n_a, n_b) > 0.98) {
                region.flush += part;
            } else {
                region.faces.push_back(n_b);
                region.faces.push_back(-n_a);
            }
        }
    }

    void pass_edges(std::map<Key, Told>& all) {
        std::map<Key, std::pair<Told, Region*>> passing;
        for (const Loop& loop : loops_) {
            std::vector<const Crossing*> sharp;
            for (const std::size_t i : loop.crossings)
                if (crossings_[i].edge->sharp) sharp.push_back(&crossings_[i]);
            for (std::size_t i = loop.closed ? 0 : 1; i < sharp.size(); ++i) {
                const Crossing *x = sharp[(i + sharp.size() - 1) % sharp.size()], *y = sharp[i];
                if (x->side == y->side) continue;
                if (x->side == 1) std::swap(x, y);
                Region& region = regions_[region_[loop.crossings[0]]];
                const auto told = pass(loop, region, *x, *y);
                if (!told) continue;
                const auto [at, fresh] = passing.try_emplace({x->edge, y->edge}, *told, &region);
                if (!fresh && told->depth < at->second.first.depth) at->second = {*told, &region};
            }
        }
        for (const auto& [key, found] : passing) {
            all[key] = found.first;
            found.second->speaks = true;
            found.second->told = std::max(found.second->told, found.first.depth);
        }
    }

    std::optional<Told> pass(const Loop& loop, const Region& region, const Crossing& x, const Crossing& y) const {
        if (region.pierced() || x.edge->concave || y.edge->concave) return {};
        const auto n_a = bodies_[0]->faces_at(*x.edge), n_b = bodies_[1]->faces_at(*y.edge);
        const Vec3 e_a = unit(bodies_[0]->along(*x.edge)), e_b = unit(bodies_[1]->along(*y.edge));
        const Vec3 s = unit(loop.area), gap = y.point - x.point;
        Vec3 n = reference::cross(e_a, e_b);
        const double sine = length(n);
        n = dot(n, n_b[0] + n_b[1]) < 0 ? -unit(n) : unit(n);
        const auto within = [](const Vec3& d, const std::array<Vec3, 2>& faces) {
            const Vec3 middle = unit(faces[0] + faces[1]);
            const auto angle = [&](const Vec3& v) { return std::acos(std::clamp(dot(v, middle), -1.0, 1.0)); };
            return angle(d) < angle(faces[0]) + 0.1;
        };
        Told told{0, x.point, n};
        if (sine > 0.05 && within(n, n_b) && within(-n, n_a) && dot(n, s) >= 0.5) {
            if (dot(n, region.way(hair_)) <= 0.1) return {};
            told.depth = dot(gap, n);
            // The point of a's edge that is nearest to b's line.
            const Vec3 start = bodies_[0]->vertices[x.edge->from], across = reference::cross(e_b, n);
            const double t = dot(y.point - start, across) / dot(e_a, across);
            told.point = start + std::clamp(t, 0.0, length(bodies_[0]->along(*x.edge))) * e_a;
        } else {
            double best = 0.8;
            for (const Vec3& face : {n_b[0], n_b[1], -n_a[0], -n_a[1]})
                if (dot(face, s) > best) {
                    best = dot(face, s);
                    told.normal = face;
                }
            if (best == 0.8) return {};
            told.depth = std::min(
                {dot(gap, told.normal), length(reference::cross(gap, e_a)), length(reference::cross(gap, e_b))});
        }
        if (told.depth <= 0 || told.depth < region.deepest / 2) return {};
        if (region.thinnest() < told.depth / 2 - 5 * hair_) return {};
        return told;
    }

    Hit out_of_other(const Piece& piece, const Vec3& point, const Vec3& way) const {
        const Vec3 from = point + 1e-3 * (0.5 * (piece.ends[0] + piece.ends[1]) - point);
        return bodies_[1 - piece.side]->way_out(from, piece.side == 0 ? way : -way);
    }

    void add(std::vector<Deep>& list, const Piece& piece, const Vec3& point, const Vec3& way, double depth,
             std::uint32_t face) const {
        if (depth <= 0) return;
        const Vec3 out = piece.side == 0 ? point + depth * way : point - depth * way;
        const Edge* other = &bodies_[1 - piece.side]->nearest_edge(face, out);
        if (piece.side == 0)
            list.push_back({{piece.edge, other}, {depth, point, way}});
        else
            list.push_back({{other, piece.edge}, {depth, out, way}});
    }

    // A region that is deeper than its contacts.
    std::vector<Deep> deeper(const Region& region, const std::vector<const Piece*>& pieces) const {
        const Vec3 toward = region.way(hair_);
        Vec3 way = toward;
        if (region.told >= region.extent(way).deep() / 2) return {};
        if (region.flush > region.whole / 10) {
            double best = 0.8;
            for (const Vec3& n : region.faces)
                if (dot(n, toward) > best && region.extent(n).deep() <= region.extent(toward).deep()) {
                    best = dot(n, toward);
                    way = n;
                }
        }
        const Extent whole = region.extent(way);
        std::vector<Deep> list;
        for (const Piece* piece : pieces) {
            std::vector<Vec3> points;
            if (piece->through) points.push_back(0.5 * (piece->ends[0] + piece->ends[1]));
            if (!region.speaks) points.insert(points.end(), {piece->ends[0], piece->ends[1]});
            const auto normals = bodies_[piece->side]->faces_at(*piece->edge);
            const Vec3 outward = unit(normals[0] + normals[1]);
            for (const Vec3& p : points) {
                const double most = piece->side == 0 ? whole.high - dot(p, way) : dot(p, way) - whole.low;
                const Hit hit = out_of_other(*piece, p, way);
                const Hit in = out_of_other(*piece, p, piece->side == 0 ? -outward : outward);
                double depth = std::min(most, hit.distance);
                if (in.triangle != Hit::none) depth = std::min(depth, in.distance);
                if (depth > region.told) add(list, *piece, p, way, depth, hit.triangle);
            }
        }
        return list;
    }

    std::vector<Deep> pierced(const Region& region, const std::vector<const Piece*>& pieces) const {
        const Vec3 preferred{0.31, 0.53, 0.79};
        Vec3 way;
        double least = inf;
        std::vector<Vec3> ways;
        for (const Vec3& face : region.faces)
            for (const Vec3& n : {face, -face}) {
                if (std::any_of(ways.begin(), ways.end(), [&](const Vec3& m) { return dot(n, m) > 0.9999; })) continue;
                ways.push_back(n);
                double most = 0;
                for (const Piece* piece : pieces)
                    for (const Vec3& end : piece->ends) most = std::max(most, out_of_other(*piece, end, n).distance);
                if (most <= 0 || most > 1.001 * least) continue;
                if (most >= 0.999 * least && dot(n, preferred) <= dot(way, preferred)) continue;
                way = n;
                least = std::min(least, most);
            }
        std::vector<Deep> list;
        if (way == Vec3{}) return list;
        for (const Piece* piece : pieces)
            for (const Vec3& end : piece->ends) {
                const Hit hit = out_of_other(*piece, end, way);
                add(list, *piece, end, way, hit.distance, hit.triangle);
            }
        return list;
    }

    void give_deep(std::map<Key, Told>& all, bool with_all) {
        for (const auto& [name, region] : regions_) {
            std::vector<const Piece*> pieces;
            for (const Piece& p : pieces_)
                if (region_[p.crossing] == name && (with_all || bodies_[p.side]->speaks(*p.edge))) pieces.push_back(&p);
            std::vector<Deep> list;
            if (!region.pierced())
                list = deeper(region, pieces);
            else if (!region.speaks)
                list = pierced(region, pieces);
            double most = 0;
            for (const Deep& d : list) most = std::max(most, d.told.depth);
            for (const Deep& d : list) {
                if (d.told.depth < most / 2) continue;
                const auto [at, fresh] = all.try_emplace(d.key, d.told);
                if (!fresh && d.told.depth > at->second.depth) at->second = d.told;
            }
        }
    }

    std::array<Body*, 2> bodies_;
    double hair_;
    std::vector<Crossing> crossings_; ///< of an edge in a row, along it
    std::vector<Link> links_;
    std::vector<Loop> loops_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> region_; ///< by crossing, then vertices of a and b
    std::map<std::uint32_t, Region> regions_;
    std::array<std::vector<std::array<const Edge*, 3>>, 2> around_;
};

// The vertex of a source that is farthest inside.
std::optional<ReferenceContact> inside(const Body& source, const Body& target, VertexBody body, Direction direction) {
    std::optional<ReferenceContact> found;
    if (!target.solid.closed) return found;
    for (std::uint32_t v = 0; v < source.vertices.size(); ++v) {
        const Vec3 p = rotate_back(target.pose, source.vertices[v] - target.pose.translation);
        if (source.solid.vertex_areas[v] <= 0 || winding_number(target.solid, p) < 0.5) continue;
        ReferenceContact c;
        c.depth = inf;
        for (std::uint32_t f = 0; f < target.solid.triangles.size(); ++f) {
            const auto& t = target.solid.triangles[f];
            const auto& at = target.solid.vertices;
            const Vec3 out = closest_on_triangle(p, at[t[0]], at[t[1]], at[t[2]]) - p;
            if (length(out) >= c.depth) continue;
            c.depth = c.ray_length = length(out);
            c.normal = rotate(target.world, rotate(target.pose, unit(body == VertexBody::a ? -out : out)));
            c.triangle = target.solid.triangle_index[f];
        }
        if (found && found->depth >= c.depth) continue;
        c.vertex_body = body;
        c.feature = Feature::inside;
        c.vertex = source.solid.vertex_index[v];
        c.point = source.world.translation + rotate(source.world, source.vertices[v]);
        if (direction == Direction::weighted) c.weight = source.solid.vertex_areas[v];
        found = c;
    }
    return found;
}

} // namespace

std::vector<ReferenceContact> find_edges(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                                         Direction direction) {
    std::vector<ReferenceContact> contacts;
    if (!a.closed && !b.closed) return contacts;
    Pose world = pose_b, a_in_b;
    world.translation = pose_b.translation + rotate(pose_b, b.centre);
    a_in_b.translation = rotate_back(pose_b, (pose_a.translation - pose_b.translation)
                                                 + (rotate(pose_a, a.centre) - rotate(pose_b, b.centre)));
    for (std::size_t i = 0; i < 9; ++i) {
        a_in_b.rotation[i] = 0;
        for (std::size_t k = 0; k < 3; ++k)
            a_in_b.rotation[i] += pose_b.rotation[3 * k + i / 3] * pose_a.rotation[3 * k + i % 3];
    }
    const double hair = 1e-7 * std::min(a.diagonal, b.diagonal);
    Body of_a(a, a_in_b, world, hair, 0.01), of_b(b, {}, world, hair, -0.01);
    for (const CastRay& r : cast_all(a, pose_a, b, pose_b))
        if (r.contact) of_a.contact[r.vertex] = r.depth;
    for (const CastRay& r : cast_all(b, pose_b, a, pose_a))
        if (r.contact) of_b.contact[r.vertex] = r.depth;
    PairOfBodies pair(of_a, of_b, hair);
    if (pair.cross()) {
        for (const auto& [edges, told] : pair.contacts()) {
            ReferenceContact c;
            c.feature = Feature::edges;
            c.vertex = edges.first->number;
            c.triangle = edges.second->number;
            c.point = world.translation + rotate(world, told.point);
            c.normal = -rotate(world, told.normal);
            c.depth = c.ray_length = told.depth;
            if (direction == Direction::weighted)
                c.weight = (of_a.area_at(*edges.first) + of_b.area_at(*edges.second)) / 12;
            contacts.push_back(c);
        }
    } else if (of_a.contact.empty() && of_b.contact.empty()) {
        if (const auto c = inside(of_a, of_b, VertexBody::a, direction)) contacts.push_back(*c);
        if (const auto c = inside(of_b, of_a, VertexBody::b, direction)) contacts.push_back(*c);
    }
    return contacts;
}

} // namespace raycontact::reference
