// SPDX-License-Identifier: Apache-2.0
#include "contacts/predictions.h"

#include "contacts/changes.h"
#include "mesh/vector.h"

#include <algorithm>
#include <tuple>

namespace raycontact {

namespace {

auto key_of(const Prediction& p) {
    return std::tuple(p.body_a, p.body_b, p.vertex_body, p.vertex);
}

// Where the vertex's outward normal meets the plane of the triangle; the vertex itself where they are parallel.
Vec3 meeting_point(const PlacedBody& source, const PlacedBody& target, const KeptRay& ray, const Vec3& vertex) {
    const Vec3 outward = transform_point({source.pose.rotation, {}}, source.shape->vertex_normals()[ray.vertex]);
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k)
        corner[k] = transform_point(target.pose, target.shape->vertices()[target.shape->triangles()[ray.triangle][k]]);
    const Vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double slope = dot(normal, outward);
    const double t = slope == 0 ? 0 : dot(normal, corner[0] - vertex) / slope;
    return vertex + t * outward;
}

} // namespace

std::vector<Prediction> find_predictions(std::span<const KeptRay> rays, std::span<const PlacedBody> bodies,
                                         const std::array<std::span<const Contact>, 2>& contacts) {
    std::vector<Prediction> found;
    for (const KeptRay& ray : rays) {
        const auto [a, b] = ray.pair;
        const PlacedBody &source = bodies[ray.from_a ? a : b], &target = bodies[ray.from_a ? b : a];
        Prediction prediction;
        prediction.body_a = a;
        prediction.body_b = b;
        prediction.vertex_body = ray.from_a ? VertexBody::a : VertexBody::b;
        prediction.vertex = source.shape->vertex_index()[ray.vertex];
        const ContactOrder own =
            order_of(LostContact{a, b, prediction.vertex_body, Feature::vertex, prediction.vertex, 0});
        const auto has_it = [&](std::span<const Contact> list) {
            return std::ranges::binary_search(list, own, {}, [](const Contact& c) { return order_of(c); });
        };
        if (std::ranges::any_of(contacts, has_it)) continue;
        prediction.triangle = target.shape->triangle_index()[ray.triangle];
        prediction.point = transform_point(source.pose, source.shape->vertices()[ray.vertex]);
        prediction.ahead = meeting_point(source, target, ray, prediction.point);
        found.push_back(prediction);
    }
    std::ranges::sort(found, {}, key_of);
    return found;
}

} // namespace raycontact
