// SPDX-License-Identifier: Apache-2.0
#include "rays/certified.h"

#include "pairs/displacement.h"
#include "pairs/rounding.h"
#include "rays/cast_standard.h"
#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr std::uint32_t slice_size = 128;                              // pairs
constexpr std::uint32_t segment_rays = SEGMENT_WATCHES * VERTEX_LANES; // as many as its watches could have
static_assert(SEGMENT_WATCHES <= 8 * sizeof(kernels::Look::casting), "a bit for each watch of a segment");

double size_of(const PlacedBody& a, const PlacedBody& b) {
    return std::min(a.shape->data().diagonal, b.shape->data().diagonal);
}

// How far beyond the bounds a new list reaches: some steps' worth between the lengths that `bench sweep` found best, on
// a pile and on fast bodies alike.
double look_ahead(double size, double speed) {
    return std::max(0.015 * size,
                    std::min(0.027 * size, 24 * speed)); // in this order also for a speed that is no number
}

// A list made at this speed, of the smaller size a step, would not last long enough to pay for itself.
constexpr double fastest = 0.006;
// The reference pose is moved once the pair is this far from it, of the smaller size.
constexpr double trembling = 0.001;
// How fast it may be for rays to go on from triangle to triangle, of the smaller size a step.
constexpr double unhurried = 0.0025;
// How fast a pair may be for tubes to be sought, of their radius a step.
constexpr double slow = 0.15;

// Beyond some sizes of the target a float32 clock would count in steps coarser than the rounding allowed for.
double longest_clock(const PlacedBody& target) {
    return 8 * target.shape->data().diagonal;
}

// A direction's segments are of its watches, where they are looked at, else of its rays.
constexpr std::uint32_t segment_size(bool look) {
    return look ? SEGMENT_WATCHES : segment_rays;
}
std::size_t segments_of(bool look, std::uint32_t watches, std::uint32_t rays) {
    const std::uint32_t most = segment_size(look);
    return ((look ? watches : rays) + most - 1) / most;
}

// As the kernel asks: nothing is known of the pair's rays, and nothing is to be sought.
bool is_idle(const kernels::Holder& holder) {
    return holder.count == 0 && holder.radius <= 0 && holder.asks_caps == 0;
}

} // namespace

// Where they lay is not known any more: the watches have to be asked again.
void CertifiedRays::forget_rays(PairState& state) {
    for (std::size_t d = 0; d < 2; ++d) {
        if (state.rays[d].count == 0) continue;
        state.rays[d].count = 0;
        state.watched[d].wake = -1;
    }
}

CertifiedRays::Slice::Slice() {
    due.reserve(std::size_t{2} * slice_size);
    ordered.reserve(std::size_t{2} * slice_size);
    pairs.reserve(std::size_t{2} * slice_size);
    stale.reserve(std::size_t{2} * slice_size);
    fast.reserve(slice_size);
    still.reserve(slice_size);
}

void CertifiedRays::Slice::clear() {
    due.clear();
    ordered.clear();
    pairs.clear();
    stale.clear();
    fast.clear();
    still.clear();
    segments = 0;
}

void CertifiedRays::clear() {
    table_.clear();
    pool_.clear();
}

void CertifiedRays::close(PairState& state) {
    for (Watched& own : state.watched) {
        pool_.give_back({own.first, own.capacity});
        own = {};
    }
    state.rays[0] = state.rays[1] = {};
}

// Of one direction in this step, all but what a look at its watches takes.
CertifiedRays::Due& CertifiedRays::add_due(std::uint32_t ordered, const PlacedBody& source, const PlacedBody& target,
                                           double speed, const PairPlace& now, Slice& slice) {
    const std::size_t d = ordered % 2;
    PairState& state = table_.state(ordered / 2);
    slice.ordered.push_back(ordered);
    Due& due = slice.due.emplace_back();
    due.own = &state.watched[d];
    due.rays = &state.rays[d];
    due.last = state.rays[d];
    due.margin = static_cast<float>(rounding_margin(source, target));
    const double size = size_of(source, target);
    const double radius = HeldRays::tube_radius(size, target.shape->data());
    due.radius = speed < slow * radius ? static_cast<float>(radius) : 0;
    due.asks_caps = speed < unhurried * size ? target.shape->data().header.caps_pay : 0;
    order_pair(source, target, d == 0 ? now.pose : now.pose_of_second(), slice.pairs.emplace_back());
    return due;
}

