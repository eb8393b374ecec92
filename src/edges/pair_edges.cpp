// SPDX-License-Identifier: Apache-2.0
#include "edges/pair_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace raycontact {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
// A contact counts beside others of its region from this part of their depth on.
constexpr double comparable = 0.5;
// The cross product of two edges is their normal if they are less parallel than this and it does not leave the arc
// between the normals of either edge's faces by more than this, radians.
constexpr double least_sine = 0.05, arc = 0.1;
// ... and is no more than 60 degrees from where the loop points. Otherwise a face's normal serves, if it is no more
// than 37 degrees from there.
constexpr double same_way = 0.5, snap = 0.8;
// Faces of the two bodies that are nearly parallel say nothing about how thin a region is.
constexpr double parallel = 0.98;
// Two edges whose normal has no larger part than this along the way of their region are passed over.
constexpr double sideways = 0.1;
// Two edges may be so many times as deep as their region is along a face; beside flush faces.
constexpr double most_deep = 2, most_flush = 1.25;
// What is no deeper than this, in perturbations, is rounding.
constexpr double noise = 0.1;
constexpr std::size_t most_faces = 64;
// A ray from a piece begins this part of its half inside.
constexpr double pull = 1e-3;
constexpr int most_triangles_around = 256;

// The edge of a face that is nearest to a point of its plane.
std::uint32_t nearest_edge(const PairMeshes& pair, std::size_t side, std::uint32_t face, const Vec3& point) {
    const ShapeData& shape = pair.shape(side);
    std::uint32_t best = 0;
    double least = never;
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

// By how much a unit direction leaves the arc between the normals of an edge's faces, radians.
double beyond(const Vec3& direction, const Vec3& n, const Vec3& m) {
    const Vec3 middle = unit(n + m);
    const auto angle = [&](const Vec3& v) { return std::acos(std::clamp(dot(v, middle), -1.0, 1.0)); };
    return angle(direction) - angle(n);
}

} // namespace

bool PairEdges::find(const PairMeshes& pair, const NearEdges& near,
                     const std::array<std::span<const kernels::LocalContact>, 2>& vertices,
                     std::vector<FeatureContact>& found) {
    list_vertices(vertices);
    follow_loops(pair, near);
    if (crossings().empty()) return false;
    list_pieces(pair);
    join_regions(pair);
    list_regions(pair);
    pass_edges(pair);
    const auto before = static_cast<std::ptrdiff_t>(found.size());
    give_edges(found);
    all_speak_ = false;
    give_deep(pair, found);
    all_speak_ = found.size() == std::size_t(before) && in_contact_.empty();
    if (all_speak_) give_deep(pair, found);
    // Two edges have one contact, the deepest.
    const auto edges = [](const FeatureContact& c) { return std::pair(c.index, c.other); };
    std::ranges::sort(found.begin() + before, found.end(), {},
                      [&](const FeatureContact& c) { return std::tuple(edges(c), -c.depth); });
    const auto same = [&](const FeatureContact& c, const FeatureContact& d) { return edges(c) == edges(d); };
    found.erase(std::unique(found.begin() + before, found.end(), same), found.end());
    return true;
}

// Every loop has been followed once each edge has been asked. Where a vertex is in contact, only those need be that
// hide much: loops that none of them crosses are left out.
void PairEdges::follow_loops(const PairMeshes& pair, const NearEdges& near) {
    const double least = in_contact_.empty() ? -1 : least_hidden * pair.size();
    const double least_beside = in_contact_.empty() ? -1 : least_hidden_beside * pair.size();
    const auto is_in_contact = [&](std::size_t side, std::uint32_t vertex) {
        return std::ranges::binary_search(in_contact_, std::uint64_t{side} << 32 | vertex, {}, &VertexContact::vertex);
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
                asked = hides > least_beside
                        || (hides > least && !is_in_contact(side, start) && !is_in_contact(side, stop));
            }
            if (!asked) continue;
            face.set(pair, 1 - side, candidate.face);
            if (Crossing seed; crosses(pair, side, edge, face, seed)) loops_.follow(pair, seed);
        }
    }
}

