// SPDX-License-Identifier: Apache-2.0
#include "step.h"

#include "pairs/rounding.h"
#include "rays/standard.h"

#include <algorithm>
#include <chrono>

namespace raycontact {

namespace {

bool by_pair(const kernels::LocalContact& a, const kernels::LocalContact& b) {
    return a.pair < b.pair;
}

} // namespace

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

// From places in a list of ordered pairs to 2 x pair + direction.
void NarrowPhase::rename(std::vector<kernels::LocalContact>& contacts, std::span<const std::uint32_t> ordered) {
    for (kernels::LocalContact& contact : contacts) contact.pair = ordered[contact.pair];
}

// Makes one of two runs, the second beginning there.
void NarrowPhase::merge(std::vector<kernels::LocalContact>& contacts, std::size_t second) {
    const auto middle = contacts.begin() + static_cast<std::ptrdiff_t>(second);
    merged_.resize(contacts.size());
    std::merge(contacts.begin(), middle, middle, contacts.end(), merged_.begin(), by_pair);
    contacts.swap(merged_);
}

void NarrowPhase::add(std::vector<kernels::LocalContact>& contacts, std::span<const kernels::LocalContact> others) {
    const std::size_t second = contacts.size();
    contacts.insert(contacts.end(), others.begin(), others.end());
    merge(contacts, second);
}

// Every vertex in the other body's bounds casts its ray, unless a grid knows that it is outside.
void NarrowPhase::cast_whole(std::vector<kernels::LocalContact>& contacts, StepStats& stats) {
    Device& on = device();
    device_pairs_.write(on, ordered_);
    const bool use_grid = settings_.skip_outside && settings_.caster != Caster::basic;
    queue_.fill(on, shapes_.arrays(), device_pairs_, use_grid);
    cast_queue(use_grid, contacts, stats);
}

void NarrowPhase::cast_near(std::span<const PlacedBody> bodies, std::span<const Pair> pairs,
                            std::span<const std::uint32_t> which, std::vector<kernels::LocalContact>& contacts,
                            StepStats& stats) {
    Device& on = device();
    order_pairs(executor(), bodies, pairs, which, ordered_);
    margins_.resize(which.size());
    executor().run(static_cast<std::uint32_t>(which.size()), 256, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            const Pair& pair = pairs[which[i] / 2];
            const bool from_a = which[i] % 2 == 0;
            const PlacedBody& source = bodies[from_a ? pair.first : pair.second];
            const PlacedBody& target = bodies[from_a ? pair.second : pair.first];
            // Of few blocks it is not worth asking which are near.
            const bool few = source.shape->data().header.vertex_block_count <= SMALL_BLOCKS;
            margins_[i] = few ? -1.0f : static_cast<float>(rounding_margin(source, target));
        }
    });
    device_pairs_.write(on, ordered_);
    device_margins_.write(on, margins_);
    queue_.fill_near(on, shapes_.arrays(), device_pairs_, device_margins_);
    cast_queue(true, contacts, stats);
}

void NarrowPhase::cast_queue(bool near, std::vector<kernels::LocalContact>& contacts, StepStats& stats) {
    Device& on = device();
    cast_standard(on, settings_.caster, shapes_.arrays(), device_pairs_, queue_.rays(), hits_, near);
    stats.side_tests += gather_.run(on, shapes_.arrays(), device_pairs_, queue_.rays(), hits_, contacts);
    stats.vertices += queue_.vertices_tested();
    stats.rays += queue_.vertices_inside();
    stats.rays_cast += queue_.rays().size();
    stats.pairs_full += ordered_.size();
}

void NarrowPhase::standard(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, StepStats& stats) {
    order_pairs(executor(), bodies, pairs, ordered_);
    cast_whole(local_, stats);
}

// The same contacts; pairs, and blocks of vertices, that cannot touch yet are left alone.
void NarrowPhase::certified(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, StepStats& stats) {
    motion_.update(executor(), bodies);
    cast_certified(bodies, pairs, settings_.displacement_threshold, local_, stats);
}

void NarrowPhase::cast_certified(std::span<const PlacedBody> bodies, std::span<const Pair> pairs,
                                 std::optional<double> threshold, std::vector<kernels::LocalContact>& contacts,
                                 StepStats& stats) {
    Device& on = device();
    certified_.fill(on, executor(), shapes_, bodies, pairs, motion_, threshold);
    certified_.cast(on, settings_.caster, shapes_);
    stats.side_tests +=
        gather_.run(on, shapes_.arrays(), certified_.pairs(), certified_.rays(), certified_.hits(), contacts);
    rename(contacts, certified_.ordered());
    stats.vertices += certified_.vertices_tested();
    stats.rays += certified_.vertices_inside();
    stats.rays_cast += certified_.rays_cast();
    stats.pairs_full += certified_.full_looks();
    stats.pairs_asleep += 2 * pairs.size() - certified_.ordered().size() - certified_.fast().size();
    stats.pair_bytes += certified_.bytes();
    if (certified_.fast().empty()) return;

    cast_near(bodies, pairs, certified_.fast(), near_, stats);
    rename(near_, certified_.fast());
    add(contacts, near_);
}

// Contacts followed from the last step, and in full for pairs that moved too far; not always those of `standard`.
void NarrowPhase::coherent(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, StepStats& stats) {
    Device& on = device();
    motion_.update(executor(), bodies);
    coherent_.follow(on, executor(), shapes_, bodies, pairs, motion_, settings_);
    stats.side_tests +=
        gather_.run(on, shapes_.arrays(), coherent_.pairs(), coherent_.rays(), coherent_.hits(), local_);
    // Two runs, pairs looked at in full and followed ones, each in the order of the pairs.
    rename(local_, coherent_.ordered());
    const auto second = std::is_sorted_until(local_.begin(), local_.end(), by_pair);
    merge(local_, static_cast<std::size_t>(second - local_.begin()));
    coherent_.count(stats);

    if (coherent_.fast().empty()) return certified_.clear(); // its pairs are those of the step before
    fast_pairs_.clear();
    for (const std::uint32_t i : coherent_.fast()) fast_pairs_.push_back(pairs[i]);
    cast_certified(bodies, fast_pairs_, std::nullopt, certified_contacts_, stats);
    for (kernels::LocalContact& contact : certified_contacts_)
        contact.pair = 2 * coherent_.fast()[contact.pair / 2] + contact.pair % 2;
    add(local_, certified_contacts_);
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
    placer_.run(executor(), settings_.direction, bodies, pairs, local_, contacts);
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
