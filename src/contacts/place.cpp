// SPDX-License-Identifier: Apache-2.0
#include "contacts/place.h"

#include "contacts/refine.h"
#include "mesh/vector.h"
#include "platform/prefetch.h"
#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

namespace {

// What all contacts of one direction of a pair have in common.
struct Side {
    SlotPair pair;
    bool from_a;
    Direction direction;
    const ShapeData &source, &target;
    const Pose &source_pose, &target_pose;

    // Prefetches most of what place() will read: the data of a fine mesh does not fit the caches.
    void send_for(const kernels::LocalContact& local) const {
        platform::prefetch(&source.mesh.vertex_index[local.vertex]);
        platform::prefetch(&source.mesh.vertices[local.vertex]);
        platform::prefetch(&target.mesh.triangle_index[local.triangle]);
        if (direction == Direction::weighted) platform::prefetch(&source.vertex_areas[local.vertex]);
    }
};

// Writes the contact in place and calls no function of another unit: a load would have to wait for a value that was
// just stored in pieces of another size. The point has the bits of transform_point().
void place(Contact& contact, const Side& side, const kernels::LocalContact& local) {
    const ShapeData& shape = side.source;
    contact.body_a = side.pair.first;
    contact.body_b = side.pair.second;
    contact.vertex_body = side.from_a ? VertexBody::a : VertexBody::b;
    contact.feature = Feature::vertex; // with edges the place may have held one of theirs
    contact.vertex = shape.mesh.vertex_index[local.vertex];
    contact.triangle = side.target.mesh.triangle_index[local.triangle];
    const Vec3 turned = rotated(side.source_pose.rotation, shape.mesh.vertices[local.vertex]);
    const Vec3& origin = side.source_pose.translation;
    contact.point.x = turned.x + origin.x;
    contact.point.y = turned.y + origin.y;
    contact.point.z = turned.z + origin.z;
    contact.ray_length = local.distance;
    contact.weight = side.direction == Direction::weighted ? shape.vertex_areas[local.vertex] : 1;
    Vec3 out; // the direction in which the source leaves the target
    switch (side.direction) {
    case Direction::reprojected:
    case Direction::refined: // refined after this
        out = rotated(side.target_pose.rotation, {local.normal.x, local.normal.y, local.normal.z});
        contact.depth = local.distance * local.facing;
        break;
    case Direction::ray:
    case Direction::weighted: {
        const Vec3 n = shape.vertex_normals[local.vertex];
        out = rotated(side.source_pose.rotation, {-n.x, -n.y, -n.z});
        contact.depth = local.distance;
    }
    }
    const double sign = side.from_a ? -1 : 1;
    contact.normal[0] = static_cast<float>(sign * out.x);
    contact.normal[1] = static_cast<float>(sign * out.y);
    contact.normal[2] = static_cast<float>(sign * out.z);
}

} // namespace

void Placer::run(Executor& executor, Direction direction, std::span<const PlacedBody> bodies,
                 std::span<const SlotPair> pairs, std::span<const kernels::LocalContact> local,
                 std::vector<Contact>& contacts) {
    contacts.resize(local.size());
    order_.resize(local.size());
    const auto begins_pair = [&](std::uint32_t i) {
        return i == 0 || i == local.size() || local[i].pair != local[i - 1].pair;
    };
    // The contacts of a pair lie together, in the order of its clusters. A slice handles the pairs that begin in it.
    executor.run(static_cast<std::uint32_t>(local.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        while (!begins_pair(begin)) ++begin;
        for (std::uint32_t next = begin; begin < end; begin = next) {
            const std::uint32_t directed = local[begin].pair;
            const auto [source, target] = directed_bodies(bodies, pairs, directed);
            const Side side{pairs[directed / 2],  directed % 2 == 0, direction,  source.shape->data(),
                            target.shape->data(), source.pose,       target.pose};
            do {
                order_[next] = std::uint64_t{local[next].vertex} << 32 | next;
                side.send_for(local[next]);
            } while (!begins_pair(++next));
            std::sort(order_.begin() + begin, order_.begin() + next);
            for (std::uint32_t i = begin; i < next; ++i) place(contacts[i], side, local[order_[i] & 0xffffffff]);
            if (direction != Direction::refined) continue;
            const Refiner refiner(source, target);
            for (std::uint32_t i = begin; i < next; ++i) refiner.refine(contacts[i], local[order_[i] & 0xffffffff]);
        }
    });
}

} // namespace raycontact
