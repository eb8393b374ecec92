// SPDX-License-Identifier: Apache-2.0
#include "speculative/vertex_search.h"

#include "shape/around.h"

#include <algorithm>

namespace raycontact {

namespace {

// Planes whose normals' product is larger are one.
constexpr double same_plane = 0.995;

// Out of the target.
Vec3 normal_of(const kernels::LocalContact& c) {
    return {c.normal.x, c.normal.y, c.normal.z};
}

// Whether all faces at a vertex look as its contact does, so it has nothing to say of another plane.
bool is_spoken_for(const OneWay& body, const kernels::LocalContact& contact) {
    const Vec3 inward = -1.0 * rotated_back(body.now.rotation, normal_of(contact));
    return !any_triangle_at(body.source, contact.vertex, [&](std::uint32_t t, std::uint32_t) {
        const Vec3 area = area_normal(body.source, t);
        const double facing = dot(area, inward);
        return !(facing > 0 && facing * facing > same_plane * same_plane * dot(area, area));
    });
}

} // namespace

void VertexSearch::find(const SpeculativePair& pair, const NearEdges& near,
                        const std::array<std::span<const kernels::LocalContact>, 2>& touching,
                        std::vector<FeatureContact>& found) {
    for (const Side side : {Side::a, Side::b}) {
        const auto own = static_cast<std::size_t>(side);
        const ShapeData& source = pair.bodies[own].source;
        const std::size_t first = found.size();
        followers_.clear();
        by_source(near[own], [&](std::uint32_t v, std::span<const NearEdge> faces) {
            const auto at = std::ranges::lower_bound(touching[own], v, {}, &kernels::LocalContact::vertex);
            const bool touches = at != touching[own].end() && at->vertex == v;
            if (touches && is_spoken_for(pair.bodies[own], *at)) return;
            find(pair, side, v, faces, touches ? &*at : nullptr, found);
        });
        if (followers_.empty()) continue;
        std::ranges::sort(followers_, {}, &Follower::vertex);
        for (const kernels::LocalContact& c : touching[own]) add_followers(source, side, c.vertex, normal_of(c), found);
        for (std::size_t k = first; k < found.size(); ++k)
            add_followers(source, side, found[k].index, Vec3(found[k].normal), found);
    }
}

// A vertex in contact is asked where its contact puts it, now and at the next step.
void VertexSearch::find(const SpeculativePair& pair, Side side, std::uint32_t vertex, std::span<const NearEdge> faces,
                        const kernels::LocalContact* touches, std::vector<FeatureContact>& found) {
    Approaches approaches(pair, side, vertex, faces);
    if (touches != nullptr) approaches.leave(normal_of(*touches), double(touches->distance) * double(touches->facing));
    approaches_.clear();
    const Vec3& p = approaches.point();
    const auto met = pair.bodies[static_cast<std::size_t>(side)].moves ? approaches.first_met() : std::nullopt;
    if (met) approaches_.push_back(*met);
    approaches.add_near(approaches_);
    const std::size_t first = found.size();
    for (const Approach& one : approaches_) {
        const auto is_alike = [&](const Vec3& n) { return dot(n, one.normal) > same_plane; };
        if (touches != nullptr && is_alike(normal_of(*touches))) continue;
        if (std::any_of(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(),
                        [&](const FeatureContact& c) { return is_alike(c.normal); }))
            continue;
        if (!approaches.reaches_farthest(one)) continue;
        const bool has_other = touches != nullptr || found.size() > first;
        found.push_back({side, has_other ? FeatureKind::vertex_face : FeatureKind::vertex, vertex, one.face, p,
                         one.normal, -one.gap, one.when});
    }
    if (touches != nullptr || found.size() > first || approaches_.empty()) return;
    if (met || approaches_.front().gap > pair.margin) followers_.push_back({vertex, p, approaches_.front()});
}

// What follows behind a vertex, against the same plane, meets it as soon as the body turns about that vertex.
void VertexSearch::add_followers(const ShapeData& source, Side side, std::uint32_t vertex, const Vec3& normal,
                                 std::vector<FeatureContact>& found) {
    any_neighbour(source, vertex, [&](std::uint32_t w) {
        const auto at = std::ranges::lower_bound(followers_, w, {}, &Follower::vertex);
        if (at == followers_.end() || at->vertex != w || !(dot(at->approach.normal, normal) > same_plane)) return false;
        found.push_back({side, FeatureKind::vertex, w, at->approach.face, at->point, at->approach.normal,
                         -at->approach.gap, at->approach.when});
        at->approach.normal = {}; // once
        return false;
    });
}

} // namespace raycontact
