// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/contact_store.h"
#include "contacts/face_contacts.h"
#include "contacts/reduce.h"
#include "contacts/round_pairs.h"
#include "part/parts.h"
#include "schedule/assignment.h"
#include "schedule/choice.h"

#include <optional>
#include <string>

namespace raycontact {

/// All contacts of a step.
struct SavedContacts {
    std::vector<Contact> kept, left_out, sensed;
    bool were_chosen = false; ///< by the settings as they are: ContactReducer::Last::has_settings of the next step
};
/// What a part keeps of its pairs.
struct SavedRays {
    std::vector<SlotPair> pairs; ///< sorted
    std::vector<std::byte> state;
};

/// The narrow phase, one step at a time.
class NarrowPhase {
public:
    explicit NarrowPhase(const Settings& settings);
    /// opened: what settings.execution.devices names, or what stands for it in a test. open_other: where that is
    /// "auto", for what all pairs may move to.
    NarrowPhase(const Settings& settings, std::vector<OpenDevice> opened, Opener open_other = {});

    Parts& parts() { return parts_; }
    const Assignment& assignment() const { return assignment_; }
    const Settings& settings() const { return settings_; }
    /// Of "auto"; null for a list.
    DeviceChoice* choice() { return choice_ ? &*choice_ : nullptr; }
    /// As Scene's.
    std::string device_choice() const;
    /// The part that has all pairs, or the first that is left.
    std::size_t first_part() const { return choice_ && parts_.has(in_use_) ? in_use_ : parts_.first(); }
    /// Begins to wake the threads that the next step will need.
    void wake();
    /// Forgets what the last method kept.
    void set_settings(const Settings& settings);

    /// Of the last step.
    const ContactStore& contacts() const { return contacts_; }
    /// Before a step, so that begin_anew() cannot fail.
    void prepare() {
        contacts_.prepare();
        left_out_.prepare();
        sensed_.prepare();
    }
    /// A step that failed has no contacts. Its pairs begin anew.
    void begin_anew() noexcept;
    /// As if the last step had found none. After prepare().
    void forget_contacts() noexcept;

    /// pairs: their changes are those since the last step. Fills stats. broad_ms: milliseconds that it took to find the
    /// pairs.
    void step(std::span<const PlacedBody> bodies, const SlotChanges& moved, OpenPairs& pairs, StepStats& stats,
              double broad_ms = 0);
    /// A step in which nothing has moved since the last, for a method that then finds what it found: contacts stay.
    void rest(StepStats& stats);
    /// Between two steps; bodies as in the last one.
    SavedContacts save_contacts(const SlotChanges& moved) const;
    std::vector<SavedRays> save_rays(std::span<const PlacedBody> bodies);
    /// Before a step, of pairs that are all new to it. moved: all bodies; PlacedBody::centred: of the step before.
    void load(std::span<const PlacedBody> bodies, const SlotChanges& moved, OpenPairs& pairs, SavedContacts contacts,
              std::span<const SavedRays> rays);
    /// The rays that the methods keep for the next step, in any order; bodies as in the last step.
    std::vector<KeptRay> kept_rays(std::span<const PlacedBody> bodies);
    /// Whether the last step freed memory, since much less of it is in use than was.
    bool trimmed() const { return trimmed_; }
    /// Contacts of the last step that the settings leave out.
    std::span<const Contact> left_out() const { return left_out_.all(); }
    /// How many bodies are sensors.
    void set_sensor_count(std::size_t count) { sensor_count_ = count; }
    /// How many are balls or capsules.
    void set_round_count(std::size_t count) { round_count_ = count; }
    /// Those of pairs with a sensor.
    const ContactStore& sensed() const { return sensed_; }
    /// Whose contacts the last step asked about. pairs: its own, before OpenPairs::step_done().
    ContactStore::Asked asked(OpenPairs& pairs) const { return {!few_, asked_.pairs, pairs.closed()}; }

private:
    /// What a part found in a step.
    struct Found {
        std::vector<Contact> contacts;
        double ms = 0;
    };
    /// Whether a part can have pairs in this step.
    bool has_pairs(std::size_t part) const { return parts_.has(part) && (!choice_ || part == in_use_); }
    void forget_loaded() noexcept {
        is_loaded_ = false;
        loaded_rays_.clear();
    }
    bool asks_few(const SlotChanges& moved, std::size_t bodies);
    const PairList& list_asked(std::span<const PlacedBody> bodies, const SlotChanges& moved, OpenPairs& pairs);
    void choose_device(std::span<const PlacedBody> bodies, StepStats& stats);
    void open_other();
    bool move_pairs(const Balance::Move& move, std::span<const PlacedBody> bodies, StepStats& stats);
    void find(std::size_t part, std::span<const PlacedBody> bodies, const SlotChanges& moved);
    std::vector<std::size_t> replace(const std::vector<std::size_t>& failed, StepStats& stats);
    std::vector<PairList> give_away(const std::vector<std::size_t>& failed, StepStats& stats);
    std::vector<Contact>& merge();
    void take_sensed(std::span<const PlacedBody> bodies, std::vector<Contact>& found);
    void count(std::size_t pair_count, StepStats& stats);
    void trim(std::uint64_t pair_bytes);

    Settings settings_;
    Parts parts_;
    Balance balance_;
    Assignment assignment_;
    Opener open_other_; ///< empty once it was asked
    std::optional<DeviceChoice> choice_;
    std::size_t in_use_ = 0;   ///< with a choice: the part that has all pairs
    std::vector<Found> found_; ///< by part; without contacts once it is dropped
    std::vector<Contact> merged_;
    SlotChanges::Seen seen_ = 0;         ///< the last step: SlotChanges of bodies
    std::vector<SavedRays> loaded_rays_; ///< since then, for who saves it again
    bool is_loaded_ = false; ///< since then: contacts are those of the step before, chosen by these settings
    bool few_ = false;       ///< only pairs that may have changed are asked about
    PairList asked_;         ///< those
    RoundPairs round_pairs_;
    std::size_t round_count_ = 0;
    FaceContacts face_contacts_;
    ContactReducer reducer_;
    ContactStore contacts_, left_out_, sensed_;
    std::vector<Contact> of_sensors_;
    std::size_t sensor_count_ = 0;
    std::uint64_t most_bytes_ = 0; ///< StepStats::pair_bytes, the most since memory was last trimmed
    unsigned trims_ = 0;           ///< still to be done, one a step
    bool trimmed_ = false;         ///< in the last step
};

} // namespace raycontact
