// SPDX-License-Identifier: Apache-2.0
#include "pair_finder.h"

#include "free_all.h"

#include <algorithm>
#include <utility>

namespace raycontact {

void PairFinder::make_room(std::size_t slots) {
    if (filters_.size() < slots) filters_.resize(slots);
    world_.make_room(slots);
    box_changes_.make_room(slots);
    unlisted_.make_room(slots);
}

void PairFinder::mark(BodySlot body) noexcept {
    world_.mark(body);
    box_changes_.mark(body);
    unlisted_.mark(body);
}

void PairFinder::forget() noexcept {
    world_.forget();
    box_changes_.forget();
    unlisted_.forget();
}

void PairFinder::cut(std::size_t slots) noexcept {
    filters_.resize(std::min(slots, filters_.size()));
    filters_.shrink_to_fit();
    world_.cut(slots);
    box_changes_.cut(slots);
    unlisted_.cut(slots);
}

void PairFinder::trim() {
    world_.trim();
    broad_phase_.trim();
    box_changes_.trim();
    free_all(others_);
}

void PairFinder::remove_body(BodySlot body, const Shape& shape) {
    world_.remove_shape(shape);
    filters_[body] = {};
    mark(body);
}

void PairFinder::set_filter(BodySlot body, const BroadPhaseInput::Filter& filter) {
    if (std::exchange(filters_[body], filter) == filter) return;
    box_changes_.mark(body);
    unlisted_.mark(body);
}

void PairFinder::drop_list() noexcept {
    listed_ = 0;
    listing_part_.reset();
}

// A device walks with all bodies, the host with those that moved: where they are few, the host goes on with the pairs,
// whoever found them.
void PairFinder::find(NarrowPhase& narrow, std::span<const PlacedBody> bodies, std::span<const Pose> next,
                      OpenPairs& pairs) {
    constexpr std::size_t few_of = 16;
    const float reach = world_.reach(bodies);
    const bool stood = unlisted_.is_next(listed_) && reach == listed_reach_;
    listed_ = 0; // until they are found again
    const std::size_t count = unlisted_.list().size();
    const bool few = stood && count < bodies.size() / few_of;
    if ((!stood || count > 0) && (few || !find_on_device(narrow, bodies, next, pairs)))
        find_on_host(narrow, bodies, next, stood, pairs);
    listed_ = unlisted_.step_done();
    listed_reach_ = reach;
}

void PairFinder::find_on_host(NarrowPhase& narrow, std::span<const PlacedBody> bodies, std::span<const Pose> next,
                              bool stood, OpenPairs& pairs) {
    Executor& executor = narrow.parts().executor();
    listing_part_.reset();
    world_.update(executor, bodies, next, narrow.settings());
    const BroadPhaseInput input{world_.boxes(), filters_};
    if (!stood) return pairs.set_all(executor, broad_phase_.find(executor, world_.tree(), input));
    others_.clear();
    for (const BodySlot slot : unlisted_.list())
        if (slot < world_.boxes().size()) others_.push_back(slot);
    broad_phase_.update(executor, world_.tree(), input, others_, pairs);
}

// False: the part that would is not one that can. Where one fails, the next goes on.
bool PairFinder::find_on_device(NarrowPhase& narrow, std::span<const PlacedBody> bodies, std::span<const Pose> next,
                                OpenPairs& pairs) {
    Parts& parts = narrow.parts();
    for (;;) {
        const std::size_t first = narrow.first_part();
        if (!parts[first].can_find_pairs()) return false;
        const DeviceBroadPhase::Changes changes = box_changes_.list(parts.executor(), bodies, next, filters_, world_,
                                                                    narrow.settings(), parts[first].known_slots());
        const bool whole = std::exchange(listing_part_, std::nullopt) != first;
        DeviceBroadPhase::Found found;
        if (!parts.before_step(first, [&] { found = parts[first].find_pairs(changes, whole); })) continue;
        if (!parts[first].can_find_pairs()) return false;
        if (found.whole)
            pairs.set_all(parts.executor(), found.opened);
        else
            pairs.apply(found.opened, found.closed);
        listing_part_ = first;
        return true;
    }
}

const WorldBoxes& PairFinder::boxes(NarrowPhase& narrow, std::span<const PlacedBody> bodies,
                                    std::span<const Pose> next) {
    if (!world_.is_up_to_date()) world_.update(narrow.parts().executor(), bodies, next, narrow.settings());
    return world_;
}

} // namespace raycontact