void PairEdges::list_vertices(const std::array<std::span<const kernels::LocalContact>, 2>& vertices) {
    in_contact_.clear();
    for (std::size_t side = 0; side < 2; ++side)
        for (const kernels::LocalContact& c : vertices[side])
            in_contact_.push_back({std::uint64_t{side} << 32 | c.vertex, double(c.distance) * double(c.facing)});
    std::ranges::sort(in_contact_, {}, &VertexContact::vertex);
}

void PairEdges::list_pieces(const PairMeshes& pair) {
    pieces_.clear();
    piece_vertices_.clear();
    crossed_.clear();
    by_edge_.resize(crossings().size());
    std::iota(by_edge_.begin(), by_edge_.end(), 0u);
    std::ranges::sort(by_edge_, {}, [this](std::uint32_t i) {
        const Crossing& c = crossings()[i];
        return std::tie(c.side, c.edge, c.at, c.face);
    });
    for (std::size_t begin = 0, end = 0; begin < by_edge_.size(); begin = end) {
        const std::uint32_t side = crossings()[by_edge_[begin]].side, edge = crossings()[by_edge_[begin]].edge;
        const auto on_edge = [&](std::uint32_t i) {
            return crossings()[i].side == side && crossings()[i].edge == edge;
        };
        while (end < by_edge_.size() && on_edge(by_edge_[end])) ++end;
        const auto [start, stop] = ends_of(pair.shape(side), edge);
        const std::uint64_t of_side = std::uint64_t{side} << 32;
        crossed_.push_back({of_side | std::min(start, stop), of_side | std::max(start, stop)});
        if (pair.shape(1 - side).header.closed == 0) continue; // an open mesh has no inside
        // The piece before crossing k, if it is inside.
        for (std::size_t k = begin; k <= end; ++k) {
            Piece piece{side, edge, {k > begin ? by_edge_[k - 1] : NONE, k < end ? by_edge_[k] : NONE}, {}};
            const auto [enters, leaves] = piece.crossings;
            if ((enters != NONE && crossings()[enters].leaves) || (leaves != NONE && !crossings()[leaves].leaves))
                continue;
            for (std::size_t e = 0; e < 2; ++e) {
                if (piece.crossings[e] != NONE) {
                    piece.ends[e] = crossings()[piece.crossings[e]].point;
                } else {
                    const std::uint32_t vertex = e == 0 ? start : stop;
                    piece.ends[e] = pair.vertex(side, vertex);
                    piece_vertices_.emplace_back(of_side | vertex, piece.crossings[1 - e]);
                }
            }
            pieces_.push_back(piece);
        }
    }
    std::sort(crossed_.begin(), crossed_.end());
}

void PairEdges::join_regions(const PairMeshes& pair) {
    // The nodes are the crossings, the vertices in contact, and the other vertices at ends of pieces.
    const auto first = static_cast<std::uint32_t>(crossings().size());
    const std::uint32_t first_other = first + static_cast<std::uint32_t>(in_contact_.size());
    sets_.reset(first_other + piece_vertices_.size());
    for (const LoopSegment& s : loops_.segments()) sets_.join(s.from, s.to);
    for (const Piece& piece : pieces_)
        if (piece.is_through()) sets_.join(piece.crossings[0], piece.crossings[1]);
    std::sort(piece_vertices_.begin(), piece_vertices_.end());
    other_vertices_.clear();
    std::size_t at = 0;
    for (const auto& [vertex, crossing] : piece_vertices_) {
        while (at < in_contact_.size() && in_contact_[at].vertex < vertex) ++at;
        if (at < in_contact_.size() && in_contact_[at].vertex == vertex) {
            sets_.join(crossing, first + static_cast<std::uint32_t>(at));
            continue;
        }
        if (other_vertices_.empty() || other_vertices_.back() != vertex) other_vertices_.push_back(vertex);
        sets_.join(crossing, first_other + static_cast<std::uint32_t>(other_vertices_.size() - 1));
    }
    node_count_ = first_other + other_vertices_.size();
    if (in_contact_.size() > 1) join_vertices(pair);
}

