// SPDX-License-Identifier: Apache-2.0
#include "contacts/place.h"

#include "contacts/write_contact.h"
#include "executor/row_slices.h"
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
    contact.is_new = pair.direction == Direction::refined; // as Refiner::awaits()
}

// Sorts a pair's placed contacts in behind `count` of its vertices: from the back, where there is room for them.
void merge(std::span<const Contact> placed, Contact* own, std::size_t count) {
    std::size_t left = placed.size();
    for (Contact* to = own + count + left; left > 0;) {
        const bool own_is_last = count > 0 && own[count - 1].key() > placed[left - 1].key();
        *--to = own_is_last ? own[--count] : placed[--left];
    }
}

} // namespace

void Placer::run(Executor& executor, Direction direction, std::span<const PlacedBody> bodies,
                 std::span<const SlotPair> pairs, const ByPair<kernels::LocalContact>& by_pair,
                 std::span<const PlacedContacts> placed, std::vector<Contact>& contacts) {
    const std::span<const kernels::LocalContact> local = by_pair.all();
    const std::size_t more = placed.empty() ? 0 : placed.back().before + placed.back().contacts.size();
    contacts.resize(local.size() + more);
    order_.resize(local.size());
    const auto place_direction = [&](std::uint32_t begin, std::uint32_t end, Contact* to) {
        const std::uint32_t directed = local[begin].pair;
        const auto [source, target] = directed_bodies(bodies, pairs, directed);
        const auto [a, b] = pairs[directed / 2];
        const Directed pair{id_in(bodies, a),     id_in(bodies, b),     directed % 2 == 0, direction,
                            source.shape->data(), target.shape->data(), source.pose,       target.pose};
        for (std::uint32_t i = begin; i < end; ++i) {
            order_[i] = std::uint64_t{local[i].vertex} << 32 | i;
            pair.send_for(local[i]);
        }
        std::sort(order_.begin() + begin, order_.begin() + end);
        for (std::uint32_t i = begin; i < end; ++i) place(to[i - begin], pair, local[order_[i] & 0xffffffff]);
    };
    const auto pair_at = [&](std::size_t i) { return local[i].pair / 2; };
    const RowSlices slices{local.size(), 256};
    const auto belongs = [&](std::size_t i) { return pair_at(i) == pair_at(i - 1); };
    slices.each(executor, belongs, [&](std::uint32_t, std::size_t first, std::size_t end) {
        auto own = beside(placed, first, end, local.size(), pair_at, &PlacedContacts::pair).begin();
        for (auto begin = static_cast<std::uint32_t>(first); begin < end;) {
            const std::uint32_t pair = pair_at(begin);
            const std::uint32_t middle = by_pair.first(2 * pair + std::size_t{1});
            const std::uint32_t next = by_pair.first(2 * pair + std::size_t{2});
            while (own != placed.end() && own->pair < pair) ++own;
            Contact* const to = contacts.data() + begin + (own == placed.end() ? more : own->before);
            if (begin < middle) place_direction(begin, middle, to);
            if (middle < next) place_direction(middle, next, to + (middle - begin));
            if (own != placed.end() && own->pair == pair) merge(own->contacts, to, next - begin);
            begin = next;
        }
    });
    // Pairs without contacts of vertices.
    executor.each(placed.size(), 256, [&](std::uint32_t i) {
        const PlacedContacts& own = placed[i];
        const std::uint32_t first = by_pair.first(2 * std::size_t{own.pair});
        if (first != by_pair.first(2 * std::size_t{own.pair} + 2)) return;
        std::ranges::copy(own.contacts, contacts.begin() + first + own.before);
    });
}

} // namespace raycontact
