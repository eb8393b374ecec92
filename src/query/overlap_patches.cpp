// SPDX-License-Identifier: Apache-2.0
#include "query/overlap_patches.h"

#include "query/surfaces.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace raycontact {

namespace {

// Of a region's volume its patches hold at least this part; else one body pierces the other there.
constexpr double least_held = 0.5;
// Vectors of area that cancel out to this part of their lengths give no direction.
constexpr double least_flatness = 0.1;
// Of directions as flat as each other to this, the mean counts.
constexpr double as_flat = 1e-6;
// A face that looks along a direction by less than this cosine has no shadow.
constexpr double upright = 1e-9;

/// A right-handed frame, its third axis the direction along which a body is seen.
struct View {
    Vec3 x, y, up;

    explicit View(const Vec3& direction) : up(direction) {
        const double ax = std::fabs(up.x), ay = std::fabs(up.y), az = std::fabs(up.z);
        const Vec3 other = ax <= ay && ax <= az ? Vec3{1, 0, 0} : ay <= az ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
        x = unit(cross(other, up));
        y = cross(up, x);
    }
    ShadowCorner of(const Vec3& p) const { return {dot(p, x), dot(p, y), dot(p, up), 0}; }
};

ShadowFace seen(const PairMeshes& pair, const View& view, std::size_t side, std::uint32_t face) {
    const auto& corners = pair.shape(side).mesh.triangles[face];
    const auto corner = [&](std::size_t k) { return view.of(pair.unmoved_vertex(side, corners[k])); };
    return ShadowFace({corner(0), corner(1), corner(2)});
}

/// What lies between two faces: the integrals over the polygons that they share.
struct Column {
    double area = 0, volume = 0;
    double x = 0, y = 0, height = 0; ///< of the middle of the volume
    double thickness = 0;            ///< there

