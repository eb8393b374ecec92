// SPDX-License-Identifier: Apache-2.0
#include "contacts/changes.h"

#include "reference/random.h"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <set>
#include <tuple>

namespace raycontact {
namespace {

using Key = std::tuple<std::uint32_t, std::uint32_t, Side, std::uint32_t>;

// Of so many bodies and vertices.
void compare_steps(std::uint32_t bodies, std::uint32_t vertices, std::uint32_t most, int steps) {
    reference::Random random(1);
    Changes changes;
    Executor executor(2);
    std::set<Key> before, touched; // all of the last step; those that touched
    for (int step = 0; step < steps; ++step) {
        std::set<Key> now, touches;
        const std::uint32_t count = step % 40 == 39 ? 0 : random.below(most);
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t a = random.below(bodies), b = a + 1 + random.below(2);
            now.insert({a, b, random.below(2) ? Side::a : Side::b, random.below(vertices)});
        }
        std::vector<Contact> contacts;
        for (const auto& [a, b, body, vertex] : now) {
            Contact contact;
            contact.body_a = {a};
            contact.body_b = {b};
            const std::uint32_t other = random.below(1000); // no part of the key
            const bool from_a = body == Side::a;
            contact.feature = {FeatureKind::vertex, body, from_a ? vertex : other, from_a ? other : vertex};
            contact.is_new = random.below(2) != 0;
            contact.depth = random.below(3) == 0 ? -1.0f : 1.0f; // speculative, or touching
            if (contact.depth > 0) touches.insert({a, b, body, vertex});
            contacts.push_back(contact);
        }
        changes.mark(executor, contacts);
        std::size_t came = 0;
        for (const Contact& c : contacts) {
            const auto& known = c.is_speculative() ? before : touched;
            EXPECT_EQ(c.is_new,
                      !known.contains({c.body_a.slot, c.body_b.slot, c.feature.source, c.feature.source_index()}));
            came += c.is_new && !c.is_speculative();
        }
        EXPECT_EQ(changes.sums().fresh, came);
        std::vector<Key> lost, expected;
        for (const LostContact& c : changes.lost())
            lost.emplace_back(c.body_a.slot, c.body_b.slot, c.feature.source, c.feature.source_index());
        std::set_difference(touched.begin(), touched.end(), touches.begin(), touches.end(),
                            std::back_inserter(expected));
        EXPECT_EQ(lost, expected); // in order
        before.swap(now);
        touched.swap(touches);
    }
}

TEST(Changes, AreTheDifferencesOfTwoSteps) {
    compare_steps(3, 3, 30, 500);
    compare_steps(300, 9, 12'000, 20);  // many slices
    compare_steps(3, 3000, 12'000, 20); // pairs of more contacts than a slice
}

TEST(Changes, LostContactsTellAllThatTheirKeyTells) {
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
    Changes changes;
    Executor executor(2);
    changes.mark(executor, contacts);
    changes.mark(executor, {});
    ASSERT_EQ(changes.lost().size(), features.size());
    for (std::size_t i = 0; i < features.size(); ++i) {
        const LostContact& lost = changes.lost()[i];
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
