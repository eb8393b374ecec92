// SPDX-License-Identifier: Apache-2.0
#include "contacts/touches.h"

#include "executor/row_slices.h"
#include "mesh/vector.h"

#include <raycontact/query.h>

#include <algorithm>
#include <iterator>

namespace raycontact {

namespace {

SlotPair slots_of(const Touch& touch) {
    return {touch.body_a.slot, touch.body_b.slot};
}

bool same_bodies(const Touch& one, const Touch& other) {
    return one.body_a == other.body_a && one.body_b == other.body_b;
}

bool is_there(const Touches::Step& step, BodyId body) {
    return body.slot < step.bodies.size() && step.bodies[body.slot].shape != nullptr
           && step.bodies[body.slot].generation == body.generation;
}

/// How far a point of a body goes until the next step.
Vec3 way_of(const Touches::Step& step, BodySlot slot, const Vec3& point) {
    const Pose &now = step.bodies[slot].pose, &then = step.next[slot];
    return transform_point(then, rotated_back(now.rotation, point - now.translation)) - point;
}

/// A pair that touches has lost a body, or a filter came between the two.
bool is_over(const Touches::Step& step, const Touch& touch) {
    return !is_there(step, touch.body_a) || !is_there(step, touch.body_b) || step.is_kept_apart(slots_of(touch));
}

bool may_have_moved(const Touches::Step& step, SlotChanges::Seen last, const Touch& touch) {
    return !step.moved.is_next(last) || step.moved.is_marked(touch.body_a.slot)
           || step.moved.is_marked(touch.body_b.slot);
}

/// Without a contact that touches: they tremble, or sleep, or are apart.
bool stays_without_touch(const Touches::Step& step, SlotChanges::Seen last, const Touch& touch) {
    if (is_over(step, touch)) return false;
    if (!may_have_moved(step, last, touch)) return true;
    const PlacedBody &a = step.bodies[touch.body_a.slot], &b = step.bodies[touch.body_b.slot];
    return distance(*a.shape, a.pose, *b.shape, b.pose, speculative_share * smaller_size(a, b)).has_value();
}

} // namespace

namespace {

/// Fills in the deepest contact, and whether the pair touches.
template <class Candidate>
void look(const Touches::Step& step, std::span<const Contact> contacts, bool sensor, Candidate& candidate) {
    const Contact* deepest = nullptr;
    for (const Contact& contact : contacts) {
        if (deepest == nullptr || contact.depth > deepest->depth) deepest = &contact;
        candidate.touches = candidate.touches || !contact.is_speculative();
        if (candidate.touches || sensor || step.next.empty()) continue;
        const Vec3 way =
            way_of(step, contact.body_b.slot, contact.point_b) - way_of(step, contact.body_a.slot, contact.point_a);
        candidate.touches = dot(way, contact.normal) <= double(contact.depth);
    }
    if (deepest == nullptr) return;
    candidate.has_contact = true;
    candidate.deepest = {deepest->body_a, deepest->body_b, 0.5 * (deepest->point_a + deepest->point_b),
                         deepest->normal, deepest->depth,  sensor};
}

} // namespace

void Touches::update(Executor& executor, const Step& step) {
    if (step.asked.all)
        list_all(executor, step);
    else
        list_asked(executor, step);
    executor.each(candidates_.size(), 16, [&](std::uint32_t i) {
        Candidate& c = candidates_[i];
        const auto old = std::ranges::lower_bound(all_, c.pair, {}, slots_of);
        if (old == all_.end() || slots_of(*old) != c.pair) return;
        c.old = static_cast<std::size_t>(old - all_.begin());
        if (c.has_contact && !same_bodies(c.deepest, *old)) return;
        c.stays = c.touches || stays_without_touch(step, seen_, *old);
        if (!c.stays) return;
        c.kept = c.has_contact ? c.deepest : *old;
        c.kept.sensor =
            step.bodies[c.kept.body_a.slot].is_sensor || step.bodies[c.kept.body_b.slot].is_sensor; // since then
    });
    seen_ = step.moved.now();
    replace();
}

void Touches::list_all(Executor& executor, const Step& step) {
    candidates_.clear();
    for (const bool sensor : {false, true}) {
        const std::span<const Contact> contacts = (sensor ? step.sensed : step.contacts).all();
        const RowSlices rows{contacts.size()};
        slices_.resize(std::max(slices_.size(), rows.count()));
        for (auto& slice : slices_) slice.clear();
        const auto belongs = [&](std::size_t i) { return pair_of(contacts[i]) == pair_of(contacts[i - 1]); };
        rows.each(executor, belongs, [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
            for (std::size_t next = begin; begin < end; begin = next) {
                while (++next < end && belongs(next)) {
                }
                Candidate& c = slices_[slice].emplace_back();
                c.pair = pair_of(contacts[begin]);
                look(step, contacts.subspan(begin, next - begin), sensor, c);
            }
        });
        for (const auto& slice : slices_) candidates_.insert(candidates_.end(), slice.begin(), slice.end());
    }
    if (!step.sensed.all().empty()) std::ranges::sort(candidates_, {}, &Candidate::pair);
    const std::size_t found = candidates_.size();
    for (const Touch& touch : all_) {
        const auto of_contacts = std::span(candidates_).first(found);
        if (!std::ranges::binary_search(of_contacts, slots_of(touch), {}, &Candidate::pair))
            candidates_.emplace_back().pair = slots_of(touch);
    }
    std::ranges::inplace_merge(candidates_, candidates_.begin() + std::ptrdiff_t(found), {}, &Candidate::pair);
}

void Touches::list_asked(Executor& executor, const Step& step) {
    pairs_.assign(step.asked.pairs.begin(), step.asked.pairs.end());
    pairs_.insert(pairs_.end(), step.asked.closed.begin(), step.asked.closed.end());
    for (std::size_t i = 0; i < all_.size(); ++i)
        if (hangs_[i] != 0 && (is_over(step, all_[i]) || may_have_moved(step, seen_, all_[i])))
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
void Touches::replace() {
    begun_.clear();
    ended_.clear();
    for (const Candidate& c : candidates_) {
        if (c.stays) continue;
        if (c.old != none) ended_.push_back(all_[c.old]);
        if (c.touches) begun_.push_back(c.deepest);
    }
    for (const Candidate& c : candidates_) {
        if (!c.stays) continue;
        all_[c.old] = c.kept;
        hangs_[c.old] = c.has_contact ? 0 : 1;
    }
    if (begun_.empty() && ended_.empty()) return;
    next_.clear();
    next_hangs_.clear();
    auto begun = begun_.begin();
    auto ended = ended_.begin();
    for (std::size_t i = 0; i <= all_.size(); ++i) {
        const bool last = i == all_.size();
        for (; begun != begun_.end() && (last || slots_of(*begun) <= slots_of(all_[i])); ++begun) {
            next_.push_back(*begun);
            next_hangs_.push_back(0);
        }
        if (last) break;
        if (ended != ended_.end() && slots_of(*ended) == slots_of(all_[i])) {
            ++ended;
            continue;
        }
        next_.push_back(all_[i]);
        next_hangs_.push_back(hangs_[i]);
    }
    all_.swap(next_);
    hangs_.swap(next_hangs_);
}

void Touches::rest() noexcept {
    begun_.clear();
    ended_.clear();
}

void Touches::restore(std::vector<Touch> touches) {
    rest();
    seen_ = 0;
    all_ = std::move(touches);
    hangs_.assign(all_.size(), 1); // the next step tells which do
}

} // namespace raycontact
