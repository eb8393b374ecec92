// SPDX-License-Identifier: Apache-2.0
#include "contacts/place.h"

#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

namespace {

Vec3 rotate(const Pose& pose, const Vec3& v) {
    const auto& r = pose.rotation;
    return {(r[0] * v.x + r[1] * v.y) + r[2] * v.z, (r[3] * v.x + r[4] * v.y) + r[5] * v.z,
            (r[6] * v.x + r[7] * v.y) + r[8] * v.z};
}

Contact place(Direction direction, const PlacedBody& source, const PlacedBody& target, const Pair& pair, bool from_a,
              const kernels::LocalContact& local) {
    const ShapeData& shape = source.shape->data();
    Contact contact;
    contact.body_a = pair.first;
    contact.body_b = pair.second;
    contact.vertex_body = from_a ? VertexBody::a : VertexBody::b;
    contact.vertex = shape.mesh.vertex_index[local.vertex];
    contact.triangle = target.shape->triangle_index()[local.triangle];
    contact.point = transform_point(source.pose, shape.mesh.vertices[local.vertex]);
    contact.ray_length = local.distance;
    Vec3 out; // in which the source leaves the target
    if (direction == Direction::reprojected) {
        out = rotate(target.pose, {local.normal.x, local.normal.y, local.normal.z});
        contact.depth = local.distance * local.facing;
    } else {
        const Vec3 n = shape.vertex_normals[local.vertex];
        out = rotate(source.pose, {-n.x, -n.y, -n.z});
        contact.depth = local.distance;
    }
    const double sign = from_a ? -1 : 1;
    contact.normal = {static_cast<float>(sign * out.x), static_cast<float>(sign * out.y),
                      static_cast<float>(sign * out.z)};
    return contact;
}

} // namespace

void Placer::run(Executor& executor, Direction direction, std::span<const PlacedBody> bodies,
                 std::span<const Pair> pairs, std::span<const kernels::LocalContact> local,
                 std::vector<Contact>& contacts) {
    contacts.resize(local.size());
    order_.resize(local.size());
    const auto begins_pair = [&](std::uint32_t i) {
        return i == 0 || i == local.size() || local[i].pair != local[i - 1].pair;
    };
    // The rays of a pair lie together, but in the order of its clusters. A slice takes the pairs that begin in it.
    executor.run(static_cast<std::uint32_t>(local.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        while (!begins_pair(begin)) ++begin;
        for (std::uint32_t next = begin; begin < end; begin = next) {
            do order_[next] = std::uint64_t{local[next].vertex} << 32 | next;
            while (!begins_pair(++next));
            std::sort(order_.begin() + begin, order_.begin() + next);
            const Pair& pair = pairs[local[begin].pair / 2];
            const bool from_a = local[begin].pair % 2 == 0;
            const PlacedBody& source = bodies[from_a ? pair.first : pair.second];
            const PlacedBody& target = bodies[from_a ? pair.second : pair.first];
            for (std::uint32_t i = begin; i < next; ++i)
                contacts[i] = place(direction, source, target, pair, from_a, local[order_[i] & 0xffffffff]);
        }
    });
}

} // namespace raycontact
