// SPDX-License-Identifier: Apache-2.0
#include "contacts/changes.h"

#include "reference/random.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>
#include <tuple>

namespace raycontact {
namespace {

using Key = std::tuple<std::uint32_t, std::uint32_t, VertexBody, std::uint32_t>;

TEST(Changes, AreTheDifferencesOfTwoSteps) {
    reference::Random random(1);
    Changes changes;
    std::set<Key> before, touched; // all of the last step; those that touched
    for (int step = 0; step < 500; ++step) {
        std::set<Key> now, touches;
        const std::uint32_t count = step % 40 == 39 ? 0 : random.below(30);
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t a = random.below(3), b = a + 1 + random.below(2);
            now.insert({a, b, random.below(2) ? VertexBody::a : VertexBody::b, random.below(3)});
        }
        std::vector<Contact> contacts;
        for (const auto& [a, b, body, vertex] : now) {
            Contact contact;
            contact.body_a = a;
            contact.body_b = b;
            contact.vertex_body = body;
            contact.vertex = vertex;
            contact.triangle = random.below(1000); // no part of the key
            contact.is_new = random.below(2) != 0;
            contact.depth = random.below(3) == 0 ? -1.0f : 1.0f; // speculative, or touching
            if (contact.depth > 0) touches.insert({a, b, body, vertex});
            contacts.push_back(contact);
        }
        changes.mark(contacts);
        std::size_t came = 0;
        for (const Contact& c : contacts) {
            const auto& known = is_speculative(c) ? before : touched;
            EXPECT_EQ(c.is_new, !known.contains({c.body_a, c.body_b, c.vertex_body, c.vertex}));
            came += c.is_new && !is_speculative(c);
        }
        EXPECT_EQ(changes.new_count(), came);
        std::vector<Key> lost, expected;
        for (const LostContact& c : changes.lost()) lost.emplace_back(c.body_a, c.body_b, c.vertex_body, c.vertex);
        std::set_difference(touched.begin(), touched.end(), touches.begin(), touches.end(),
                            std::back_inserter(expected));
        EXPECT_EQ(lost, expected); // in order
        before.swap(now);
        touched.swap(touches);
    }
}

} // namespace
} // namespace raycontact
