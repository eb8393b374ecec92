// SPDX-License-Identifier: Apache-2.0
#include "reference/contacts.h"

#include "reference/ray.h"
#include "reference/vector.h"

#include <algorithm>
#include <cmath>

namespace raycontact::reference {

namespace {

// From offsets of the source to offsets of the target; the centres are met before anything large is added.
struct Relative {
    const Solid& source;
    const Pose& source_pose;
    const Solid& target;
    const Pose& target_pose;
    Vec3 shift; ///< world: source centre minus target centre

    Relative(const Solid& s, const Pose& sp, const Solid& t, const Pose& tp)
        : source(s), source_pose(sp), target(t), target_pose(tp),
          shift((sp.translation - tp.translation) + (rotate(sp, s.centre) - rotate(tp, t.centre))) {}
    Vec3 point(std::uint32_t v) const {
        return rotate_back(target_pose, rotate(source_pose, source.vertices[v]) + shift);
    }
    Vec3 turned(const Vec3& v) const { return rotate_back(target_pose, rotate(source_pose, v)); }
    Vec3 inward(std::uint32_t v) const { return unit(turned(-source.vertex_normals[v])); }
};

struct Bounds {
    Vec3 low, high;

    // An open target has no inside: a source vertex beyond its box may still have pushed its surface through it.
    Bounds(const Solid& source, const Solid& target) : low(target.box_min), high(target.box_max) {
        if (target.closed) return;
        const Vec3 by{source.reach, source.reach, source.reach};
        low = low - by;
        high = high + by;
    }
    bool holds(const Vec3& p) const {
        return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
    }
};

struct Exit {
    std::uint32_t triangle;
    Vec3 off; ///< from the vertex to the nearest point
};

// In the target's frame, outward.
std::vector<Vec3> normals_at(const Relative& relative, std::uint32_t vertex) {
    std::vector<Vec3> normals;
    for (std::uint32_t t = 0; t < relative.source.triangles.size(); ++t)
        if (std::ranges::count(relative.source.triangles[t], vertex) > 0)
            normals.push_back(relative.turned(relative.source.face_normals[t]));
    return normals;
}

// The nearest of the triangle that was hit and of all that have the vertex behind them and look as that one or against
// one of the vertex's own, by more than `by` of 1 and of the diagonal.
Exit exit_of(const Solid& target, const Vec3& p, const std::vector<Vec3>& own, std::uint32_t hit, double by) {
    const auto off = [&](std::uint32_t t) {
        const auto& [a, b, c] = target.triangles[t];
        return closest_on_triangle(p, target.vertices[a], target.vertices[b], target.vertices[c]) - p;
    };
    Exit best{hit, off(hit)};
    for (std::uint32_t t = 0; t < target.triangles.size(); ++t) {
        const Vec3 n = target.face_normals[t];
        if (!(dot(n, target.vertices[target.triangles[t][0]] - p) >= 0.01 * by * target.diagonal)
            || (!(dot(n, target.face_normals[hit]) > 0.98 + by)
                && std::ranges::none_of(own, [&](const Vec3& m) { return dot(n, m) < -0.05 - by; })))
            continue;
        const Vec3 to = off(t);
        if (dot(to, to) < dot(best.off, best.off)) best = {t, to};
    }
    return best;
}

} // namespace

std::vector<CastRay> cast_all(const Solid& source, const Pose& source_pose, const Solid& target,
                              const Pose& target_pose, Direction direction) {
    const Relative relative(source, source_pose, target, target_pose);
    const Bounds bounds(source, target);
    RayCaster caster(target);
    std::vector<CastRay> rays;
    for (std::uint32_t v = 0; v < source.vertices.size(); ++v) {
        if (source.vertex_normals[v] == Vec3{}) continue;
        const Vec3 origin = relative.point(v);
        if (!bounds.holds(origin)) continue;
        CastRay ray;
        ray.vertex = v;
        const Vec3 inward = relative.inward(v);
        const Hit hit = caster.closest(origin, inward);
        if (hit.triangle != Hit::none && hit.from_inside && hit.distance <= source.exits[v]) {
            const Vec3& out = direction == Direction::reprojected ? target.face_normals[hit.triangle] : inward;
            ray.contact = true;
            ray.triangle = hit.triangle;
            ray.point = source_pose.translation + rotate(source_pose, source.centre + source.vertices[v]);
            ray.normal = rotate(target_pose, out);
            ray.ray_length = hit.distance;
            ray.depth = hit.distance * dot(inward, out);
            if (direction == Direction::weighted) ray.weight = source.vertex_areas[v];
            ray.least_depth = ray.depth;
            if (direction == Direction::refined) {
                const std::vector<Vec3> own = normals_at(relative, v);
                const Exit way = exit_of(target, origin, own, hit.triangle, 1e-7);
                ray.triangle = way.triangle;
                ray.depth = length(way.off);
                ray.normal = rotate(target_pose, unit(way.off));
                ray.least_depth = length(exit_of(target, origin, own, hit.triangle, -1e-7).off);
            }
        }
        rays.push_back(ray);
    }
    return rays;
}

std::vector<ReferenceContact> find_contacts(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                                            Direction direction) {
    std::vector<ReferenceContact> contacts;
    const auto add = [&](Side body, const Solid& source, const Solid& target, const std::vector<CastRay>& rays) {
        for (const CastRay& ray : rays) {
            if (!ray.contact) continue;
            ReferenceContact contact;
            contact.vertex_body = body;
            contact.vertex = source.vertex_index[ray.vertex];
            contact.triangle = target.triangle_index[ray.triangle];
            contact.point = ray.point;
            contact.normal = body == Side::a ? -ray.normal : ray.normal;
            contact.depth = ray.depth;
            contact.ray_length = ray.ray_length;
            contact.weight = ray.weight;
            contacts.push_back(contact);
        }
    };
    add(Side::a, a, b, cast_all(a, pose_a, b, pose_b, direction));
    add(Side::b, b, a, cast_all(b, pose_b, a, pose_a, direction));
    std::stable_sort(contacts.begin(), contacts.end(), [](const auto& x, const auto& y) {
        return x.vertex_body != y.vertex_body ? x.vertex_body < y.vertex_body : x.vertex < y.vertex;
    });
    return contacts;
}

Margins ray_margins(const Solid& source, const Pose& source_pose, const Solid& target, const Pose& target_pose,
                    std::uint32_t vertex) {
    const Relative relative(source, source_pose, target, target_pose);
    const Bounds bounds(source, target);
    const Vec3 origin = relative.point(vertex);
    const Vec3 direction = relative.inward(vertex);
    const double t_max = source.exits[vertex];
    const Hit hit = RayCaster(target).closest(origin, direction);
    const double inf = std::numeric_limits<double>::infinity();
    const double decided = std::min(hit.distance, t_max) + 1e-5 * target.diagonal;

    Margins margins;
    margins.edge = distance_to_edges(target, origin, direction, decided) / target.diagonal;
    margins.t_max = hit.distance < inf && t_max < inf ? std::fabs(hit.distance - t_max) / target.diagonal : inf;
    margins.surface = distance_to_surface(target, origin) / target.diagonal;
    margins.bounds = distance_to_box(bounds.low, bounds.high, origin) / target.diagonal;
    return margins;
}

} // namespace raycontact::reference