// Vertices in contact with their neighbours, over edges that stay in the other body.
void PairEdges::join_vertices(const PairMeshes& pair) {
    for (std::size_t side = 0; side < 2; ++side)
        if (node_at_[side].size() < pair.shape(side).points.size())
            node_at_[side].resize(pair.shape(side).points.size(), NONE);
    for (const VertexContact& contact : in_contact_) node_at_[contact.side()][contact.number()] = node_of(contact);
    for (const VertexContact& contact : in_contact_) {
        const std::size_t side = contact.side();
        const std::uint32_t own = contact.number();
        const ShapeData& shape = pair.shape(side);
        const auto join = [&](std::uint32_t other) {
            const std::uint32_t node = node_at_[side][other];
            if (other < own || node == NONE) return; // below: joined there
            if (sets_.of(node) == sets_.of(node_of(contact))) return;
            const std::uint64_t vertex = std::uint64_t{side} << 32 | other;
            if (!std::binary_search(crossed_.begin(), crossed_.end(), std::array{contact.vertex, vertex}))
                sets_.join(node, node_of(contact));
        };
        // Around the vertex; where a border ends that, the other way round, too.
        const std::uint32_t begin = shape.vertex_triangle[own];
        std::uint32_t t = begin;
        for (const std::size_t way : {0u, 2u}) {
            for (int count = 0; count < most_triangles_around && t != NONE; ++count) {
                const auto& corners = shape.mesh.triangles[t];
                const std::size_t c = corners[0] == own ? 0 : corners[1] == own ? 1 : 2;
                join(corners[(c + (way == 0 ? 2 : 1)) % 3]); // the other corner is the next triangle's, or a border's
                const std::uint32_t next = shape.neighbours[t][(c + way) % 3];
                if (next == NONE) join(corners[(c + (way == 0 ? 1 : 2)) % 3]);
                t = next;
                if (t == begin) break;
            }
            if (t != NONE) break;
            t = begin;
        }
    }
    for (const VertexContact& contact : in_contact_) node_at_[contact.side()][contact.number()] = NONE;
}

// Keeps the order within a region.
void PairEdges::sort_by_region(std::vector<std::pair<std::uint32_t, Vec3>>& list) {
    if (regions_.size() < 2) return;
    firsts_.assign(regions_.size() + 1, 0);
    for (const auto& [region, point] : list) ++firsts_[region + 1];
    std::partial_sum(firsts_.begin(), firsts_.end(), firsts_.begin());
    sorted_.resize(list.size());
    for (const auto& one : list) sorted_[firsts_[one.first]++] = one;
    list.swap(sorted_);
}

void PairEdges::list_regions(const PairMeshes& pair) {
    regions_.clear();
    points_.clear();
    faces_.clear();
    region_of_.assign(node_count_, NONE);
    for (std::uint32_t i = 0; i < region_of_.size(); ++i) {
        const std::uint32_t root = sets_.of(i); // the lowest, so seen already
        if (root == i) {
            region_of_[i] = static_cast<std::uint32_t>(regions_.size());
            regions_.emplace_back();
        } else {
            region_of_[i] = region_of_[root];
        }
    }
    for (const Loop& loop : loops_.loops()) {
        Region& region = regions_[region_of_[loop.first]];
        region.area = region.area + loop.area;
        region.area_sum += length(loop.area);
    }
    for (std::uint32_t i = 0; i < crossings().size(); ++i) points_.emplace_back(region_of_[i], crossings()[i].point);
    const auto place = [&](std::uint32_t node, std::uint64_t vertex) {
        points_.emplace_back(region_of_[node], pair.vertex(vertex >> 32, static_cast<std::uint32_t>(vertex)));
    };
    for (const VertexContact& c : in_contact_) {
        place(node_of(c), c.vertex);
        Region& region = regions_[region_of_[node_of(c)]];
        region.deepest = std::max(region.deepest, c.depth);
        region.told = region.deepest;
        region.speaks = true;
    }
    for (std::size_t i = 0; i < other_vertices_.size(); ++i)
        place(static_cast<std::uint32_t>(node_count_ - other_vertices_.size() + i), other_vertices_[i]);
    for (const LoopSegment& s : loops_.segments()) {
        Region& region = regions_[region_of_[s.from]];
        const double along = length(crossings()[s.to].point - crossings()[s.from].point);
        region.loop_length += along;
        if (dot(s.normals[0], s.normals[1]) > parallel) {
            region.flush_length += along;
            continue;
        }
        faces_.emplace_back(region_of_[s.from], s.normals[1]);
        faces_.emplace_back(region_of_[s.from], -1.0 * s.normals[0]);
    }
    sort_by_region(points_);
    sort_by_region(faces_);
    std::uint32_t point = 0, face = 0;
    for (std::uint32_t r = 0; r < regions_.size(); ++r) {
        Region& region = regions_[r];
        region.first_point = point;
        while (point < points_.size() && points_[point].first == r) ++point;
        region.end_point = point;
        region.first_face = face;
        while (face < faces_.size() && faces_[face].first == r) ++face;
        region.end_face = face;
    }
}

