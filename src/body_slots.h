// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slot_pair.h"

#include <raycontact/body_id.h>
#include <raycontact/export.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Gives bodies their ids by a rule that a replay repeats: always the lowest free slot. A slot is free again at once
/// when no step has seen its body; otherwise once a step has seen it empty, so that nothing kept by slots from one step
/// to the next can pass from a body to its successor. A slot that is out of generations is never given again.
class RAYCONTACT_API BodySlots { // shown to raycontact::recording
public:
    /// first_generation: of a slot's first body; a late one lets a test see the last.
    explicit BodySlots(std::uint32_t first_generation = 0) : first_generation_(first_generation) {}

    /// The id that give() will give. May have to make room, after which give() cannot fail. Throws InputError where no
    /// slot is left.
    BodyId next();
    BodyId give() noexcept; ///< after next()
    void take_back(BodySlot slot) noexcept;

    /// A step has seen the bodies that are there, and which slots have none. One that fails has seen nothing: it leaves
    /// nothing behind.
    void step_done() noexcept;

    void save(std::vector<std::byte>& bytes) const;
    void load(std::span<const std::byte>& bytes);

    bool is_there(BodyId body) const {
        const BodySlot slot = body.slot;
        return slot < slots_.size() && slots_[slot].use == Use::taken && slots_[slot].generation == body.generation;
    }
    bool was_given(BodyId body) const {
        const BodySlot slot = body.slot;
        return slot < slots_.size() && slots_[slot].use != Use::never && body.generation <= slots_[slot].generation;
    }
    bool is_taken(BodySlot slot) const { return slot < slots_.size() && slots_[slot].use == Use::taken; }
    /// Of the body that has the slot, or had it last.
    BodyId id_in(BodySlot slot) const { return BodyId{slot, slots_[slot].generation}; }
    std::uint32_t count() const { return count_; } ///< of bodies
    /// Slots from here on have no body and no step has to see that: arrays by slot may end here.
    BodySlot end() const { return end_; }

private:
    enum class Use : std::uint8_t { never, free, taken, leaving, retired };
    struct Slot {
        std::uint64_t first_step = 0; ///< steps done when it was given
        std::uint32_t generation = 0; ///< of its last body
        Use use = Use::never;
    };
    void make_free(BodySlot slot) noexcept;
    void shorten() noexcept;

    std::uint32_t first_generation_;
    std::uint64_t steps_ = 0;
    std::vector<Slot> slots_;
    std::vector<BodySlot> free_;    ///< a heap, the lowest on top; has room for all
    std::vector<BodySlot> leaving_; ///< until a step has seen them empty; likewise
    BodySlot end_ = 0;
    std::uint32_t count_ = 0;
};

} // namespace raycontact
