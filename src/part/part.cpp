// SPDX-License-Identifier: Apache-2.0
#include "part/part.h"

#include "free_all.h"

#include <algorithm>
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
    free_all(broad_phase_, placer_, edges_, last_, merged_);
    has_last_ = false;
}

void Part::forget() {
    pipeline_.forget();
    has_last_ = false;
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
    may_rest_ = has_last_ && knows_moves_ && can_rest(settings, device_->traits());
    seen_ = moved.now();
    if (needs_motion(settings, device_->traits())) {
        motion_.update(*executor_, bodies, moved);
        if (settings.is_speculative()) motion_.expect(*executor_, bodies, moved);
    }
    pipeline_.begin(update(bodies, pairs));
}

void Part::end(std::vector<Contact>& contacts) {
    const Update now = update(bodies_, pairs_);
    pipeline_.end(now);
    place(now, pipeline_, contacts);
    if (may_rest_) add_resting(contacts);
    // Where most bodies move, hardly a pair will rest.
    has_last_ = knows_moves_ && can_rest(*settings_, device_->traits()) && moved_->list().size() < bodies_.size() / 4;
    last_.clear();
    if (has_last_) last_ = contacts;
    may_rest_ = false; // what is asked after this is of new pairs
}

// Both are in order.
void Part::add_resting(std::vector<Contact>& contacts) {
    merged_.clear();
    auto found = contacts.begin();
    std::size_t place = 0;
    for (auto first = last_.begin(), next = first; first != last_.end(); first = next) {
        const SlotPair pair = pair_of(*first);
        while (next != last_.end() && pair_of(*next) == pair) ++next;
        while (place < pairs_.size() && pairs_[place] < pair) ++place;
        if (place == pairs_.size()) break;
        if (pairs_[place] != pair || !pipeline_.rests(update(bodies_, pairs_), place)) continue;
        const auto before = std::find_if(found, contacts.end(), [&](const Contact& c) { return pair_of(c) > pair; });
        merged_.insert(merged_.end(), found, before);
        merged_.insert(merged_.end(), first, next);
        found = before;
    }
    merged_.insert(merged_.end(), found, contacts.end());
    contacts.swap(merged_);
}

void Part::place(const Update& now, const Pipeline& found, std::vector<Contact>& contacts) {
    placer_.run(*executor_, settings_->direction, now.bodies, now.pairs, found.contacts().all(), contacts);
    if (!now.asks_near()) return;
    edges_.run(now, found.contacts(), found.speculative(), found.asked(), contacts);
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