// By the cheap bound nothing of the pair needs to be looked at, but it has rays.
void CertifiedRays::repeat_pair(std::uint32_t i, std::span<const PlacedBody> bodies, const SlotPair& pair, double shear,
                                double speed, Slice& slice) {
    const PlacedBody* body[2] = {&bodies[pair.first], &bodies[pair.second]};
    const PairPlace now = place_pair(body[0]->centred, body[1]->centred, shear);
    for (std::uint32_t d = 0; d < 2; ++d)
        if (table_.state(i).rays[d].count > 0) add_due(2 * i + d, *body[d], *body[1 - d], speed, now, slice);
}

// Decides for one pair, in double, what must be looked at.
void CertifiedRays::wake_pair(std::uint32_t i, std::span<const PlacedBody> bodies, const SlotPair& pair, double shear,
                              double speed, std::optional<double> threshold, Slice& slice) {
    PairState& state = table_.state(i);
    const PlacedBody* body[2] = {&bodies[pair.first], &bodies[pair.second]};
    const double size = size_of(*body[0], *body[1]);
    const bool fresh = state.watched[0].expiry < 0;
    const PairPlace now = place_pair(body[0]->centred, body[1]->centred, shear);
    std::array<double, 2> moved{0, 0};
    if (!fresh)
        moved = displacement_bounds(state.reference, now, body[0]->shape->data().reach, body[1]->shape->data().reach);
    bool look[2] = {}, list[2] = {};
    if (table_.hot(i).still) forget_rays(state);
    Slack hot{1e300, true, false, false};
    for (std::size_t d = 0; d < 2; ++d) {
        const Watched& own = state.watched[d];
        const double clock = own.clock + moved[d];
        // Asked so that a clock that is not a number, of bodies beyond the range of squares, is a reason to look.
        list[d] = fresh || !(clock < own.expiry);
        look[d] = list[d] || !(clock < own.wake);
        if (look[d]) continue;
        hot.metres = std::min(hot.metres, std::min(own.wake, own.expiry) - clock);
        hot.casts = hot.casts || state.rays[d].count > 0;
    }
    table_.hot(i) = hot;
    const bool looks = look[0] || look[1];
    if (!looks && !hot.casts) return;

    if (list[0] || list[1]) state.speed = fresh ? speed : 0.75 * state.speed + 0.25 * speed;
    const bool move = list[0] || list[1] || (looks && !(std::max(moved[0], moved[1]) < trembling * size));
    if (move) state.reference = now;
    for (std::uint32_t d = 0; d < 2; ++d) {
        Watched& own = state.watched[d];
        if (move) {
            own.clock += moved[d];
            moved[d] = 0;
        }
        if (list[d]) {
            own.clock = 0;
            own.expiry = threshold ? std::min(*threshold, longest_clock(*body[1 - d])) : look_ahead(size, state.speed);
            slice.stale.push_back(static_cast<std::uint32_t>(slice.due.size()));
        }
        if (!look[d] && state.rays[d].count == 0) continue;
        Due& due = add_due(2 * i + d, *body[d], *body[1 - d], speed, now, slice);
        due.look = look[d];
        due.now = static_cast<float>(own.clock + moved[d]);
        due.from = static_cast<float>(own.clock - moved[d]);
        due.longest = longest_clock(*body[1 - d]);
        due.expiry = own.expiry;
        due.first = own.first;
        due.count = list[d] ? 0 : own.count; // until there is a new list
    }
}

