// SPDX-License-Identifier: Apache-2.0
#include "edges/pair_edges.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace raycontact {

namespace {

// A contact counts beside others of its region from this part of their depth on.
constexpr double comparable = 0.5;
// Two edges that pass each other may be so many times as deep as the edge's own way inward is long, where this part of
// the way to the ridge lies inside: over something round half of it does.
constexpr double most_times = 2, reached = 0.75;
// What is no deeper than this, in perturbations, is rounding.
constexpr double noise = 0.1;
// A contact whose normal has no larger part than this along the loops' vector area makes the overlap no smaller.
constexpr double sideways = 0.1;
constexpr std::size_t most_faces = 64;

// The edge of a face that is nearest to a point of its plane.
std::uint32_t nearest_edge(const PairMeshes& pair, std::size_t side, std::uint32_t face, const Vec3& point) {
    const ShapeData& shape = pair.shape(side);
    std::uint32_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t k = 0; k < 3; ++k) {
        const Vec3 from = pair.corner(side, face, k), along = pair.corner(side, face, (k + 1) % 3) - from;
        const double size = length(along);
        const double away = size > 0 ? length(cross(along, point - from)) / size : length(point - from);
        if (away < least) {
            least = away;
            best = k;
        }
    }
    return edge_of(shape, face, best);
}

// The way in which a leaves b, of a normal out of the body that a piece is in.
Vec3 out_of_b(const EdgePiece& piece, const Vec3& normal) {
    return piece.side == 0 ? normal : -1.0 * normal;
}

} // namespace

bool PairEdges::find(const PairMeshes& pair, const NearEdges& near,
                     const std::array<std::span<const kernels::LocalContact>, 2>& vertices,
                     std::vector<FeatureContact>& found) {
    list_vertices(vertices);
    follow_loops(pair, near);
    if (loops_.crossings().empty()) return false;
    pieces_.list(pair, loops_.crossings());
    regions_.find(pair, loops_, pieces_, touching_);
    candidates_.clear();
    number_ = 0;
    list_inner_vertices(pair);
    for (const Effort effort : {Effort::edges_alone, Effort::any_way, Effort::any_edge}) {
        // Edges within flat faces and valleys speak only for a pair that has no contact at all.
        if (effort == Effort::any_edge && !(candidates_.empty() && touching_.empty())) break;
        effort_ = effort;
        const std::size_t first = effort == Effort::edges_alone ? 0 : candidates_.size();
        list_ways(pair);
        leave_out_hidden(first);
    }
    give(found);
    return true;
}

void PairEdges::list_vertices(const std::array<std::span<const kernels::LocalContact>, 2>& vertices) {
    touching_.clear();
    for (std::size_t side = 0; side < 2; ++side)
        for (const kernels::LocalContact& c : vertices[side])
            touching_.push_back({vertex_of_side(side, c.vertex), double(c.distance) * double(c.facing), c.triangle});
    std::ranges::sort(touching_, {}, &TouchingVertex::vertex);
}

// Every loop has been followed once each edge has been asked. Where a vertex is in contact, only those need be that
// hide much: loops that none of them crosses are left out.
void PairEdges::follow_loops(const PairMeshes& pair, const NearEdges& near) {
    const double least = touching_.empty() ? -1 : least_hidden * pair.size();
    const double least_beside = touching_.empty() ? -1 : least_hidden_beside * pair.size();
    const auto touches = [&](std::size_t side, std::uint32_t vertex) {
        return std::ranges::binary_search(touching_, vertex_of_side(side, vertex), {}, &TouchingVertex::vertex);
    };
    loops_.clear();
    for (std::size_t side = 0; side < 2; ++side) {
        const ShapeData& source = pair.shape(side);
        PlacedFace face;
        std::uint32_t edge = NONE;
        bool asked = false;
        for (const NearEdge& candidate : near[side]) {
            if (candidate.edge != edge) {
                edge = candidate.edge;
                const auto [start, stop] = ends_of(source, edge);
                const double hides = hidden_by(source, edge);
                asked = hides > least_beside || (hides > least && !touches(side, start) && !touches(side, stop));
            }
            if (!asked) continue;
            face.set(pair, 1 - side, candidate.face);
            if (Crossing seed; crosses(pair, side, edge, face, seed)) loops_.follow(pair, seed);
        }
    }
}

