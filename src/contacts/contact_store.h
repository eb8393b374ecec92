// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contacts/contact_order.h"
#include "executor/executor.h"
#include "slot_pair.h"

#include <raycontact/contact.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace raycontact {

/// The contacts of a scene, sorted. A step puts in what it found of the pairs that it asked about; what the others had
/// stays. It tells what is new and what is gone: what touches is new where it did not touch before.
class ContactStore {
public:
    /// The pairs that a step asked about, or all; and those that closed. Sorted.
    struct Asked {
        bool all;
        std::span<const SlotPair> pairs, closed;
    };
    /// Of all contacts.
    struct Sums {
        std::uint64_t fresh = 0, speculative = 0; ///< fresh: new ones that touch
        double ray_length = 0, depth_max = 0;     ///< metres; ray_length: of those that touch
        void add(const Sums& other);
    };

    std::span<const Contact> all() const { return *contacts_; }
    /// They stay as they are while somebody holds them.
    std::shared_ptr<const std::vector<Contact>> shared() const { return contacts_; }
    std::span<const Contact> of(const SlotPair& pair) const;
    const Sums& sums() const { return sums_; }
    /// Of the last step.
    std::span<const LostContact> lost() const { return lost_; }

    /// Before a step, so that clear() cannot fail.
    void prepare();
    /// found: of the pairs asked about, sorted; becomes any others.
    void replace(Executor& executor, const Asked& asked, std::vector<Contact>& found);
    /// A step that asked about none: no contact is new any more.
    void rest(Executor& executor);
    /// After prepare().
    void clear() noexcept;
    /// Puts back what all() was.
    void restore(Executor& executor, std::vector<Contact> contacts);
    void trim();

private:
    static constexpr std::size_t block_size = 128; ///< contacts
    struct Block {
        std::uint64_t first = 0; ///< number_of_pair() of its first contact
        Sums sums;
    };
    /// Contacts in a row, by place.
    struct Range {
        std::size_t begin, end;
        std::size_t size() const { return end - begin; }
    };
    /// What becomes of a pair: the old contacts, and the found ones in their place.
    struct Unit {
        Range old, found;
        std::size_t to; ///< place of the first one found, among all
    };
    /// What is found of some pairs in a row.
    struct Slice {
        std::vector<Unit> units;
        std::vector<LostContact> lost;
        std::uint64_t fresh;
    };
    bool is_held() const;
    Range range_of(const SlotPair& pair) const;
    std::span<Slice> begin_slices(std::size_t count);
    void compare(const Range& old, std::span<Contact> found, Slice& slice) const;
    void replace_all(Executor& executor, std::vector<Contact>& found);
    void list_units(Executor& executor, std::span<const SlotPair> pairs, std::vector<Contact>& found);
    void replace_units(Executor& executor, const std::vector<Contact>& found);
    void move_units(Executor& executor, const std::vector<Contact>& found);
    void forget_new(Executor& executor);
    void fill_all(Executor& executor);
    void fill(std::size_t block, std::span<const Contact> contacts);
    void sum_up();

    std::shared_ptr<std::vector<Contact>> contacts_ = std::make_shared<std::vector<Contact>>(),
                                          next_ = std::make_shared<std::vector<Contact>>();
    std::vector<Block> blocks_;    ///< of contacts_
    std::vector<Range> maybe_new_; ///< all that are new lie in these
    std::vector<SlotPair> pairs_;  ///< asked about or closed
    std::vector<Slice> slices_;
    std::vector<Unit> units_;
    bool moves_ = false;        ///< units_ have not the places of the old ones
    std::vector<Range> copied_; ///< by slices of move_units()
    std::vector<std::size_t> changed_blocks_;
    std::vector<LostContact> lost_;
    Sums sums_;
};

} // namespace raycontact
