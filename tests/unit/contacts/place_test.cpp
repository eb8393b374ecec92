// SPDX-License-Identifier: Apache-2.0
#include "contacts/place.h"

#include "contacts/write_contact.h"

#include "device/device.h"
#include "reference/random.h"
#include "scenes/models/model.h"
#include "shape/shape_data.h"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <numeric>

namespace raycontact {
namespace {

ByPair<kernels::LocalContact> by_pair(Executor& executor, std::span<const kernels::LocalContact> local,
                                      std::span<const SlotPair> pairs) {
    ByPair<kernels::LocalContact> sorted;
    sorted.set(executor, local, std::identity(), pairs.size());
    return sorted;
}

// Pairs of so many contacts are sorted in different ways.
TEST(Placer, SortsTheContactsOfEachPair) {
    const std::shared_ptr<const Shape> shape = Shape::make(scenes::scene_model("gear", 902).mesh);
    const auto vertices = static_cast<std::uint32_t>(shape->data().mesh.vertices.size());
    const OpenDevice opened = open_device("cpu", 2);
    reference::Random random(1);
    std::vector<PlacedBody> bodies;
    std::vector<SlotPair> pairs;
    std::vector<kernels::LocalContact> local;
    for (const std::uint32_t count : {1u, 2u, 7u, 8u, 9u, 15u, 16u, 17u, 100u, 127u, 128u, 129u, 300u, 3u, 33u}) {
        ASSERT_LT(count, vertices);
        const auto pair = static_cast<std::uint32_t>(pairs.size());
        pairs.emplace_back(2 * pair, 2 * pair + 1);
        bodies.resize(bodies.size() + 2, PlacedBody{shape.get(), 0, 0, {}, {}});
        std::vector<std::uint32_t> chosen(vertices);
        std::iota(chosen.begin(), chosen.end(), 0u);
        for (std::uint32_t direction = 0; direction < 2; ++direction) {
            for (std::uint32_t i = 0; i < count; ++i) {
                std::swap(chosen[i], chosen[i + random.below(vertices - i)]);
                local.push_back({2 * pair + direction, chosen[i], 0, static_cast<float>(chosen[i]), 1, {1, 0, 0}});
            }
        }
    }
    std::vector<Contact> contacts(local.size()); // as a step with edges leaves it to the next
    for (Contact& contact : contacts) contact.feature.kind = FeatureKind::edges;
    Placer placer;
    placer.run(*opened.executor, Direction::ray, bodies, pairs, by_pair(*opened.executor, local, pairs), {}, contacts);

    std::sort(local.begin(), local.end(),
              [](const auto& a, const auto& b) { return std::pair(a.pair, a.vertex) < std::pair(b.pair, b.vertex); });
    ASSERT_EQ(contacts.size(), local.size());
    for (std::size_t i = 0; i < local.size(); ++i) {
        EXPECT_EQ(contacts[i].body_a.slot, local[i].pair / 2 * 2);
        EXPECT_EQ(contacts[i].feature.source, local[i].pair % 2 == 0 ? Side::a : Side::b);
        EXPECT_EQ(contacts[i].feature.source_index(), shape->data().mesh.vertex_index[local[i].vertex]);
        EXPECT_EQ(contacts[i].ray_length, local[i].distance);
        EXPECT_EQ(contacts[i].feature.kind, FeatureKind::vertex);
    }
}

// Contacts that are placed already, with keys before, between and behind those of vertices; some pairs have no others.
TEST(Placer, PutsPlacedContactsBetweenThoseOfVertices) {
    const std::shared_ptr<const Shape> shape = Shape::make(scenes::scene_model("gear", 902).mesh);
    const OpenDevice opened = open_device("cpu", 2);
    reference::Random random(2);
    std::vector<PlacedBody> bodies;
    std::vector<SlotPair> pairs;
    std::vector<kernels::LocalContact> local;
    std::vector<std::vector<Contact>> own(400);
    std::vector<PlacedContacts> placed;
    std::uint32_t before = 0;
    for (std::uint32_t pair = 0; pair < own.size(); ++pair) {
        pairs.emplace_back(2 * pair, 2 * pair + 1);
        bodies.resize(bodies.size() + 2, PlacedBody{shape.get(), 0, 0, {}, {}});
        std::vector<std::uint32_t> chosen(60);
        std::iota(chosen.begin(), chosen.end(), 0u);
        for (std::size_t i = chosen.size(); i > 1; --i)
            std::swap(chosen[i - 1], chosen[random.below(static_cast<std::uint32_t>(i))]);
        const std::uint32_t vertices = pair % 3 == 0 ? 0 : random.below(30), others = random.below(30);
        for (std::uint32_t side = 0; side < 2; ++side)
            for (std::uint32_t i = 0; i < vertices; ++i)
                local.push_back({2 * pair + side, chosen[i], 0, 1, 1, {1, 0, 0}});
        for (std::uint32_t i = 0; i < others; ++i) {
            Contact contact;
            contact.body_a = {2 * pair};
            contact.body_b = {2 * pair + 1};
            const std::uint32_t vertex = shape->data().mesh.vertex_index[chosen[vertices + i]];
            contact.feature = i % 3 == 0
                                  ? ContactFeature{FeatureKind::edges, Side::a, vertex, 7}
                                  : ContactFeature{FeatureKind::vertex, i % 3 == 1 ? Side::a : Side::b, vertex, vertex};
            own[pair].push_back(contact);
        }
        std::ranges::sort(own[pair], {}, &Contact::key);
        if (!own[pair].empty()) placed.push_back({pair, before, own[pair]});
        before += others;
    }
    std::vector<Contact> contacts;
    Placer().run(*opened.executor, Direction::ray, bodies, pairs, by_pair(*opened.executor, local, pairs), placed,
                 contacts);
    ASSERT_EQ(contacts.size(), local.size() + before);
    std::vector<std::pair<SlotPair, std::uint64_t>> found, expected;
    for (const Contact& contact : contacts) found.emplace_back(pair_of(contact), contact.key());
    for (const auto& list : own)
        for (const Contact& contact : list) expected.emplace_back(pair_of(contact), contact.key());
    for (const kernels::LocalContact& one : local)
        expected.emplace_back(pairs[one.pair / 2],
                              vertex_feature(one.pair % 2 == 0, shape->data().mesh.vertex_index[one.vertex], 0).key());
    std::ranges::sort(expected);
    EXPECT_EQ(found, expected);
}

// A vertex of a and one of b, each 0.5 m below a face that its ray leaves at an angle: cosine 0.5.
TEST(Placer, MakesNormalDepthAndWeightByTheDirection) {
    const std::shared_ptr<const Shape> shape = Shape::make(scenes::scene_model("gear", 902).mesh);
    const ShapeData& data = shape->data();
    const OpenDevice opened = open_device("cpu", 1);
    const Pose quarter_turn{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {}};
    const std::vector<PlacedBody> bodies{{shape.get(), 0, 0, quarter_turn, {}}, {shape.get(), 0, 0, {}, {}}};
    const std::vector<SlotPair> pairs{{0, 1}};
    const std::vector<kernels::LocalContact> local{{0, 7, 3, 1, 0.5f, {1, 0, 0}}, {1, 9, 3, 1, 0.5f, {1, 0, 0}}};
    const auto place = [&](Direction direction) {
        std::vector<Contact> contacts;
        Placer().run(*opened.executor, direction, bodies, pairs, by_pair(*opened.executor, local, pairs), {}, contacts);
        return contacts;
    };
    using Normal = Vec3f;
    const auto reprojected = place(Direction::reprojected);
    EXPECT_EQ(reprojected[0].normal, (Normal{-1, 0, 0})); // away from b's face
    EXPECT_EQ(reprojected[1].normal, (Normal{0, 1, 0}));  // away from a's face, which is turned
    const Vec3 &n0 = data.vertex_normals[7], &n1 = data.vertex_normals[9];
    for (const Direction direction : {Direction::ray, Direction::weighted}) {
        const auto contacts = place(direction);
        EXPECT_EQ(contacts[0].normal, (Normal{float(-n0.y), float(n0.x), float(n0.z)})); // out of a, turned
        EXPECT_EQ(contacts[1].normal, (Normal{float(-n1.x), float(-n1.y), float(-n1.z)}));
        for (std::size_t i = 0; i < 2; ++i) {
            EXPECT_EQ(reprojected[i].depth, 0.5f);
            EXPECT_EQ(reprojected[i].weight, 1);
            EXPECT_EQ(contacts[i].depth, 1);
            EXPECT_EQ(contacts[i].ray_length, 1);
            EXPECT_EQ(contacts[i].weight, direction == Direction::ray ? 1 : data.vertex_areas[local[i].vertex]);
        }
    }
}

} // namespace
} // namespace raycontact
