// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/changes.h"
#include "contacts/place.h"
#include "part/part.h"
#include "schedule/schedule.h"

namespace raycontact {

/// The narrow phase, one step at a time.
class NarrowPhase {
public:
    explicit NarrowPhase(const Settings& settings);

    Executor& executor() { return part_.executor(); }
    ShapeStore& shapes() { return part_.shapes(); }
    const Settings& settings() const { return settings_; }
    /// Forgets what the last method kept.
    void set_settings(const Settings& settings);

    /// pairs: sorted, without duplicates, indices into bodies. Fills contacts and all of stats but broad_ms.
    void step(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, std::vector<Contact>& contacts,
              StepStats& stats);
    std::span<const LostContact> lost_contacts() const { return changes_.lost(); }

private:
    Settings settings_;
    Part part_;
    Schedule schedule_;
    Placer placer_;
    Changes changes_;
};

} // namespace raycontact
