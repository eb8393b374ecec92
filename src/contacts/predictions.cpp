// SPDX-License-Identifier: Apache-2.0
#include "contacts/predictions.h"

#include "mesh/vector.h"

#include <algorithm>
#include <tuple>

namespace raycontact {

namespace {

template <class T>
auto key_of(const T& c) {
    return std::tuple(c.body_a, c.body_b, c.vertex_body, c.vertex);
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
                                         std::span<const Contact> contacts) {
    std::vector<Prediction> found;
    for (const KeptRay& ray : rays) {
        const auto [a, b] = ray.pair;
        const PlacedBody &source = bodies[ray.from_a ? a : b], &target = bodies[ray.from_a ? b : a];
        Prediction prediction;
        prediction.body_a = a;
        prediction.body_b = b;
        prediction.vertex_body = ray.from_a ? VertexBody::a : VertexBody::b;
        prediction.vertex = source.shape->vertex_index()[ray.vertex];
        const auto same = std::ranges::lower_bound(contacts, key_of(prediction), {}, key_of<Contact>);
        if (same != contacts.end() && key_of(*same) == key_of(prediction)) continue;
        prediction.triangle = target.shape->triangle_index()[ray.triangle];
        prediction.point = transform_point(source.pose, source.shape->vertices()[ray.vertex]);
        prediction.ahead = meeting_point(source, target, ray, prediction.point);
        found.push_back(prediction);
    }
    std::ranges::sort(found, {}, key_of<Prediction>);
    return found;
}

} // namespace raycontact