bool PairEdges::speaks(const PairMeshes& pair, const EdgePiece& piece) const {
    const ShapeData& shape = pair.shape(piece.side);
    return effort_ == Effort::any_edge || (is_sharp(shape, piece.edge) && is_convex(shape, piece.edge));
}

// What is less than half as deep as the region's deepest contact along that one's normal comes out with it.
bool PairEdges::is_hidden(const Region& region, double depth, const Vec3& way) const {
    return depth < comparable * region.deepest * std::max(0.0, dot(way, region.normal));
}

void PairEdges::list_ways(const PairMeshes& pair) {
    const auto regions = regions_.all();
    for (const EdgePiece& piece : pieces_.all()) {
        const Region& region = regions[region_of(piece)];
        if (region.is_pierced() || (effort_ != Effort::edges_alone && region.speaks)) continue;
        if (!speaks(pair, piece)) continue;
        if (effort_ == Effort::edges_alone || !region.leads)
            list_way(pair, piece);
        else
            list_way_of_region(pair, piece);
    }
    for (std::uint32_t r = 0; r < regions.size(); ++r)
        if (regions[r].is_pierced() && !regions[r].speaks) list_pierced(pair, r);
}

// The shorter one of a piece's ways; but a ridge that it passes counts up to twice the way inward.
void PairEdges::list_way(const PairMeshes& pair, const EdgePiece& piece) {
    if (goes_with_vertex(pair, piece)) return;
    const bool through = piece.is_through();
    const WayOut way = through ? way_over_ridge(pair, piece, loops_.crossings())
                               : way_past_face(pair, piece, loops_.crossings()[piece.crossing()].face);
    const Region& region = regions_.all()[region_of(piece)];
    if (way.exists() && is_hidden(region, way.depth, out_of_b(piece, way.normal))) return;
    const Vec3 direction = inward_of(pair, piece);
    const WayOut inward = way_along(pair, piece, piece.middle(), direction);
    if (inward.distance < way.distance) {
        const bool passes = through && way.in_arc && way.distance <= most_times * inward.distance
                            && exit_along(pair, piece, way.point, way.normal).distance > reached * way.distance;
        if (!passes) return list_way_along(pair, piece, direction, inward);
    }
    if (way.exists() && way.in_arc && (through || touching(pair, piece) == nullptr)) add(pair, piece, way);
}

// Where no piece has a way of its own: that of the region.
void PairEdges::list_way_of_region(const PairMeshes& pair, const EdgePiece& piece) {
    const Vec3 out = unit(regions_.all()[region_of(piece)].area), direction = piece.side == 0 ? out : -1.0 * out;
    const WayOut middle = way_along(pair, piece, piece.middle(), direction);
    if (middle.exists()) list_way_along(pair, piece, direction, middle);
}

// An edge on a face stands on its ends, one on something round on its middle.
void PairEdges::list_way_along(const PairMeshes& pair, const EdgePiece& piece, const Vec3& direction,
                               const WayOut& middle) {
    std::array<WayOut, 2> ends;
    std::array<std::uint32_t, 2> others;
    for (std::size_t e = 0; e < 2; ++e) {
        ends[e] = way_along(pair, piece, piece.ends[e], direction);
        if (!ends[e].exists() || ends[e].depth < comparable * middle.depth || middle.depth < comparable * ends[e].depth)
            return add(pair, piece, middle);
        others[e] = piece.crossings[e] == NONE ? edge_past(pair, piece, ends[e]) : edge_at(pair, piece, e);
    }
    if (others[0] == others[1]) return add(pair, piece, middle);
    for (std::size_t e = 0; e < 2; ++e) add(pair, piece, ends[e], others[e]);
}