PairEdges::Range PairEdges::range(const Region& region, const Vec3& normal) const {
    Range range{never, -never};
    for (std::uint32_t i = region.first_point; i < region.end_point; ++i) range.add(dot(points_[i].second, normal));
    return range;
}

// Whether a region is thinner than `limit` along a normal of a face that its loops cross.
bool PairEdges::is_thinner(const Region& region, double limit) const {
    for (std::uint32_t i = region.first_face; i < region.end_face; ++i) {
        Range range{never, -never};
        std::uint32_t k = region.first_point;
        for (; k < region.end_point && !(range.extent() >= limit); ++k)
            range.add(dot(points_[k].second, faces_[i].second));
        if (range.extent() < limit) return true;
    }
    return false;
}

// The way in which a region's a leaves b, of regions that are not pierced: as its loops' area, or by a face along which
// it is less than half as deep.
const Vec3& PairEdges::way_of(const PairMeshes& pair, Region& region) const {
    if (region.way == Vec3{}) region.way = find_way(pair, region);
    return region.way;
}

Vec3 PairEdges::find_way(const PairMeshes& pair, const Region& region) const {
    const Vec3 way = unit(region.area);
    if (!is_thinner(region, 0.5 * range(region, way).extent() - 5 * pair.perturbation())) return way;
    double thin = never;
    for (std::uint32_t i = region.first_face; i < region.end_face; ++i)
        thin = std::min(thin, range(region, faces_[i].second).extent());
    Vec3 by{};
    double best = -never;
    for (std::uint32_t i = region.first_face; i < region.end_face; ++i) {
        const Vec3& n = faces_[i].second;
        if (dot(n, way) > best && range(region, n).extent() <= 1.1 * thin + pair.perturbation()) {
            best = dot(n, way);
            by = n;
        }
    }
    return by;
}

void PairEdges::pass_edges(const PairMeshes& pair) {
    passing_.clear();
    for (const Loop& loop : loops_.loops()) {
        // Edges within a flat face are passed over.
        std::uint32_t first = NONE, last = NONE;
        const auto visit = [&](std::uint32_t c) {
            const Crossing& now = crossings()[c];
            if (last != NONE && crossings()[last].side != now.side)
                pass(pair, loop, now.side == 0 ? c : last, now.side == 0 ? last : c);
            last = c;
        };
        for (std::uint32_t c = loop.first; c < loop.first + loop.count; ++c) {
            if (!is_sharp(pair.shape(crossings()[c].side), crossings()[c].edge)) continue;
            if (first == NONE) first = c;
            visit(c);
        }
        if (loop.is_closed() && first != NONE && first != last) visit(first);
    }
}

