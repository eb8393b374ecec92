// SPDX-License-Identifier: Apache-2.0
#include <scenes/holds/depth.h>

#include <raycontact/collide.h>

#include <algorithm>
#include <cmath>

namespace raycontact::scenes {

namespace {

Vec3 minus(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

double square_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 way = minus(b, a), from = minus(p, a);
    const double length = dot(way, way);
    const double t = length > 0 ? std::clamp(dot(from, way) / length, 0.0, 1.0) : 0;
    const Vec3 rest{from.x - t * way.x, from.y - t * way.y, from.z - t * way.z};
    return dot(rest, rest);
}

double square_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 u = minus(b, a), v = minus(c, a), w = minus(p, a);
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v);
    const double scale = uu * vv - uv * uv;
    const double s = wu * vv - wv * uv, t = wv * uu - wu * uv;
    if (scale > 0 && s >= 0 && t >= 0 && s + t <= scale) {
        const Vec3 rest{w.x - (s * u.x + t * v.x) / scale, w.y - (s * u.y + t * v.y) / scale,
                        w.z - (s * u.z + t * v.z) / scale};
        return dot(rest, rest);
    }
    return std::min({square_to_segment(p, a, b), square_to_segment(p, b, c), square_to_segment(p, c, a)});
}

double distance_to_surface(const Shape& shape, const Vec3& p) {
    double least = 1e300;
    const auto vertices = shape.vertices();
    for (const auto& t : shape.triangles())
        least = std::min(least, square_to_triangle(p, vertices[t[0]], vertices[t[1]], vertices[t[2]]));
    return std::sqrt(least);
}

bool is_in_box(const Shape& shape, const Vec3& p) {
    const Vec3 low = shape.box_min(), high = shape.box_max();
    return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
}

Settings plain() {
    Settings settings;
    settings.threads = 1;
    settings.speculative = false;
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
            deepest = std::max(deepest, distance_to_surface(*in.shape, p));
    }
    return deepest;
}

double DepthProbe::deepest(const std::vector<Pose>& poses) {
    for (std::size_t i = 0; i < poses.size(); ++i) scene_.set_pose(bodies_[i].id, poses[i]);
    scene_.step();
    double deepest = 0;
    for (const Contact& contact : scene_.contacts())
        if (contact.feature == Feature::edges) deepest = std::max(deepest, static_cast<double>(contact.depth));
    for (const auto& [a, b] : scene_.pairs()) {
        const Body &first = bodies_[slot_of(a)], &second = bodies_[slot_of(b)];
        if (first.fixed && second.fixed) continue;
        deepest = std::max(deepest, deepest_vertex(first, scene_.pose(a), second, scene_.pose(b)));
        deepest = std::max(deepest, deepest_vertex(second, scene_.pose(b), first, scene_.pose(a)));
    }
    return deepest;
}

} // namespace raycontact::scenes
