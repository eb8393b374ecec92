// SPDX-License-Identifier: Apache-2.0
#include "contacts/place.h"

#include "shape/shape_data.h"

#include <algorithm>
#include <array>
#include <span>

namespace raycontact {

namespace {

Vec3 rotate(const Pose& pose, const Vec3& v) {
    const auto& r = pose.rotation;
    return {(r[0] * v.x + r[1] * v.y) + r[2] * v.z, (r[3] * v.x + r[4] * v.y) + r[5] * v.z,
            (r[6] * v.x + r[7] * v.y) + r[8] * v.z};
}

// Written where it is to be: a contact made on the stack is copied in words that no store has just written, and waits.
void place(Contact& contact, Direction direction, const PlacedBody& source, const PlacedBody& target, const Pair& pair,
           bool from_a, const kernels::LocalContact& local) {
    const ShapeData& shape = source.shape->data();
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
}

// How many vertices are smaller says where a contact belongs, without a branch to guess wrong: of this many contacts
// that is faster than sorting them.
constexpr std::size_t few = 8, many = 128, lanes = 16;

// keys: vertex, place; of a pair no vertex casts twice.
void sort_by_vertex(std::span<std::uint64_t> keys) {
    if (keys.size() < few || keys.size() > many) {
        std::sort(keys.begin(), keys.end());
        return;
    }
    std::array<std::uint64_t, many> unsorted;
    std::array<std::int32_t, many> vertex; // signed, which every processor compares many at once
    std::copy(keys.begin(), keys.end(), unsorted.begin());
    for (std::size_t i = 0; i < keys.size(); ++i) vertex[i] = static_cast<std::int32_t>(keys[i] >> 32);
    for (std::size_t i = keys.size(); i % lanes != 0; ++i) vertex[i] = 0;
    for (std::size_t first = 0; first < keys.size(); first += lanes) {
        std::array<std::int32_t, lanes> smaller{};
        for (std::size_t j = 0; j < keys.size(); ++j)
            for (std::size_t k = 0; k < lanes; ++k) smaller[k] += vertex[j] < vertex[first + k] ? 1 : 0;
        for (std::size_t k = 0; k < lanes && first + k < keys.size(); ++k)
            keys[static_cast<std::size_t>(smaller[k])] = unsorted[first + k];
    }
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
            sort_by_vertex({order_.data() + begin, next - begin});
            const std::uint32_t ordered = local[begin].pair;
            const auto [source, target] = directed_pair(bodies, pairs, ordered);
            for (std::uint32_t i = begin; i < next; ++i)
                place(contacts[i], direction, source, target, pairs[ordered / 2], ordered % 2 == 0,
                      local[order_[i] & 0xffffffff]);
        }
    });
}

} // namespace raycontact
