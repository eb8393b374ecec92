// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/contact_store.h"
#include "executor/executor.h"
#include "pairs/directed_pairs.h"
#include "slot_changes.h"

#include <raycontact/scene.h>

#include <functional>
#include <span>
#include <vector>

namespace raycontact {

/// Which pairs of bodies touch, from step to step (Scene::touching()). A step asks no meshes, and allocates nothing
/// once it has room.
class Touches {
public:
    /// A step that found contacts.
    struct Step {
        std::span<const PlacedBody> bodies;
        std::span<const Pose> next;                         ///< where bodies are expected, by slot; empty: nowhere
        const SlotChanges& moved;                           ///< bodies
        const ContactStore &contacts, &sensed;              ///< sensed: of pairs with a sensor
        ContactStore::Asked asked;                          ///< whose contacts may be others
        std::function<bool(const SlotPair&)> is_kept_apart; ///< by a filter
    };
    /// Where a pair had its last contact.
    struct Place {
        Vec3 on_a, on_b;        ///< the witness points, in the frames of the bodies
        std::uint64_t gone = 0; ///< the contact is, since
    };
    void update(Executor& executor, const Step& step);
    /// Of a step in which nothing is new.
    void rest() noexcept;
    /// Frees memory that the next update() makes anew.
    void trim();
    /// What it keeps for pairs that have a contact, about.
    std::uint64_t bytes() const;
    /// Puts back what all() and places() were; nothing is told of it.
    void restore(std::vector<Touch> touches, std::vector<Place> places);

    std::span<const Touch> all() const { return all_; } ///< by pair
    std::span<const Place> places() const { return places_; }
    std::span<const Touch> begun() const { return begun_; }
    std::span<const Touch> ended() const { return ended_; }

private:
    static constexpr std::size_t none = ~std::size_t{0};
    /// A pair that was asked about, or touches.
    struct Candidate {
        SlotPair pair;
        const Contact* deepest = nullptr; ///< null: it has none
        bool is_sensor = false;
        bool touches = false;
        std::size_t old = none; ///< its place in all_, if it touched in the last step, too
        bool stays = false;     ///< and does so still
    };
    static void look(const Step& step, std::span<const Contact> contacts, bool is_sensor, Candidate& candidate);
    static bool is_over(const Step& step, const Touch& touch);
    bool may_have_moved(const Step& step, const Touch& touch) const;
    bool stays_near(const Step& step, std::size_t i) const;
    void list_all(Executor& executor, const Step& step);
    void list_asked(Executor& executor, const Step& step);
    void replace(const Step& step);

    SlotChanges::Seen seen_ = 0; ///< of bodies: the last step
    std::vector<Touch> all_, begun_, ended_, next_;
    std::vector<Place> places_, next_places_; ///< of all_
    std::vector<SlotPair> pairs_;
    std::vector<std::vector<Candidate>> slices_;
    std::vector<Candidate> candidates_, found_; ///< by pair
};

} // namespace raycontact
