// SPDX-License-Identifier: Apache-2.0
#include "coming/coming_contacts.h"

#include "broadphase/sweep_and_prune.h"
#include "edges/pair_meshes.h"
#include "give_back.h"
#include "pairs/displacement.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr std::size_t pairs_in_block = 32;
// Of the smaller body's size: a pair that moves less in a step passes no wall unseen that is thicker.
constexpr double least_motion = 0.005;

Box box_of(const ShapeData& shape, const Pose& pose) {
    return world_box(box_of(shape), pose, 0);
}

// One direction of a pair, by the target's centred frame.
struct Course {
    const PlacedBody &source, &target;
    Pose now, then; ///< of the source's centred frame, in this step and in the next
};

void find(const Course& course, const SlotPair& pair, VertexBody side, Direction direction,
          std::vector<Contact>& found) {
    const ShapeData &source = course.source.shape->data(), &target = course.target.shape->data();
    const Box wall = box_of(target, {}), before = box_of(source, course.now), after = box_of(source, course.then);
    // A NaN, of bodies beyond all range, touches nothing.
    if (!Box{least(before.low, after.low), most(before.high, after.high)}.touches(wall)) return;

    const double hair = 1e-7 * smaller_size(course.source, course.target);
    const auto first = static_cast<std::ptrdiff_t>(found.size());
    for (std::uint32_t v = 0; v < source.points.size(); ++v) {
        const Vec3 from = transform_point(course.now, source.point(v));
        const Vec3 to = transform_point(course.then, source.point(v));
        if (!Box{least(from, to), most(from, to)}.touches(wall)) continue;
        const double way = length(to - from);
        if (!(way > 0)) continue;
        // From a hair behind, so that a vertex on the surface that is about to enter counts.
        const MeshHit hit = closest_hit(target, {from, (1 / way) * (to - from), -hair, way});
        if (hit.face == NONE || hit.from_inside) continue;
        const Vec3 out = unit(area_normal(target, hit.face));
        const double gap = std::max(0.0, dot(from - target.corner(hit.face, 0), out));
        Contact& contact = found.emplace_back(contact_at(pair, side, course.target, from, out));
        contact.vertex = source.mesh.vertex_index[v];
        contact.triangle = target.mesh.triangle_index[hit.face];
        contact.depth = static_cast<float>(-gap);
        contact.ray_length = static_cast<float>(std::max(0.0, hit.distance));
        if (direction == Direction::weighted) contact.weight = source.vertex_areas[v];
    }
    std::ranges::sort(found.begin() + first, found.end(), {}, &Contact::vertex);
}

void find(const SlotPair& pair, std::span<const PlacedBody> bodies, std::span<const Pose> next, Direction direction,
          std::vector<Contact>& found) {
    const PlacedBody &a = bodies[pair.first], &b = bodies[pair.second];
    const PairPlace now = place_pair(a.centred, b.centred, 0);
    const PairPlace then =
        place_pair(centred_pose(*a.shape, next[pair.first]), centred_pose(*b.shape, next[pair.second]), 0);
    const auto ways = displacement_bounds(now, then, a.shape->data().reach, b.shape->data().reach);
    const double least_way = least_motion * smaller_size(a, b);
    if (ways[0] > least_way) find({a, b, now.pose, then.pose}, pair, VertexBody::a, direction, found);
    if (ways[1] > least_way)
        find({b, a, now.pose_of_second(), then.pose_of_second()}, pair, VertexBody::b, direction, found);
}

} // namespace

void ComingContacts::run(Executor& executor, Direction direction, std::span<const PlacedBody> bodies,
                         std::span<const Pose> next, std::span<const SlotPair> pairs) {
    blocks_.resize((pairs.size() + pairs_in_block - 1) / pairs_in_block);
    executor.each(blocks_.size(), 1, [&](std::uint32_t b) {
        blocks_[b].clear();
        const std::size_t first = b * pairs_in_block;
        for (const SlotPair& pair : pairs.subspan(first, std::min(pairs.size() - first, pairs_in_block)))
            find(pair, bodies, next, direction, blocks_[b]);
    });
    contacts_.clear();
    for (std::vector<Contact>& block : blocks_) {
        contacts_.insert(contacts_.end(), block.begin(), block.end());
        give_back(block);
    }
    give_back(contacts_);
}

} // namespace raycontact