    void add(const ShadowPolygon& polygon, double sign) {
        for (std::size_t k = 2; k < polygon.count; ++k) {
            const std::array c{polygon.corners[0], polygon.corners[k - 1], polygon.corners[k]};
            const double part = 0.5 * sign * doubled_area(c[0], c[1], c[2]);
            const auto thick = [&](std::size_t i) { return c[i].first - c[i].second; };
            const double sum = thick(0) + thick(1) + thick(2);
            area += part;
            volume += part * sum / 3;
            for (std::size_t i = 0; i < 3; ++i) {
                const double moment = part / 12 * (sum + thick(i));
                x += moment * c[i].x;
                y += moment * c[i].y;
            }
        }
    }
    /// Once all is added. of_a lies above of_b.
    void finish(const ShadowFace& of_a, const ShadowFace& of_b) {
        x /= volume;
        y /= volume;
        const ShadowCorner middle{x, y, 0, 0};
        const double top = of_a.height(middle), bottom = of_b.height(middle);
        height = 0.5 * (top + bottom);
        thickness = top - bottom;
    }
};

/// Calls visit(polygon, sign) for polygons that add up to what of one lies in an outline, counter-clockwise: what is
/// below the segments that run back, less what is below those that run on.
template <class Visit>
void within(const ShadowPolygon& polygon, std::span<const OutlineSegment> outline, const View& view, double turn,
            double sign, Visit&& visit) {
    if (polygon.count < 3) return;
    if (outline.empty()) return visit(polygon, sign);
    double low = polygon.corners[0].x, high = low;
    for (std::size_t k = 1; k < polygon.count; ++k) {
        low = std::min(low, polygon.corners[k].x);
        high = std::max(high, polygon.corners[k].x);
    }
    for (const auto& [from, to] : outline) {
        ShadowCorner p = view.of(from), q = view.of(to);
        const double on = turn * (p.x < q.x ? -sign : sign);
        if (p.x > q.x) std::swap(p, q);
        if (p.x == q.x || q.x <= low || p.x >= high) continue;
        ShadowPolygon below = clipped(polygon, [&](const ShadowCorner& c) { return c.x - p.x; });
        below = clipped(below, [&](const ShadowCorner& c) { return q.x - c.x; });
        below = clipped(below, [&](const ShadowCorner& c) { return -doubled_area(p, q, c); });
        if (below.count >= 3) visit(below, on);
    }
}

/// Whether a place lies in an outline, or beside it by rounding. No outline is around everything.
bool is_within(const ShadowCorner& at, std::span<const OutlineSegment> outline, const View& view, double error) {
    bool inside = outline.empty();
    for (const auto& [from, to] : outline) {
        const ShadowCorner p = view.of(from), q = view.of(to);
        const double x = q.x - p.x, y = q.y - p.y, square = x * x + y * y;
        const double along = square > 0 ? std::clamp(((at.x - p.x) * x + (at.y - p.y) * y) / square, 0.0, 1.0) : 0;
        if (std::hypot(at.x - (p.x + along * x), at.y - (p.y + along * y)) <= error) return true;
        if ((p.x <= at.x) == (q.x <= at.x)) continue;
        if ((doubled_area(p, q, at) > 0) == (q.x > p.x)) inside = !inside; // it is below
    }
    return inside;
}

/// The corners of the convex hull, counter-clockwise (Andrew 1979), without those that add less than `error` to it.
std::vector<ShadowCorner> hull_of(std::vector<ShadowCorner>& points, double error) {
    std::ranges::sort(points, {}, [](const ShadowCorner& c) { return std::pair(c.x, c.y); });
    std::vector<ShadowCorner> hull;
    const auto add = [&](const ShadowCorner& next, std::size_t first) {
        while (hull.size() >= first + 2 && !(doubled_area(hull[hull.size() - 2], hull.back(), next) > 0))
            hull.pop_back();
        hull.push_back(next);
    };
    for (const ShadowCorner& point : points) add(point, 0);
    const std::size_t back = hull.empty() ? 0 : hull.size() - 1;
    for (std::size_t i = points.size(); i-- > 0;) add(points[i], back);
    std::vector<ShadowCorner> kept;
    if (!hull.empty()) kept.push_back(hull[0]);
    for (std::size_t i = 1; i + 1 < hull.size(); ++i) { // the last is the first again
        const ShadowCorner &before = kept.back(), &after = hull[i + 1];
        const double base = std::hypot(after.x - before.x, after.y - before.y);
        if (doubled_area(before, hull[i], after) > error * base) kept.push_back(hull[i]);
    }
    return kept;
}

/// Whether nothing lies between the faces in the middle of a column: either body ends there first.
bool is_whole(const PairMeshes& pair, const View& view, const Column& column) {
    const Vec3 middle = column.x * view.x + column.y * view.y + column.height * view.up;
    for (std::size_t side = 0; side < 2; ++side) {
        const ShapeData& mesh = pair.shape(side);
        const double error = 10 * rounding_of(mesh) + 1e-9 * pair.size(), half = 0.5 * column.thickness;
        if (half < error) continue;
        const Vec3 way = side == 0 ? view.up : -1.0 * view.up;
        const Vec3 turned = unit(pair.direction_in(side, way));
        const MeshHit hit = closest_hit(mesh, {pair.point_in(side, middle), turned, 0, 2 * half + error});
        if (hit.face == NONE || !hit.from_inside || hit.distance < 0.99 * half - error) return false;
    }
    return true;
}

/// Calls visit(face of a, face of b, column) for what lies over each other of a face of one side and the inner faces of
/// the other; of one part of these, if that is not NONE. view.up: from a to b. corners: unless null, gets what together
/// has the convex hull of each column.
template <class Visit>
void each_over(const PairMeshes& pair, const InnerSurfaces& surfaces, const View& view, std::size_t side,
               const InnerFace& own, std::uint32_t other_part, std::vector<ShadowCorner>* corners, Visit&& visit) {
    const double looks = side == 0 ? 1 : -1; // a's faces look along the normal, b's against it
    if (!(looks * dot(own.normal, view.up) > upright)) return;
    const ShadowFace shadow = seen(pair, view, side, own.face);
    if (shadow.area == 0) return;
    const std::size_t other = 1 - side;
    const ShapeData& mesh = pair.shape(other);
    const double slack = rounding_of(mesh) + 1e-9 * pair.size();
    const Vec3 centre = pair.centre(other);
    struct Axis {
        Vec3 along, size;
        double at, low, high;
    };
    const auto axis_of = [&](const Vec3& direction, double low, double high) {
        const Vec3 d = pair.direction_in(other, direction);
        return Axis{
            d, {std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)}, dot(centre, direction), low - slack, high + slack};
    };
    constexpr double far = 1e300;
    const std::array axes{axis_of(view.x, shadow.low_x, shadow.high_x), axis_of(view.y, shadow.low_y, shadow.high_y),
                          side == 0 ? axis_of(view.up, -far, shadow.high) : axis_of(view.up, shadow.low, far)};
    const auto meets = [&](const Box& box) {
        return std::ranges::all_of(axes, [&](const Axis& axis) {
            const double middle = axis.at + dot(axis.along, box.middle());
            const double half = 0.5 * dot(axis.size, box.high - box.low);
            return middle - half <= axis.high && middle + half >= axis.low;
        });
    };
    visit_blocks(mesh, meets, [&](const kernels::TriangleBlock& block) {
        for (const std::uint32_t t : block.triangle) {
            if (t == NONE) continue;
            const InnerFace* const across = surfaces.at(other, t);
            if (across == nullptr || (other_part != NONE && across->part != other_part)) continue;
            if (!(looks * dot(across->normal, view.up) < -upright)) continue;
            const ShadowFace below = seen(pair, view, other, t);
            if (below.area == 0 || shadow.is_beside(below)) continue;
            const ShadowFace &of_a = side == 0 ? shadow : below, &of_b = side == 0 ? below : shadow;
            const InnerFace &face_a = side == 0 ? own : *across, &face_b = side == 0 ? *across : own;
            const ShadowPolygon polygon =
                clipped(shared_shadow(of_a, of_b), [](const ShadowCorner& c) { return c.first - c.second; });
            Column column;
            const std::size_t before = corners != nullptr ? corners->size() : 0;
            within(polygon, surfaces.outline(face_a), view, 1, 1, [&](const ShadowPolygon& part, double sign) {
                within(part, surfaces.outline(face_b), view, -1, sign, [&](const ShadowPolygon& shared, double of) {
                    column.add(shared, of);
                    if (corners != nullptr)
                        corners->insert(corners->end(), shared.corners.begin(),
                                        shared.corners.begin() + std::ptrdiff_t(shared.count));
                });
            });
            const bool counts =
                column.volume > 0 && column.area > 0 && (column.finish(of_a, of_b), is_whole(pair, view, column));
            // Where an outline runs, some of the polygons are taken off others: their corners may lie outside.
            if (corners != nullptr) {
                const auto lies_outside = [&](const ShadowCorner& c) {
                    return !counts || !is_within(c, surfaces.outline(face_a), view, slack)
                           || !is_within(c, surfaces.outline(face_b), view, slack);
                };
                corners->erase(std::remove_if(corners->begin() + std::ptrdiff_t(before), corners->end(), lies_outside),
                               corners->end());
            }
            if (counts) visit(face_a, face_b, column);
        }
        return true;
    });
}

} // namespace