// A cheap bound first, which most pairs at rest pass.
void CertifiedRays::wake_slice(std::uint32_t begin, std::uint32_t end, std::span<const PlacedBody> bodies,
                               std::span<const SlotPair> pairs, const Motion& motion, std::optional<double> threshold,
                               Slice& slice) {
    const auto wants = [&](std::uint32_t i, Slack& slack) {
        slack.metres -= motion.pair_bound(pairs[i]);
        const bool sleeps = slack.metres > 0;
        if (sleeps && !slack.casts) return Wanted::nothing;
        if (slack.lists && motion.is_still(pairs[i])) {
            slack.still = true;
            slice.still.push_back(i);
            return Wanted::nothing;
        }
        return sleeps && !slack.still ? Wanted::head : Wanted::all;
    };
    const auto ask = [&](std::uint32_t i, Wanted wanted) {
        const SlotPair& pair = pairs[i];
        const double speed = motion.pair_speed(pair), shear = motion.pair_shear(pair);
        if (wanted == Wanted::head)
            repeat_pair(i, bodies, pair, shear, speed, slice);
        else if (!threshold && speed > fastest * size_of(bodies[pair.first], bodies[pair.second]))
            slice.fast.push_back(i);
        else
            wake_pair(i, bodies, pair, shear, speed, threshold, slice);
    };
    table_.sift(
        begin, end, [&](std::uint32_t i) { motion.prefetch(pairs[i]); }, wants, ask);
}

template <class Work>
void CertifiedRays::each_slice(Executor& executor, std::uint32_t grain, Work&& work) {
    executor.run(slice_count_, grain, [&](std::uint32_t begin, std::uint32_t end) {
        for (Slice& slice : std::span(slices_).subspan(begin, end - begin)) work(slice);
    });
}

void CertifiedRays::wake_up(Executor& executor, std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                            const Motion& motion, std::optional<double> threshold) {
    const auto count = static_cast<std::uint32_t>(pairs.size());
    slice_count_ = (count + slice_size - 1) / slice_size;
    if (slices_.size() < slice_count_) slices_.resize(slice_count_);
    each_slice(executor, 1, [&](Slice& slice) {
        const auto begin = static_cast<std::uint32_t>(&slice - slices_.data()) * slice_size;
        slice.clear();
        wake_slice(begin, std::min(begin + slice_size, count), bodies, pairs, motion, threshold, slice);
        for (const Due& due : slice.due) slice.segments += segments_of(due.look, due.count, due.last.count);
    });
    list_stale();
}

// What the slices found that is to be done before the rest, in the order of the pairs.
void CertifiedRays::list_stale() {
    stale_.clear();
    fast_.clear();
    still_.clear();
    for (Slice& slice : std::span(slices_).first(slice_count_)) {
        for (const std::uint32_t at : slice.stale) stale_.push_back({&slice, at});
        for (const std::uint32_t i : slice.fast) {
            if (table_.hot(i).lists) close(table_.state(i));
            table_.hot(i) = {};
            fast_.insert(fast_.end(), {2 * i, 2 * i + 1});
        }
        for (const std::uint32_t i : slice.still) still_.insert(still_.end(), {2 * i, 2 * i + 1});
    }
}

