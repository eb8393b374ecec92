// SPDX-License-Identifier: Apache-2.0
// Pairs that change their part between two steps have the contacts that they would have had, bit for bit.
#include "device/listed_pairs.h"
#include "device/same_contacts.h"
#include "mesh/vector.h"
#include "part/part.h"

#include "reference/random.h"
#include "scenes/models/model.h"

#include <cstddef>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

using reference::Random;

class Crowd {
public:
    Crowd() {
        for (const char* kind : {"torus", "knot", "gear"})
            shapes.push_back(Shape::make(scenes::scene_model(kind, 300).mesh));
        for (std::uint32_t i = 0; i < 24; ++i) {
            PlacedBody& body = bodies.emplace_back();
            body.shape = shapes[i % shapes.size()].get();
            body.pose = random_.rotation();
            body.pose.translation = 1.2 * random_.in_ball();
        }
        for (BodySlot a = 0; a < bodies.size(); ++a)
            for (BodySlot b = a + 1; b < bodies.size(); ++b) pairs.emplace_back(a, b);
        move(0);
    }

    void move(double by) {
        for (PlacedBody& body : bodies) {
            body.pose.translation = body.pose.translation + by * random_.in_ball();
            body.centred = centred_pose(*body.shape, body.pose);
        }
    }

    /// Shapes lie in another order in each part.
    std::unique_ptr<Part> make_part(std::size_t first) const {
        auto part = std::make_unique<Part>(open_device("cpu", 1));
        for (std::size_t i = 0; i < shapes.size(); ++i) part->shapes().add(shapes[(first + i) % shapes.size()]);
        return part;
    }
    /// As one part numbers the shapes.
    std::vector<PlacedBody> seen_by(Part& part) const {
        std::vector<PlacedBody> own = bodies;
        for (PlacedBody& body : own) body.shape_index = part.shapes().index_of(body.shape);
        return own;
    }

    std::vector<std::shared_ptr<const Shape>> shapes;
    std::vector<PlacedBody> bodies;
    std::vector<SlotPair> pairs;

private:
    Random random_{4};
};

TEST(Part, PairsThatChangeItGoOnAsTheyWere) {
    for (const Method method : {Method::standard, Method::certified, Method::iterative, Method::predictive}) {
        Settings settings;
        settings.method = method;
        Crowd crowd;
        const auto whole = crowd.make_part(0), a = crowd.make_part(0), b = crowd.make_part(1);
        Random random(9);
        std::vector<bool> on_b(crowd.pairs.size());
        SlotChanges moves;
        device_test::ListedPairs pairs, pairs_a, pairs_b;
        std::size_t moved = 0, contacts = 0, bytes = 0;
        for (int step = 0; step < 40; ++step) {
            // Any pair may change its part, in either direction.
            std::vector<SlotPair> to_b, to_a, of_a, of_b;
            for (std::size_t i = 0; i < crowd.pairs.size(); ++i) {
                if (step > 0 && random.below(10) == 0) {
                    (on_b[i] ? to_a : to_b).push_back(crowd.pairs[i]);
                    on_b[i] = !on_b[i];
                    ++moved;
                }
                (on_b[i] ? of_b : of_a).push_back(crowd.pairs[i]);
            }
            PairList from_a = pairs_a.of(to_b), from_b = pairs_b.of(to_a);
            const auto state_a = a->export_state(crowd.seen_by(*a), from_a),
                       state_b = b->export_state(crowd.seen_by(*b), from_b);
            const Part::Pairs next_a = pairs_a.next(of_a), next_b = pairs_b.next(of_b);
            a->import_state(crowd.seen_by(*a), pairs_a.of(from_b.pairs), state_b);
            b->import_state(crowd.seen_by(*b), pairs_b.of(from_a.pairs), state_a);
            bytes += state_a.size() + state_b.size();

            crowd.move(step % 5 == 4 ? 0.004 : 0.0004);
            const std::vector<PlacedBody> seen_whole = crowd.seen_by(*whole), seen_a = crowd.seen_by(*a),
                                          seen_b = crowd.seen_by(*b);
            moves.forget(); // every body may have moved
            whole->begin(seen_whole, moves, pairs.next(crowd.pairs), settings);
            a->begin(seen_a, moves, next_a, settings);
            b->begin(seen_b, moves, next_b, settings);
            std::vector<Contact> expected, found, others;
            whole->end(expected);
            a->end(found);
            b->end(others);
            found.insert(found.end(), others.begin(), others.end());
            for (device_test::ListedPairs* list : {&pairs, &pairs_a, &pairs_b}) list->step_done();
            std::ranges::stable_sort(found, {}, [](const Contact& c) { return pair_of(c); });
            ASSERT_TRUE(device_test::same(found, expected)) << to_string(method) << ", step " << step;
            contacts += found.size();
        }
        EXPECT_GT(contacts, 1000u);
        EXPECT_GT(moved, 200u);
        const bool depends = method == Method::iterative || method == Method::predictive;
        EXPECT_EQ(bytes > 0, depends) << "the other methods' contacts do not depend on what they keep";
    }
}

} // namespace
} // namespace raycontact