void follow_all(const PairMeshes& meshes, const ShapePair& pair, Loops& loops) {
    loops.clear();
    std::array<PlacedFace, 2> faces;
    each_touching_pair(pair, [&](std::uint32_t a, std::uint32_t b) {
        faces[0].set(meshes, 0, a);
        faces[1].set(meshes, 1, b);
        for (std::size_t side = 0; side < 2; ++side)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const std::uint32_t edge = edge_of(meshes.shape(side), faces[side].face, k);
                if (Crossing seed; crosses(meshes, side, edge, faces[1 - side], seed)) loops.follow(meshes, seed);
            }
    });
}

bool OverlapPatches::find(const PlacedBody& a, const PlacedBody& b, bool of_file, bool hulls) {
    hulls_ = hulls;
    overlaps_.clear();
    patches_.clear();
    const PairMeshes pair(a, b, of_file);
    follow_all(pair, ShapePair(*a.shape, a.pose, *b.shape, b.pose), loops_);
    if (loops_.crossings().empty() || !std::ranges::all_of(loops_.loops(), &Loop::is_closed)) return false;
    pieces_.list(pair, loops_.crossings());
    surfaces_.find(pair, loops_, pieces_);
    list_by_part();
    covered_.clear();
    for (const std::size_t side : {0u, 1u})
        for (std::uint32_t part = surfaces_.first_part(side); part < surfaces_.end_part(side); ++part)
            look_along(pair, side, part);
    for (const auto& [parts, covered] : covered_)
        for (const std::uint32_t part : parts) ++parts_[part].met;
    for (const auto& [parts, covered] : covered_) list_overlaps(pair, parts, covered);
    leave_out_pierced();
    std::ranges::sort(overlaps_, {}, [](const FaceOverlap& o) { return std::pair(o.faces, o.patch); });
    return true;
}

void OverlapPatches::list_by_part() {
    part_first_.assign(surfaces_.end_part(1) + 1, 0);
    for (const std::size_t side : {0u, 1u})
        for (const InnerFace& face : surfaces_.of(side)) ++part_first_[face.part + 1];
    for (std::size_t i = 1; i < part_first_.size(); ++i) part_first_[i] += part_first_[i - 1];
    parts_.assign(surfaces_.end_part(1), {});
    for (const std::size_t side : {0u, 1u})
        for (const InnerFace& face : surfaces_.of(side)) {
            parts_[face.part].area = parts_[face.part].area + face.area * face.normal;
            parts_[face.part].size += face.area;
        }
    by_part_.resize(part_first_.back());
    std::vector<std::uint32_t> next(part_first_.begin(), part_first_.end() - 1);
    for (const std::size_t side : {0u, 1u})
        for (std::uint32_t i = 0; i < surfaces_.of(side).size(); ++i) by_part_[next[surfaces_.of(side)[i].part]++] = i;
}

