// SPDX-License-Identifier: Apache-2.0
#include "body_slots.h"

#include "state_bytes.h"

#include <raycontact/error.h>

#include <algorithm>
#include <functional>
#include <limits>

namespace raycontact {

BodyId BodySlots::next() {
    if (free_.empty()) {
        // The highest slot stays unused: adapters and files have it for "none".
        if (slots_.size() >= std::numeric_limits<BodySlot>::max())
            throw InputError("more than 2^32 - 1 bodies in one scene; remove some, or use several scenes");
        if (slots_.size() == slots_.capacity()) slots_.reserve(std::max<std::size_t>(16, 2 * slots_.size()));
        free_.reserve(slots_.capacity());
        leaving_.reserve(slots_.capacity());
        slots_.emplace_back();
        free_.push_back(static_cast<BodySlot>(slots_.size() - 1));
    }
    const Slot& slot = slots_[free_.front()];
    return {free_.front(), slot.use == Use::never ? first_generation_ : slot.generation + 1};
}

BodyId BodySlots::give() noexcept {
    const BodySlot lowest = free_.front();
    std::pop_heap(free_.begin(), free_.end(), std::greater<>());
    free_.pop_back();
    Slot& slot = slots_[lowest];
    slot.generation = slot.use == Use::never ? first_generation_ : slot.generation + 1;
    slot.use = Use::taken;
    slot.first_step = steps_;
    end_ = std::max(end_, lowest + 1);
    ++count_;
    return id_in(lowest);
}

void BodySlots::take_back(BodySlot taken) noexcept {
    Slot& slot = slots_[taken];
    --count_;
    if (slot.generation == std::numeric_limits<std::uint32_t>::max()) {
        slot.use = Use::retired;
    } else if (slot.first_step == steps_) {
        make_free(taken);
    } else {
        slot.use = Use::leaving;
        leaving_.push_back(taken);
    }
    shorten();
}

void BodySlots::step_done() noexcept {
    ++steps_;
    for (const BodySlot slot : leaving_) make_free(slot);
    leaving_.clear();
    shorten();
}

void BodySlots::save(std::vector<std::byte>& bytes) const {
    put_bytes(bytes, first_generation_);
    put_bytes(bytes, steps_);
    put_list<Slot>(bytes, slots_);
    put_list<BodySlot>(bytes, free_);
    put_list<BodySlot>(bytes, leaving_);
    put_bytes(bytes, end_);
    put_bytes(bytes, count_);
}

void BodySlots::load(std::span<const std::byte>& bytes) {
    first_generation_ = take_bytes<std::uint32_t>(bytes);
    steps_ = take_bytes<std::uint64_t>(bytes);
    slots_ = take_list<Slot>(bytes);
    free_ = take_list<BodySlot>(bytes);
    leaving_ = take_list<BodySlot>(bytes);
    end_ = take_bytes<BodySlot>(bytes);
    count_ = take_bytes<std::uint32_t>(bytes);
    free_.reserve(slots_.capacity());
    leaving_.reserve(slots_.capacity());
}

void BodySlots::make_free(BodySlot slot) noexcept {
    slots_[slot].use = Use::free;
    free_.push_back(slot);
    std::push_heap(free_.begin(), free_.end(), std::greater<>());
}

void BodySlots::shorten() noexcept {
    while (end_ > 0 && slots_[end_ - 1].use != Use::taken && slots_[end_ - 1].use != Use::leaving) --end_;
}

} // namespace raycontact
