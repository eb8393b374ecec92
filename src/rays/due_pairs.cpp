// SPDX-License-Identifier: Apache-2.0
#include "rays/due_pairs.h"

#include "pairs/rounding.h"
#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

namespace {

// Shares of the smaller body's size:
constexpr double fastest = 0.006;    // a step: a list would not last long enough to pay for itself
constexpr double unhurried = 0.0025; // a step: rays may go on from triangle to triangle
// Share of the swept clearance's radius a step: faster pairs seek no swept clearances.
constexpr double slow = 0.15;

// How far beyond the bounds a new list reaches: the way of some steps, between the lengths that were best for
// a pile and for fast bodies (bench/log.md, entry 15).
double reach_of_lists(double size, double speed) {
    return std::max(0.015 * size,
                    std::min(0.027 * size, 24 * speed)); // this order of arguments also works for a NaN speed
}

// A longer clock in float32 would count in steps coarser than the rounding that is allowed for.
double longest_clock(const PlacedBody& target) {
    return 8 * target.shape->data().diagonal;
}

// Metres around a ray to search for triangles. Within the length of a triangle the surface mostly faces one way; a
// wider swept clearance only finds more triangles to test.
double clearance_radius(double size, const ShapeData& target) {
    return std::min(size / 128, target.grain);
}

// Whether a ray of the source meets no target beyond its hull: it ends in the source, or the first face that it meets
// is met from outside.
bool ends_before(const Update& update, const PlacedBody& source, const PlacedBody& target) {
    return source.shape->data().rays_end || update.shapes.headers()[target.shape_index].outward != 0;
}

// Where the hulls are apart, nothing touches: no ray is due until they may meet. Nothing of speculative
// contacts is asked here, so that rays are the same with and without. False: they are due.
bool extend_rays(const Update& update, const PlacedBody& a, const PlacedBody& b, CertifiedPair& state, Slack& slack) {
    constexpr double wanted = 0.005; // of the size
    if (!ends_before(update, a, b) || !ends_before(update, b, a)) return false;
    const double needed = std::max(rounding_margin(a, b), rounding_margin(b, a));
    const double gap = state.normal.gap(a, b, needed + wanted * smaller_size(a, b), false);
    if (!(gap > needed)) return false;
    slack.metres = edge_share * (gap - needed);
    return true;
}

// Whether nothing beyond its hull is inside a body: of a closed mesh that is inside out, say, all may be.
bool is_inside_its_hull(const Update& update, const PlacedBody& body) {
    const kernels::ShapeHeader& shape = update.shapes.headers()[body.shape_index];
    return shape.closed == 0 || shape.outward != 0;
}

// The same of what is near, now and, if the pair hurries, on its way.
bool extend_near(const Update& update, const PlacedBody& a, const PlacedBody& b, CertifiedPair& state, Slack& slack,
                 bool hurries, double thrown) {
    if (!is_inside_its_hull(update, a) || !is_inside_its_hull(update, b)) return false;
    const double needed = std::max(rounding_margin(a, b), rounding_margin(b, a)) + double(slack.margin) + thrown;
    const double gap = state.normal_of_near.gap(a, b, needed, hurries);
    if (!(gap > needed)) return false;
    slack.edges = slack.points = edge_share * (gap - needed);
    state.edges.counts = state.points.counts = {};
    slack.has_points = false;
    slack.apart = slack.all = true;
    return true;
}

} // namespace

// Decides for one pair, in double, what is due.
void DuePairs::check_pair(const Update& update, CertifiedPairs& table, std::uint32_t i, double speed, Slice& slice) {
    const std::optional<double>& threshold = update.settings.paper.displacement_threshold;
    const SlotPair& pair = update.pairs[i];
    CertifiedPair& state = table.state(i);
    Slack& slack = table.hot(i);
    const PlacedBody* body[2] = {&update.bodies[pair.first], &update.bodies[pair.second]};
    const double size = smaller_size(*body[0], *body[1]);
    const bool fresh = state.directions[0].expiry < 0;
    const PairPlace now = place_pair(body[0]->centred, body[1]->centred, update.motion.pair_shear(pair));
    std::array<double, 2> moved{0, 0};
    if (!fresh)
        moved = displacement_bounds(state.reference, now, body[0]->shape->data().reach, body[1]->shape->data().reach);
    bool stale[2] = {}, is_due[2] = {};
    slack.metres = never;
    slack.open = true;
    slack.casts = false;
    for (std::size_t d = 0; d < 2; ++d) {
        Candidates& own = state.directions[d];
        const double clock = own.clock + moved[d];
        // Written so that a clock that is NaN, for bodies beyond the range of squares, makes the list stale.
        stale[d] = fresh || !(clock < own.expiry);
        // The same comparison as in the kernel: blocks are tested only at the reference pose.
        is_due[d] = stale[d] || !(double(static_cast<float>(clock)) < own.valid_until);
        slack.casts = slack.casts || own.rays.count > 0;
        if (!is_due[d]) slack.metres = std::min(slack.metres, std::min(own.valid_until, own.expiry) - clock);
    }
    const bool any_due = is_due[0] || is_due[1], any_stale = stale[0] || stale[1];
    if (!any_due && !slack.casts) return;

    if (any_stale) state.speed = fresh ? speed : 0.75 * state.speed + 0.25 * speed;
    if (any_due) state.reference = now;
    for (std::uint32_t d = 0; d < 2; ++d) {
        const PlacedBody &source = *body[d], &target = *body[1 - d];
        Candidates& own = state.directions[d];
        const double clock = own.clock + moved[d];
        if (any_due) own.clock = clock;
        if (stale[d]) {
            own.clock = 0;
            own.expiry = threshold ? std::min(*threshold, longest_clock(target)) : reach_of_lists(size, state.speed);
            slice.stale.add() = slice.due.size();
        }
        if (!is_due[d] && own.rays.count == 0) continue;
        Due& due = slice.due.add();
        due.own = &own;
        due.directed = 2 * i + d;
        due.now = static_cast<float>(stale[d] ? 0 : clock);
        due.margin = static_cast<float>(rounding_margin(source, target));
        const double radius = clearance_radius(size, target.shape->data());
        due.radius = speed < slow * radius ? static_cast<float>(radius) : 0;
        due.tests_cones = speed < unhurried * size ? update.shapes.headers()[target.shape_index].cones_pay : 0;
        due.longest = longest_clock(target);
        place_source(source, target, d == 0 ? now.pose : now.pose_of_second(), slice.places.add());
    }
}