// Of a region whose faces hardly lie over each other, as those of a rod through a plate, patches say nothing.
void OverlapPatches::leave_out_pierced() {
    struct Volumes {
        double all = 0, held = 0; ///< three times the region's own; its patches'
    };
    std::map<std::uint32_t, Volumes> volumes;
    std::optional<Vec3> origin;
    for (const std::size_t side : {0u, 1u})
        for (const InnerFace& face : surfaces_.of(side)) {
            if (!origin) origin = face.middle;
            volumes[face.region].all += face.area * dot(face.middle - *origin, face.normal);
        }
    for (const FaceOverlap& overlap : overlaps_) volumes[patches_[overlap.patch].region].held += overlap.volume;
    const auto is_pierced = [&](const FaceOverlap& overlap) {
        const Volumes& of = volumes.at(patches_[overlap.patch].region);
        return !(of.held > least_held / 3 * of.all);
    };
    std::erase_if(overlaps_, is_pierced);
    std::vector<std::uint32_t> kept(patches_.size(), NONE);
    std::vector<OverlapPatch> patches;
    for (FaceOverlap& overlap : overlaps_) {
        std::uint32_t& number = kept[overlap.patch];
        if (number == NONE) {
            number = static_cast<std::uint32_t>(patches.size());
            patches.push_back(patches_[overlap.patch]);
        }
        overlap.patch = number;
    }
    patches_ = std::move(patches);
}

// What of a part lies over which part of the other side, seen along its vector area.
void OverlapPatches::look_along(const PairMeshes& pair, std::size_t side, std::uint32_t part) {
    const std::span<const InnerFace> faces = surfaces_.of(side);
    if (!(parts_[part].flatness() > least_flatness)) return;
    const Vec3 way = unit(parts_[part].area);
    const View view(side == 0 ? way : -1.0 * way);
    for (const std::uint32_t i : faces_of(part))
        each_over(pair, surfaces_, view, side, faces[i], NONE, nullptr,
                  [&](const InnerFace& of_a, const InnerFace& of_b, const Column& column) {
                      Covered& covered = covered_[{of_a.part, of_b.part}];
                      covered.region = of_a.region;
                      auto& areas = covered.areas[side];
                      const auto on_face = [&](const InnerFace& face) {
                          const double area = column.area / std::fabs(dot(face.normal, view.up));
                          return std::min(area, face.area) * face.normal; // of an upright one all, at most
                      };
                      areas[0] = areas[0] + on_face(of_a);
                      areas[1] = areas[1] + on_face(of_b);
                  });
}

// That of the flatter part; of parts as flat as each other, of the one that faces more; else what is between.
Vec3 OverlapPatches::normal_of(const Parts& parts, const Covered& covered) const {
    const std::array two{&parts_[parts[0]], &parts_[parts[1]]};
    const std::array flat{two[0]->flatness(), two[1]->flatness()};
    const auto own = [&](std::size_t side) {
        const auto& seen = covered.areas;
        if (two[side]->met == 1 && two[side]->flatness() > least_flatness)
            return (side == 0 ? 1 : -1) * unit(two[side]->area); // exact: it is the loop's
        const Vec3 area = unit(length(seen[side][side]) > 0 ? seen[side][side] : seen[1 - side][side]);
        return side == 0 ? area : -1.0 * area;
    };
    if (std::fabs(flat[0] - flat[1]) > as_flat) return own(flat[0] > flat[1] ? 0 : 1);
    if (two[0]->met != two[1]->met) return own(two[0]->met > two[1]->met ? 0 : 1);
    return unit(own(0) + own(1));
}

void OverlapPatches::list_overlaps(const PairMeshes& pair, const Parts& parts, const Covered& covered) {
    const std::size_t side = faces_of(parts[0]).size() <= faces_of(parts[1]).size() ? 0 : 1, other = 1 - side;
    const auto patch = static_cast<std::uint32_t>(patches_.size());
    const std::size_t before = overlaps_.size();
    const Vec3 normal = normal_of(parts, covered);
    if (normal == Vec3{}) return;
    const View view(normal);
    std::vector<ShadowCorner> corners;
    for (const std::uint32_t i : faces_of(parts[side]))
        each_over(pair, surfaces_, view, side, surfaces_.of(side)[i], parts[other], hulls_ ? &corners : nullptr,
                  [&](const InnerFace& of_a, const InnerFace& of_b, const Column& column) {
                      overlaps_.push_back({{of_a.face, of_b.face},
                                           patch,
                                           column.area,
                                           column.volume,
                                           column.x * view.x + column.y * view.y + column.height * view.up});
                  });
    if (overlaps_.size() == before) return;
    patches_.push_back({parts, normal, covered.region, {}});
    for (const ShadowCorner& corner : hull_of(corners, 1e-10 * pair.size()))
        patches_.back().hull.push_back(corner.x * view.x + corner.y * view.y);
}

} // namespace raycontact
