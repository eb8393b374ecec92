// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/results.h"
#include "device/scan.h"
#include "slot_pair.h"

#include <array>
#include <span>
#include <vector>

namespace raycontact {

/// Finds on a device the pairs that BroadPhase finds on the host, in the same order. It keeps the boxes of bodies and
/// their pairs, and is told of changes, and tells of them, alone. Each body walks down the tree: unlike a node of
/// bodies, it needs no shared memory, and there are as many walks as a GPU wants.
class DeviceBroadPhase {
public:
    /// What the device does not know yet.
    struct Changes {
        std::size_t slots = 0;  ///< of bodies; where it is not slots(), all are listed
        std::size_t places = 1; ///< of a body: its box holds them all
        std::span<const kernels::BodyExtent> extents;
        std::span<const kernels::BodyPlace>
            moved; ///< body frames: `places` of each body that moved or whose extent is new
    };

    /// Those that the device knows: none before the first find(), and after one that failed.
    std::size_t slots() const { return boxes_.size(); }
    /// What became since the last find() of the pairs whose boxes touch, and which no filter keeps apart.
    struct Found {
        bool whole = false;                       ///< `opened` is all pairs: nothing is known of the last ones
        std::span<const SlotPair> opened, closed; ///< each sorted; valid until the next call
    };
    /// The device has double. whole: the caller has not the pairs of the last find().
    Found find(Device& device, const Changes& changes, bool whole);
    /// So many bodies are near so many others, which filters may keep apart, that a host finds the pairs with less
    /// memory. The last find() changed nothing then.
    bool gave_up() const { return gave_up_; }

private:
    void tell(Device& device, const Changes& changes);
    void fill(Device& device);
    void sort(Device& device);
    void search(Device& device);
    void compare(Device& device);
    void write_changes(Device& device);
    bool read(Device& device);
    void list_wide(Device& device);
    void take_all(Device& device);
    void take_changes(Device& device, std::size_t count);

    Array<kernels::BodyExtent> extents_, changed_; ///< by slot; those to set
    Array<kernels::BodyPlace> moved_;
    Array<kernels::WorldBox> boxes_; ///< by slot
    kernels::uint levels_ = 0;       ///< of the tree
    Array<kernels::BoxNode> tree_;
    Array<kernels::SortKey> order_, keys_; ///< order_: slots along the curve
    Columns digits_;
    Array<kernels::uint> is_wide_, wide_; ///< by slot: near so many bodies that it is tested against all; their slots
    Array<kernels::Totals> totals_;       ///< of the list, of changes
    struct List {
        Columns counts; ///< by row
        Array<kernels::PairBodies> pairs;
        std::size_t count = 0; ///< of pairs
    };
    List list_, last_; ///< last_: of the last find()
    bool has_last_ = false, compares_ = false;
    Columns changes_; ///< by row
    Results<kernels::PairDifference> changed_pairs_;
    std::vector<kernels::uint> host_wide_, wide_slots_, last_wide_; ///< last_wide_: of last_, with whose rows go others
    std::vector<kernels::SortKey> host_order_;
    std::vector<SlotPair> opened_, closed_;
    double tests_ = 0, tests_when_sorted_ = 0; ///< of nodes, in the last search
    unsigned wide_steps_ = 0;                  ///< since some bodies are wide
    bool sorts_next_ = true, gave_up_ = false;
};

} // namespace raycontact