// What is due, in the order of the pairs, and the segments that are to be looked at or repeated.
void CertifiedRays::gather(Device& device, Executor& executor) {
    std::size_t due_count = 0, segment_count = 0;
    for (Slice& slice : std::span(slices_).first(slice_count_)) {
        slice.first = due_count;
        slice.segment_first = segment_count;
        due_count += slice.due.size();
        segment_count += slice.segments;
    }
    active_.resize(due_count);
    const auto pairs = pairs_.fill(device, due_count);
    const auto segments = segments_.fill(device, segment_count);
    each_slice(executor, 8, [&](const Slice& slice) {
        const auto at = static_cast<std::ptrdiff_t>(slice.first);
        std::copy(slice.ordered.begin(), slice.ordered.end(), active_.begin() + at);
        std::copy(slice.pairs.begin(), slice.pairs.end(), pairs.begin() + at);
        auto i = static_cast<std::uint32_t>(slice.first);
        std::size_t next = slice.segment_first;
        for (const Due& due : slice.due) {
            const std::uint32_t all = due.look ? due.count : due.last.count;
            const std::uint32_t most = segment_size(due.look);
            for (std::uint32_t done = 0; done < all; done += most) {
                const std::uint32_t some = std::min(most, all - done);
                segments[next++] = due.look
                                       ? kernels::Segment{i, due.first + done, some, due.now, due.from, due.margin, 0}
                                       : kernels::Segment{i, due.last.first + done, 0, 0, 0, 0, some};
            }
            ++i;
        }
    });
    pairs_.send(device);
    segments_.send(device);
}

// The blocks of each stale pair that reach into its bounds widened by what the list is to last, and could be in contact
// before it ends.
void CertifiedRays::make_lists(Device& device, const ShapeStore& shapes) {
    const ShapeStore::Arrays& arrays = shapes.arrays();
    const auto wide = wide_pairs_.fill(device, stale_.size());
    const auto margins = margins_.fill(device, stale_.size());
    const auto horizons = horizons_.fill(device, stale_.size());
    for (std::size_t i = 0; i < stale_.size(); ++i) {
        const Due& due = stale_[i].due();
        wide[i] = stale_[i].slice->pairs[stale_[i].at];
        margins[i] = due.margin;
        horizons[i] = static_cast<float>(due.expiry) + due.margin;
        widen(wide[i], horizons[i]);
    }
    wide_pairs_.send(device);
    margins_.send(device);
    horizons_.send(device);
    finder_.find_near(device, arrays, wide_pairs_.array(), horizons_.array());
    host_counts_.resize(stale_.size());
    host_clears_.resize(stale_.size());
    finder_.counts().read(device, host_counts_);
    finder_.clears().read(device, host_clears_);

    const auto places = places_.fill(device, stale_.size());
    for (std::size_t i = 0; i < stale_.size(); ++i) {
        Due& due = stale_[i].due();
        Watched& own = *due.own;
        pool_.give_back({own.first, own.capacity});
        own.capacity = 0; // should the next line fail
        const RangePool::Range range = pool_.take(host_counts_[i]);
        places[i] = due.first = own.first = range.first;
        own.capacity = range.capacity;
        due.count = own.count = host_counts_[i];
        stale_[i].slice->segments += segments_of(true, due.count, 0);
        if (own.count == 0) { // nothing to look at for longer than was asked
            const double clear = 0.99999 * double(host_clears_[i]) - double(due.margin);
            due.expiry = own.expiry = std::max(own.expiry, std::min(clear, due.longest));
        }
    }
    if (finder_.blocks().size() == 0) return;
    watches_.extend(device, pool_.end());
    places_.send(device);
    launch<KernelId::begin_watches>(device, finder_.blocks().size(), wide_pairs_.array(), arrays.headers,
                                    arrays.clusters, arrays.clearances, margins_.array(), finder_.blocks(),
                                    finder_.firsts(), places_.array(), watches_);
}

void CertifiedRays::look(Device& device, const ShapeStore& shapes) {
    const ShapeStore::Arrays& arrays = shapes.arrays();
    const std::size_t count = segments_.size();
    looks_.resize(device, count);
    counts_.resize(device, count);
    launch<KernelId::look_at_watches>(device, count, pairs_.array(), arrays.headers, arrays.vertex_blocks,
                                      arrays.clearances, segments_.array(), watches_, looks_.array(), counts_);
    std::swap(rays_, last_rays_);
    if (last_rays_.size() == 0) last_rays_.resize(device, 1); // an argument is never nothing
    rays_.resize(device, scan_.run(device, counts_, firsts_.array()));
    launch<KernelId::write_watch_rays>(device, rays_.size() > 0 ? count : 0, segments_.array(), watches_,
                                       looks_.array(), last_rays_, firsts_.array(), rays_);
}

