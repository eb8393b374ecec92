// SPDX-License-Identifier: Apache-2.0
#include "step.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace raycontact {

NarrowPhase::NarrowPhase(const Settings& settings)
    : settings_(settings), part_(open_device(settings.device, settings.threads, settings.inexact)) {}

void NarrowPhase::set_settings(const Settings& settings) {
    settings_ = settings;
    part_.forget();
}

void NarrowPhase::step(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                       std::vector<Contact>& contacts, StepStats& stats) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<DeviceWork> work = std::move(stats.work); // to reuse its memory
    stats = {};
    try {
        schedule_.assign(pairs);
        part_.begin(bodies, schedule_.pairs_of(0), settings_);
        placer_.run(executor(), settings_.direction, bodies, schedule_.pairs_of(0), part_.end(), contacts);
        changes_.mark(contacts);
    } catch (...) {
        part_.forget(); // the step failed half-way: what it kept may be wrong
        contacts.clear();
        throw;
    }

    part_.count(stats);
    work.assign(1, part_.work());
    stats.work = std::move(work);
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
