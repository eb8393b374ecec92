// SPDX-License-Identifier: Apache-2.0
#include "edges/inner_surfaces.h"

#include <algorithm>

namespace raycontact {

namespace {

/// The pieces of an edge; some, if it crosses a face.
std::span<const EdgePiece> pieces_of(std::span<const EdgePiece> all, std::size_t side, std::uint32_t edge) {
    const auto key = [](const EdgePiece& piece) { return std::pair(piece.side, piece.edge); };
    const auto asked = std::pair(static_cast<std::uint32_t>(side), edge);
    const auto first = std::ranges::lower_bound(all, asked, {}, key);
    return {first, std::ranges::upper_bound(first, all.end(), asked, {}, key)};
}

bool is_inside(const PairMeshes& pair, std::size_t side, std::uint32_t vertex) {
    const std::size_t other = 1 - side;
    return encloses(pair.shape(other), pair.point_in(other, pair.vertex(side, vertex)));
}

} // namespace

const InnerFace* InnerSurfaces::at(std::size_t side, std::uint32_t face) const {
    const auto found = std::ranges::lower_bound(faces_[side], face, {}, &InnerFace::face);
    return found != faces_[side].end() && found->face == face ? &*found : nullptr;
}

void InnerSurfaces::find(const PairMeshes& pair, const Loops& loops, const EdgePieces& pieces) {
    joints_.clear();
    segments_.clear();
    for (std::size_t side = 0; side < 2; ++side) {
        faces_[side].clear();
        begin(pair, loops, pieces, side);
        std::vector<std::uint32_t>& open = sides_[side].open;
        while (!open.empty()) {
            const std::uint32_t face = open.back();
            open.pop_back();
            visit(pair, pieces, side, face);
        }
        std::ranges::sort(faces_[side], {}, &InnerFace::face);
    }
    std::erase_if(joints_, [&](const Joint& joint) {
        return at(joint.side, joint.faces[0]) == nullptr || at(joint.side, joint.faces[1]) == nullptr;
    });
    join_regions(loops);
    divide(pair.size());
}

// The vertices at the ends of crossed edges are known. The faces at these, and those that loops pass, are the first.
void InnerSurfaces::begin(const PairMeshes& pair, const Loops& loops, const EdgePieces& pieces, std::size_t side) {
    Side& own = sides_[side];
    own.inside.clear();
    own.cut.clear();
    own.open.clear();
    own.seen.clear();
    const auto add = [&](std::uint32_t face) {
        if (face != NONE && own.seen.insert(face).second) own.open.push_back(face);
    };
    for (const EdgePiece& piece : pieces.all()) {
        if (piece.side != side) continue;
        const auto ends = ends_of(pair.shape(side), piece.edge);
        for (std::size_t e = 0; e < 2; ++e) own.inside[ends[e]] |= piece.crossings[e] == NONE;
        const EdgeFaces faces = faces_of(pair.shape(side), piece.edge);
        add(faces.own);
        add(faces.across);
    }
    // As `area` runs, what lies inside is to the left of a loop on b, and to its right on a.
    for (const Loop& loop : loops.loops())
        for (const LoopSegment& s : loops.segments().subspan(loop.first_segment, loop.segment_count)) {
            add(s.faces[side]);
            OutlineSegment segment{loops.crossings()[s.from].point, loops.crossings()[s.to].point};
            if (loop.runs_back != (side == 0)) std::swap(segment[0], segment[1]);
            own.cut.emplace_back(s.faces[side], segment);
        }
    std::ranges::sort(own.cut, {}, &std::pair<std::uint32_t, OutlineSegment>::first);
}

// Across an edge that crosses nothing all is as on this side of it.
void InnerSurfaces::know_corners(const PairMeshes& pair, const EdgePieces& pieces, std::size_t side,
                                 std::uint32_t face) {
    const ShapeData& shape = pair.shape(side);
    const auto& corners = shape.mesh.triangles[face];
    auto& inside = sides_[side].inside;
    const auto pass_on = [&] {
        for (std::size_t round = 0; round < 2; ++round)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t v = corners[k], w = corners[(k + 1) % 3];
                const auto p = inside.find(v), q = inside.find(w);
                if ((p == inside.end()) == (q == inside.end())) continue;
                if (!pieces_of(pieces.all(), side, edge_of(shape, face, k)).empty()) continue;
                const bool value = p == inside.end() ? q->second : p->second;
                inside.emplace(p == inside.end() ? v : w, value);
            }
    };
    pass_on();
    for (const std::uint32_t v : corners) {
        if (inside.contains(v)) continue;
        inside.emplace(v, is_inside(pair, side, v));
        pass_on();
    }
}

