// SPDX-License-Identifier: Apache-2.0
#include "edges/pair_edges.h"

#include "edges/mesh_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
// Ends are pulled into their piece by this part of the smaller body, so that a ray from there starts inside.
constexpr double pull = 1e-3, most_pull = 0.01;
// An end beside vertices in contact is a contact from this part of their depth on.
constexpr double comparable = 0.5;
// Depths are equal if they differ by less: what was equal before vertices were moved by a hair may differ by two.
constexpr double few_hairs = 3;
// Of faces equally deep the one that looks most this way decides: of two that are not parallel, always the same.
constexpr Vec3 preferred{0.31, 0.53, 0.79};
// Of a larger region so many points stand for all.
constexpr std::size_t most_points = 48;

// How far a point must go along a face's normal to leave the target; if it is beyond the face's plane, its distance
// from that plane, negative. A plane may reach past its face, so a ray decides.
double way_out(const ShapeData& target, const Vec3& point, const Vec3& normal, double height) {
    const double flat = height - dot(point, normal);
    if (flat <= 0) return flat;
    const MeshHit hit = closest_hit(target, point, normal, 0, never);
    return hit.face != NONE && hit.from_inside ? hit.distance : flat;
}

// Inward mean of the normals of an edge's faces, in the source's frame; zero for a fold.
Vec3 inward(const ShapeData& source, std::uint32_t edge) {
    const std::uint32_t across = source.neighbours[edge / 3][edge % 3];
    const Vec3 n = normal_of(source, edge / 3) + (across != NONE ? normal_of(source, across) : Vec3{});
    const double size = length(n);
    return size > 1e-6 ? (-1 / size) * n : Vec3{};
}

// Beside a concave edge that is inside the target, the target is inside the source.
bool is_concave(const ShapeData& source, std::uint32_t edge) {
    const std::uint32_t face = edge / 3, across = source.neighbours[face][edge % 3];
    if (across == NONE) return false;
    const auto& own = source.mesh.triangles[face];
    const Vec3 start = source.corner(face, edge % 3), n = normal_of(source, face);
    double highest = 0; // of the corner that is not on the edge
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = source.mesh.triangles[across][k];
        if (v != own[edge % 3] && v != own[(edge % 3 + 1) % 3]) highest = dot(source.point(v) - start, n);
    }
    return highest > 0;
}

} // namespace

bool PairEdges::find(const std::array<SourceMesh, 2>& placed, const NearEdges& near,
                     const std::array<std::span<const kernels::LocalContact>, 2>& vertices,
                     std::vector<FeatureContact>& found) {
    for (std::size_t side = 0; side < 2; ++side) {
        crossings_[side].clear();
        find_crossings(placed[side], near[side], crossings_[side]);
    }
    if (crossings_[0].empty() && crossings_[1].empty()) return false;
    const std::size_t before = found.size();
    ask(placed, vertices, false, found);
    if (found.size() == before && vertices[0].empty() && vertices[1].empty()) ask(placed, vertices, true, found);
    return true;
}

void PairEdges::ask(const std::array<SourceMesh, 2>& placed,
                    const std::array<std::span<const kernels::LocalContact>, 2>& vertices, bool concave,
                    std::vector<FeatureContact>& found) {
    const std::array<std::uint32_t, 2> first{0, static_cast<std::uint32_t>(crossings_[0].size())};
    auto node = static_cast<std::uint32_t>(crossings_[0].size() + crossings_[1].size());
    for (std::size_t side = 0; side < 2; ++side) {
        list_vertices(placed[side], vertices[side], node, vertices_[side]);
        list_pieces(placed[side], crossings_[side], vertices_[side], first[side], concave, pieces_[side]);
    }
    regions_.reset(node);
    curves_.clear(); // a step that failed half-way left some
    for (std::size_t side = 0; side < 2; ++side) list_curves(placed, side, first[side]);
    join_curves(placed[0]);
    for (std::size_t side = 0; side < 2; ++side) join_vertices(placed[side], side);
    for (std::size_t side = 0; side < 2; ++side) give_contacts(placed[side], side, found);
}

