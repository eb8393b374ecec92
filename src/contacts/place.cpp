// SPDX-License-Identifier: Apache-2.0
#include "contacts/place.h"

#include "contacts/refine.h"
#include "contacts/write_contact.h"
#include "mesh/vector.h"
#include "platform/prefetch.h"
#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

namespace {

// What all contacts of one direction of a pair have in common.
struct Directed {
    BodyId a, b;
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

// Calls no function of another unit: a load would have to wait for a value that was just stored in pieces of another
// size. The point has the bits of transform_point().
void place(Contact& contact, const Directed& pair, const kernels::LocalContact& local) {
    const ShapeData& shape = pair.source;
    const Vec3 turned = rotated(pair.source_pose.rotation, shape.mesh.vertices[local.vertex]);
    const Vec3& origin = pair.source_pose.translation;
    Vec3 out; // the direction in which the source leaves the target
    float depth = local.distance;
    switch (pair.direction) {
    case Direction::reprojected:
    case Direction::refined: // refined after this
        out = rotated(pair.target_pose.rotation, {local.normal.x, local.normal.y, local.normal.z});
        depth = local.distance * local.facing;
        break;
    case Direction::ray:
    case Direction::weighted: {
        const Vec3 n = shape.vertex_normals[local.vertex];
        out = rotated(pair.source_pose.rotation, {-n.x, -n.y, -n.z});
    }
    }
    write_contact(contact, pair.a, pair.b,
                  vertex_feature(pair.from_a, shape.mesh.vertex_index[local.vertex],
                                 pair.target.mesh.triangle_index[local.triangle]),
                  {turned.x + origin.x, turned.y + origin.y, turned.z + origin.z}, out, depth, local.distance,
                  pair.direction == Direction::weighted ? shape.vertex_areas[local.vertex] : 1);
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
            const auto [a, b] = pairs[directed / 2];
            const Directed pair{id_in(bodies, a),     id_in(bodies, b),     directed % 2 == 0, direction,
                                source.shape->data(), target.shape->data(), source.pose,       target.pose};
            do {
                order_[next] = std::uint64_t{local[next].vertex} << 32 | next;
                pair.send_for(local[next]);
            } while (!begins_pair(++next));
            std::sort(order_.begin() + begin, order_.begin() + next);
            for (std::uint32_t i = begin; i < next; ++i) place(contacts[i], pair, local[order_[i] & 0xffffffff]);
            if (direction != Direction::refined) continue;
            const Refiner refiner(source, target);
            for (std::uint32_t i = begin; i < next; ++i) refiner.refine(contacts[i], local[order_[i] & 0xffffffff]);
        }
    });
}

} // namespace raycontact