void InnerSurfaces::visit(const PairMeshes& pair, const EdgePieces& pieces, std::size_t side, std::uint32_t face) {
    const ShapeData& shape = pair.shape(side);
    Side& own = sides_[side];
    know_corners(pair, pieces, side, face);
    const auto& corners = shape.mesh.triangles[face];
    InnerFace inner{face, 0, 0, pair.normal(side, face), 0, {}, static_cast<std::uint32_t>(segments_.size()), 0};
    bool whole = true;
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t edge = edge_of(shape, face, k);
        const auto parts = pieces_of(pieces.all(), side, edge);
        const std::uint32_t v = corners[k], w = corners[(k + 1) % 3];
        const Vec3 from = pair.unmoved_vertex(side, v), to = pair.unmoved_vertex(side, w);
        const bool turned = ends_of(shape, edge)[0] != v;
        for (const EdgePiece& piece : parts) {
            OutlineSegment segment{piece.crossings[0] == NONE ? (turned ? to : from) : piece.ends[0],
                                   piece.crossings[1] == NONE ? (turned ? from : to) : piece.ends[1]};
            if (turned) std::swap(segment[0], segment[1]);
            segments_.push_back(segment);
        }
        const bool all = parts.empty() && own.inside.at(v);
        if (all) segments_.push_back({from, to});
        whole = whole && all;
        if (!all && parts.empty()) continue;
        const std::uint32_t next = shape.neighbours[face][k];
        if (next == NONE) continue;
        if (own.seen.insert(next).second) own.open.push_back(next);
        if (face < next) joints_.push_back({side, {face, next}, !is_sharp(shape, edge), is_convex(shape, edge)});
    }
    const auto of_face = &std::pair<std::uint32_t, OutlineSegment>::first;
    for (auto at = std::ranges::lower_bound(own.cut, face, {}, of_face); at != own.cut.end() && at->first == face;
         ++at) {
        segments_.push_back(at->second);
        whole = false;
    }
    inner.segment_count = static_cast<std::uint32_t>(segments_.size()) - inner.first_segment;
    if (inner.segment_count == 0) return;
    const Vec3 origin = pair.unmoved_vertex(side, corners[0]);
    for (const auto& [p, q] : outline(inner)) {
        const double part = 0.5 * dot(cross(p - origin, q - origin), inner.normal);
        inner.area += part;
        inner.middle = inner.middle + part * ((1.0 / 3) * ((p - origin) + (q - origin)));
    }
    if (inner.area > 0) {
        inner.middle = origin + (1 / inner.area) * inner.middle;
    } else {
        inner.area = 0;
        inner.middle = segments_[inner.first_segment][0];
    }
    if (whole) {
        segments_.resize(inner.first_segment);
        inner.segment_count = 0;
    }
    faces_[side].push_back(inner);
}

std::uint32_t InnerSurfaces::node_at(std::size_t side, std::uint32_t face) const {
    const auto place = at(side, face) - faces_[side].data();
    return static_cast<std::uint32_t>(place + (side == 0 ? 0 : std::ssize(faces_[0])));
}

void InnerSurfaces::join_regions(const Loops& loops) {
    const std::size_t count = faces_[0].size() + faces_[1].size();
    sets_.reset(count);
    for (const Joint& joint : joints_)
        sets_.join(node_at(joint.side, joint.faces[0]), node_at(joint.side, joint.faces[1]));
    for (const LoopSegment& s : loops.segments()) sets_.join(node_at(0, s.faces[0]), node_at(1, s.faces[1]));
    for (std::uint32_t node = 0; node < count; ++node) face_of(node).region = sets_.of(node);
}

// Each side's surface in parts of which no face lies in front of another: from the largest flat piece on, over convex
// edges, as long as neither that piece nor what is reached lies in front of the other.
void InnerSurfaces::divide(double size) {
    struct Flat {
        double area = 0;
        Vec3 moment, normal; ///< area x middle; the largest face's
        double largest = -1;
        std::uint32_t part = NONE;
        Vec3 middle() const { return area > 0 ? (1 / area) * moment : moment; }
    };
    const std::size_t count = faces_[0].size() + faces_[1].size();
    sets_.reset(count);
    for (const Joint& joint : joints_)
        if (joint.flush) sets_.join(node_at(joint.side, joint.faces[0]), node_at(joint.side, joint.faces[1]));
    std::vector<Flat> flats(count); // by the lowest node
    std::vector<std::uint32_t> order;
    for (std::uint32_t node = 0; node < count; ++node) {
        const InnerFace& face = face_of(node);
        Flat& flat = flats[sets_.of(node)];
        flat.area += face.area;
        flat.moment = flat.moment + face.area * face.middle;
        if (face.area > flat.largest) {
            flat.largest = face.area;
            flat.normal = face.normal;
        }
        if (sets_.of(node) == node) order.push_back(node);
    }
    std::vector<std::vector<std::uint32_t>> beside(count);
    for (const Joint& joint : joints_) {
        const std::uint32_t p = sets_.of(node_at(joint.side, joint.faces[0])),
                            q = sets_.of(node_at(joint.side, joint.faces[1]));
        if (p == q || !joint.convex) continue;
        beside[p].push_back(q);
        beside[q].push_back(p);
    }
    const double slack = 1e-9 * size;
    const auto is_convex = [&](const Flat& p, const Flat& q) {
        const Vec3 way = q.middle() - p.middle();
        return dot(way, p.normal) <= slack && dot(way, q.normal) >= -slack;
    };
    const auto first_of_b = static_cast<std::uint32_t>(faces_[0].size());
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return std::pair(i >= first_of_b, -flats[i].area); });
    parts_ = parts_of_a_ = 0;
    std::vector<std::uint32_t> open;
    for (const std::uint32_t seed : order) {
        if (flats[seed].part != NONE) continue;
        const std::uint32_t part = parts_++;
        if (seed < first_of_b) parts_of_a_ = parts_;
        flats[seed].part = part;
        open.assign(1, seed);
        while (!open.empty()) {
            const std::uint32_t at = open.back();
            open.pop_back();
            for (const std::uint32_t next : beside[at]) {
                if (flats[next].part != NONE || !is_convex(flats[seed], flats[next])) continue;
                flats[next].part = part;
                open.push_back(next);
            }
        }
    }
    for (std::uint32_t node = 0; node < count; ++node) face_of(node).part = flats[sets_.of(node)].part;
}

} // namespace raycontact