void PairEdges::list_vertices(const SourceMesh& placed, std::span<const kernels::LocalContact> vertices,
                              std::uint32_t& node, std::vector<VertexContact>& in_contact) {
    in_contact.clear();
    for (const kernels::LocalContact& c : vertices)
        in_contact.push_back({c.vertex, c.triangle, double(c.distance) * double(c.facing), placed.vertex(c.vertex), 0});
    std::sort(in_contact.begin(), in_contact.end(),
              [](const VertexContact& p, const VertexContact& q) { return p.vertex < q.vertex; });
    for (VertexContact& vertex_contact : in_contact) vertex_contact.region = node++;
}

void PairEdges::list_pieces(const SourceMesh& placed, std::span<const Crossing> crossings,
                            std::span<const VertexContact> in_contact, std::uint32_t first_node, bool concave,
                            std::vector<Piece>& pieces) {
    pieces.clear();
    const auto contact_at = [&](std::uint32_t vertex) -> const VertexContact* {
        const auto at = std::lower_bound(in_contact.begin(), in_contact.end(), vertex,
                                         [](const VertexContact& s, std::uint32_t v) { return s.vertex < v; });
        return at != in_contact.end() && at->vertex == vertex ? &*at : nullptr;
    };
    for (std::size_t begin = 0, end = 0; begin < crossings.size(); begin = end) {
        const std::uint32_t edge = crossings[begin].edge;
        while (end < crossings.size() && crossings[end].edge == edge) ++end;
        if (!concave && is_concave(placed.source, edge)) continue;
        const std::span<const Crossing> own = crossings.subspan(begin, end - begin);
        const auto [start, stop] = ends_of(placed.source, edge);
        const Vec3 origin = placed.vertex(start), along = placed.vertex(stop) - origin;
        const double most = std::min(most_pull, pull * placed.size / length(along));
        // The piece before crossing k, if it is inside.
        for (std::size_t k = 0; k <= own.size(); ++k) {
            const bool enters = k > 0, leaves = k < own.size();
            if ((enters && own[k - 1].leaves) || (leaves && !own[k].leaves)) continue;
            const double p = enters ? own[k - 1].at : 0, q = leaves ? own[k].at : 1;
            if (q <= p) continue;
            const double by = std::min(most, (q - p) / 4);
            Piece piece{edge, first_node + static_cast<std::uint32_t>(begin + (leaves ? k : k - 1)), {}, {NONE, NONE}};
            if (enters) {
                piece.faces[0] = own[k - 1].face;
                piece.ends[0] = {origin + (p + by) * along, NONE, static_cast<std::uint32_t>(k - 1), nullptr};
            } else {
                piece.ends[0] = {origin, start, edge_start, contact_at(start)};
            }
            if (leaves) {
                piece.faces[1] = own[k].face;
                piece.ends[1] = {origin + (q - by) * along, NONE, static_cast<std::uint32_t>(k), nullptr};
            } else {
                piece.ends[1] = {origin + along, stop, edge_end, contact_at(stop)};
            }
            pieces.push_back(piece);
        }
    }
}

