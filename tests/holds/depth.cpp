// SPDX-License-Identifier: Apache-2.0
#include <tests/holds/depth.h>

#include "shape/mesh_rays.h"

#include <raycontact/collide.h>

#include <algorithm>

namespace raycontact::scenes {

namespace {

bool is_in_box(const Shape& shape, const Vec3& p) {
    const Vec3 low = shape.box_min(), high = shape.box_max();
    return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
}

Settings plain() {
    Settings settings;
    settings.execution.threads = 1;
    settings.speculative = Speculative::off;
    settings.method = Method::standard;
    return settings;
}

} // namespace

DepthProbe::DepthProbe(const Stack& stack, Ground ground) : scene_(plain()) {
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const StackShape& shape : stack.shapes) shapes.push_back(Shape::make(shape.mesh));
    const auto add = [&](const std::shared_ptr<const Shape>& shape, const Pose& pose, bool fixed) {
        bodies_.push_back({shape, scene_.add(shape, pose), fixed});
    };
    for (const StackBody& body : stack.bodies) add(shapes[body.shape], body.pose, body.fixed);
    if (ground != Ground::none) add(Shape::make(ground_mesh(Ground::slab)), {}, true);
}

double DepthProbe::deepest_vertex(const Body& in, const Pose& pose_in, const Body& of, const Pose& pose_of) const {
    const Pose seen = relative_pose(pose_in, pose_of);
    double deepest = 0;
    for (const Vec3& v : of.shape->vertices()) {
        const Vec3 p = transform_point(seen, v);
        if (is_in_box(*in.shape, p) && contains(*in.shape, p))
            deepest = std::max(deepest, nearest_face(in.shape->data(), p - in.shape->centre(), 0).distance);
    }
    return deepest;
}

double DepthProbe::deepest(const std::vector<Pose>& poses) {
    for (std::size_t i = 0; i < poses.size(); ++i) scene_.set_pose(bodies_[i].id, poses[i]);
    scene_.find_contacts();
    double deepest = 0;
    for (const Contact& contact : scene_.contacts())
        if (contact.feature.kind == FeatureKind::edges) deepest = std::max(deepest, static_cast<double>(contact.depth));
    for (const auto& [a, b] : scene_.pairs()) {
        const Body &first = bodies_[a.slot], &second = bodies_[b.slot];
        if (first.fixed && second.fixed) continue;
        deepest = std::max(deepest, deepest_vertex(first, scene_.pose(a), second, scene_.pose(b)));
        deepest = std::max(deepest, deepest_vertex(second, scene_.pose(b), first, scene_.pose(a)));
    }
    return deepest;
}

} // namespace raycontact::scenes
