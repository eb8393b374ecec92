// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "body_slots.h"
#include "contacts/touches.h"
#include "narrow_phase.h"
#include "next_poses.h"

#include <raycontact/scene.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace raycontact {

/// A body as Scene::save_state() has it.
struct SavedBody {
    BodySlot slot = 0;
    std::uint32_t shape = 0; ///< place in Scene::shapes()
    Pose pose, centred;      ///< centred: PlacedBody's, of the last step
    double margin = -1;
    std::uint64_t user_data = 0;
    std::uint32_t groups = 0, mask = 0;
    std::uint32_t is_static = 0, is_sensor = 0;
};

/// What Scene::save_state() tells.
struct SavedScene {
    std::vector<SavedBody> bodies; ///< by slot
    BodySlots slots;
    NextPoses next_poses;
    std::vector<SlotPair> pairs; ///< that are open
    SavedContacts contacts;
    std::vector<Touch> touches;
    std::vector<Touches::Place> places; ///< of touches
    std::vector<SavedRays> rays;

    std::vector<std::byte> encode(const Settings& settings, std::span<const std::shared_ptr<const Shape>> shapes) const;
    /// Throws InputError as Scene::load_state().
    static SavedScene decode(std::span<const std::byte> state, const Settings& settings,
                             std::span<const std::shared_ptr<const Shape>> shapes);
};

} // namespace raycontact
