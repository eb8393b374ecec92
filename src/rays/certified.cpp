// SPDX-License-Identifier: Apache-2.0
#include "rays/certified.h"

#include "mesh/vector.h"
#include "pairs/displacement.h"
#include "pairs/rounding.h"
#include "shape/shape_data.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr std::uint32_t segment_size = 64; // watches; a pair of large meshes keeps every thread busy

enum Due : std::uint8_t { look_0 = 1, list_0 = 4 };

// How far beyond the bounds a new list reaches: some steps' worth between the lengths that `bench sweep` found best, on
// a pile and on fast bodies alike.
double look_ahead(const PlacedBody& a, const PlacedBody& b, double speed) {
    const double size = std::min(a.shape->data().diagonal, b.shape->data().diagonal);
    return std::max(0.015 * size,
                    std::min(0.027 * size, 24 * speed)); // in this order also for a speed that is no number
}

// Beyond some sizes of the target a float32 clock would count in steps coarser than the rounding allowed for.
double longest_clock(const PlacedBody& target) {
    return 8 * target.shape->data().diagonal;
}

} // namespace

void CertifiedRays::clear() {
    table_.clear();
    pool_.clear();
}

// Decides for each pair, in double, what must be looked at; a cheap bound first, which most pairs at rest pass.
void CertifiedRays::wake_up(Executor& executor, std::span<const PlacedBody> bodies, std::span<const Pair> pairs,
                            const Motion& motion, std::optional<double> threshold) {
    due_.resize(pairs.size());
    executor.run(static_cast<std::uint32_t>(pairs.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            due_[i] = 0;
            double& left = table_.slack(i);
            left -= motion.pair_bound(pairs[i]);
            if (left > 0) continue;
            PairState& state = table_.state(i);
            const bool fresh = state.directed[0].expiry < 0;

            const PlacedBody &a = bodies[pairs[i].first], &b = bodies[pairs[i].second];
            const PairPlace now = place_pair(a.centred, b.centred, motion.pair_shear(pairs[i]));
            std::array<double, 2> clock{0, 0};
            if (!fresh) {
                clock = displacement_bounds(state.reference, now, a.shape->data().reach, b.shape->data().reach);
                for (std::size_t d = 0; d < 2; ++d) clock[d] += state.directed[d].clock;
            }
            double slack = 1e300;
            for (std::size_t d = 0; d < 2; ++d) {
                const DirectedState& own = state.directed[d];
                // Asked so that a clock that is not a number, of bodies beyond the range of squares, is a reason to
                // look.
                if (fresh || !(clock[d] < own.expiry))
                    due_[i] |= static_cast<std::uint8_t>(list_0 << d);
                else if (!(clock[d] < own.wake))
                    due_[i] |= static_cast<std::uint8_t>(look_0 << d);
                slack = std::min(slack, std::min(own.wake, own.expiry) - clock[d]);
            }
            left = slack;
            if (due_[i] == 0) continue; // the reference stays, so that a jitter adds up to nothing
            state.reference = now;
            const double speed = motion.pair_speed(pairs[i]);
            state.speed = fresh ? speed : 0.75 * state.speed + 0.25 * speed;
            for (std::size_t d = 0; d < 2; ++d) {
                DirectedState& own = state.directed[d];
                own.clock = clock[d];
                if ((due_[i] & (list_0 << d)) == 0) continue;
                own.clock = 0;
                own.expiry =
                    threshold ? std::min(*threshold, longest_clock(d == 0 ? b : a)) : look_ahead(a, b, state.speed);
            }
        }
    });

    active_.clear();
    stale_.clear();
    for (std::uint32_t i = 0; i < pairs.size(); ++i) {
        if (due_[i] == 0) continue;
        for (std::uint32_t d = 0; d < 2; ++d) {
            if ((due_[i] & ((look_0 | list_0) << d)) == 0) continue;
            if ((due_[i] & (list_0 << d)) != 0) stale_.push_back(static_cast<std::uint32_t>(active_.size()));
            active_.push_back(2 * i + d);
        }
    }
    host_pairs_.resize(active_.size());
    margins_.resize(active_.size());
    executor.run(static_cast<std::uint32_t>(active_.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            const Pair& pair = pairs[active_[i] / 2];
            const bool from_a = active_[i] % 2 == 0;
            const PlacedBody& source = bodies[from_a ? pair.first : pair.second];
            const PlacedBody& target = bodies[from_a ? pair.second : pair.first];
            const PairPlace& place = table_.state(active_[i] / 2).reference;
            host_pairs_[i] = order_pair(source, target, from_a ? place.pose : place.pose_of_second());
            margins_[i] = static_cast<float>(rounding_margin(source, target));
        }
    });
}

