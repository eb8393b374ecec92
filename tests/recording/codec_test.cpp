// SPDX-License-Identifier: Apache-2.0
// Behind a right checksum may still be nonsense: decoders throw Damage, whatever the bytes.
#include "sample.h"

#include <raycontact/primitives.h>
#include <recording/layout.h>
#include <recording/shape_codec.h>
#include <recording/step_codec.h>

#include <gtest/gtest.h>

#include <random>

using namespace raycontact;
using namespace raycontact::recording;

namespace {

/// Of changed payloads; how many of them were refused. Anything but Damage ends the test.
template <class Decode>
int refused(const Bytes& payload, int rounds, Decode decode) {
    std::mt19937_64 numbers(17);
    int count = 0;
    for (int i = 0; i < rounds; ++i) {
        Bytes bytes = payload;
        for (std::uint64_t k = numbers() % 4 + 1; k > 0; --k)
            bytes[numbers() % bytes.size()] = static_cast<unsigned char>(numbers());
        if (i % 3 == 0) bytes.resize(numbers() % bytes.size());
        try {
            decode(bytes);
        } catch (const Damage&) {
            ++count;
        }
    }
    return count;
}

} // namespace

TEST(Codec, MeshesFromNonsense) {
    const Sample sample = make_sample(1);
    const Bytes payload = encode_mesh(remade_mesh(*sample.shapes[0]));
    EXPECT_NO_THROW(decode_mesh(payload));
    EXPECT_GT(refused(payload, 3000, [](const Bytes& bytes) { decode_mesh(bytes); }), 1000);
    EXPECT_THROW(decode_mesh({}), Damage);
}

TEST(Codec, RoundShapesAreTheirMeasures) {
    for (const auto& shape : {make_ball(0.3), make_capsule(0.1, 2)}) {
        const Bytes payload = encode_shape(*shape);
        EXPECT_EQ(payload.size(), 16u);
        const auto same = decode_shape(payload);
        ASSERT_NE(same->round(), nullptr);
        EXPECT_EQ(same->round()->radius, shape->round()->radius);
        EXPECT_EQ(same->round()->to, shape->round()->to);
        EXPECT_EQ(same->name(), shape->name());
        EXPECT_GT(refused(payload, 1000, [](const Bytes& bytes) { decode_shape(bytes); }), 300);
    }
}

TEST(Codec, StepsFromNonsense) {
    const Sample sample = make_sample(6);
    const std::vector<std::uint32_t> live{0, 1, 2, 3, 4};
    const auto numbers = [](const std::vector<Pair>& pairs) {
        std::vector<NumberPair> list;
        list.reserve(pairs.size());
        for (const auto& [a, b] : pairs) list.emplace_back(a.slot, b.slot);
        return list;
    };
    StepEncoder encoder;
    for (std::uint32_t i = 0; i < 6; ++i) encoder.add(live, sample.poses[i], numbers(sample.pairs[i]));
    const Bytes payload = encoder.take();
    const auto decode = [&](const Bytes& bytes) {
        StepDecoder decoder;
        decoder.open(bytes, 6 * 12 * live.size(), sample.bodies.size());
        std::vector<Pose> poses(sample.bodies.size());
        for (int i = 0; i < 6; ++i) decoder.next(live, poses);
        for (const NumberPair& pair : decoder.pairs()) EXPECT_TRUE(pair.first < pair.second && pair.second < 7);
    };
    EXPECT_NO_THROW(decode(payload));
    EXPECT_GT(refused(payload, 3000, decode), 900);

    // The pairs alone: the first bytes behind the residuals.
    const Bytes pairs(payload.begin() + 8 * 6 * 12 * 5, payload.end());
    const auto decode_pairs = [&](const Bytes& bytes) {
        Bytes whole(payload.begin(), payload.begin() + 8 * 6 * 12 * 5);
        whole.insert(whole.end(), bytes.begin(), bytes.end());
        decode(whole);
    };
    EXPECT_GT(refused(pairs, 3000, decode_pairs), 1000);
}

TEST(Codec, EventsAndTextsFromNonsense) {
    const BodyEvent events[] = {{0, BodyEvent::comes, 0, 1}, {0, BodyEvent::comes, 1, 0}, {4, BodyEvent::goes, 0, 0}};
    const Bytes payload = encode_events(events);
    std::vector<BodyEvent> read;
    std::vector<Body> bodies;
    apply_events(payload, 2, read, bodies);
    EXPECT_EQ(encode_events(read), payload);
    ASSERT_EQ(bodies.size(), 2u);
    EXPECT_EQ(bodies[0].end_step, 4u);
    EXPECT_FALSE(bodies[0].alive(4));
    EXPECT_TRUE(bodies[0].alive(3));
    const auto decode = [](const Bytes& bytes) {
        std::vector<BodyEvent> of_list;
        std::vector<Body> list;
        apply_events(bytes, 2, of_list, list);
    };
    EXPECT_GT(refused(payload, 1000, decode), 500);
    EXPECT_GT(
        refused(encode_info(make_sample(1).info), 1000, [](const Bytes& bytes) { decode_info(bytes, format_version); }),
        500);
    EXPECT_GT(refused(encode_end(5, "0123456789abcdef"), 1000, [](const Bytes& bytes) { decode_end(bytes, 5); }), 500);
}

TEST(Codec, EventsHappenInOrder) {
    const BodyEvent events[] = {{4, BodyEvent::comes, 0, 1}, {3, BodyEvent::comes, 1, 0}};
    std::vector<BodyEvent> read;
    std::vector<Body> bodies;
    EXPECT_THROW(apply_events(encode_events(events), 2, read, bodies), Damage);
}

// As a scene gives them: the second body comes and goes between two steps, the first is missed by one.
TEST(Codec, IdsFollowFromTheEvents) {
    const BodyEvent events[] = {{0, BodyEvent::comes, 0, 0}, {2, BodyEvent::comes, 1, 0}, {2, BodyEvent::goes, 1, 0},
                                {2, BodyEvent::goes, 0, 0},  {2, BodyEvent::comes, 2, 0}, {5, BodyEvent::comes, 3, 0}};
    for (const std::uint32_t version : {1u, 2u}) {
        std::vector<Body> bodies(4);
        give_ids(version, events, bodies);
        const std::vector<BodyId> expected =
            version == 1 ? std::vector<BodyId>{{0}, {1}, {2}, {3}} : std::vector<BodyId>{{0}, {1}, {1, 1}, {0, 1}};
        for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(bodies[i].id, expected[i]) << i << ", version " << version;
    }
}

TEST(Codec, BlocksAreCheckedByTheirPlaceToo) {
    const Bytes payload{1, 2, 3, 4, 5, 6, 7};
    const Bytes block = make_block(BlockType::steps, 3, 4, payload, 64, Effort::quick);
    const std::span<const unsigned char> header_bytes = std::span(block).first(BlockHeader::size);
    const std::span<const unsigned char> stored = std::span(block).subspan(BlockHeader::size);
    const BlockHeader header = read_block_header(header_bytes);
    EXPECT_EQ(header.first_step, 3u);
    EXPECT_EQ(header.step_count, 4u);
    EXPECT_EQ(unpack_block(header, stored, 64), payload);
    EXPECT_THROW(unpack_block(header, stored, 72), Damage);
}
