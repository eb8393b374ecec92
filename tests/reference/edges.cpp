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

struct VertexContact {
    double depth;
    std::uint32_t face; ///< of the other body
};

// A body of the pair, in the frame in which all is decided: that of b, about its centre.
struct Body {
    const Solid& solid;
    Pose pose; ///< in that frame
    std::vector<Edge> edges;
    std::vector<std::vector<const Edge*>> around;   ///< each face
    std::vector<Vec3> vertices, normals;            ///< moved by a perturbation; of faces
    std::map<std::uint32_t, VertexContact> contact; ///< vertices in contact
    RayCaster caster;

    Body(const Solid& s, const Pose& p, double inward, double shaken) // metres
        : solid(s), pose(p), edges(edges_of(s)), around(s.triangles.size()), caster(s) {
        for (std::uint32_t v = 0; v < s.vertices.size(); ++v)
            vertices.push_back(p.translation
                               + rotate(p, s.vertices[v] + shaken * shake(v) - inward * s.vertex_normals[v]));
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
    std::size_t crossing; ///< where it is cut; one that goes through, where it leaves: the one before enters
    Vec3 ends[2];
    bool through;
    std::uint32_t vertex = none; ///< at its end, if it does not go through
    Vec3 middle() const { return 0.5 * (ends[0] + ends[1]); }
};

struct Region {
    Vec3 area;                     ///< S
    double areas = 0, deepest = 0; ///< lengths of S; contact
    Vec3 normal;                   ///< of the deepest contact, out of b
    bool speaks = false;
    std::vector<Vec3> faces;

    bool pierced() const { return length(area) <= areas / 4; }
    void tell(double depth, const Vec3& way) {
        speaks = true;
        if (depth > deepest) deepest = depth, normal = way;
    }
    bool hides(double depth, const Vec3& way) const { return depth < deepest / 2 * std::max(0.0, dot(way, normal)); }
};

using Key = std::pair<const Edge*, const Edge*>; // of a, of b
struct Found {
    double depth;
    Vec3 point, way; ///< out of b
};

// How a piece leaves the other body.
struct Way {
    double distance = inf, depth = 0;
    Vec3 normal; ///< out of that body
    std::uint32_t face = none;
    Vec3 point;
    bool in_arc = true;
};

class PairOfBodies {
public:
    PairOfBodies(Body& a, Body& b, double perturbation)
        : bodies_{&a, &b}, perturbation_(perturbation), sheets_(!a.solid.closed && !b.solid.closed) {
        for (const std::size_t side : {0u, 1u})
            for (const Edge& edge : bodies_[side]->edges) pierce(side, edge);
    }
    bool crosses() const { return !crossings_.empty(); }
    struct InnerVertex {
        std::size_t side;
        std::uint32_t vertex, face;
        Vec3 way; ///< out of the other body
        double depth;
        std::uint32_t region;
    };
    /// Vertices that crossings have inside, though their rays found nothing. After contacts().
    const std::vector<InnerVertex>& inner_vertices() const { return inner_; }

    std::map<Key, Found> contacts() {
        find_loops();
        if (!bodies_[0]->contact.empty() || !bodies_[1]->contact.empty()) leave_out();
        cut_pieces();
        find_regions();
        find_inner_vertices();
        std::map<Key, Found> all;
        for (const int effort : {0, 1, 2}) {
            if (effort == 2 && !(all.empty() && bodies_[0]->contact.empty() && bodies_[1]->contact.empty())) break;
            give(all, effort);
        }
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
            runs += dot(q - p, cross(l.n_b, l.n_a));
            loop.closed = to == begin;
            at = to;
        }
        if (runs < 0) loop.area = -loop.area;
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
            if (!sheets_ && !bodies_[1 - c.side]->solid.closed) continue;
            const bool first = i == 0 || crossings_[i - 1].edge != c.edge;
            const bool last = i + 1 == crossings_.size() || crossings_[i + 1].edge != c.edge;
            if (c.leaves && first)
                pieces_.push_back({c.side, c.edge, i, {own.vertices[c.edge->from], c.point}, false, c.edge->from});
            if (!c.leaves && last)
                pieces_.push_back({c.side, c.edge, i, {c.point, own.vertices[c.edge->to]}, false, c.edge->to});
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
        for (const Piece& p : pieces_) {
            join(p.crossing, p.through ? p.crossing - 1 : first[p.side] + p.vertex);
        }
        std::set<const Edge*> crossed;
        for (const Crossing& c : crossings_) crossed.insert(c.edge);
        for (const std::size_t side : {0u, 1u}) {
            const auto& contact = bodies_[side]->contact;
            for (const Edge& e : bodies_[side]->edges)
                if (contact.contains(e.from) && contact.contains(e.to) && !crossed.contains(&e))
                    join(first[side] + e.from, first[side] + e.to);
        }
        region_ = graph.flood();
        for (const std::size_t side : {0u, 1u})
            for (const auto& [v, contact] : bodies_[side]->contact) {
                const Vec3 n = bodies_[1 - side]->normals[contact.face];
                regions_[region_[first[side] + v]].tell(contact.depth, side == 0 ? n : -n);
            }
        for (const Loop& loop : loops_) {
            Region& region = regions_[region_[loop.crossings[0]]];
            region.area = region.area + loop.area;
            region.areas += length(loop.area);
        }
        for (const Link& l : links_) {
            auto& faces = regions_[region_[l.from]].faces;
            faces.insert(faces.end(), {l.n_b, -l.n_b, -l.n_a, l.n_a});
        }
    }

