// SPDX-License-Identifier: Apache-2.0
#include "rays/coherent.h"

#include "device/launch.h"
#include "free_all.h"
#include "pairs/rounding.h"
#include "shape/shape_data.h"
#include "state_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace raycontact {

namespace {

/// Metres. No mesh reaches as far (Mesh: 1e9 m), so nothing is lost; and a ray that ended beyond 1e30 m would meet the
/// inverted boxes of a tree's empty lanes.
constexpr double farthest_ahead = 1e12;

// Cost of a full test that finds no rays, in rays followed; `predictive`, where following costs more, has a lower
// ratio.
constexpr double cost_of_test[] = {12, 6}; // iterative, predictive
// Share of the smaller body's diagonal: a pair that moves farther than this in a step is not worth following.
constexpr double farthest = 0.015;

// How far a pair may move before its next full test, metres, if no setting says so. A longer distance saves full tests
// but follows more rays, since it must predict farther ahead. The counted costs of both decide, by one factor at each
// test: counts, not times, so that equal input gives equal results. speed: metres a step. last: the distance of the
// last test, below 0 if there was none. test_cost: what that test cost, in rays; follows: rays followed since.
double next_threshold(const PlacedBody& a, const PlacedBody& b, double speed, double last, double test_cost,
                      double follows, bool predictive) {
    const double least = 0.001 * smaller_size(a, b), most = farthest * smaller_size(a, b);
    // Too fast to be followed: a full test in every step. (With `predictive` such pairs do not come here.)
    if (speed > most) return 0.2 * least;
    double threshold = 4 * speed;
    if (last >= least) {
        const double tests = cost_of_test[predictive ? 1 : 0] + test_cost;
        threshold = last * std::clamp(std::sqrt(tests / std::max(follows, 1e-3)), 0.5, 2.0);
    }
    return std::clamp(threshold, least, most);
}

// Whether the pair's vertices reach other triangles within a few steps: then prediction costs more than it saves.
bool is_too_fast_to_predict(const PlacedBody& a, const PlacedBody& b, double speed) {
    const double grain = std::min(a.shape->data().grain, b.shape->data().grain);
    return speed > std::min(farthest * smaller_size(a, b), 0.125 * grain);
}

} // namespace

// Decides for one pair, in double, whether it is tested in full or followed.
void CoherentRays::choose_turn(const Update& update, std::uint32_t i) {
    const SlotPair& pair = update.pairs[i];
    const Motion& motion = update.motion;
    const Settings& settings = update.settings;
    PairState& state = table_.state(i);
    auto& [left, kept] = table_.hot(i);
    const PlacedBody &a = update.bodies[pair.first], &b = update.bodies[pair.second];
    const bool predictive = settings.method == Method::predictive;
    if (predictive && !settings.paper.displacement_threshold && is_too_fast_to_predict(a, b, motion.pair_speed(pair))) {
        turns_[i] = Turn::test;
        state = {};
        state.culling = -1;
        table_.hot(i) = {};
        return;
    }
    const PairPlace now = place_pair(a.centred, b.centred, motion.pair_shear(pair));
    if (state.threshold >= 0) { // it was tested before
        const auto moved = displacement_bounds(state.reference, now, a.shape->data().reach, b.shape->data().reach);
        // The paper: a full test once the displacement exceeds the threshold, or is not a number. It is put off while
        // it would find nothing.
        const double allowed = std::max(state.threshold, state.safe);
        if (moved[0] <= allowed && moved[1] <= allowed) {
            left = allowed - std::max(moved[0], moved[1]);
            return;
        }
    }
    turns_[i] = Turn::test;
    state.reference = now;
    const double follows = double(step_ - state.tested) * (kept[0].count + kept[1].count);
    state.tested = step_;
    state.threshold = left =
        settings.paper.displacement_threshold
            ? *settings.paper.displacement_threshold
            : next_threshold(a, b, motion.pair_speed(pair), state.threshold, state.test_cost, follows, predictive);
    state.safe = state.culling = 0;
    if (predictive)
        state.culling = std::min(settings.paper.culling_distance ? *settings.paper.culling_distance
                                                                 : settings.paper.confidence * state.threshold,
                                 farthest_ahead);
}

