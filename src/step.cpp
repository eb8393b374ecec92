// SPDX-License-Identifier: Apache-2.0
#include "step.h"

#include "rays/standard.h"

#include <algorithm>
#include <chrono>

namespace raycontact {

NarrowPhase::NarrowPhase(const Settings& settings)
    : settings_(settings), opened_(open_device(settings.device, settings.threads)), shapes_(*opened_.device) {}

void NarrowPhase::step(std::span<const PlacedBody> bodies, std::span<const Pair> pairs, std::vector<Contact>& contacts,
                       StepStats& stats) {
    const auto start = std::chrono::steady_clock::now();
    Device& on = device();

    // Pairs: each in both directions, the source seen from the target.
    order_pairs(executor(), bodies, pairs, ordered_);
    device_pairs_.write(on, ordered_);

    // Rays: the vertices inside the other body's bounds, found by clusters.
    queue_.fill(on, shapes_.arrays(), device_pairs_, settings_.skip_outside && settings_.caster != Caster::basic);

    // Hits: every ray in full.
    cast_standard(on, settings_.caster, shapes_.arrays(), device_pairs_, queue_.rays(), hits_);

    // Contacts: counted, scanned, written; then placed in the world and sorted.
    stats.side_tests = gather_.run(on, shapes_.arrays(), device_pairs_, queue_.rays(), hits_, local_);
    place_contacts(executor(), settings_.direction, bodies, pairs, local_, contacts);

    stats.pairs = pairs.size();
    stats.vertices = queue_.vertices_tested();
    stats.rays = queue_.vertices_inside();
    stats.rays_cast = queue_.rays().size();
    stats.contacts = contacts.size();
    stats.ray_length = 0;
    stats.depth_max = 0;
    for (const Contact& contact : contacts) {
        stats.ray_length += double(contact.ray_length);
        stats.depth_max = std::max(stats.depth_max, double(contact.depth));
    }
    stats.narrow_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

} // namespace raycontact