    // They are cast again from where they were moved to.
    void find_inner_vertices() {
        std::map<std::pair<std::size_t, std::uint32_t>, std::size_t> ends; // vertices, and a piece of theirs
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            if (!pieces_[i].through && !bodies_[pieces_[i].side]->contact.contains(pieces_[i].vertex))
                ends.emplace(std::pair(pieces_[i].side, pieces_[i].vertex), i);
        for (const auto& [end, i] : ends) {
            const auto& [side, v] = end;
            Body &own = *bodies_[side], &other = *bodies_[1 - side];
            const Vec3 inward = rotate(own.pose, -own.solid.vertex_normals[v]);
            const Hit hit = other.exit_along(own.vertices[v], inward);
            if (hit.triangle == Hit::none || hit.distance > own.solid.exits[v]) continue;
            const Vec3 n = other.normals[hit.triangle];
            const double depth = hit.distance * dot(n, inward);
            const std::uint32_t region = region_[pieces_[i].crossing];
            if (!leads_out(regions_[region], depth, side == 0 ? n : -n)) continue;
            inner_.push_back({side, v, hit.triangle, n, depth, region});
            own.contact[v] = {depth, hit.triangle};
        }
    }

    bool pierced(const Region& region) const { return !sheets_ && region.pierced(); }

    bool leads_out(const Region& region, double depth, const Vec3& way) const {
        return depth > 0.1 * perturbation_ && (sheets_ || region.pierced() || dot(way, unit(region.area)) > 0.1);
    }

    // From a little inside the piece.
    Hit exit_along(const Piece& piece, const Vec3& point, const Vec3& way) const {
        return bodies_[1 - piece.side]->exit_along(point + 1e-3 * (piece.middle() - point), way);
    }

    // The piece between two planes, moved until its line passes where they meet: along what is across both.
    Way way_over_ridge(const Piece& piece) const {
        const Body& other = *bodies_[1 - piece.side];
        const std::uint32_t entry = crossings_[piece.crossing - 1].face, exit = crossings_[piece.crossing].face;
        const Vec3 along = unit(piece.ends[1] - piece.ends[0]), in = other.normals[entry], out = other.normals[exit];
        const double enters = std::max(1e-9, -dot(in, along)), leaves = std::max(1e-9, dot(out, along));
        const Vec3 sum = (1 / enters) * in + (1 / leaves) * out;
        if (!(length(sum) > 1e-3)) return {};
        Way way;
        way.distance = way.depth = length(piece.ends[1] - piece.ends[0]) / length(sum);
        way.normal = unit(sum);
        way.face = dot(in, way.normal) > dot(out, way.normal) ? entry : exit;
        const double foot = way.depth * dot(in, way.normal) / enters; // in an acute ridge beside the piece
        way.point = piece.ends[0] + std::clamp(foot, 0.0, length(piece.ends[1] - piece.ends[0])) * along;
        const auto n = bodies_[piece.side]->normals_at(*piece.edge);
        way.in_arc = angle(-way.normal, n[0] + n[1]) < angle(n[0], n[0] + n[1]) + 0.1;
        return way;
    }

    Way way_past_face(const Piece& piece) const {
        Way way;
        way.face = crossings_[piece.crossing].face;
        way.normal = bodies_[1 - piece.side]->normals[way.face];
        way.distance = way.depth = std::fabs(dot(piece.ends[1] - piece.ends[0], way.normal));
        way.point = bodies_[piece.side]->vertices[piece.vertex];
        return way;
    }

    Way way_along(const Piece& piece, const Vec3& point, const Vec3& direction) const {
        const Hit hit = exit_along(piece, point, direction);
        if (hit.triangle == Hit::none) return {};
        const Vec3 out = bodies_[1 - piece.side]->normals[hit.triangle];
        return {hit.distance, hit.distance * dot(out, direction), out, hit.triangle, point};
    }

