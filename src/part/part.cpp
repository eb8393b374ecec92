// SPDX-License-Identifier: Apache-2.0
#include "part/part.h"

#include "free_all.h"

#include <algorithm>
#include <utility>

namespace raycontact {

namespace {

const Settings before_any_step;
const SlotChanges none_moved;
const PairSlots no_pairs;

} // namespace

Part::Part(OpenDevice opened)
    : executor_(std::move(opened.executor)), device_(std::make_unique<CountingDevice>(std::move(opened.device))),
      shapes_(*device_), moved_(&none_moved), open_(&no_pairs), settings_(&before_any_step) {}

void Part::trim() {
    pipeline_.trim();
    free_all(broad_phase_, placer_, edges_);
}

// Not every method asks for the motion of bodies on every device: all begin anew without it.
void Part::forget() {
    pipeline_.forget();
    motion_ = {};
    had_none_ = false;
}

Update Part::update(std::span<const PlacedBody> bodies, const Pairs& pairs) const {
    return {*device_, *executor_, shapes_, bodies, *moved_, pairs.open, pairs.asked, pairs.slots, motion_, *settings_};
}

void Part::begin(std::span<const PlacedBody> bodies, const SlotChanges& moved, const Pairs& pairs,
                 const Settings& settings) {
    bodies_ = bodies;
    moved_ = &moved;
    open_ = &pairs.open;
    asked_ = pairs.asked;
    slots_ = pairs.slots;
    settings_ = &settings;
    adopted_.clear();
    idle_ = had_none_ && open_->count() == 0;
    // Pairs that move here with their state go on by how fast their bodies were in the last step.
    if (needs_motion(settings, device_->traits()) && !(idle_ && answers(settings) == Answers::some)) {
        motion_.update(*executor_, bodies, moved);
        if (settings.is_speculative()) motion_.expect(*executor_, bodies, moved);
    }
    if (!idle_) pipeline_.begin(update());
}

void Part::end(std::vector<Contact>& contacts) {
    had_none_ = open_->count() == 0;
    if (idle_) return contacts.clear();
    place(pipeline_.end(update()), pipeline_, contacts);
}

void Part::place(const Update& now, const Pipeline& found, std::vector<Contact>& contacts) {
    edges_.run(now, found.contacts(), found.speculative(), found.asked());
    placer_.run(*executor_, settings_->direction, now.bodies, now.pairs, found.contacts(), edges_.found(), contacts);
}

void Part::take_over(const PairList& pairs, std::vector<Contact>& contacts) {
    Adopted& added = *adopted_.emplace_back(std::make_unique<Adopted>());
    added.pairs.pairs = pairs.pairs;
    for (const SlotPair& pair : pairs.pairs) added.pairs.slots.push_back(added.open.open(pair));
    const Update now = update(bodies_, added.all());
    added.pipeline.begin(now);
    std::vector<Contact> more;
    place(added.pipeline.end(now), added.pipeline, more);
    added.open.step_done();
    pipeline_.import_state(now, pairs, added.pipeline.export_state(now, added.pairs));
    const auto old = static_cast<std::ptrdiff_t>(contacts.size());
    contacts.insert(contacts.end(), more.begin(), more.end());
    std::ranges::inplace_merge(contacts, contacts.begin() + old, {}, pair_of);
}

std::vector<std::byte> Part::export_state(std::span<const PlacedBody> bodies, const PairList& pairs) {
    return pipeline_.export_state(update(bodies, {*open_, {}, {}}), pairs);
}

void Part::import_state(std::span<const PlacedBody> bodies, const PairList& pairs, std::span<const std::byte> bytes) {
    pipeline_.import_state(update(bodies, {*open_, {}, {}}), pairs, bytes);
}

void Part::list_kept_rays(std::span<const PlacedBody> bodies, std::vector<KeptRay>& rays) {
    const auto list = [&](Pipeline& pipeline, const PairSlots& open) {
        pipeline.list_kept_rays(update(bodies, {open, {}, {}}), rays);
    };
    list(pipeline_, *open_);
    for (const auto& added : adopted_) list(added->pipeline, added->open);
}

void Part::count(StepStats& stats) const {
    pipeline_.count(update(), stats);
    for (const auto& added : adopted_) added->pipeline.count(update(bodies_, added->all()), stats);
    stats.pairs += open_->count(); // with those adopted
    stats.pair_bytes += edges_.bytes();
}

DeviceWork Part::take_work() {
    DeviceWork work = device_->take_work();
    work.device = device_->info().id;
    work.pairs = open_->count();
    return work;
}

} // namespace raycontact