// Vertices that are inside by the crossings, though the rays of float32 found nothing, as where faces are flush: their
// rays are cast again from where the crossings have them.
void PairEdges::list_inner_vertices(const PairMeshes& pair) {
    const std::size_t count = touching_.size();
    std::uint64_t last = ~std::uint64_t{0};
    inner_.clear();
    for (const EdgePiece& piece : pieces_.all())
        if (!piece.is_through() && touching(pair, piece) == nullptr)
            inner_.emplace_back(vertex_of(pair, piece), &piece);
    std::ranges::sort(inner_);
    for (const auto& [vertex, piece] : inner_) {
        if (std::exchange(last, vertex) == vertex) continue;
        const WayOut way = way_of_vertex(pair, *piece);
        if (!way.exists() || !leads_out(pair, *piece, way)) continue;
        const bool of_a = piece->side == 0;
        const std::size_t other = 1 - piece->side;
        const TouchingVertex touching{vertex, way.depth, way.face};
        candidates_.push_back({region_of(*piece),
                               number_++,
                               out_of_b(*piece, way.normal),
                               {of_a ? Side::a : Side::b, FeatureKind::vertex, touching.number(), way.face,
                                pair.point_in(other, way.point), pair.direction_in(other, way.normal), way.depth}});
        touching_.push_back(touching);
    }
    if (touching_.size() > count) std::ranges::sort(touching_, {}, &TouchingVertex::vertex);
}

// The vertex in contact at the end of a piece; null: none is.
const TouchingVertex* PairEdges::touching(const PairMeshes& pair, const EdgePiece& piece) const {
    const std::uint64_t vertex = vertex_of(pair, piece);
    const auto at = std::ranges::lower_bound(touching_, vertex, {}, &TouchingVertex::vertex);
    return at != touching_.end() && at->vertex == vertex ? &*at : nullptr;
}

// Whether a way is deeper than rounding, and makes the overlap smaller.
bool PairEdges::leads_out(const PairMeshes& pair, const EdgePiece& piece, const WayOut& way) {
    const Region& region = regions_.all()[region_of(piece)];
    return way.depth > noise * pair.perturbation()
           && (!region.leads || region.is_pierced() || dot(out_of_b(piece, way.normal), unit(region.area)) > sideways);
}

// Whether a piece comes out with the vertex in contact at its end. Of an edge that lies on a face the other end, too,
// is a contact: there it passes an edge.
bool PairEdges::goes_with_vertex(const PairMeshes& pair, const EdgePiece& piece) {
    if (piece.is_through()) return false;
    const TouchingVertex* const at = touching(pair, piece);
    if (at == nullptr) return false;
    if (hidden_by(pair.shape(piece.side), piece.edge) < least_hidden_beside * pair.size()) return true;
    const Vec3 normal = pair.normal(1 - piece.side, at->face);
    const double most = 1.1 * at->depth + 10 * pair.perturbation();
    const MeshHit middle = exit_along(pair, piece, piece.middle(), normal);
    if (middle.face == NONE || middle.distance > most) return false;
    const std::size_t far = 1 - piece.vertex_end();
    const MeshHit end = exit_along(pair, piece, piece.ends[far], normal);
    if (end.face != NONE && end.distance <= most && end.distance >= comparable * at->depth)
        add(pair, piece, {end.distance, end.distance, normal, end.face, piece.ends[far]}, edge_at(pair, piece, far));
    return true;
}

// Where a's surface is when a piece of b has come out.
Vec3 PairEdges::point_past(const PairMeshes& pair, const WayOut& way) {
    const auto corner = [&](std::size_t k) { return pair.corner(0, way.face, k); };
    return nearest_point(way.point + way.depth * way.normal, corner(0), corner(1), corner(2));
}

// The edge of the other body nearest to where a piece comes out.
std::uint32_t PairEdges::edge_past(const PairMeshes& pair, const EdgePiece& piece, const WayOut& way) {
    return nearest_edge(pair, 1 - piece.side, way.face, way.point + way.depth * way.normal);
}

// The edge of the face that a piece crosses at an end, nearest to there.
std::uint32_t PairEdges::edge_at(const PairMeshes& pair, const EdgePiece& piece, std::size_t end) const {
    const Crossing& crossing = loops_.crossings()[piece.crossings[end]];
    return nearest_edge(pair, 1 - piece.side, crossing.face, crossing.point);
}

