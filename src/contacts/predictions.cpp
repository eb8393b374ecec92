// SPDX-License-Identifier: Apache-2.0
#include "contacts/predictions.h"

#include "contacts/contact_order.h"
#include "contacts/write_contact.h"
#include "mesh/vector.h"

#include <algorithm>

namespace raycontact {

namespace {

ContactOrder order_of(const Prediction& p) {
    return raycontact::order_of(p.body_a, p.body_b, p.feature.key());
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
        prediction.body_a = id_in(bodies, a);
        prediction.body_b = id_in(bodies, b);
        prediction.feature = vertex_feature(ray.from_a, source.shape->vertex_index()[ray.vertex],
                                            target.shape->triangle_index()[ray.triangle]);
        const ContactOrder own = order_of(prediction);
        const auto has_it = [&](std::span<const Contact> list) {
            return std::ranges::binary_search(list, own, {}, [](const Contact& c) { return raycontact::order_of(c); });
        };
        if (std::ranges::any_of(contacts, has_it)) continue;
        prediction.point = transform_point(source.pose, source.shape->vertices()[ray.vertex]);
        prediction.ahead = meeting_point(source, target, ray, prediction.point);
        found.push_back(prediction);
    }
    std::ranges::sort(found, {}, [](const Prediction& p) { return order_of(p); });
    return found;
}

} // namespace raycontact