// The cheap bound comes first; most pairs at rest need no more.
void DuePairs::check_slice(const Update& update, CertifiedPairs& table, std::uint32_t begin, std::uint32_t end,
                           Slice& slice) {
    const bool speculative = update.settings.is_speculative();
    const bool edges = update.settings.features == Features::edges;
    // A pair that hurries needs what its whole way passes.
    const auto is_due = [](double slack, double way) { return !(slack > 0) || !(slack > way); };
    const auto way_of = [&](std::uint32_t i, const Slack& slack) {
        return speculative ? update.motion.pair_way(update.pairs[i], double(slack.margin)) : 0;
    };
    // How much farther than the margin some vertices are asked: half the way, where a body is thinner than that.
    const auto thrown_of = [](const Slack& slack, double way) {
        const double thrown = thrown_share * way;
        return double(slack.least_exit) < thrown ? thrown : 0;
    };
    const auto wants = [&](std::uint32_t i, Slack& slack) {
        const Motion::Bound bound = update.motion.pair_bound(update.pairs[i]);
        slack.metres -= bound.moved;
        slack.edges -= bound.nearer;
        slack.points -= bound.nearer;
        if (!(slack.metres > 0) || slack.casts) return true;
        const double way = way_of(i, slack);
        return (edges && is_due(slack.edges, way))
               || (speculative && is_due(slack.points, way + thrown_of(slack, way)));
    };
    const auto ask = [&](std::uint32_t i) {
        const SlotPair& pair = update.pairs[i];
        const double speed = update.motion.pair_speed(pair);
        const double size = smaller_size(update.bodies[pair.first], update.bodies[pair.second]);
        CertifiedPair& state = table.state(i);
        Slack& slack = table.hot(i);
        const PlacedBody &a = update.bodies[pair.first], &b = update.bodies[pair.second];
        const bool may_hurry = !update.settings.paper.displacement_threshold;
        // A new pair that rests may be a question that is asked once: no list is made for steps to come.
        const bool once = !slack.known && speed == 0 && may_hurry;
        slack.known = true;
        const bool rays_valid = !slack.casts && (slack.metres > 0 || extend_rays(update, a, b, state, slack));
        if (!rays_valid && may_hurry && (once || speed > fastest * size || state.as_standard > 0)) {
            slice.as_standard.add() = i;
            if (state.as_standard > 0) --state.as_standard;
        } else if (!rays_valid) {
            check_pair(update, table, i, speed, slice);
        }
        if (!edges && !speculative) return;
        if (speculative) {
            slack.margin = static_cast<float>(1.000001 * speculative_margin(update.settings, a, b));
            slack.least_exit = std::min(a.shape->data().header.least_exit, b.shape->data().header.least_exit);
        }
        const double way = way_of(i, slack), thrown = thrown_of(slack, way);
        const DueNear due{
            i,       size, speed, speculative && is_due(slack.points, way + thrown), edges && is_due(slack.edges, way),
            way > 0, once};
        if ((due.points || due.edges) && !slack.casts && extend_near(update, a, b, state, slack, way > 0, thrown))
            return;
        if (due.points || due.edges || !slack.all) slice.near.add() = due;
    };
    table.sift(
        begin, end, [&](std::uint32_t i) { update.motion.prefetch(update.pairs[i]); }, wants, ask);
}

void DuePairs::run(const Update& update, CertifiedPairs& table) {
    const auto count = static_cast<std::uint32_t>(update.pairs.size());
    slice_count_ = (count + slice_size - 1) / slice_size;
    if (slices_.size() < slice_count_) {
        const std::size_t room = slice_count_ + slice_count_ / 2;
        rooms_ = std::make_unique_for_overwrite<Room[]>(room);
        slices_.resize(room);
    }
    update.executor.each(slice_count_, 1, [&](std::uint32_t s) {
        Slice& slice = slices_[s];
        Room& room = rooms_[s];
        slice.due = List(room.due);
        slice.places = List(room.places);
        slice.stale = List(room.stale);
        slice.as_standard = List(room.as_standard);
        slice.near = List(room.near);
        check_slice(update, table, s * slice_size, std::min((s + 1) * slice_size, count), slice);
    });
}

} // namespace raycontact
