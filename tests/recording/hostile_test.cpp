// SPDX-License-Identifier: Apache-2.0
// Recordings made to do harm, with every checksum right: told in one line at once, before they fill the memory.
#include "sample.h"
#include "tests/time_limit.h"

#include <recording/layout.h>
#include <recording/replay.h>
#include <recording/shape_codec.h>
#include <recording/step_codec.h>
#include <recording/viewer_part.h>

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <xxhash.h>
#include <zlib.h>

#include <array>

using namespace raycontact;
using namespace raycontact::recording;

namespace {

/// A recording of blocks as an attacker packs them: as small as deflate can.
class Forged {
public:
    Forged() {
        side_.assign(side_chunk_start.begin(), side_chunk_start.end());
        Info info;
        info.scene = "forged";
        info.bodies = 2;
        info_ = encode_info(info);
    }

    Forged& info(const Bytes& payload = {}) { return add(BlockType::info, payload.empty() ? info_ : payload); }

    Forged& add(BlockType type, const Bytes& payload, std::uint32_t first = 0, std::uint32_t count = 0) {
        uLongf size = compressBound(payload.size());
        Bytes packed(size);
        EXPECT_EQ(compress2(packed.data(), &size, payload.data(), payload.size(), 9), Z_OK);
        packed.resize((size + 7) & ~std::size_t{7});
        Bytes block;
        put(block, static_cast<std::uint32_t>(type));
        put(block, std::uint32_t{1});
        put(block, std::uint64_t{size});
        put(block, std::uint64_t{payload.size()});
        put(block, first);
        put(block, count);
        block.insert(block.end(), packed.begin(), packed.end());
        Bytes sum;
        put(sum, std::uint64_t{XXH64(block.data(), block.size(), side_.size())});
        block.insert(block.begin() + 32, sum.begin(), sum.end());
        side_.insert(side_.end(), block.begin(), block.end());
        return *this;
    }

    Forged& mesh(const PreparedMesh& mesh) { return add(BlockType::shape, encode_mesh(mesh)); }

    /// Two bodies of shape 0.
    Forged& two_bodies() {
        return add(BlockType::bodies, encode_events(std::array{BodyEvent{0, BodyEvent::comes, 0, 0},
                                                               BodyEvent{0, BodyEvent::comes, 1, 0}}));
    }

    /// How it is refused; empty when it is read to its end.
    std::string message() const {
        const TemporaryFile file;
        Bytes bytes = viewer_part({}, {}, {}, {});
        put(bytes, static_cast<std::uint32_t>(side_.size()));
        put(bytes, side_chunk);
        bytes.insert(bytes.end(), side_.begin(), side_.end());
        Bytes length;
        put(length, static_cast<std::uint32_t>(bytes.size()));
        std::copy(length.begin(), length.end(), bytes.begin() + glb::length_at);
        write_bytes(file.path(), bytes);
        std::string message;
        const TimeLimit limit(5);
        try {
            Reader reader(file.path());
            replay(reader, {});
        } catch (const InputError& error) {
            message = error.what();
            EXPECT_EQ(message.find(file.path().string()), 0u) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        }
        return message;
    }

private:
    Bytes side_, info_;
};

#define EXPECT_SAYS(message, words) EXPECT_NE((message).find(words), std::string::npos) << (message)

Bytes repeated(std::size_t count, char c) {
    return Bytes(count, static_cast<unsigned char>(c));
}

PreparedMesh sample_mesh() {
    return remade_mesh(*make_sample(1).shapes[0]);
}

/// So many bodies that come and go again before the next comes, each for a step.
Bytes short_lives(std::uint32_t bodies, std::uint32_t every) {
    std::vector<BodyEvent> events;
    for (std::uint32_t i = 0; i < bodies; ++i) {
        events.push_back({i * every, BodyEvent::comes, i, 0});
        events.push_back({i * every, BodyEvent::goes, i, 0});
    }
    return encode_events(events);
}

} // namespace

TEST(HostileRecording, JsonThatIsDeepOrLong) {
    EXPECT_SAYS(Forged().info(repeated(97'000'000, '[')).message(), "would unpack to more");
    EXPECT_SAYS(Forged().info(repeated(1'000'000, '[')).message(), "nests its JSON too deeply");
    EXPECT_SAYS(Forged().info().add(BlockType::end, repeated(97'000'000, '[')).message(), "would unpack to more");
    EXPECT_SAYS(Forged().info().add(BlockType::end, repeated(1'000'000, '[')).message(), "nests its JSON too deeply");
}