    // Where a's surface is when a piece of b has come out.
    Vec3 point_past(const Way& way) const {
        const auto& [x, y, z] = bodies_[0]->solid.triangles[way.face];
        const auto& at = bodies_[0]->vertices;
        return closest_on_triangle(way.point + way.depth * way.normal, at[x], at[y], at[z]);
    }

    const Edge* nearest_to(const Piece& piece, const Way& way) const {
        return bodies_[1 - piece.side]->nearest_edge(way.face, way.point + way.depth * way.normal);
    }

    const Edge* edge_at(const Piece& piece, std::size_t end) const {
        const std::size_t crossing = piece.through ? piece.crossing - 1 + end : piece.crossing;
        return bodies_[1 - piece.side]->nearest_edge(crossings_[crossing].face, piece.ends[end]);
    }

    // A piece that ends at a vertex in contact comes out with it, if it is short or its middle does; its other end may
    // be a contact, too.
    template <class Add>
    bool goes_with_vertex(const Piece& piece, Add add) const {
        const auto& contact = bodies_[piece.side]->contact;
        const auto at = contact.find(piece.vertex);
        if (piece.through || at == contact.end()) return false;
        if (piece.edge->hides < 1e6 * perturbation_) return true;
        const double depth = at->second.depth, most = 1.1 * depth + 10 * perturbation_;
        const Vec3 n = bodies_[1 - piece.side]->normals[at->second.face];
        const Hit middle = exit_along(piece, piece.middle(), n);
        if (middle.triangle == Hit::none || middle.distance > most) return false;
        const std::size_t far = piece.vertex == piece.edge->from ? 1 : 0;
        const Hit end = exit_along(piece, piece.ends[far], n);
        if (end.triangle != Hit::none && end.distance <= most && end.distance >= depth / 2)
            add(piece, {end.distance, end.distance, n, end.triangle, piece.ends[far]}, edge_at(piece, far));
        return true;
    }

    // effort 0: by ways of sharp and convex edges; 1: of silent regions by S; 2: likewise, by any edge.
    void give(std::map<Key, Found>& all, int effort) {
        struct Candidate {
            Region* region;
            Key key;
            Found found;
        };
        std::vector<Candidate> candidates;
        const auto counts = [&](const Piece& p) { return effort == 2 || (p.edge->sharp && !p.edge->concave); };
        const auto add = [&](const Piece& piece, const Way& way, const Edge* other) {
            const bool of_a = piece.side == 0;
            if (!leads_out(regions_[region_[piece.crossing]], way.depth, of_a ? way.normal : -way.normal)) return;
            candidates.push_back({&regions_[region_[piece.crossing]],
                                  of_a ? Key{piece.edge, other} : Key{other, piece.edge},
                                  {way.depth, of_a ? way.point : point_past(way), of_a ? way.normal : -way.normal}});
        };
        for (const Piece& piece : pieces_) {
            const Region& region = regions_[region_[piece.crossing]];
            if (pierced(region) || (effort > 0 && region.speaks) || !counts(piece)) continue;
            const bool own = effort == 0 || sheets_; // its way, not that of the region
            if (own && goes_with_vertex(piece, add)) continue;
            const Way way = !own ? Way{} : piece.through ? way_over_ridge(piece) : way_past_face(piece);
            if (way.face != none && region.hides(way.depth, piece.side == 0 ? way.normal : -way.normal)) continue;
            const auto n = bodies_[piece.side]->normals_at(*piece.edge);
            const Vec3 direction = own ? -unit(n[0] + n[1]) : (piece.side == 0 ? 1 : -1) * unit(region.area);
            const Way middle = way_along(piece, piece.middle(), direction);
            const bool passes = piece.through && way.in_arc && way.distance <= 2 * middle.distance
                                && exit_along(piece, way.point, way.normal).distance > 0.75 * way.distance;
            if (middle.face == none && way.face == none) continue;
            if (middle.distance >= way.distance || passes) {
                const bool with_vertex = !piece.through && bodies_[piece.side]->contact.contains(piece.vertex);
                if (way.face != none && way.in_arc && !with_vertex) add(piece, way, nearest_to(piece, way));
                continue;
            }
            std::vector<std::pair<Way, const Edge*>> ends;
            for (const std::size_t e : {0u, 1u}) {
                const Way end = way_along(piece, piece.ends[e], direction);
                if (end.face == none || end.depth < middle.depth / 2 || middle.depth < end.depth / 2) break;
                const bool vertex = !piece.through && (piece.vertex == piece.edge->from) == (e == 0);
                ends.emplace_back(end, vertex ? nearest_to(piece, end) : edge_at(piece, e));
            }
            if (ends.size() == 2 && ends[0].second != ends[1].second)
                for (const auto& [end, other] : ends) add(piece, end, other);
            else
                add(piece, middle, nearest_to(piece, middle));
        }
        for (const auto& entry : regions_)
            if (pierced(entry.second) && !entry.second.speaks) ask_pierced(entry.first, counts, add);
        for (const Candidate& c : candidates) c.region->tell(c.found.depth, c.found.way);
        const auto out_of_b = [](const InnerVertex& v) { return v.side == 0 ? v.way : -v.way; };
        if (effort == 0) {
            for (const InnerVertex& v : inner_) regions_[v.region].tell(v.depth, out_of_b(v));
            std::erase_if(inner_, [&](const auto& v) { return regions_[v.region].hides(v.depth, out_of_b(v)); });
        }
        for (const Candidate& c : candidates)
            if (!c.region->hides(c.found.depth, c.found.way)
                && (!all.contains(c.key) || (1 + 1e-6) * all[c.key].depth < c.found.depth))
                all[c.key] = c.found;
    }