void PairEdges::pass(const PairMeshes& pair, const Loop& loop, std::uint32_t of_a, std::uint32_t of_b) {
    const Crossing &x = crossings()[of_a], &y = crossings()[of_b];
    const std::uint32_t number = region_of_[of_a];
    Region& region = regions_[number];
    if (region.is_pierced()) return;
    const double least = comparable * region.deepest;
    const Vec3 &p = x.point, &q = y.point;
    if (!(length(q - p) >= least)) return;
    const ShapeData &a = pair.shape(0), &b = pair.shape(1);
    if (!is_convex(a, x.edge) || !is_convex(b, y.edge)) return;
    const Vec3 way = unit(loop.area);
    const auto normals = [&](std::size_t side, std::uint32_t edge) {
        const auto [own, across] = faces_of(pair.shape(side), edge);
        const Vec3 n = pair.normal(side, own);
        return std::array{n, across == NONE ? n : pair.normal(side, across)};
    };
    const auto na = normals(0, x.edge), nb = normals(1, y.edge);
    const auto [a0, a1] = ends_of(a, x.edge);
    const auto [b0, b1] = ends_of(b, y.edge);
    const Vec3 start = pair.vertex(0, a0), whole = pair.vertex(0, a1) - start;
    const Vec3 ea = unit(whole), eb = unit(pair.vertex(1, b1) - pair.vertex(1, b0));
    Vec3 n = cross(ea, eb);
    const double sine = length(n);
    n = unit(n);
    if (dot(n, nb[0] + nb[1]) < 0) n = -1.0 * n;
    const bool own = sine > least_sine && dot(n, way) >= same_way && beyond(n, nb[0], nb[1]) < arc
                     && beyond(-1.0 * n, na[0], na[1]) < arc;
    // Beside flush faces a loop's area leans, and two edges may pass each other sideways.
    if (own && dot(n, way_of(pair, region)) <= sideways) return;
    Vec3 point = p;
    if (own) {
        // The point of a's edge that is nearest to b's.
        const Vec3 w = p - q;
        const double cosine = dot(ea, eb), t = (cosine * dot(eb, w) - dot(ea, w)) / (sine * sine);
        // ... of the part that is inside b.
        const double size = length(whole), here = x.at * size;
        point = start + std::clamp(dot(p + t * ea - start, ea), x.leaves ? 0 : here, x.leaves ? here : size) * ea;
    } else {
        // Of flush edges, say: a face's normal.
        double best = snap;
        n = {};
        for (const Vec3& face : {nb[0], nb[1], -1.0 * na[0], -1.0 * na[1]})
            if (dot(face, way) > best) {
                best = dot(face, way);
                n = face;
            }
    }
    double depth = dot(q - p, n);
    // Nearly parallel edges are pierced far apart, and only what lies across them counts.
    if (!own) depth = std::min({depth, length(cross(q - p, ea)), length(cross(q - p, eb))});
    if (!(depth > noise * pair.perturbation()) || depth < least) return;
    if (is_thinner(region, depth / (region.is_flush() ? most_flush : most_deep) - 5 * pair.perturbation())) return;
    passing_.push_back({number, {Side::a, FeatureKind::edges, x.edge, y.edge, point, n, depth}});
}

// Two edges that pass each other more than once have the shallowest contact.
void PairEdges::give_edges(std::vector<FeatureContact>& found) {
    std::ranges::sort(passing_, {},
                      [](const Passing& p) { return std::tuple(p.contact.index, p.contact.other, p.contact.depth); });
    for (std::size_t i = 0; i < passing_.size(); ++i) {
        const FeatureContact& c = passing_[i].contact;
        if (i > 0 && passing_[i - 1].contact.index == c.index && passing_[i - 1].contact.other == c.other) continue;
        Region& region = regions_[passing_[i].region];
        region.told = std::max(region.told, c.depth);
        region.speaks = true;
        found.push_back(c);
    }
}

// Sharp and convex edges speak; concave ones and those within flat faces only where nothing else does.
bool PairEdges::speaks(const PairMeshes& pair, const Piece& piece) const {
    const ShapeData& shape = pair.shape(piece.side);
    return all_speak_ || (is_sharp(shape, piece.edge) && is_convex(shape, piece.edge));
}

// How far a point of a piece goes along the way, until its body is out of the other there; from a little inside.
MeshHit PairEdges::exit_along(const PairMeshes& pair, const Piece& piece, const Vec3& point, const Vec3& way) {
    const std::size_t other = 1 - piece.side;
    const Vec3 from = point + pull * (0.5 * (piece.ends[0] + piece.ends[1]) - point);
    const Vec3 along = pair.direction_in(other, piece.side == 0 ? way : -1.0 * way);
    const MeshHit hit = closest_hit(pair.shape(other), {pair.point_in(other, from), along, 0, never});
    return hit.face != NONE && hit.from_inside ? hit : MeshHit{0, NONE, false};
}

// Adds the point of a piece, with the edge of the other body nearest to where it comes out.
void PairEdges::add_deep(const PairMeshes& pair, const Piece& piece, const Vec3& point, const Vec3& way, double depth,
                         const MeshHit& hit) {
    if (!(depth > noise * pair.perturbation())) return;
    const bool of_a = piece.side == 0;
    const std::uint32_t other = nearest_edge(pair, 1 - piece.side, hit.face, point + (of_a ? depth : -depth) * way);
    deep_.push_back({Side::a, FeatureKind::edges, of_a ? piece.edge : other, of_a ? other : piece.edge,
                     of_a ? point : point - depth * way, way, depth});
}

