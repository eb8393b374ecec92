// SPDX-License-Identifier: Apache-2.0
#include "part/part.h"

#include "executor/copy_all.h"
#include "executor/row_slices.h"
#include "free_all.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace raycontact {

namespace {

const Settings before_any_step;
const MovedBodies none_moved;

} // namespace

Part::Part(OpenDevice opened)
    : executor_(std::move(opened.executor)), device_(std::make_unique<CountingDevice>(std::move(opened.device))),
      shapes_(*device_), moved_(&none_moved), settings_(&before_any_step) {}

void Part::trim() {
    pipeline_.trim();
    free_all(broad_phase_, placer_, edges_, last_, merged_, stays_, ends_);
    has_last_ = false;
}

// Not every method asks for the motion of bodies on every device: all begin anew without it.
void Part::forget() {
    pipeline_.forget();
    motion_ = {};
    has_last_ = had_none_ = false;
}

Update Part::update(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs) const {
    return {*device_, *executor_, shapes_, bodies, *moved_, pairs, motion_, *settings_, may_rest_};
}

void Part::begin(std::span<const PlacedBody> bodies, const MovedBodies& moved, std::span<const SlotPair> pairs,
                 const Settings& settings) {
    bodies_ = bodies;
    moved_ = &moved;
    pairs_ = pairs;
    settings_ = &settings;
    adopted_.clear();
    knows_moves_ = moved.is_next(seen_);
    idle_ = had_none_ && pairs.empty();
    may_rest_ = !idle_ && has_last_ && knows_moves_ && can_rest(settings, device_->traits());
    seen_ = moved.now();
    // Pairs that move here with their state go on by how fast their bodies were in the last step.
    if (needs_motion(settings, device_->traits()) && !(idle_ && can_rest(settings, device_->traits()))) {
        motion_.update(*executor_, bodies, moved);
        if (settings.is_speculative()) motion_.expect(*executor_, bodies, moved);
    }
    if (!idle_) pipeline_.begin(update(bodies, pairs));
}

void Part::end(std::vector<Contact>& contacts) {
    had_none_ = pairs_.empty();
    if (idle_) return contacts.clear();
    const Update now = update(bodies_, pairs_);
    pipeline_.end(now);
    place(now, pipeline_, contacts);
    if (may_rest_) add_resting(contacts);
    // Where most bodies move, hardly a pair will rest.
    has_last_ = knows_moves_ && can_rest(*settings_, device_->traits()) && moved_->list().size() < bodies_.size() / 4;
    copy_all(*executor_, has_last_ ? std::span<const Contact>(contacts) : std::span<const Contact>(), last_);
    may_rest_ = false; // what is asked after this is of new pairs
}

// Puts the contacts of pairs that rest between those found. Both are in order; slices of the last step's hold whole
// pairs.
void Part::add_resting(std::vector<Contact>& contacts) {
    const RowSlices slices{last_.size()};
    const auto belongs = [&](std::size_t i) { return pair_of(last_[i]) == pair_of(last_[i - 1]); };
    const auto pair_at = [&](std::size_t i) { return pair_of(last_[i]); };
    const auto found_beside = [&](std::size_t begin, std::size_t end) {
        return beside(std::as_const(contacts), begin, end, last_.size(), pair_at, pair_of);
    };
    const Update now = update(bodies_, pairs_);
    stays_.resize(last_.size());
    ends_.assign(slices.count(), 0);
    slices.each(*executor_, belongs, [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
        auto place = beside(pairs_, begin, end, last_.size(), pair_at).begin();
        for (std::size_t i = begin; i < end; ++i) {
            if (i > begin && belongs(i)) {
                stays_[i] = stays_[i - 1];
            } else {
                while (place != pairs_.end() && *place < pair_of(last_[i])) ++place;
                stays_[i] = place != pairs_.end() && *place == pair_of(last_[i])
                            && pipeline_.rests(now, static_cast<std::size_t>(place - pairs_.begin()));
            }
            ends_[slice] += static_cast<std::size_t>(stays_[i]);
        }
        ends_[slice] += found_beside(begin, end).size();
    });
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
    merged_.resize(ends_.back());
    slices.each(*executor_, belongs, [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
        auto to = merged_.begin() + static_cast<std::ptrdiff_t>(slice == 0 ? 0 : ends_[slice - 1]);
        auto [found, found_end] = found_beside(begin, end);
        for (std::size_t i = begin; i < end; ++i) {
            if (stays_[i] == 0) continue;
            for (; found != found_end && pair_of(*found) < pair_of(last_[i]); ++found) *to++ = *found;
            *to++ = last_[i];
        }
        std::copy(found, found_end, to);
    });
    contacts.swap(merged_);
}

void Part::place(const Update& now, const Pipeline& found, std::vector<Contact>& contacts) {
    edges_.run(now, found.contacts(), found.speculative(), found.asked());
    placer_.run(*executor_, settings_->direction, now.bodies, now.pairs, found.contacts(), edges_.found(), contacts);
}

void Part::take_over(std::span<const SlotPair> pairs, std::vector<Contact>& contacts) {
    Adopted& added = *adopted_.emplace_back(std::make_unique<Adopted>());
    added.pairs.assign(pairs.begin(), pairs.end());
    const Update now = update(bodies_, added.pairs);
    added.pipeline.begin(now);
    std::vector<Contact> more;
    added.pipeline.end(now);
    place(now, added.pipeline, more);
    pipeline_.import_state(now, added.pipeline.export_state(now, added.pairs));
    const auto old = static_cast<std::ptrdiff_t>(contacts.size());
    contacts.insert(contacts.end(), more.begin(), more.end());
    std::ranges::inplace_merge(contacts, contacts.begin() + old, {}, pair_of);
}

std::vector<std::byte> Part::export_state(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs) {
    return pipeline_.export_state(update(bodies, pairs_), pairs);
}

void Part::import_state(std::span<const PlacedBody> bodies, std::span<const std::byte> bytes) {
    pipeline_.import_state(update(bodies, pairs_), bytes);
}

void Part::list_kept_rays(std::span<const PlacedBody> bodies, std::vector<KeptRay>& rays) {
    pipeline_.list_kept_rays(update(bodies, pairs_), rays);
    for (const auto& added : adopted_) added->pipeline.list_kept_rays(update(bodies, added->pairs), rays);
}

void Part::count(StepStats& stats) const {
    pipeline_.count(update(bodies_, pairs_), stats);
    for (const auto& added : adopted_) added->pipeline.count(update(bodies_, added->pairs), stats);
    stats.pair_bytes += edges_.bytes() + last_.size() * sizeof(Contact);
}

DeviceWork Part::take_work() {
    DeviceWork work = device_->take_work();
    work.device = device_->info().id;
    work.pairs = pairs_.size();
    for (const auto& added : adopted_) work.pairs += added->pairs.size();
    return work;
}

} // namespace raycontact