// What the pairs keep of this step, and what their rays are told of the last: where each lay, and how wide a tube may
// be sought. held: something will be known of them afterwards.
void CertifiedRays::settle(Device& device, Executor& executor, bool held) {
    const auto holders = holders_.fill(device, active_.size());
    const auto looks = looks_.read(device);
    const auto firsts = firsts_.read(device);
    each_slice(executor, 8, [&](Slice& slice) {
        std::size_t segment = slice.segment_first;
        slice.blocks = 0;
        for (std::size_t i = 0; i < slice.due.size(); ++i) {
            const Due& due = slice.due[i];
            const std::size_t own = segments_of(due.look, due.count, due.last.count);
            Found found = add_up(looks.subspan(segment, own));
            if (segment < looks.size()) found.ray_first = firsts[segment];
            segment += own;
            slice.blocks += found.blocks;
            settle_one(slice.ordered[i], due, found, held, holders[slice.first + i]);
        }
    });
    holders_.send(device);
}

CertifiedRays::Found CertifiedRays::add_up(std::span<const kernels::Look> looks) {
    Found found;
    for (const kernels::Look& look : looks) {
        found.wake = std::min(found.wake, double(look.wake));
        found.rays += look.rays;
        found.blocks += look.blocks;
    }
    return found;
}

void CertifiedRays::settle_one(std::uint32_t ordered, const Due& due, const Found& found, bool held,
                               kernels::Holder& holder) {
    holder = {due.last.first, due.last.held ? due.last.count : 0, found.ray_first, due.margin, due.radius,
              due.asks_caps};
    due.rays->first = found.ray_first;
    // Of a pair that is too fast to be sought for, and of which nothing was known, nothing is known now either.
    due.rays->held = held && !is_idle(holder);
    if (!due.look) return;
    due.rays->count = found.rays;
    due.own->wake = std::min(found.wake, due.expiry);
    // The two directions of a pair are in one slice.
    Slack& slack = table_.hot(ordered / 2);
    slack.metres = std::min(slack.metres, due.own->wake - double(due.now));
    slack.casts = slack.casts || found.rays > 0;
}

void CertifiedRays::cast(Device& device, Executor& executor, Caster caster, const ShapeStore& shapes) {
    const bool held = caster != Caster::basic;
    settle(device, executor, held);
    if (held) {
        held_.cast(device, shapes.arrays(), pairs_.array(), rays_, holders_.array(), hits_);
        cast_ = held_.cast_in_full();
        return;
    }
    // Of the two, only this one asks for the bounds, which a vertex of ours may have left.
    cast_standard(device, Caster::basic, shapes.arrays(), pairs_.array(), rays_, hits_);
    cast_ = rays_.size();
    held_.forget(device);
}

void CertifiedRays::fill(Device& device, Executor& executor, const ShapeStore& shapes,
                         std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, const Motion& motion,
                         std::optional<double> threshold) {
    if (packed_ != shapes.packed()) clear(); // lists name vertex blocks by their place
    packed_ = shapes.packed();
    open_pairs_ = pairs.size();
    table_.match(pairs, [this](PairState& state) { close(state); });
    wake_up(executor, bodies, pairs, motion, threshold);
    make_lists(device, shapes);
    gather(device, executor);
    look(device, shapes);
}

void CertifiedRays::count(StepStats& stats) const {
    for (const Slice& slice : std::span(slices_).first(slice_count_)) stats.vertices += VERTEX_LANES * slice.blocks;
    stats.rays += rays_.size();
    stats.rays_cast += cast_;
    stats.pairs_full += stale_.size();
    stats.pairs_asleep += 2 * open_pairs_ - active_.size() - fast_.size();
    stats.pair_bytes +=
        table_.bytes() + pool_.in_use() * sizeof(kernels::Watch) + rays_.size() * sizeof(kernels::Ray) + held_.bytes();
}

} // namespace raycontact