void PairEdges::add(const PairMeshes& pair, const EdgePiece& piece, const WayOut& way) {
    add(pair, piece, way, edge_past(pair, piece, way));
}

void PairEdges::add(const PairMeshes& pair, const EdgePiece& piece, const WayOut& way, std::uint32_t other) {
    if (!leads_out(pair, piece, way)) return;
    const bool of_a = piece.side == 0;
    const Vec3 normal = out_of_b(piece, way.normal);
    candidates_.push_back({region_of(piece),
                           number_++,
                           normal,
                           {Side::a, FeatureKind::edges, of_a ? piece.edge : other, of_a ? other : piece.edge,
                            of_a ? way.point : point_past(pair, way), normal, way.depth}});
}

// A body pierced through: the loops on either side cancel, and say nothing. Of the normals of the faces that they cross
// the one along which the pieces are out soonest.
void PairEdges::list_pierced(const PairMeshes& pair, std::uint32_t number) {
    constexpr Vec3 preferred{0.31, 0.53, 0.79}; // of two ways alike always the same, whatever rounding does
    const auto exit = [&](const EdgePiece& piece, const Vec3& end, const Vec3& way) {
        return exit_along(pair, piece, end, piece.side == 0 ? way : -1.0 * way);
    };
    const auto counts = [&](const EdgePiece& piece) { return region_of(piece) == number && speaks(pair, piece); };
    Vec3 way{};
    double least = std::numeric_limits<double>::infinity();
    asked_.clear();
    const auto ask = [&](const Vec3& n) {
        if (std::ranges::any_of(asked_, [&](const Vec3& m) { return dot(n, m) > 0.9999; })) return;
        asked_.push_back(n);
        double most = 0;
        for (const EdgePiece& piece : pieces_.all()) {
            if (!counts(piece)) continue;
            for (const Vec3& end : piece.ends) most = std::max(most, exit(piece, end, n).distance);
            if (most > 1.001 * least) return;
        }
        if (!(most > 0)) return;
        if (most < 0.999 * least || dot(n, preferred) > dot(way, preferred)) {
            way = n;
            least = std::min(most, least);
        }
    };
    for (const LoopSegment& s : loops_.segments()) {
        if (regions_.of_crossing(s.from) != number) continue;
        for (const Vec3& n : {s.normals[1], -1.0 * s.normals[1], -1.0 * s.normals[0], s.normals[0]}) ask(n);
        if (asked_.size() >= most_faces) break;
    }
    if (way == Vec3{}) return;
    for (const EdgePiece& piece : pieces_.all()) {
        if (!counts(piece)) continue;
        for (const Vec3& end : piece.ends) {
            const MeshHit hit = exit(piece, end, way);
            if (hit.face != NONE)
                add(pair, piece, {hit.distance, hit.distance, piece.side == 0 ? way : -1.0 * way, hit.face, end});
        }
    }
}

// Of the candidates from the first one on; each may hide others.
void PairEdges::leave_out_hidden(std::size_t first) {
    const auto regions = regions_.all();
    const auto added = std::span(candidates_).subspan(first);
    for (const Candidate& c : added) regions[c.region].tell(c.contact.depth, c.normal);
    const auto is_out = [&](const Candidate& c) { return is_hidden(regions[c.region], c.contact.depth, c.normal); };
    candidates_.erase(
        std::remove_if(candidates_.begin() + static_cast<std::ptrdiff_t>(first), candidates_.end(), is_out),
        candidates_.end());
}

// Two edges have one contact, the deepest; of equally deep ones, whatever rounding says, the first.
void PairEdges::give(std::vector<FeatureContact>& found) {
    const auto key = [](const Candidate& c) {
        return std::tuple(c.contact.kind, c.contact.source, c.contact.index, c.contact.other);
    };
    std::ranges::sort(candidates_, {}, [&](const Candidate& c) { return std::tuple(key(c), c.number); });
    const Candidate* last = nullptr;
    for (const Candidate& c : candidates_) {
        if (last == nullptr || key(c) != key(*last))
            found.push_back(c.contact);
        else if (c.contact.depth > (1 + 1e-6) * found.back().depth)
            found.back() = c.contact;
        last = &c;
    }
}

} // namespace raycontact