void PairEdges::give_contacts(const SourceMesh& placed, std::size_t side, std::vector<FeatureContact>& found) {
    points_.clear();
    deepest_.clear();
    extents_.clear();
    edge_contacts_.clear();
    choices_.clear();
    for (VertexContact& vertex_contact : vertices_[side]) {
        vertex_contact.region = regions_.of(vertex_contact.region);
        points_.push_back({vertex_contact.region, static_cast<std::uint32_t>(points_.size()), vertex_contact.point});
        deepest_.push_back(&vertex_contact);
    }
    for (Piece& piece : pieces_[side]) {
        piece.region = regions_.of(piece.region);
        for (const End& end : piece.ends)
            if (end.vertex_contact == nullptr)
                points_.push_back({piece.region, static_cast<std::uint32_t>(points_.size()), end.point});
    }
    std::sort(points_.begin(), points_.end(), [](const RegionPoint& p, const RegionPoint& q) {
        return std::pair(p.region, p.number) < std::pair(q.region, q.number);
    });
    last_extent_.assign(points_.size(), NONE);
    std::sort(deepest_.begin(), deepest_.end(), [](const VertexContact* p, const VertexContact* q) {
        if (p->region != q->region) return p->region < q->region;
        return p->depth != q->depth ? p->depth > q->depth : p->vertex < q->vertex;
    });
    for (const Piece& piece : pieces_[side]) choose(placed, piece);
    std::sort(choices_.begin(), choices_.end(), [](const Choice& p, const Choice& q) {
        return std::pair(p.piece->region, p.piece) < std::pair(q.piece->region, q.piece);
    });
    for (std::size_t begin = 0, end = 0; begin < choices_.size(); begin = end) {
        while (end < choices_.size() && choices_[end].piece->region == choices_[begin].piece->region) ++end;
        agree(placed, std::span(choices_).subspan(begin, end - begin));
    }
    for (const Choice& choice : choices_) give_contacts(placed.target, static_cast<VertexBody>(side), choice, found);
    // Several edges may have a contact at one vertex: the lowest counts.
    std::sort(edge_contacts_.begin(), edge_contacts_.end(), [](const auto& p, const auto& q) {
        return p.first != q.first ? p.first < q.first : p.second.index < q.second.index;
    });
    for (std::size_t i = 0; i < edge_contacts_.size(); ++i)
        if (i == 0 || edge_contacts_[i].first != edge_contacts_[i - 1].first) found.push_back(edge_contacts_[i].second);
}

PairEdges::Candidate PairEdges::candidate_of(const SourceMesh& placed, const Piece& piece, std::uint32_t face) {
    Candidate candidate{face, normal_of(placed.target, face), 0, {}};
    candidate.height = dot(placed.target.corner(face, 0), candidate.normal);
    for (std::size_t k = 0; k < 2; ++k) {
        const Vec3& end = piece.ends[k].point;
        // Just below the face that it crosses the plane is the face.
        candidate.depths[k] = piece.faces[k] == face ? candidate.height - dot(end, candidate.normal)
                                                     : way_out(placed.target, end, candidate.normal, candidate.height);
    }
    return candidate;
}