void CoherentRays::choose_turns(const Update& update) {
    const Settings& settings = update.settings;
    const auto pair_count = static_cast<std::uint32_t>(update.pairs.size());
    const bool predictive = settings.method == Method::predictive;
    turns_.resize(pair_count);
    update.executor.run(pair_count, 256, [&](std::uint32_t begin, std::uint32_t end) {
        const auto wants = [&](std::uint32_t i, Hot& hot) {
            turns_[i] = Turn::follow;
            hot.slack -= update.motion.pair_bound(update.pairs[i]).moved;
            return !(hot.slack >= 0);
        };
        const auto prefetch = [&](std::uint32_t i) { update.motion.prefetch(update.pairs[i]); };
        table_.sift(begin, end, prefetch, wants, [&](std::uint32_t i) { choose_turn(update, i); });
    });

    directed_.clear();
    for (std::uint32_t i = 0; i < pair_count; ++i)
        if (turns_[i] == Turn::test) directed_.insert(directed_.end(), {2 * i, 2 * i + 1});
    full_count_ = directed_.size();
    for (std::uint32_t i = 0; i < pair_count; ++i)
        for (std::uint32_t d = 0; turns_[i] == Turn::follow && d < 2; ++d)
            if (table_.hot(i).kept[d].count > 0) directed_.push_back(2 * i + d);

    host_pairs_.resize(directed_.size());
    cullings_.resize(directed_.size());
    wide_pairs_.resize(full_count_);
    reaches_.resize(full_count_);
    margins_.resize(full_count_);
    update.executor.each(directed_.size(), 256, [&](std::uint32_t i) {
        const auto [source, target] = directed_bodies(update.bodies, update.pairs, directed_[i]);
        place_source(source, target, host_pairs_[i]);
        cullings_[i] = static_cast<float>(table_.state(directed_[i] / 2).culling);
        if (i >= full_count_) return;
        const float ahead = std::max(cullings_[i], 0.0F);
        const bool extended = predictive && settings.paper.distance_extension && cullings_[i] >= 0;
        wide_pairs_[i] = host_pairs_[i];
        const double extension = std::min(settings.paper.distance_extension.value_or(0), farthest_ahead);
        widen(wide_pairs_[i], extended ? static_cast<float>(extension) : ahead);
        margins_[i] = static_cast<float>(rounding_margin(source, target));
        reaches_[i] = ahead + margins_[i];
        // As in the paper: no vertex inside the bounds is known to be outside the mesh or far from it.
        if (!settings.paper.skip_outside) reaches_[i] = margins_[i] = std::numeric_limits<float>::max();
    });
}

// Pairs without a block near either surface.
void CoherentRays::skip_apart() {
    for (std::size_t i = 0; i < full_count_; i += 2) {
        PairState& state = table_.state(directed_[i] / 2);
        if (state.threshold < 0 || near_.host_counts()[i] != 0 || near_.host_counts()[i + 1] != 0) continue;
        for (std::size_t d = 0; d < 2; ++d) {
            const double safe = 0.99999 * double(near_.host_safe_distances()[i + d]) - double(margins_[i + d]);
            state.safe = d == 0 ? safe : std::min(state.safe, safe);
        }
        table_.hot(directed_[i] / 2).slack = std::max(state.threshold, state.safe);
    }
}

void CoherentRays::list_segments() {
    host_segments_.clear();
    host_firsts_.clear();
    followed_count_ = 0;
    for (std::size_t i = full_count_; i < directed_.size(); ++i) {
        const Kept& own = kept(directed_[i]);
        host_segments_.push_back({static_cast<kernels::uint>(i), own.first, own.count, 0, 0});
        host_firsts_.push_back(static_cast<kernels::uint>(followed_count_));
        followed_count_ += own.count;
    }
}

// The rays that are followed come first, as only the device knows how many full tests find: vertices in the bounds that
// could be in contact, or soon.
void CoherentRays::find_rays(const Update& update, RayBatch& batch) {
    const ShapeStore::Arrays& arrays = update.arrays();
    Device& device = update.device;
    batch.count = Count(followed_count_);
    if (full_count_ > 0) {
        const Array<float> none;
        near_.find(update, device_wide_, skips_outside_ ? device_reaches_ : none, {}, batch.totals,
                   RayBatch::block_sum);
        launch<KernelId::count_near_rays>(device, near_.found(), near_.ray_counts().stride(), device_wide_,
                                          device_reaches_, device_margins_, arrays.headers, arrays.memory,
                                          near_.blocks(), near_.ray_counts().values());
        near_.ray_counts().scan(device, near_.found(), batch.totals, RayBatch::ray_sum, batch.rays.size(),
                                followed_count_);
        launch<KernelId::write_near_rays>(device, items_of(batch.totals, RayBatch::ray_sum, near_.found().most),
                                          near_.blocks(), near_.ray_counts().firsts(), batch.rays, starts_);
        batch.count = results_of(batch.totals, RayBatch::ray_sum, batch.rays.size());
    }
    launch<KernelId::copy_cached_rays>(device, host_segments_.size(), segments_, segment_firsts_, last_cached_,
                                       batch.rays, starts_);
}