// Where round bodies cross, a region's middle is deeper than its border: the middles of its pieces, by a ray. Of a
// region without any contact the ends, too.
void PairEdges::list_deep(const PairMeshes& pair, std::uint32_t number) {
    Region& region = regions_[number];
    if (!(region.told < comparable * range(region, unit(region.area)).extent())) return;
    Vec3 way = way_of(pair, region);
    Range along = range(region, way);
    if (!(region.told < comparable * along.extent())) return;
    // Beside flush faces a loop's area leans: then along the face that looks most that way.
    double best = snap;
    const double deep = along.extent();
    for (std::uint32_t i = region.first_face; i < region.end_face && region.is_flush(); ++i) {
        const Vec3& n = faces_[i].second;
        const double facing = dot(n, way_of(pair, region));
        if (!(facing > best)) continue;
        const Range by_face = range(region, n);
        if (!(by_face.extent() <= deep)) continue;
        best = facing;
        way = n;
        along = by_face;
    }
    const auto ask = [&](const Piece& piece, const Vec3& point) {
        const double at = dot(point, way), most = piece.side == 0 ? along.high - at : at - along.low;
        if (!(most > region.told)) return;
        const MeshHit hit = exit_along(pair, piece, point, way);
        double depth = std::min(most, hit.distance);
        if (!(depth > region.told)) return;
        const auto [own, across] = faces_of(pair.shape(piece.side), piece.edge);
        Vec3 inward = pair.normal(piece.side, own);
        if (across != NONE) inward = inward + pair.normal(piece.side, across);
        inward = unit(inward);
        const MeshHit in = exit_along(pair, piece, point, piece.side == 0 ? -1.0 * inward : inward);
        if (in.face != NONE) depth = std::min(depth, in.distance);
        if (depth > region.told) add_deep(pair, piece, point, way, depth, hit);
    };
    for (const Piece& piece : pieces_) {
        if (region_of(piece) != number || !speaks(pair, piece)) continue;
        if (piece.is_through()) ask(piece, 0.5 * (piece.ends[0] + piece.ends[1]));
        if (region.speaks) continue;
        for (const Vec3& end : piece.ends) ask(piece, end);
    }
}

// A body pierced through: the loops on either side cancel, and say nothing. Of the normals of the faces that they cross
// the one along which the pieces are out soonest.
void PairEdges::list_pierced(const PairMeshes& pair, std::uint32_t number) {
    constexpr Vec3 preferred{0.31, 0.53, 0.79}; // of two ways alike always the same, whatever rounding does
    const Region& region = regions_[number];
    Vec3 way{};
    double least = never;
    asked_.clear();
    for (std::uint32_t i = region.first_face; i < region.end_face && asked_.size() < most_faces; ++i)
        for (const Vec3& n : {faces_[i].second, -1.0 * faces_[i].second}) {
            if (std::any_of(asked_.begin(), asked_.end(), [&](const Vec3& m) { return dot(n, m) > 0.9999; })) continue;
            asked_.push_back(n);
            double most = 0;
            for (const Piece& piece : pieces_) {
                if (region_of(piece) != number || !speaks(pair, piece)) continue;
                for (const Vec3& end : piece.ends) most = std::max(most, exit_along(pair, piece, end, n).distance);
                if (most > 1.001 * least) break;
            }
            if (!(most > 0)) continue;
            if (most < 0.999 * least || (most <= 1.001 * least && dot(n, preferred) > dot(way, preferred))) {
                way = n;
                least = std::min(most, least);
            }
        }
    if (way == Vec3{}) return;
    for (const Piece& piece : pieces_) {
        if (region_of(piece) != number || !speaks(pair, piece)) continue;
        for (const Vec3& end : piece.ends) {
            const MeshHit hit = exit_along(pair, piece, end, way);
            add_deep(pair, piece, end, way, hit.distance, hit);
        }
    }
}

void PairEdges::give_deep(const PairMeshes& pair, std::vector<FeatureContact>& found) {
    for (std::uint32_t r = 0; r < regions_.size(); ++r) {
        deep_.clear();
        if (!regions_[r].is_pierced())
            list_deep(pair, r);
        else if (!regions_[r].speaks)
            list_pierced(pair, r);
        double most = 0;
        for (const FeatureContact& c : deep_) most = std::max(most, c.depth);
        for (const FeatureContact& c : deep_)
            if (c.depth >= comparable * most) found.push_back(c);
    }
}

} // namespace raycontact
