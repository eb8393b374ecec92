// SPDX-License-Identifier: Apache-2.0
#include "rays/certified.h"

#include "device/launch.h"
#include "free_all.h"
#include "pairs/near_edges.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <utility>

namespace raycontact {

namespace {

// Lists made at once: for all pairs of a first step they would take as much memory as all that is kept.
constexpr std::size_t lists_at_once = 1 << 15;

static_assert(SEGMENT_CANDIDATES <= 8 * sizeof(kernels::CandidateTest::casting),
              "a bit for each candidate of a segment");

std::size_t segments_of(std::uint32_t candidates) {
    return (candidates + SEGMENT_CANDIDATES - 1) / SEGMENT_CANDIDATES;
}

bool casts_all(const Update& update) {
    return update.settings.paper.caster == Caster::basic;
}

// A pair most of whose certified vertices have rays, many of them, and that moves too far for swept clearances, is left
// to `standard` for some steps: each vertex is cast anyway.
constexpr std::uint32_t steps_as_standard = 16, many_rays = 1024;

bool spares_little(const Due& due) {
    const Candidates& own = *due.own;
    return own.rays.count > many_rays && 2 * own.rays.count > VERTEX_LANES * own.count && due.radius == 0;
}

bool is_in_contact(const ByPair<kernels::LocalContact>& contacts, std::uint32_t pair) {
    return contacts.first(2 * pair) != contacts.first(2 * pair + 2);
}

// The same as in the kernel (hold.h): nothing is known of the pair's rays, and nothing will be sought.
bool is_idle(const kernels::HeldRange& held_range) {
    return held_range.count == 0 && held_range.radius <= 0 && held_range.tests_cones == 0;
}

} // namespace

void CertifiedRays::clear() {
    table_.clear();
    pool_.clear();
    edges_.clear();
    points_.clear();
    candidates_ = {};
    held_ = {};
    last_held_ = {};
}

void CertifiedRays::close(CertifiedPair& state) {
    for (Candidates& own : state.directions) {
        pool_.release({own.first, own.capacity});
        own = {};
    }
}

// Collects what the slices found, in the order of the pairs.
void CertifiedRays::list_slices() {
    stale_.clear();
    directed_.clear();
    for (DuePairs::Slice& slice : due_pairs_.slices()) {
        for (const std::uint32_t at : slice.stale) stale_.push_back({&slice, at});
        for (const std::uint32_t i : slice.as_standard) {
            if (table_.hot(i).open) close(table_.state(i));
            table_.hot(i).metres = -1;
            table_.hot(i).open = table_.hot(i).casts = false;
            directed_.insert(directed_.end(), {2 * i, 2 * i + 1});
        }
    }
    standard_count_ = directed_.size();
}

// Makes new lists for some of the stale pairs: the blocks that reach into the bounds, widened by the distance for which
// the list lasts, and that could be in contact before it expires.
void CertifiedRays::make_lists(const Update& update, RayBatch& batch, std::span<const Stale> stale) {
    Device& device = update.device;
    resize(device, stale.size(), wide_pairs_, horizons_, places_);
    for (std::size_t i = 0; i < stale.size(); ++i) {
        const Due& due = stale[i].due();
        const float horizon = static_cast<float>(due.own->expiry) + due.margin;
        horizons_.in_place()[i] = horizon;
        kernels::DirectedPair& wide = wide_pairs_.in_place()[i];
        wide = stale[i].slice->places[stale[i].at];
        widen(wide, horizon);
    }
    near_.find_now(update, wide_pairs_, stale.size(), horizons_, batch.totals, RayBatch::block_sum);
    for (std::size_t i = 0; i < stale.size(); ++i) {
        const Due& due = stale[i].due();
        Candidates& own = *due.own;
        pool_.release({own.first, own.capacity});
        own.capacity = 0; // in case the next line throws
        const RangePool::Range range = pool_.allocate(near_.host_counts()[i]);
        places_.in_place()[i] = own.first = range.first;
        own.capacity = range.capacity;
        own.count = near_.host_counts()[i];
        if (own.count == 0) { // an empty list may last longer
            const double safe = 0.99999 * double(near_.host_safe_distances()[i]) - double(due.margin);
            own.expiry = std::max(own.expiry, std::min(safe, due.longest));
        }
    }
    if (near_.blocks().size() == 0) return;
    candidates_.extend(device, pool_.end());
    launch<KernelId::begin_candidates>(device, near_.blocks().size(), near_.blocks(), near_.firsts(), places_,
                                       candidates_);
}

// Places the pairs of the batch: those left to `standard`, then those that are due, with the segments of their blocks.
void CertifiedRays::place(const Update& update) {
    std::size_t due_count = standard_count_, segment_count = 0;
    for (DuePairs::Slice& slice : due_pairs_.slices()) {
        slice.first = due_count;
        slice.segment_first = segment_count;
        due_count += slice.due.size();
        for (const Due& due : slice.due) segment_count += segments_of(due.own->count);
    }
    directed_.resize(due_count);
    resize(update.device, due_count, pairs_, held_ranges_);
    segments_.resize(update.device, segment_count);
    update.executor.each(standard_count_, 256, [&](std::uint32_t i) {
        const auto [source, target] = directed_bodies(update.bodies, update.pairs, directed_[i]);
        place_source(source, target, pairs_.in_place()[i]);
        held_ranges_.in_place()[i] = {};
    });
    due_pairs_.each_slice(update.executor, [&](const DuePairs::Slice& slice) {
        std::copy(slice.places.begin(), slice.places.end(), pairs_.in_place().begin() + std::ptrdiff_t(slice.first));
        std::size_t i = slice.first, next = slice.segment_first;
        for (const Due& due : slice.due) {
            directed_[i] = due.directed;
            for (std::uint32_t done = 0; done < due.own->count; done += SEGMENT_CANDIDATES)
                segments_.in_place()[next++] = {static_cast<std::uint32_t>(i), due.own->first + done,
                                                std::min(SEGMENT_CANDIDATES, due.own->count - done), due.now,
                                                due.margin};
            ++i;
        }
    });
}

// The rays of pairs that are left to `standard`.
void CertifiedRays::find_standard_rays(const Update& update, RayBatch& batch) {
    standard_.find_now(update, pairs_, standard_count_, {}, batch.totals, RayBatch::block_sum);
    standard_.count_rays(update, pairs_, true, batch.totals, RayBatch::ray_sum, NONE - 1);
}

void CertifiedRays::test_candidates(const Update& update, RayBatch& batch) {
    const ShapeStore::Arrays& arrays = update.arrays();
    const std::size_t count = segments_.size();
    tests_.resize(update.device, count);
    test_rays_.resize(update.device, 1, count);
    launch<KernelId::test_candidates>(update.device, count, pairs_, arrays.headers, arrays.memory, segments_,
                                      candidates_, tests_, test_rays_.values());
    test_rays_.scan(update.device, count, batch.totals, RayBatch::method_sum, NONE - 1);
}

// The rays of pairs left to `standard`, then those of blocks.
void CertifiedRays::write_rays(const Update& update, RayBatch& batch) {
    Device& device = update.device;
    device.queue().finish();
    const auto sums = batch.totals.in_place();
    check_sums(sums);
    standard_sums_ = standard_count_ > 0 ? sums[RayBatch::ray_sum] : kernels::Totals{};
    const kernels::uint first = standard_sums_.results;
    batch.count = Count(std::size_t{first} + sums[RayBatch::method_sum].results);
    batch.resize(device, batch.count.value);
    standard_.write_rays(update, batch.totals, RayBatch::ray_sum, 0, batch.rays);
    launch<KernelId::write_candidate_rays>(device, segments_.size(), first, segments_, candidates_, tests_,
                                           test_rays_.firsts(), batch.rays);
    settle(update, first);
}

// Stores what the pairs keep of this step, and tells the rays of each pair where those of the last step are and how
// wide a swept clearance to seek.
void CertifiedRays::settle(const Update& update, std::uint32_t first_ray) {
    const bool holds = !casts_all(update); // something will be known of the rays afterwards
    const auto tests = tests_.in_place();
    const auto firsts = test_rays_.firsts().in_place();
    const auto held_ranges = held_ranges_.in_place();
    due_pairs_.each_slice(update.executor, [&](DuePairs::Slice& slice) {
        std::size_t segment = slice.segment_first, i = slice.first;
        slice.blocks = 0;
        for (const Due& due : slice.due) {
            Candidates& own = *due.own;
            const std::uint32_t ray = segment < tests.size() ? first_ray + firsts[segment] : 0;
            const std::size_t end = segment + segments_of(own.count);
            kernels::HeldRange& held_range = held_ranges[i++];
            const bool held = own.rays.held + 1 == step_; // the pair was asked about in the last step, too
            held_range = {own.rays.first, held ? own.rays.count : 0, ray, due.margin, due.radius, due.tests_cones};
            // For an idle pair nothing was known and nothing is sought, so nothing is known afterwards.
            own.rays = {ray, 0, holds && !is_idle(held_range) ? step_ : 0};
            own.valid_until = own.expiry;
            for (; segment < end; ++segment) {
                own.valid_until = std::min(own.valid_until, double(tests[segment].valid_until));
                own.rays.count += tests[segment].rays;
                slice.blocks += tests[segment].blocks;
            }
            // The two directions of a pair are in one slice.
            Slack& slack = table_.hot(due.directed / 2);
            slack.metres = std::min(slack.metres, own.valid_until - double(due.now));
            slack.casts = slack.casts || own.rays.count > 0;
            if (spares_little(due)) table_.state(due.directed / 2).as_standard = steps_as_standard;
        }
    });
}

// Decides most rays by the one triangle that each can meet (docs/internals/certified.md). A certified vertex may have
// left the bounds; the kernels of both casters test that.
void CertifiedRays::decide(const Update& update, RayBatch& batch) {
    Device& device = update.device;
    if (casts_all(update)) {
        held_.resize(device, 0);
        return cast_in_full(update, batch);
    }
    const ShapeStore::Arrays& arrays = update.arrays();
    std::swap(held_, last_held_);
    held_.resize(device, batch.count.value);
    launch<KernelId::hold_rays>(device, batch.count, batch.outcomes.stride(), pairs_, held_ranges_, arrays.headers,
                                arrays.memory, batch.rays, last_held_, held_, batch.hits, batch.outcomes.values());
}

void CertifiedRays::cast(const Update& update, RayBatch& batch) {
    open_pairs_ = update.open.count();
    ++step_;
    batch.resize(update.device, 0);
    if (!table_.knows(update.open)) clear();
    table_.begin(update.open, update.slots, [this](CertifiedPair& state) {
        close(state);
        edges_.release(state);
        points_.release(state);
        state.as_standard = 0;
    });
    due_pairs_.run(update, table_);
    list_slices();
    if (stale_.empty()) {
        near_.rest();
        resize(update.device, 0, wide_pairs_, horizons_, places_);
    }
    for (std::size_t done = 0; done < stale_.size(); done += lists_at_once)
        make_lists(update, batch, std::span(stale_).subspan(done).first(std::min(lists_at_once, stale_.size() - done)));
    place(update);
    find_standard_rays(update, batch);
    test_candidates(update, batch);
    write_rays(update, batch);
    batch.pairs = &pairs_;
    batch.directed = directed_;
    decide(update, batch);
}

// What was near is sought a little farther out than it must be, since each source more is asked in every step; where
// nothing was near, far out, since a list of nothing spares all. A list that would not last some steps is not worth its
// width; nor is one that found much where nothing was before.
NearLists::Search CertifiedRays::search_of(const DueNear& due, const KeptNear& kept, bool moves, double margin) {
    const bool empty = kept.count() == 0;
    NearLists::Search search{due.pair, 0, 0, static_cast<float>(margin), 0, 0, moves, kept.reach};
    if (due.once) return search;
    double more = empty ? double(kept.reach) * std::clamp(6 * due.speed, 0.005 * due.size, 0.015 * due.size)
                        : std::clamp(6 * due.speed, 0.002 * due.size, 0.006 * due.size);
    if (more < 4 * due.speed) more = 0;
    double ahead = std::clamp(4 * due.speed, 0.02 * due.size, 0.1 * due.size);
    if (!empty) ahead = margin > 0 ? 0.003 * due.size : 0;
    if (moves) ahead = 0;
    search.margin = static_cast<float>(more);
    search.ahead = static_cast<float>(ahead);
    search.is_wide = empty && more > 0;
    return search;
}

void CertifiedRays::find_points(const Update& update, RayBatch& batch) {
    searches_.clear();
    for (const DuePairs::Slice& slice : due_pairs_.slices())
        for (const DueNear& due : slice.near) {
            const Slack& slack = table_.hot(due.pair);
            const CertifiedPair& state = table_.state(due.pair);
            if (!due.points) continue;
            searches_.push_back(search_of(due, state.points, due.moves, double(slack.margin)));
        }
    points_.find(update, searches_, table_, batch);
    for (const NearLists::Search& search : searches_)
        table_.hot(search.pair).has_points = table_.state(search.pair).points.count() > 0;
}

// What only vertices need tell is not sought: of a pair in contact edges that hide little.
void CertifiedRays::find_edges(const Update& update, const ByPair<kernels::LocalContact>& contacts, RayBatch& batch) {
    searches_.clear();
    for (const DuePairs::Slice& slice : due_pairs_.slices())
        for (const DueNear& due : slice.near) {
            Slack& slack = table_.hot(due.pair);
            const bool in_contact = is_in_contact(contacts, due.pair);
            if (!due.edges && (in_contact || slack.all)) continue;
            const auto [first, second] = update.pairs[due.pair];
            const PlacedBody &a = update.bodies[first], &b = update.bodies[second];
            CertifiedPair& state = table_.state(due.pair);
            const KeptNear before = state.edges;
            slack.apart = false;
            slack.edges = never;
            slack.all = !in_contact;
            edges_.release(state);
            if (in_contact && !hides_more(a, b, least_hidden)) continue;
            NearLists::Search& search = searches_.emplace_back(search_of(due, before, due.moves, double(slack.margin)));
            search.least = in_contact ? static_cast<float>(hidden_length(a, b)) : 0;
            const double ahead = speculative_margin(update.settings, a, b);
            if (update.settings.is_speculative() && seeks_what_hides(a, b, ahead))
                search.least_ahead = static_cast<float>(0.9999 * least_hidden_ahead(a, b, ahead));
        }
    edges_.find(update, searches_, table_, batch);
}

void CertifiedRays::count(const RayBatch& batch, StepStats& stats) const {
    std::uint64_t blocks = standard_.blocks().size();
    for (const DuePairs::Slice& slice : due_pairs_.slices()) blocks += slice.blocks;
    const std::uint64_t certified = batch.count.value - standard_sums_.results;
    stats.details.vertices += VERTEX_LANES * blocks;
    stats.details.rays += certified + standard_sums_.sums[1];
    stats.details.pairs_full += stale_.size() + standard_count_;
    stats.details.pairs_as_standard += standard_count_;
    stats.details.pairs_skipped += 2 * open_pairs_ - directed_.size();
    stats.pair_bytes += table_.bytes() + pool_.in_use() * sizeof(kernels::CandidateBlock)
                        + 2 * held_.size() * sizeof(kernels::Held) + batch.count.value * RayBatch::bytes_of_ray
                        + (directed_.size() - standard_count_) * (sizeof(Due) + sizeof(kernels::DirectedPair))
                        + directed_.size() * (sizeof(kernels::DirectedPair) + sizeof(kernels::HeldRange))
                        + segments_.size() * (sizeof(kernels::Segment) + sizeof(kernels::CandidateTest))
                        + standard_.bytes() + edges_.bytes() + points_.bytes() + near_.bytes();
}

// Not the rays held: the next step needs them.
void CertifiedRays::trim() {
    free_all(due_pairs_, searches_, stale_, directed_, pairs_, segments_, tests_, held_ranges_, test_rays_, wide_pairs_,
             horizons_, places_, near_, standard_);
    edges_.trim();
    points_.trim();
}

} // namespace raycontact