void CoherentRays::follow(const Update& update, RayBatch& batch) {
    const ShapeStore::Arrays& arrays = update.arrays();
    const Settings& settings = update.settings;
    resize(update.device, batch.rays.size(), nexts_, hows_);
    const kernels::uint predictive = settings.method == Method::predictive ? 1 : 0;
    const kernels::uint cast_lost = predictive != 0 && settings.paper.cast_lost_walks ? 1 : 0;
    const auto run = [&]<KernelId kernel>() {
        launch<kernel>(update.device, batch.count, settings.paper.max_iterations, predictive, cast_lost,
                       batch.outcomes.stride(), device_pairs_, device_cullings_, arrays.headers, arrays.memory,
                       batch.rays, starts_, batch.hits, batch.outcomes.values(), nexts_, hows_);
    };
    if (settings.paper.caster == Caster::basic)
        run.operator()<KernelId::follow_rays_basic>();
    else
        run.operator()<KernelId::follow_rays_bvh>();
}

// The cached rays of the next step, and what each pair's rays came to.
void CoherentRays::list_cached_rays(const Update& update, RayBatch& batch) {
    Device& device = update.device;
    host_ranges_.assign(2 * directed_.size(), 0);
    ranges_.write(device, host_ranges_);
    launch<KernelId::find_ranges>(device, batch.count, batch.rays, ranges_);
    followed_.resize(device, directed_.size());
    kept_counts_.resize(device, 1, directed_.size());
    cached_.resize(device, batch.rays.size());
    launch<KernelId::count_cached_rays>(device, directed_.size(), ranges_, batch.hits, nexts_, hows_, followed_,
                                        kept_counts_.values());
    kept_counts_.scan(device, directed_.size(), batch.totals, RayBatch::method_sum, cached_.size());
    launch<KernelId::write_cached_rays>(device, directed_.size(), ranges_, batch.rays, nexts_, kept_counts_.firsts(),
                                        cached_);
}

std::array<Piece, 3> CoherentRays::results() {
    host_followed_.resize(directed_.size());
    std::array<Piece, 3> pieces{followed_.piece(host_followed_)};
    if (full_count_ > 0) std::ranges::copy(near_.results(), pieces.begin() + 1);
    return pieces;
}

bool CoherentRays::had_room(Device& device, RayBatch& batch) {
    if (full_count_ == 0) return true;
    const std::size_t rays = followed_count_ + batch.sums[RayBatch::ray_sum].sums[0], room = batch.rays.size();
    const bool blocks_had = near_.had_room(device, batch.sums[RayBatch::block_sum]);
    if (rays > room) batch.resize(device, rays + rays / 2);
    return blocks_had && rays <= room;
}

void CoherentRays::keep(const RayBatch& batch) {
    if (full_count_ > 0) {
        if (skips_outside_) skip_apart();
        sums_.vertices = VERTEX_LANES * std::uint64_t{batch.sums[RayBatch::block_sum].sums[0]};
        full_rays_ = batch.sums[RayBatch::ray_sum].sums[0];
        sums_.rays = batch.sums[RayBatch::ray_sum].sums[1];
    }
    sums_.rays += followed_count_;
    kernels::uint first = 0;
    std::uint64_t cast = 0;
    for (std::size_t i = 0; i < directed_.size(); ++i) {
        const kernels::Followed& sum = host_followed_[i];
        Kept& own = kept(directed_[i]);
        own.first = first;
        own.count = sum.kept;
        if (i < full_count_) {
            double& cost = table_.state(directed_[i] / 2).test_cost;
            cost = (directed_[i] % 2 == 0 ? 0 : cost) + 2.0 * sum.cast;
        }
        first += sum.kept;
        sums_.predictions += sum.predictions;
        sums_.walks += sum.walks;
        sums_.walks_lost += sum.lost;
        cast += sum.cast;
    }
    sums_.walk_casts = cast - full_rays_;
    cached_count_ = first;
}

void CoherentRays::begin(const Update& update, RayBatch& batch) {
    constexpr std::size_t least_room = 4096; // rays
    Device& device = update.device;
    sums_ = {};
    full_rays_ = 0;
    ++step_;
    open_pairs_ = update.pairs.size();
    table_.begin(update.open, update.slots, [](PairState&) {});
    skips_outside_ = update.settings.paper.skip_outside;
    choose_turns(update);
    list_segments();
    device_pairs_.write(device, host_pairs_);
    device_cullings_.write(device, cullings_);
    device_wide_.write(device, wide_pairs_);
    device_reaches_.write(device, reaches_);
    device_margins_.write(device, margins_);
    segments_.write(device, host_segments_);
    segment_firsts_.write(device, host_firsts_);
    std::swap(cached_, last_cached_);
    batch.resize(device, std::max<std::size_t>({batch.rays.size(), least_room, followed_count_ + followed_count_ / 2}));
    batch.pairs = &device_pairs_;
    batch.directed = directed_;
    cast(update, batch);
}

void CoherentRays::cast(const Update& update, RayBatch& batch) {
    starts_.resize(update.device, batch.rays.size());
    find_rays(update, batch);
    follow(update, batch);
    list_cached_rays(update, batch);
}

