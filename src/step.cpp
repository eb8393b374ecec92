// SPDX-License-Identifier: Apache-2.0
#include "step.h"

#include <algorithm>
#include <chrono>

namespace raycontact {

NarrowPhase::NarrowPhase(const Settings& settings)
    : settings_(settings), opened_(open_device(settings.device, settings.threads)), shapes_(*opened_.device) {}

void NarrowPhase::set_settings(const Settings& settings) {
    settings_ = settings;
    forget();
}

void NarrowPhase::forget() {
    certified_.clear();
    coherent_.clear();
    local_.clear();
}

template <class Rays>
void NarrowPhase::take(const Rays& rays, std::span<const std::uint32_t> which, StepStats& stats) {
    stats.side_tests += gather_.run(device(), shapes_.arrays(), rays.pairs(), rays.rays(), rays.hits());
    local_.add(gather_.contacts(device()), rays.ordered(), which);
    rays.count(stats);
}

void NarrowPhase::standard(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, StepStats& stats) {
    local_.clear();
    standard_.fill(device(), executor(), shapes_, bodies, pairs, settings_);
    standard_.cast(device(), settings_.caster, shapes_);
    take(standard_, {}, stats);
}

// The same contacts; pairs, and blocks of vertices, that cannot touch yet are left alone.
void NarrowPhase::certified(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, StepStats& stats) {
    motion_.update(executor(), bodies);
    cast_certified(bodies, pairs, settings_.displacement_threshold);
    still_.clear();
    if (!certified_.still().empty())
        find_still_contacts(certified_.last_pairs(), local_.contacts(), pairs, certified_.still(), still_);
    local_.clear();
    take_certified(bodies, pairs, {}, stats);
    if (!still_.empty()) local_.add(still_, certified_.still());
}

void NarrowPhase::cast_certified(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                                 std::optional<double> threshold) {
    certified_.fill(device(), executor(), shapes_, bodies, pairs, motion_, threshold);
    certified_.cast(device(), executor(), settings_.caster, shapes_);
}

void NarrowPhase::take_certified(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                                 std::span<const std::uint32_t> which, StepStats& stats) {
    take(certified_, which, stats);
    if (certified_.fast().empty()) return;
    standard_.fill_near(device(), executor(), shapes_, bodies, pairs, certified_.fast());
    standard_.cast(device(), settings_.caster, shapes_);
    take(standard_, which, stats);
}

// Contacts followed from the last step, and in full for pairs that moved too far; not always those of `standard`.
void NarrowPhase::coherent(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, StepStats& stats) {
    local_.clear();
    motion_.update(executor(), bodies);
    coherent_.follow(device(), executor(), shapes_, bodies, pairs, motion_, settings_);
    take(coherent_, {}, stats);
    if (coherent_.fast().empty()) return certified_.clear(); // its pairs are those of the step before
    fast_pairs_.clear();
    for (const std::uint32_t i : coherent_.fast()) fast_pairs_.push_back(pairs[i]);
    cast_certified(bodies, fast_pairs_, std::nullopt);
    take_certified(bodies, fast_pairs_, coherent_.fast(), stats);
}

void NarrowPhase::step(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                       std::vector<Contact>& contacts, StepStats& stats) {
    const auto start = std::chrono::steady_clock::now();
    stats = {};
    try {
        if (settings_.method == Method::certified)
            certified(bodies, pairs, stats);
        else if (settings_.method != Method::standard)
            coherent(bodies, pairs, stats);
        else
            standard(bodies, pairs, stats);
        placer_.run(executor(), settings_.direction, bodies, pairs, local_.contacts(), contacts);
        changes_.mark(contacts);
    } catch (...) {
        forget(); // what a step that failed half-way kept is worth nothing
        contacts.clear();
        throw;
    }

    stats.pairs = pairs.size();
    stats.contacts = contacts.size();
    stats.contacts_new = changes_.new_count();
    stats.contacts_lost = changes_.lost().size();
    for (const Contact& contact : contacts) {
        stats.ray_length += double(contact.ray_length);
        stats.depth_max = std::max(stats.depth_max, double(contact.depth));
    }
    stats.narrow_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

} // namespace raycontact