    template <class Counts, class Add>
    void ask_pierced(std::uint32_t number, Counts counts, Add add) const {
        const Vec3 preferred{0.31, 0.53, 0.79};
        std::vector<Piece> pieces;
        for (const Piece& p : pieces_)
            if (region_[p.crossing] == number && counts(p)) pieces.push_back(p);
        const auto exit = [&](const Piece& p, const Vec3& end, const Vec3& n) {
            return exit_along(p, end, p.side == 0 ? n : -n);
        };
        Vec3 way;
        double least = inf;
        for (const Vec3& n : regions_.at(number).faces) {
            double most = 0;
            for (const Piece& p : pieces)
                for (const Vec3& end : p.ends) most = std::max(most, exit(p, end, n).distance);
            if (most <= 0 || most > 1.001 * least) continue;
            if (most >= 0.999 * least && dot(n, preferred) <= dot(way, preferred)) continue;
            way = n;
            least = std::min(least, most);
        }
        for (const Piece& p : pieces)
            for (const Vec3& end : p.ends) {
                const Hit hit = exit(p, end, way);
                if (hit.triangle == Hit::none) continue;
                const Way out{hit.distance, hit.distance, p.side == 0 ? way : -way, hit.triangle, end};
                add(p, out, nearest_to(p, out));
            }
    }

    std::array<Body*, 2> bodies_;
    double perturbation_;
    bool sheets_;                     ///< both: S says nothing
    std::vector<Crossing> crossings_; ///< of an edge in a row, along it
    std::vector<Link> links_;
    std::vector<Loop> loops_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> region_; ///< by crossing, then vertices of a and b
    std::map<std::uint32_t, Region> regions_;
    std::vector<InnerVertex> inner_;
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
    Pose a_in_b;
    a_in_b.translation = rotate_back(pose_b, (pose_a.translation - pose_b.translation)
                                                 + (rotate(pose_a, a.centre) - rotate(pose_b, b.centre)));
    for (std::size_t i = 0; i < 9; ++i) {
        a_in_b.rotation[i] = 0;
        for (std::size_t k = 0; k < 3; ++k)
            a_in_b.rotation[i] += pose_b.rotation[3 * k + i / 3] * pose_a.rotation[3 * k + i % 3];
    }
    const double perturbation = 1e-7 * std::min(a.diagonal, b.diagonal);
    Body of_a(a, a_in_b, perturbation, 0.01 * perturbation), of_b(b, {}, 3 * perturbation, -0.01 * perturbation);
    for (const CastRay& r : cast_all(a, pose_a, b, pose_b))
        if (r.contact) of_a.contact[r.vertex] = {r.depth, r.triangle};
    for (const CastRay& r : cast_all(b, pose_b, a, pose_a))
        if (r.contact) of_b.contact[r.vertex] = {r.depth, r.triangle};
    std::vector<ReferenceContact> contacts;
    PairOfBodies pair(of_a, of_b, perturbation);
    if (pair.crosses()) {
        for (const auto& [edges, c] : pair.contacts())
            contacts.push_back({Side::a, FeatureKind::edges, edges.first->number, edges.second->number, c.point, -c.way,
                                c.depth, c.depth, (of_a.area_at(*edges.first) + of_b.area_at(*edges.second)) / 12});
        for (const auto& v : pair.inner_vertices()) {
            const Body &own = v.side == 0 ? of_a : of_b, &other = v.side == 0 ? of_b : of_a;
            contacts.push_back({v.side == 0 ? Side::a : Side::b, FeatureKind::vertex, own.solid.vertex_index[v.vertex],
                                other.solid.triangle_index[v.face], own.vertices[v.vertex],
                                v.side == 0 ? -v.way : v.way, v.depth, v.depth, own.solid.vertex_areas[v.vertex]});
        }
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