std::vector<kernels::CachedRay> CoherentRays::read_cached_rays(Device& device) {
    std::vector<kernels::CachedRay> cached(cached_count_);
    const Piece piece = cached_.piece(cached);
    if (!cached.empty()) device.queue().read({&piece, 1});
    return cached;
}

// Of one direction of a pair. Without any, `first` may be of a list that is gone.
std::span<const kernels::CachedRay> CoherentRays::cached_of(const Kept& own, std::span<const kernels::CachedRay> all) {
    return own.count > 0 ? all.subspan(own.first, own.count) : all.first(0);
}

void CoherentRays::list_kept_rays(Device& device, std::span<const PlacedBody> bodies, const PairSlots& open,
                                  std::vector<KeptRay>& rays) {
    const std::vector<kernels::CachedRay> cached = read_cached_rays(device);
    for (std::uint32_t slot = 0; slot < open.end(); ++slot) {
        if (!table_.knows(open, slot)) continue;
        const SlotPair pair = open[slot];
        // A body may be gone since, and its pairs close in the next step.
        if (bodies[pair.first].shape == nullptr || bodies[pair.second].shape == nullptr) continue;
        for (std::uint32_t d = 0; d < 2; ++d) {
            const PlacedBody& source = bodies[d == 0 ? pair.first : pair.second];
            const auto& blocks = source.shape->data().vertex_blocks;
            for (const auto& [lane, triangle] : cached_of(table_.hot_in(slot).kept[d], cached))
                rays.push_back({pair, d == 0, blocks[lane / VERTEX_LANES].vertex[lane % VERTEX_LANES], triangle});
        }
    }
}

std::vector<std::byte> CoherentRays::export_state(Device& device, const PairSlots& open, const PairList& pairs) {
    std::vector<std::byte> bytes;
    const std::vector<kernels::CachedRay> cached = read_cached_rays(device);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const std::uint32_t slot = pairs.slots[i];
        if (!table_.knows(open, slot)) continue;
        Moving moving{static_cast<std::uint32_t>(i), table_.state_in(slot), table_.hot_in(slot)};
        moving.state.tested = step_ - moving.state.tested; // as long ago; every device counts its own steps
        put_bytes(bytes, moving);
        for (const Kept& own : moving.hot.kept)
            for (const kernels::CachedRay& ray : cached_of(own, cached)) put_bytes(bytes, ray);
    }
    return bytes;
}

void CoherentRays::import_state(Device& device, const PairList& pairs, std::span<const std::byte> bytes) {
    cached_.extend(device, cached_count_);
    std::vector<kernels::CachedRay> cached;
    while (!bytes.empty()) {
        auto moving = take_bytes<Moving>(bytes);
        moving.state.tested = step_ - moving.state.tested;
        for (Kept& own : moving.hot.kept) {
            own.first = static_cast<std::uint32_t>(cached_count_ + cached.size());
            for (std::uint32_t i = 0; i < own.count; ++i) cached.push_back(take_bytes<kernels::CachedRay>(bytes));
        }
        table_.import_state(pairs.pairs[moving.pair], pairs.slots[moving.pair], moving.state, moving.hot);
    }
    cached_.append(device, std::span<const kernels::CachedRay>(cached));
    cached_count_ += cached.size();
}

void CoherentRays::count(StepStats& stats) const {
    stats.details.vertices += sums_.vertices;
    stats.details.rays += sums_.rays;
    stats.details.pairs_full += full_count_;
    stats.details.pairs_skipped += 2 * open_pairs_ - directed_.size();
    stats.details.walks += sums_.walks;
    stats.details.walks_lost += sums_.walks_lost;
    stats.details.walk_casts += sums_.walk_casts;
    stats.details.predictions += sums_.predictions;
    stats.pair_bytes += table_.bytes() + turns_.size() + cached_count_ * sizeof(kernels::CachedRay)
                        + (2 * directed_.size() + 2 * full_count_) * sizeof(kernels::DirectedPair)
                        + directed_.size() * (2 * sizeof(float) + 2 * sizeof(kernels::Followed))
                        + (sums_.walks + full_rays_) * (RayBatch::bytes_of_ray + 3 * sizeof(kernels::uint))
                        + BlockSearch::bytes(sums_.vertices / VERTEX_LANES, full_count_);
}

void CoherentRays::trim() {
    free_all(turns_, directed_, host_pairs_, wide_pairs_, cullings_, reaches_, margins_, host_segments_, host_firsts_,
             host_ranges_, host_followed_, device_pairs_, device_wide_, device_cullings_, device_reaches_,
             device_margins_, kept_counts_, segment_firsts_, ranges_, starts_, nexts_, hows_, near_, segments_,
             followed_, last_cached_);
}

} // namespace raycontact