void PairEdges::choose(const SourceMesh& placed, const Piece& piece) {
    const ShapeData& target = placed.target;
    for (std::size_t k = 0; k < 2; ++k) {
        const VertexContact* vertex_contact = piece.ends[k].vertex_contact;
        if (vertex_contact == nullptr) continue;
        // On a fine mesh nearly every piece begins at a vertex in contact and leaves through the border of the contact:
        // it gives none.
        const Vec3 normal = normal_of(target, vertex_contact->face);
        if (dot(target.corner(vertex_contact->face, 0) - piece.ends[1 - k].point, normal)
            < comparable * vertex_contact->depth)
            return;
    }

    std::array<Candidate, 5> candidates;
    std::size_t count = 0;
    const auto add = [&](std::uint32_t face) {
        for (std::size_t i = 0; i < count; ++i)
            if (candidates[i].face == face) return;
        const Vec3 normal = normal_of(target, face);
        const double height = dot(target.corner(face, 0), normal);
        for (std::size_t i = 0; i < count; ++i) // the other triangle of a flat face
            if (dot(candidates[i].normal, normal) > 1 - 1e-12
                && std::fabs(candidates[i].height - height) < 1e-9 * target.diagonal)
                return;
        candidates[count] = candidate_of(placed, piece, face);
        if (candidates[count].deeper() > 0) ++count;
    };
    for (const std::uint32_t face : piece.faces)
        if (face != NONE) add(face);
    const Vec3 own = inward(placed.source, piece.edge), in = placed.turned(own);
    if (own != Vec3{}) {
        const Vec3 middle = 0.5 * (piece.ends[0].point + piece.ends[1].point);
        for (const Vec3& origin : {piece.ends[0].point, piece.ends[1].point, middle}) {
            const MeshHit hit = closest_hit(target, origin, in, 0, never);
            if (hit.face == NONE || !hit.from_inside) continue;
            // The paper's second test: before leaving the source (section 2.1).
            if (closest_hit(placed.source, placed.back(origin), own, placed.hair, hit.distance).distance
                >= hit.distance)
                add(hit.face);
        }
    }
    double deepest = 0;
    for (std::size_t i = 0; i < count; ++i) deepest = std::max(deepest, candidates[i].deeper());
    if (count == 0 || deepest < comparable * vertex_depth(piece.region)) return;

    // What is equal is so to a few hairs, by which vertices were moved: rounding decides nothing. No region is
    // shallower than its piece: from the shallowest on, the rest need not be asked.
    const double few = few_hairs * placed.hair;
    std::array<double, 5> regions{never, never, never, never, never};
    double shallowest = never, shallowest_piece = never;
    for (;;) {
        std::size_t next = count;
        for (std::size_t i = 0; i < count; ++i)
            if (regions[i] == never && (next == count || candidates[i].deeper() < candidates[next].deeper())) next = i;
        if (next == count || candidates[next].deeper() >= shallowest + few) break;
        const Candidate& c = candidates[next];
        regions[next] = std::max(c.deeper(), extent(placed, piece.region, c.normal, c.height, shallowest + few));
        shallowest = std::min(shallowest, regions[next]);
    }
    for (std::size_t i = 0; i < count; ++i)
        if (regions[i] < shallowest + few) shallowest_piece = std::min(shallowest_piece, candidates[i].deeper());
    // By its direction, not by which end comes first: all edges that pierce a plate leave by the same side.
    std::size_t chosen = count;
    for (std::size_t i = 0; i < count; ++i) {
        if (regions[i] >= shallowest + few || candidates[i].deeper() >= shallowest_piece + few) continue;
        if (chosen == count || dot(preferred, candidates[i].normal) > dot(preferred, candidates[chosen].normal))
            chosen = i;
    }
    choices_.push_back({&piece, candidates[chosen], regions[chosen]});
}

// Where an edge grazes a side of the target, its own candidates may be that side and one a whole body away, although
// the region leaves by another face at once: then by that.
void PairEdges::agree(const SourceMesh& placed, std::span<Choice> region) {
    double least = never, most = 0;
    for (const Choice& choice : region) {
        most = std::max(most, choice.metres);
        least = std::min(least, choice.metres);
    }
    std::size_t shallowest = 0;
    while (region[shallowest].metres >= least + few_hairs * placed.hair) ++shallowest;
    std::uint32_t face = region[shallowest].by.face;
    least = region[shallowest].metres;
    if (const VertexContact* vertex_contact = deepest_vertex(region[0].piece->region);
        vertex_contact && vertex_contact->depth < comparable * most) {
        const Vec3 normal = normal_of(placed.target, vertex_contact->face);
        const double height = dot(placed.target.corner(vertex_contact->face, 0), normal);
        const double metres = extent(placed, vertex_contact->region, normal, height, least);
        if (metres < least - few_hairs * placed.hair) {
            least = metres;
            face = vertex_contact->face;
        }
    }
    if (!(least < comparable * most)) return;
    for (Choice& choice : region) {
        if (!(least < comparable * choice.metres)) continue;
        const Candidate other = candidate_of(placed, *choice.piece, face);
        if (other.deeper() > 0) choice = {choice.piece, other, least};
    }
}

