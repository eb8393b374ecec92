// SPDX-License-Identifier: Apache-2.0
#include "contacts/touches.h"

#include "executor/row_slices.h"
#include "free_all.h"
#include "mesh/vector.h"
#include "platform/system.h"

#include <algorithm>
#include <utility>

namespace raycontact {

namespace {

/// Of the smaller body: by how much two that touch may be apart where they touched last, and how far beside.
constexpr double apart_share = speculative_share, beside_share = 0.25;

SlotPair slots_of(const Touch& touch) {
    return {touch.body_a.slot, touch.body_b.slot};
}

Touch touch_of(const Contact& contact, bool is_sensor) {
    return {contact.body_a, contact.body_b, 0.5 * (contact.point_a + contact.point_b),
            contact.normal, contact.depth,  is_sensor};
}

Touches::Place witness_of(const Touches::Step& step, const Contact& contact) {
    const auto in_frame = [&](BodyId body, const Vec3& point) {
        const Pose& pose = step.bodies[body.slot].pose;
        return rotated_back(pose.rotation, point - pose.translation);
    };
    return {in_frame(contact.body_a, contact.point_a), in_frame(contact.body_b, contact.point_b), 0};
}

/// How far a point of a body goes until the next step.
Vec3 way_of(const Touches::Step& step, BodySlot slot, const Vec3& point) {
    const Pose &now = step.bodies[slot].pose, &then = step.next[slot];
    return transform_point(then, rotated_back(now.rotation, point - now.translation)) - point;
}

bool is_there(const Touches::Step& step, BodyId body) {
    return body.slot < step.bodies.size() && step.bodies[body.slot].shape != nullptr
           && step.bodies[body.slot].generation == body.generation;
}

} // namespace

void Touches::look(const Step& step, std::span<const Contact> contacts, bool is_sensor, Candidate& candidate) {
    candidate.is_sensor = is_sensor;
    for (const Contact& contact : contacts) {
        if (candidate.deepest == nullptr || contact.depth > candidate.deepest->depth) candidate.deepest = &contact;
        candidate.touches = candidate.touches || !contact.is_speculative();
        if (candidate.touches || is_sensor || step.next.empty()) continue;
        const Vec3 way =
            way_of(step, contact.body_b.slot, contact.point_b) - way_of(step, contact.body_a.slot, contact.point_a);
        candidate.touches = dot(way, contact.normal) <= double(contact.depth);
    }
}

bool Touches::is_over(const Step& step, const Touch& touch) {
    return !is_there(step, touch.body_a) || !is_there(step, touch.body_b) || step.is_kept_apart(slots_of(touch));
}

bool Touches::may_have_moved(const Step& step, const Touch& touch) const {
    return !step.moved.is_next(seen_) || step.moved.is_marked(touch.body_a.slot)
           || step.moved.is_marked(touch.body_b.slot);
}

// Without a contact that touches, it trembles, or sleeps, or is apart.
bool Touches::stays_near(const Step& step, std::size_t i) const {
    const Touch& touch = all_[i];
    if (is_over(step, touch)) return false;
    if (!may_have_moved(step, touch)) return true;
    const PlacedBody &a = step.bodies[touch.body_a.slot], &b = step.bodies[touch.body_b.slot];
    const Vec3 between = transform_point(b.pose, places_[i].on_b) - transform_point(a.pose, places_[i].on_a);
    const double size = smaller_size(a, b), apart = dot(between, touch.normal);
    return apart <= apart_share * size && apart >= -beside_share * size
           && length(between - apart * Vec3(touch.normal)) <= beside_share * size;
}

void Touches::update(Executor& executor, const Step& step) {
    if (step.asked.all)
        list_all(executor, step);
    else
        list_asked(executor, step);
    executor.each(candidates_.size(), 64, [&](std::uint32_t i) {
        Candidate& c = candidates_[i];
        const auto old = std::ranges::lower_bound(all_, c.pair, {}, slots_of);
        if (old == all_.end() || slots_of(*old) != c.pair) return;
        c.old = static_cast<std::size_t>(old - all_.begin());
        if (c.deepest == nullptr) {
            c.stays = stays_near(step, c.old);
        } else if (c.deepest->body_a == old->body_a && c.deepest->body_b == old->body_b) {
            const double size = smaller_size(step.bodies[c.pair.first], step.bodies[c.pair.second]);
            c.stays = c.touches || -double(c.deepest->depth) <= apart_share * size;
        }
    });
    seen_ = step.moved.now();
    replace(step);
}

void Touches::list_all(Executor& executor, const Step& step) {
    found_.clear();
    for (const bool is_sensor : {false, true}) {
        const std::span<const Contact> contacts = (is_sensor ? step.sensed : step.contacts).all();
        const RowSlices rows{contacts.size()};
        if (slices_.size() < rows.count()) slices_.resize(rows.count());
        for (auto& slice : slices_) slice.clear();
        const auto belongs = [&](std::size_t i) { return pair_of(contacts[i]) == pair_of(contacts[i - 1]); };
        rows.each(executor, belongs, [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
            for (std::size_t next = begin; begin < end; begin = next) {
                while (++next < end && belongs(next)) {
                }
                Candidate& c = slices_[slice].emplace_back();
                c.pair = pair_of(contacts[begin]);
                look(step, contacts.subspan(begin, next - begin), is_sensor, c);
            }
        });
        for (const auto& slice : slices_) found_.insert(found_.end(), slice.begin(), slice.end());
    }
    if (!step.sensed.all().empty()) std::ranges::sort(found_, {}, &Candidate::pair);
    candidates_.clear();
    auto found = found_.begin();
    for (const Touch& touch : all_) {
        while (found != found_.end() && found->pair <= slots_of(touch)) candidates_.push_back(*found++);
        if (candidates_.empty() || candidates_.back().pair != slots_of(touch))
            candidates_.emplace_back().pair = slots_of(touch);
    }
    candidates_.insert(candidates_.end(), found, found_.end());
}

void Touches::list_asked(Executor& executor, const Step& step) {
    found_.clear();
    pairs_.assign(step.asked.pairs.begin(), step.asked.pairs.end());
    pairs_.insert(pairs_.end(), step.asked.closed.begin(), step.asked.closed.end());
    for (std::size_t i = 0; i < all_.size(); ++i)
        if (places_[i].gone != 0 && (is_over(step, all_[i]) || may_have_moved(step, all_[i])))
            pairs_.push_back(slots_of(all_[i]));
    std::ranges::sort(pairs_);
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    candidates_.assign(pairs_.size(), {});
    executor.each(pairs_.size(), 64, [&](std::uint32_t i) {
        Candidate& c = candidates_[i];
        c.pair = pairs_[i];
        const auto sensed = step.sensed.of(c.pair);
        look(step, sensed.empty() ? step.contacts.of(c.pair) : sensed, !sensed.empty(), c);
    });
}

// What is not a candidate stays as it is. In place, if the same pairs touch.
void Touches::replace(const Step& step) {
    begun_.clear();
    ended_.clear();
    next_places_.clear();
    for (const Candidate& c : candidates_) {
        if (!c.stays) {
            if (c.old != none) ended_.push_back(all_[c.old]);
            if (c.touches) begun_.push_back(touch_of(*c.deepest, c.is_sensor));
            if (c.touches) next_places_.push_back(witness_of(step, *c.deepest));
        } else if (c.deepest != nullptr) {
            all_[c.old] = touch_of(*c.deepest, c.is_sensor);
            places_[c.old] = witness_of(step, *c.deepest);
        } else {
            all_[c.old].sensor = step.bodies[c.pair.first].is_sensor || step.bodies[c.pair.second].is_sensor;
            places_[c.old].gone = 1;
        }
    }
    if (begun_.empty() && ended_.empty()) return;
    const std::size_t begun_count = begun_.size();
    next_.clear();
    std::size_t begun = 0, ended = 0;
    for (std::size_t i = 0; i <= all_.size(); ++i) {
        const bool is_end = i == all_.size();
        for (; begun < begun_count && (is_end || slots_of(begun_[begun]) <= slots_of(all_[i])); ++begun) {
            next_.push_back(begun_[begun]);
            next_places_.push_back(next_places_[begun]); // behind those of all that began
        }
        if (is_end) break;
        if (ended < ended_.size() && slots_of(ended_[ended]) == slots_of(all_[i])) {
            ++ended;
            continue;
        }
        next_.push_back(all_[i]);
        next_places_.push_back(places_[i]);
    }
    next_places_.erase(next_places_.begin(), next_places_.begin() + std::ptrdiff_t(begun_count));
    all_.swap(next_);
    places_.swap(next_places_);
}

// No trim() follows a step that rests: what is much is freed here.
void Touches::rest() noexcept {
    constexpr std::size_t much = 4096;
    const bool frees = begun_.capacity() + ended_.capacity() > much;
    begun_.clear();
    ended_.clear();
    if (!frees) return;
    free_all(begun_, ended_);
    platform::trim_heap();
}

void Touches::trim() {
    free_all(next_, next_places_, pairs_, slices_, candidates_, found_);
    for (auto* list : {&all_, &begun_, &ended_}) list->shrink_to_fit();
    places_.shrink_to_fit();
}

std::uint64_t Touches::bytes() const {
    const auto held = static_cast<std::uint64_t>(std::ranges::count(places_, std::uint64_t{0}, &Place::gone));
    return 2 * held * (sizeof(Touch) + sizeof(Place)) + 3 * found_.size() * sizeof(Candidate);
}

void Touches::restore(std::vector<Touch> touches, std::vector<Place> places) {
    rest();
    seen_ = 0;
    all_ = std::move(touches);
    places_ = std::move(places);
}

} // namespace raycontact