// The blocks of each stale pair that reach into its bounds widened by what the list is to last.
void CertifiedRays::make_lists(Device& device, const ShapeStore& shapes) {
    const ShapeStore::Arrays& arrays = shapes.arrays();
    wide_pairs_.resize(stale_.size());
    stale_margins_.resize(stale_.size());
    for (std::size_t i = 0; i < stale_.size(); ++i) {
        wide_pairs_[i] = host_pairs_[stale_[i]];
        const DirectedState& own = directed(active_[stale_[i]]);
        stale_margins_[i] = margins_[stale_[i]];
        const float wide = static_cast<float>(own.expiry) + margins_[stale_[i]];
        for (int k = 0; k < 3; ++k) {
            wide_pairs_[i].bounds[k] -= wide;
            wide_pairs_[i].bounds[3 + k] += wide;
        }
    }
    device_wide_.write(device, wide_pairs_);
    counts_.resize(device, stale_.size());
    small_.resize(device, stale_.size());
    launch<KernelId::count_clusters>(device, stale_.size(), device_wide_, arrays.headers, arrays.clusters, counts_,
                                     small_);
    clusters_.resize(device, scan_.run(device, counts_, firsts_));
    host_counts_.resize(stale_.size());
    counts_.read(device, host_counts_);

    places_.resize(stale_.size());
    for (std::size_t i = 0; i < stale_.size(); ++i) {
        DirectedState& own = directed(active_[stale_[i]]);
        pool_.give_back({own.first, own.capacity});
        own.capacity = 0; // should the next line fail
        const RangePool::Range range = pool_.take(host_counts_[i]);
        places_[i] = own.first = range.first;
        own.capacity = range.capacity;
        own.count = host_counts_[i];
    }
    if (clusters_.size() == 0) return;
    watches_.extend(device, pool_.end());
    device_places_.write(device, places_);
    launch<KernelId::write_clusters>(device, stale_.size(), device_wide_, arrays.headers, arrays.clusters, small_,
                                     firsts_, clusters_);
    device_margins_.write(device, stale_margins_);
    launch<KernelId::begin_watches>(device, clusters_.size(), device_wide_, arrays.headers, arrays.clusters,
                                    arrays.clearances, device_margins_, clusters_, firsts_, device_places_, watches_);
}

void CertifiedRays::look(Device& device, const ShapeStore& shapes) {
    const ShapeStore::Arrays& arrays = shapes.arrays();
    host_segments_.clear();
    for (std::uint32_t i = 0; i < active_.size(); ++i) {
        DirectedState& own = directed(active_[i]);
        own.wake = own.expiry;
        for (std::uint32_t done = 0; done < own.count; done += segment_size)
            host_segments_.push_back({i, own.first + done, std::min(segment_size, own.count - done),
                                      static_cast<float>(own.clock), margins_[i]});
    }
    device_pairs_.write(device, host_pairs_);
    segments_.write(device, host_segments_);
    looks_.resize(device, host_segments_.size());
    counts_.resize(device, host_segments_.size());
    launch<KernelId::look_at_watches>(device, host_segments_.size(), device_pairs_, arrays.headers,
                                      arrays.vertex_blocks, arrays.outside_cells, arrays.clearances, segments_,
                                      watches_, looks_, counts_);
    rays_.resize(device, scan_.run(device, counts_, firsts_));
    launch<KernelId::write_watch_rays>(device, rays_.size() > 0 ? host_segments_.size() : 0, segments_, watches_,
                                       firsts_, rays_);
    host_looks_.resize(host_segments_.size());
    looks_.read(device, host_looks_);
    inside_ = blocks_ = 0;
    for (std::size_t s = 0; s < host_segments_.size(); ++s) {
        DirectedState& own = directed(active_[host_segments_[s].pair]);
        own.wake = std::min(own.wake, double(host_looks_[s].wake));
        inside_ += host_looks_[s].inside;
        blocks_ += host_looks_[s].blocks;
    }
    for (const std::uint32_t ordered : active_) {
        const PairState& state = table_.state(ordered / 2);
        table_.slack(ordered / 2) = std::min(state.directed[0].wake - state.directed[0].clock,
                                             state.directed[1].wake - state.directed[1].clock);
    }
}

void CertifiedRays::fill(Device& device, Executor& executor, const ShapeStore& shapes,
                         std::span<const PlacedBody> bodies, std::span<const Pair> pairs, const Motion& motion,
                         std::optional<double> threshold) {
    if (packed_ != shapes.packed()) clear(); // lists name vertex blocks by their place
    packed_ = shapes.packed();
    table_.match(pairs, [this](PairState& state) {
        for (const DirectedState& own : state.directed) pool_.give_back({own.first, own.capacity});
    });
    wake_up(executor, bodies, pairs, motion, threshold);
    make_lists(device, shapes);
    look(device, shapes);
}

} // namespace raycontact
