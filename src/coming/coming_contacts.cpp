// SPDX-License-Identifier: Apache-2.0
#include "coming/coming_contacts.h"

#include "edges/mesh_rays.h"
#include "edges/source_mesh.h"
#include "give_back.h"
#include "mesh/vector.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

constexpr std::uint32_t pairs_in_block = 32;
// Of the smaller body's size: a pair that moves less in a step passes no wall unseen that is thicker.
constexpr double least_motion = 0.005;

struct Box {
    Vec3 low, high;
    bool meets(const Vec3& other_low, const Vec3& other_high) const {
        // Written so that a NaN, of bodies beyond all range, meets nothing.
        return low.x <= other_high.x && other_low.x <= high.x && low.y <= other_high.y && other_low.y <= high.y
               && low.z <= other_high.z && other_low.z <= high.z;
    }
};

Box box_of(const ShapeData& shape) {
    const auto& h = shape.header;
    return {{h.low[0], h.low[1], h.low[2]}, {h.high[0], h.high[1], h.high[2]}};
}

Box placed(const Box& box, const Pose& pose) {
    const Vec3 middle = transform_point(pose, 0.5 * (box.low + box.high)), half = 0.5 * (box.high - box.low);
    const auto& r = pose.rotation;
    const Vec3 reach{std::abs(r[0]) * half.x + std::abs(r[1]) * half.y + std::abs(r[2]) * half.z,
                     std::abs(r[3]) * half.x + std::abs(r[4]) * half.y + std::abs(r[5]) * half.z,
                     std::abs(r[6]) * half.x + std::abs(r[7]) * half.y + std::abs(r[8]) * half.z};
    return {middle - reach, middle + reach};
}

// One direction of a pair: the source's centred frame in the target's, in this step and in the next.
struct Course {
    const PlacedBody &source, &target;
    Pose now, then;

    Course(const PlacedBody& from, const PlacedBody& to, const Pose& next_from, const Pose& next_to)
        : source(from), target(to), now(relative_pose(to.centred, from.centred)),
          then(relative_pose(centred_pose(*to.shape, next_to), centred_pose(*from.shape, next_from))) {}

    // At least as far as any vertex goes.
    double length_bound() const {
        double turn = 0;
        for (std::size_t k = 0; k < 9; ++k) {
            const double d = then.rotation[k] - now.rotation[k];
            turn += d * d;
        }
        return length(then.translation - now.translation) + std::sqrt(turn) * source.shape->data().reach;
    }
};

void find(const Course& course, const SlotPair& pair, VertexBody side, Direction direction,
          std::vector<Contact>& found) {
    const ShapeData &source = course.source.shape->data(), &target = course.target.shape->data();
    const double size = smaller_size(course.source, course.target);
    if (!(course.length_bound() > least_motion * size)) return;
    const Box wall = box_of(target), own = box_of(source);
    const Box before = placed(own, course.now), after = placed(own, course.then);
    if (!wall.meets(least(before.low, after.low), most(before.high, after.high))) return;

    const auto first = static_cast<std::ptrdiff_t>(found.size());
    for (std::uint32_t v = 0; v < source.points.size(); ++v) {
        const Vec3 from = transform_point(course.now, source.point(v)),
                   to = transform_point(course.then, source.point(v));
        if (!wall.meets(least(from, to), most(from, to))) continue;
        const double way = length(to - from);
        if (!(way > 0)) continue;
        // From a hair behind, so that a vertex on the surface that is about to enter counts.
        const MeshHit hit = closest_hit(target, from, (1 / way) * (to - from), -1e-7 * size, way);
        if (hit.face == NONE || hit.from_inside) continue;
        const Vec3 out = normal_of(target, hit.face);
        const double gap = std::max(0.0, dot(from - target.corner(hit.face, 0), out));
        Contact& contact = found.emplace_back();
        contact.body_a = pair.first;
        contact.body_b = pair.second;
        contact.vertex_body = side;
        contact.vertex = source.mesh.vertex_index[v];
        contact.triangle = target.mesh.triangle_index[hit.face];
        contact.point = transform_point(course.target.centred, from);
        const Vec3 turned = transform_point({course.target.centred.rotation, {}}, out);
        const double sign = side == VertexBody::a ? -1 : 1;
        contact.normal = {static_cast<float>(sign * turned.x), static_cast<float>(sign * turned.y),
                          static_cast<float>(sign * turned.z)};
        contact.depth = static_cast<float>(-gap);
        contact.ray_length = static_cast<float>(std::max(0.0, hit.distance));
        if (direction == Direction::weighted) contact.weight = source.vertex_areas[v];
    }
    std::sort(found.begin() + first, found.end(),
              [](const Contact& p, const Contact& q) { return p.vertex < q.vertex; });
}

} // namespace

void ComingContacts::run(Executor& executor, Direction direction, std::span<const PlacedBody> bodies,
                         std::span<const Pose> next, std::span<const SlotPair> pairs) {
    const auto block_count = static_cast<std::uint32_t>((pairs.size() + pairs_in_block - 1) / pairs_in_block);
    blocks_.resize(block_count);
    executor.run(block_count, 1, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t b = begin; b < end; ++b) {
            blocks_[b].clear();
            const std::size_t last = std::min<std::size_t>(pairs.size(), (b + 1) * std::size_t{pairs_in_block});
            for (std::size_t i = b * std::size_t{pairs_in_block}; i < last; ++i) {
                const PlacedBody &first = bodies[pairs[i].first], &second = bodies[pairs[i].second];
                const Pose &first_next = next[pairs[i].first], &second_next = next[pairs[i].second];
                find({first, second, first_next, second_next}, pairs[i], VertexBody::a, direction, blocks_[b]);
                find({second, first, second_next, first_next}, pairs[i], VertexBody::b, direction, blocks_[b]);
            }
        }
    });
    contacts_.clear();
    for (std::vector<Contact>& block : blocks_) {
        contacts_.insert(contacts_.end(), block.begin(), block.end());
        give_back(block);
    }
    give_back(contacts_);
}

} // namespace raycontact
