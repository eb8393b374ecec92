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
    free_all(placer_, edges_);
}

Update Part::update(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs) const {
    return {*device_, *executor_, shapes_, bodies, *moved_, pairs, motion_, *settings_};
}

void Part::begin(std::span<const PlacedBody> bodies, const MovedBodies& moved, std::span<const SlotPair> pairs,
                 const Settings& settings) {
    bodies_ = bodies;
    moved_ = &moved;
    pairs_ = pairs;
    settings_ = &settings;
    adopted_.clear();
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
    stats.pair_bytes += edges_.bytes();
}

DeviceWork Part::take_work() {
    DeviceWork work = device_->take_work();
    work.device = device_->info().id;
    work.pairs = pairs_.size();
    for (const auto& added : adopted_) work.pairs += added->pairs.size();
    return work;
}

} // namespace raycontact
