// SPDX-License-Identifier: Apache-2.0
#include "step.h"

#include "rays/standard.h"

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
}

// Every vertex in the other body's bounds casts its ray, unless a grid knows that it is outside.
void NarrowPhase::standard(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, StepStats& stats) {
    Device& on = device();
    order_pairs(executor(), bodies, pairs, ordered_);
    device_pairs_.write(on, ordered_);
    const bool use_grid = settings_.skip_outside && settings_.caster != Caster::basic;
    queue_.fill(on, shapes_.arrays(), device_pairs_, use_grid);
    cast_standard(on, settings_.caster, shapes_.arrays(), device_pairs_, queue_.rays(), hits_, use_grid);
    stats.side_tests = gather_.run(on, shapes_.arrays(), device_pairs_, queue_.rays(), hits_, local_);
    stats.vertices = queue_.vertices_tested();
    stats.rays = queue_.vertices_inside();
    stats.rays_cast = queue_.rays().size();
    stats.pairs_full = 2 * pairs.size();
}

// The same contacts; pairs, and blocks of vertices, that cannot touch yet are left alone.
void NarrowPhase::certified(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, StepStats& stats) {
    Device& on = device();
    motion_.update(executor(), bodies);
    certified_.fill(on, executor(), shapes_, bodies, pairs, motion_, settings_.displacement_threshold);
    cast_standard(on, settings_.caster, shapes_.arrays(), certified_.pairs(), certified_.rays(), hits_);
    stats.side_tests = gather_.run(on, shapes_.arrays(), certified_.pairs(), certified_.rays(), hits_, local_);
    for (kernels::LocalContact& contact : local_) contact.pair = certified_.ordered()[contact.pair];
    stats.vertices = certified_.vertices_tested();
    stats.rays = certified_.vertices_inside();
    stats.rays_cast = certified_.rays().size();
    stats.pairs_full = certified_.full_looks();
    stats.pairs_asleep = 2 * pairs.size() - certified_.ordered().size();
    stats.pair_bytes = certified_.bytes();
}

// Contacts followed from the last step, and in full for pairs that moved too far; not always those of `standard`.
void NarrowPhase::coherent(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, StepStats& stats) {
    Device& on = device();
    motion_.update(executor(), bodies);
    coherent_.follow(on, executor(), shapes_, bodies, pairs, motion_, settings_);
    stats.side_tests = gather_.run(on, shapes_.arrays(), coherent_.pairs(), coherent_.rays(), coherent_.hits(), local_);
    // Two runs, pairs looked at in full and followed ones, each in the order of the pairs.
    for (kernels::LocalContact& contact : local_) contact.pair = coherent_.ordered()[contact.pair];
    const auto by_pair = [](const auto& a, const auto& b) { return a.pair < b.pair; };
    const auto second = std::is_sorted_until(local_.begin(), local_.end(), by_pair);
    merged_.resize(local_.size());
    std::merge(local_.begin(), second, second, local_.end(), merged_.begin(), by_pair);
    local_.swap(merged_);
    coherent_.count(stats);
}

void NarrowPhase::step(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, std::vector<Contact>& contacts,
                       StepStats& stats) {
    const auto start = std::chrono::steady_clock::now();
    stats = {};
    try {
        if (settings_.method == Method::certified)
            certified(bodies, pairs, stats);
        else if (settings_.method != Method::standard)
            coherent(bodies, pairs, stats);
        else
            standard(bodies, pairs, stats);
    } catch (...) {
        forget(); // what a step that failed half-way kept is worth nothing
        throw;
    }
    place_contacts(executor(), settings_.direction, bodies, pairs, local_, contacts);
    changes_.mark(contacts);

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