void PairEdges::give_contacts(const ShapeData& target, VertexBody source, const Choice& choice,
                              std::vector<FeatureContact>& found) {
    const Piece& piece = *choice.piece;
    const Candidate& by = choice.by;
    const double enough = deepest_vertex(piece.region) ? comparable * choice.metres : 0;
    if (piece.ends[0].is_crossing() && piece.ends[1].is_crossing()) {
        // Where round bodies cross, both ends lie on the target's surface, and the edge is deep between them.
        const Vec3 middle = 0.5 * (piece.ends[0].point + piece.ends[1].point);
        const double depth = way_out(target, middle, by.normal, by.height);
        if (depth > enough && comparable * depth > std::max(by.depths[0], by.depths[1])
            && static_cast<float>(depth) > 0) {
            found.push_back(
                {source, Feature::edge, piece.edge, piece.ends[0].crossing, by.face, middle, by.normal, depth});
            return;
        }
    }
    for (std::size_t k = 0; k < 2; ++k) {
        const End &end = piece.ends[k], &other = piece.ends[1 - k];
        // Above a vertex at which this piece has a contact, the crossing adds nothing.
        if (end.is_crossing() && !other.is_crossing() && by.depths[k] < comparable * by.depths[1 - k]) continue;
        if (end.vertex_contact != nullptr || !(by.depths[k] > enough) || !(static_cast<float>(by.depths[k]) > 0))
            continue;
        const FeatureContact contact{source,  Feature::edge, piece.edge, end.crossing,
                                     by.face, end.point,     by.normal,  by.depths[k]};
        if (end.is_crossing())
            found.push_back(contact);
        else
            edge_contacts_.emplace_back(end.vertex, contact);
    }
}

double PairEdges::extent(const SourceMesh& placed, std::uint32_t region, const Vec3& normal, double height,
                         double enough) {
    const auto less = [](const RegionPoint& p, std::uint32_t r) { return p.region < r; };
    const auto begin = std::lower_bound(points_.begin(), points_.end(), region, less);
    const auto end = std::lower_bound(begin, points_.end(), region + 1, less);
    std::uint32_t& last = last_extent_[static_cast<std::size_t>(begin - points_.begin())];
    for (std::uint32_t i = last; i != NONE; i = extents_[i].next) {
        const Extent& known = extents_[i];
        if (known.region == region && known.normal == normal && known.height == height) return known.metres;
    }
    const auto count = static_cast<std::size_t>(end - begin);
    const std::size_t asked = std::min(count, most_points);
    const auto point_at = [&](std::size_t i) -> const Vec3& {
        return begin[static_cast<std::ptrdiff_t>(i * count / asked)].point;
    };
    // The point deepest below the plane first: it is likely to decide. Most others then need no more than a short ray.
    std::size_t first = 0;
    double lowest = -never;
    for (std::size_t i = 0; i < asked; ++i) {
        const double below = height - dot(point_at(i), normal);
        if (below <= lowest) continue;
        lowest = below;
        first = i;
    }
    double metres = 0;
    for (std::size_t i = 0; i <= asked; ++i) {
        if (i == first + 1) continue;
        const Vec3& point = point_at(i == 0 ? first : i - 1);
        if (metres > 0) {
            const MeshHit hit = closest_hit(placed.target, point, normal, 0, metres);
            if (hit.face != NONE && hit.from_inside) continue;
        }
        metres = std::max(metres, way_out(placed.target, point, normal, height));
        if (metres >= enough) return metres;
    }
    extents_.push_back({region, normal, height, metres, last});
    last = static_cast<std::uint32_t>(extents_.size() - 1);
    return metres;
}

const PairEdges::VertexContact* PairEdges::deepest_vertex(std::uint32_t region) const {
    const auto at = std::lower_bound(deepest_.begin(), deepest_.end(), region,
                                     [](const VertexContact* s, std::uint32_t r) { return s->region < r; });
    return at != deepest_.end() && (*at)->region == region ? *at : nullptr;
}

} // namespace raycontact
