// SPDX-License-Identifier: Apache-2.0
#include "contacts/contact_store.h"

#include "reference/random.h"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <tuple>

namespace raycontact {
namespace {

using Key = std::tuple<std::uint32_t, std::uint32_t, Side, std::uint32_t>;

Contact contact_of(const Key& key, std::uint32_t other, float depth) {
    const auto& [a, b, body, vertex] = key;
    Contact contact;
    contact.body_a = {a};
    contact.body_b = {b};
    const bool from_a = body == Side::a;
    contact.feature = {FeatureKind::vertex, body, from_a ? vertex : other, from_a ? other : vertex};
    contact.depth = depth;
    contact.ray_length = 2;
    return contact;
}

// Of so many bodies and vertices. A step asks about all pairs, or about some, and some close; somebody may hold what
// was before.
void compare_steps(std::uint32_t bodies, std::uint32_t vertices, std::uint32_t most, int steps) {
    reference::Random random(1);
    ContactStore store;
    Executor executor(2);
    std::map<Key, Contact> before; // of the last step
    std::size_t in_place = 0, moved = 0;
    for (int step = 0; step < steps; ++step) {
        const bool all = step % 4 == 0;
        const std::uint32_t of = 1 + random.below(5); // about one in so many
        std::set<SlotPair> asked, closed;
        for (std::uint32_t a = 0; a < bodies; ++a)
            for (std::uint32_t b = a + 1; b < a + 3; ++b) {
                if (all || random.below(of) == 0) asked.insert({a, b});
                if (random.below(40) == 0) closed.insert({a, b}); // of which some are open again
            }
        std::map<Key, Contact> now;
        const auto pair_at = [](const Key& key) { return SlotPair(std::get<0>(key), std::get<1>(key)); };
        for (const auto& [key, contact] : before)
            if (!asked.contains(pair_at(key)) && !closed.contains(pair_at(key))) now[key] = contact;
        const bool as_many = step % 3 == 1;
        if (as_many) { // the same ones, of which some no longer touch, or do
            for (const auto& [key, contact] : before)
                if (asked.contains(pair_at(key)))
                    now[key] = contact_of(key, random.below(1000), random.below(3) == 0 ? -1.0f : 1.0f);
        } else {
            for (std::uint32_t i = step % 40 == 39 ? 0 : random.below(most); i > 0; --i) {
                const std::uint32_t a = random.below(bodies), b = a + 1 + random.below(2);
                const Key key{a, b, random.below(2) ? Side::a : Side::b, random.below(vertices)};
                if (asked.contains({a, b}))
                    now[key] = contact_of(key, random.below(1000), random.below(3) == 0 ? -1.0f : 1.0f);
            }
        }
        std::vector<Contact> found;
        for (auto& [key, contact] : now) {
            if (!asked.contains(pair_at(key))) continue;
            contact.is_new = random.below(2) != 0;
            found.push_back(contact);
        }
        const std::vector<SlotPair> asked_pairs(asked.begin(), asked.end()), closed_pairs(closed.begin(), closed.end());
        store.prepare();
        const auto held = random.below(3) == 0 ? store.shared() : nullptr;
        const std::vector<Contact> copy = held ? *held : std::vector<Contact>();
        const Contact* const place = store.all().data();
        store.replace(executor, {all, asked_pairs, closed_pairs}, found);
        if (held) {
            ASSERT_EQ(held->size(), copy.size());
            for (std::size_t i = 0; i < copy.size(); ++i) {
                ASSERT_EQ(order_of((*held)[i]), order_of(copy[i]));
                ASSERT_EQ((*held)[i].is_new, copy[i].is_new) << "what somebody holds stays";
            }
        }
        if (!all && !now.empty()) ++(store.all().data() == place ? in_place : moved);

        ASSERT_EQ(store.all().size(), now.size());
        std::size_t fresh = 0, speculative = 0, i = 0;
        std::vector<Key> lost, expected;
        for (const auto& [key, contact] : now) {
            const Contact& own = store.all()[i++];
            ASSERT_EQ(order_of(own), order_of(contact));
            ASSERT_EQ(own.feature, contact.feature);
            ASSERT_EQ(own.depth, contact.depth);
            const auto old = before.find(key);
            const bool known = old != before.end() && (own.is_speculative() || !old->second.is_speculative());
            ASSERT_EQ(own.is_new, !known) << "step " << step;
            fresh += !known && !own.is_speculative();
            speculative += own.is_speculative();
        }
        EXPECT_EQ(store.sums().fresh, fresh);
        EXPECT_EQ(store.sums().speculative, speculative);
        EXPECT_EQ(store.sums().ray_length, 2.0 * double(now.size() - speculative));
        EXPECT_EQ(store.sums().depth_max, now.size() > speculative ? 1 : 0);
        for (const LostContact& c : store.lost())
            lost.emplace_back(c.body_a.slot, c.body_b.slot, c.feature.source, c.feature.source_index());
        for (const auto& [key, contact] : before)
            if (const auto own = now.find(key);
                !contact.is_speculative() && (own == now.end() || own->second.is_speculative()))
                expected.push_back(key);
        EXPECT_EQ(lost, expected); // in order
        for (const SlotPair& pair : asked_pairs) {
            const auto of_pair = [&](const auto& entry) { return pair_at(entry.first) == pair; };
            ASSERT_EQ(store.of(pair).size(), static_cast<std::size_t>(std::ranges::count_if(now, of_pair)));
            for (const Contact& contact : store.of(pair)) ASSERT_EQ(pair_of(contact), pair);
            if (now.size() > 1000) break;
        }
        before.swap(now);
        if (step % 7 == 3) {
            store.prepare();
            store.rest(executor);
            EXPECT_EQ(store.sums().fresh, 0u);
            EXPECT_TRUE(store.lost().empty());
            EXPECT_TRUE(std::ranges::none_of(store.all(), &Contact::is_new));
        }
    }
    EXPECT_GT(in_place, 1u);
    EXPECT_GT(moved, 1u);
    const auto held = store.shared();
    const std::size_t count = held->size();
    store.prepare();
    store.clear();
    store.clear(); // as often as it may be
    EXPECT_TRUE(store.all().empty());
    EXPECT_EQ(held->size(), count) << "what somebody holds stays";
    EXPECT_TRUE(store.of({0, 1}).empty());
}

TEST(ContactStore, HasWhatTheLastStepOfEachPairFound) {
    compare_steps(3, 3, 30, 500);
    compare_steps(300, 9, 12'000, 40);  // many slices
    compare_steps(3, 3000, 12'000, 40); // pairs of more contacts than a slice
}

// The place of a body that is gone may be another's in the next step.
TEST(ContactStore, TellsBodiesInOneSlotApart) {
    ContactStore store;
    Executor executor(1);
    std::vector<Contact> found{contact_of({1, 2, Side::a, 3}, 4, 1)};
    store.prepare();
    store.replace(executor, {true, {}, {}}, found);
    found = {contact_of({1, 2, Side::a, 3}, 4, 1)};
    found[0].body_b.generation = 1;
    store.prepare();
    store.replace(executor, {true, {}, {}}, found);
    EXPECT_TRUE(store.all()[0].is_new);
    ASSERT_EQ(store.lost().size(), 1u);
    EXPECT_EQ(store.lost()[0].body_b, (BodyId{2}));
}

TEST(ContactStore, LostContactsTellAllThatTheirKeyTells) {
    constexpr std::uint32_t none = ContactFeature::no_index, most_edge = 0x7ffffffeu, most_vertex = 0xfffffffdu;
    const std::vector<ContactFeature> features{
        {FeatureKind::vertex, Side::a, 0, 7},           {FeatureKind::vertex, Side::a, most_vertex, 7},
        {FeatureKind::vertex, Side::b, 7, 0},           {FeatureKind::vertex, Side::b, 7, most_vertex},
        {FeatureKind::edges, Side::a, 0, most_edge},    {FeatureKind::edges, Side::a, 1, 0},
        {FeatureKind::edges, Side::a, most_edge, 0},    {FeatureKind::edges, Side::a, most_edge, most_edge},
        {FeatureKind::inside, Side::a, most_vertex, 7}, {FeatureKind::inside, Side::b, 7, 3}};
    std::vector<Contact> contacts;
    for (const ContactFeature& feature : features) {
        Contact& contact = contacts.emplace_back();
        contact.body_a = {3, 1};
        contact.body_b = {5, 2};
        contact.feature = feature;
        contact.depth = 1;
    }
    EXPECT_TRUE(std::ranges::is_sorted(contacts, std::ranges::less_equal(), &Contact::key)); // and no key twice
    ContactStore store;
    Executor executor(2);
    std::vector<Contact> found = contacts, nothing;
    store.prepare();
    store.replace(executor, {true, {}, {}}, found);
    store.prepare();
    store.replace(executor, {true, {}, {}}, nothing);
    ASSERT_EQ(store.lost().size(), features.size());
    for (std::size_t i = 0; i < features.size(); ++i) {
        const LostContact& lost = store.lost()[i];
        ContactFeature told = features[i];
        if (told.kind != FeatureKind::edges) (told.source == Side::a ? told.index_b : told.index_a) = none;
        EXPECT_TRUE(lost.feature == told) << i;
        EXPECT_EQ(lost.key(), contacts[i].key()) << i;
        EXPECT_EQ(lost.body_a, (BodyId{3, 1}));
        EXPECT_EQ(lost.body_b, (BodyId{5, 2}));
    }
}

} // namespace
} // namespace raycontact