TEST(HostileRecording, StepsThatAreOnlyCounted) {
    EXPECT_EQ(Forged().info().add(BlockType::steps, Bytes(32), 0, 16).message(), "");
    EXPECT_SAYS(Forged().info().add(BlockType::steps, Bytes(8), 0, 0xfffffff0).message(), "more steps than");
    EXPECT_SAYS(Forged().info().add(BlockType::steps, Bytes(80'000'000), 0, 40'000'000).message(),
                "would unpack to more");
    EXPECT_SAYS(Forged().info().add(BlockType::steps, Bytes(16'000'000), 0, 8'000'000).message(), "more steps than");
}

TEST(HostileRecording, BodiesThatComeAndGoOverManySteps) {
    Forged many;
    many.info().mesh(sample_mesh()).add(BlockType::bodies, short_lives(20'000, 50));
    EXPECT_SAYS(many.add(BlockType::steps, Bytes(2'000'000), 0, 1'000'000).message(), "more steps than");
    // As many as the rule allows: no step may look at every body there ever was.
    Forged allowed;
    allowed.info().mesh(sample_mesh()).add(BlockType::bodies, short_lives(30'000, 1));
    for (std::uint32_t i = 0; i < 1875; ++i) allowed.add(BlockType::steps, Bytes(32), 16 * i, 16);
    EXPECT_EQ(allowed.message(), "");
}

TEST(HostileRecording, MeshesThatAreMostlyZeros) {
    EXPECT_SAYS(Forged().info().add(BlockType::shape, Bytes(64'000'000)).message(), "would unpack to more");
}

TEST(HostileRecording, PairsTwice) {
    const std::vector<std::uint32_t> live{0, 1};
    const std::vector<Pose> poses{Pose{}, Pose{}};
    StepEncoder encoder;
    encoder.add(live, poses, std::vector<NumberPair>{{0, 1}});
    Bytes payload = encoder.take();
    const auto message = [&] {
        return Forged().info().mesh(sample_mesh()).two_bodies().add(BlockType::steps, payload, 0, 1).message();
    };
    EXPECT_EQ(message(), "");
    payload[payload.size() - 3] = 2; // pairs that are new: the same one again, at no distance from the first
    payload.insert(payload.end(), {0, 0});
    EXPECT_SAYS(message(), "has a pair twice");
}

TEST(HostileRecording, AMeshIsWhatItsReportSays) {
    const PreparedMesh mesh = sample_mesh();
    ASSERT_TRUE(mesh.report.closed && mesh.report.manifold && mesh.report.oriented && mesh.report.outward);
    const auto message = [](const PreparedMesh& changed) {
        return Forged().info().mesh(changed).two_bodies().message();
    };
    EXPECT_EQ(message(mesh), "");
    PreparedMesh open = mesh;
    open.triangles[0][1] = open.triangles[0][2];
    EXPECT_SAYS(message(open), "is not as closed, manifold or oriented as its report says");
    PreparedMesh turned = mesh;
    std::swap(turned.triangles[0][1], turned.triangles[0][2]);
    EXPECT_SAYS(message(turned), "is not as closed, manifold or oriented as its report says");

    // What rounding may change is measured, not refused.
    PreparedMesh crossed = mesh;
    crossed.vertices[0] = {-2 * crossed.vertices[0].x, -2 * crossed.vertices[0].y, -2 * crossed.vertices[0].z};
    const MeshReport report = decode_mesh(encode_mesh(crossed)).report;
    EXPECT_TRUE(report.self_intersecting);
    EXPECT_FALSE(report.outward);
    PreparedMesh inside_out = mesh;
    for (auto& triangle : inside_out.triangles) std::swap(triangle[1], triangle[2]);
    EXPECT_FALSE(decode_mesh(encode_mesh(inside_out)).report.outward);
}

TEST(HostileRecording, TheWriterKeepsToTheLimitsOfTheReader) {
    // Bodies at rest pack to nothing: what unpacks to too much for a reader is stored as it is.
    const Bytes still = make_block(BlockType::steps, 0, 1, Bytes(std::size_t{40} << 20), 16, Effort::quick);
    const auto header_bytes = std::span(still).first(BlockHeader::size);
    const BlockHeader header = read_block_header(header_bytes);
    EXPECT_EQ(unpack_block(header, std::span(still).subspan(BlockHeader::size), 16).size(), std::size_t{40} << 20);
    Info info;
    info.mesh_source = std::string(2'000'000, 'x');
    EXPECT_THROW(encode_info(info), InputError);
}
