// SPDX-License-Identifier: Apache-2.0
#include "pairs/open_pairs.h"

#include "reference/random.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <set>

namespace raycontact {
namespace {

using reference::Random;

/// Open pairs beside a plain model of them.
class Twins {
public:
    explicit Twins(std::uint32_t bodies) : bodies_(bodies) {}

    std::set<SlotPair> some(std::uint32_t count) {
        std::set<SlotPair> pairs;
        for (std::uint32_t i = 0; i < count; ++i) {
            const BodySlot a = random_.below(bodies_ - 1);
            pairs.insert({a, a + 1 + random_.below(std::min(6u, bodies_ - 1 - a))});
        }
        return pairs;
    }
    void set_all(const std::set<SlotPair>& now) {
        open_.set_all(executor_, std::vector<SlotPair>(now.begin(), now.end()));
        model_ = now;
    }
    // Some of the bodies get others; of the pairs of two bodies that do not, none changes.
    void set_of(std::uint32_t count, const std::set<SlotPair>& wanted) {
        std::vector<char> is_in(bodies_, 0);
        std::vector<BodySlot> in;
        for (std::uint32_t i = 0; i < count; ++i) {
            const BodySlot body = random_.below(bodies_);
            if (is_in[body] == 0) in.push_back(body);
            is_in[body] = 1;
        }
        const auto of = [&](const SlotPair& pair) { return is_in[pair.first] != 0 || is_in[pair.second] != 0; };
        std::vector<SlotPair> theirs;
        std::ranges::copy_if(wanted, std::back_inserter(theirs), of);
        std::erase_if(model_, of);
        model_.insert(theirs.begin(), theirs.end());
        open_.set_of(executor_, in, is_in, theirs);
    }
    void apply(const std::set<SlotPair>& now) {
        std::vector<SlotPair> opened, closed;
        std::ranges::set_difference(now, model_, std::back_inserter(opened));
        std::ranges::set_difference(model_, now, std::back_inserter(closed));
        open_.apply(opened, closed);
        model_ = now;
    }
    void remove(BodySlot body) {
        open_.close_all_of(body);
        std::erase_if(model_, [&](const SlotPair& pair) { return pair.first == body || pair.second == body; });
    }

    // All that is told of the changes since the last call.
    void check() {
        const PairList& all = open_.all(executor_);
        ASSERT_EQ(all.pairs, std::vector<SlotPair>(model_.begin(), model_.end()));
        ASSERT_EQ(open_.slots().count(), model_.size());
        std::map<SlotPair, std::uint32_t> slots;
        for (std::size_t i = 0; i < all.size(); ++i) {
            ASSERT_EQ(open_.slots()[all.slots[i]], all.pairs[i]);
            slots[all.pairs[i]] = all.slots[i];
        }
        const std::span<const SlotPair> closed = open_.closed();
        EXPECT_TRUE(std::ranges::is_sorted(closed));
        std::size_t kept = 0;
        for (const auto& [pair, slot] : last_) {
            const auto own = slots.find(pair);
            const bool changed = open_.slots().changes().is_marked(slot);
            EXPECT_EQ(own == slots.end() || own->second != slot, changed && !reopened(pair, slot));
            EXPECT_TRUE(own != slots.end() || std::ranges::binary_search(closed, pair));
            if (!changed) ++kept;
        }
        EXPECT_EQ(open_.count_kept(), kept);

        SlotChanges moved;
        moved.make_room(bodies_);
        for (BodySlot body = random_.below(9); body < bodies_; body += 1 + random_.below(bodies_)) moved.mark(body);
        PairList asked, expected;
        open_.list_of(executor_, moved, asked);
        for (const auto& [pair, slot] : slots)
            if (moved.is_marked(pair.first) || moved.is_marked(pair.second) || open_.slots().changes().is_marked(slot))
                expected.add({pair, slot});
        EXPECT_EQ(asked.pairs, expected.pairs);
        EXPECT_EQ(asked.slots, expected.slots);
        last_ = slots;
        open_.step_done();
        EXPECT_FALSE(open_.have_changed());
    }

    std::size_t size() const { return model_.size(); }
    const std::set<SlotPair>& model() const { return model_; }
    OpenPairs& open() { return open_; }

private:
    // Closed and opened again, in the slot that it had.
    bool reopened(const SlotPair& pair, std::uint32_t slot) const {
        return open_.slots().is_open(slot) && open_.slots()[slot] == pair;
    }

    std::uint32_t bodies_;
    Random random_{7};
    Executor executor_{2};
    OpenPairs open_;
    std::set<SlotPair> model_;
    std::map<SlotPair, std::uint32_t> last_; ///< of the last check
};

void change(std::uint32_t bodies, std::uint32_t most, int steps) {
    Random random(1);
    Twins twins(bodies);
    std::size_t pairs = 0;
    for (int step = 0; step < steps; ++step) {
        switch (random.below(6)) {
        case 0:
            twins.set_all(twins.some(most));
            break;
        case 1:
            twins.apply(twins.some(most));
            break;
        case 2:
            twins.remove(random.below(bodies));
            [[fallthrough]];
        case 3: // nothing
            twins.set_of(random.below(bodies), twins.model());
            break;
        default:
            twins.set_of(random.below(bodies), twins.some(most));
        }
        if (random.below(4) > 0) twins.check();
        pairs += twins.size();
    }
    EXPECT_GT(pairs, 10u * most);
    const auto executor = std::make_unique<Executor>(1);
    twins.open().clear();
    EXPECT_EQ(twins.open().slots().count(), 0u);
    twins.open().set_all(*executor, std::vector<SlotPair>{{0, 1}});
    EXPECT_EQ(twins.open().slots().count(), 1u);
}

TEST(OpenPairs, TellWhatOpensAndCloses) {
    change(12, 30, 600);
    change(5000, 12'000, 40); // many slices
}

} // namespace
} // namespace raycontact
