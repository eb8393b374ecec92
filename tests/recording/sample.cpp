// SPDX-License-Identifier: Apache-2.0
#include "sample.h"

#include <recording/layout.h>
#include <scenes/models/model.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>

#include <unistd.h>

using namespace raycontact;
using namespace raycontact::recording;

namespace {

std::mt19937_64 numbers(7);

double uniform() {
    return static_cast<double>(numbers() >> 11) * 0x1p-53 * 2 - 1;
}

/// Vertices that use all of a double's bits, far from the origin, where the middle of the box is never exact.
Mesh crooked(const char* kind, std::uint32_t triangles) {
    Mesh mesh = scenes::scene_model(kind, triangles).mesh;
    const Vec3 offset{10 * uniform(), 100 * uniform(), uniform()};
    const double scale = 1 + 0.5 * uniform();
    for (Vec3& v : mesh.vertices) v = {v.x * scale + offset.x, v.y * scale + offset.y, v.z * scale + offset.z};
    return mesh;
}

Pose moved(const Pose& last) {
    const Pose turn = pose_from_quaternion({}, 1, 0.05 * uniform(), 0.05 * uniform(), 0.05 * uniform());
    Pose next = relative_pose(turn, last);
    next.translation = {last.translation.x + 0.1 * uniform(), last.translation.y + 0.1 * uniform(),
                        last.translation.z + 0.1 * uniform()};
    return next;
}

} // namespace

Sample make_sample(std::uint32_t steps) {
    Sample sample;
    sample.info.scene = "sample";
    sample.info.seed = 0xfedcba9876543210u;
    sample.info.bodies = 7;
    sample.info.dt = 1.0 / 240;
    sample.info.mesh_source = "meshes made for a test";
    sample.info.settings.paper.caster = Caster::basic;
    sample.info.settings.direction = Direction::ray;
    sample.info.settings.execution.threads = 2;
    sample.info.settings.paper.displacement_threshold = 0.1 / 3; // no short decimal
    sample.info.settings.paper.confidence = 2.0 + 1e-15;
    sample.info.settings.paper.distance_extension = 0.07;
    sample.info.settings.paper.max_iterations = 5;
    sample.info.settings.paper.cast_lost_walks = false;
    sample.info.settings.paper.skip_outside = false;
    sample.info.settings.max_contacts_per_pair = 7;
    sample.info.settings.max_contacts = 400;
    sample.shapes = {Shape::make(crooked("torus", 60)), Shape::make(crooked("knot", 60)),
                     Shape::make(crooked("sphere", 40))};
    sample.bodies = {{0, 0, Body::never, {}}, {1, 0, Body::never, {}}, {1, 0, 12, {}}, {0, 0, Body::never, {}},
                     {2, 0, Body::never, {}}, {2, 7, Body::never, {}}, {1, 9, 20, {}}};
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < sample.bodies.size(); ++i)
        poses.push_back(pose_from_quaternion({10 * uniform(), 10 * uniform(), 1e-3 * uniform()}, uniform(), uniform(),
                                             uniform(), uniform()));
    std::vector<Pair> pairs;
    for (std::uint32_t step = 0; step < steps; ++step) {
        for (std::size_t i = 1; i < poses.size(); ++i) poses[i] = moved(poses[i]);
        for (std::uint32_t a = 0; a < poses.size(); ++a) {
            for (std::uint32_t b = a + 1; b < poses.size(); ++b) {
                const Pair pair{BodyId{a}, BodyId{b}};
                const auto at = std::lower_bound(pairs.begin(), pairs.end(), pair);
                const bool had = at != pairs.end() && *at == pair;
                const bool there = sample.bodies[a].alive(step) && sample.bodies[b].alive(step);
                const bool change = numbers() % 5 == 0;
                if (had && (change || !there))
                    pairs.erase(at);
                else if (!had && change && there)
                    pairs.insert(at, pair);
            }
        }
        sample.poses.push_back(poses);
        sample.pairs.push_back(pairs);
    }
    return sample;
}

Feeder::Feeder(const Sample& sample, Writer& writer) : sample_(sample), writer_(writer) {
    for (const auto& shape : sample.shapes) writer.add_shape(*shape);
}

void Feeder::step() {
    std::size_t known = 0;
    for (std::uint32_t id = 0; id < sample_.bodies.size(); ++id) {
        const Body& body = sample_.bodies[id];
        if (body.first_step == next_) writer_.add_body(body.shape);
        if (body.end_step == next_) writer_.remove_body({id});
        if (body.first_step <= next_) ++known;
    }
    // As a broad phase may hand them over: backwards, either way round, some twice.
    std::vector<Pair> pairs(sample_.pairs[next_].rbegin(), sample_.pairs[next_].rend());
    for (std::size_t i = 0; i < pairs.size(); i += 2) std::swap(pairs[i].first, pairs[i].second);
    if (!pairs.empty()) pairs.push_back(pairs.front());
    writer_.step(std::span(sample_.poses[next_]).first(known), pairs);
    ++next_;
}

void record(const Sample& sample, const std::filesystem::path& file, bool finish, const WriterOptions& options) {
    Writer writer(file, sample.info, options);
    Feeder feeder(sample, writer);
    while (feeder.steps() < sample.steps()) feeder.step();
    if (finish) writer.finish(sample.hash);
}

namespace {

template <class T>
bool same_bits(std::span<const T> p, std::span<const T> q) {
    return p.size() == q.size() && (p.empty() || std::memcmp(p.data(), q.data(), p.size_bytes()) == 0);
}

bool same_bits(const Pose& p, const Pose& q) {
    using Bits = std::array<std::uint64_t, sizeof(Pose) / sizeof(double)>;
    return std::bit_cast<Bits>(p) == std::bit_cast<Bits>(q);
}

bool same_shape(const Shape& p, const Shape& q) {
    return p.name() == q.name() && to_json(p.report()) == to_json(q.report()) && p.centre() == q.centre()
           && p.radius() == q.radius() && same_bits(p.vertices(), q.vertices())
           && same_bits(p.triangles(), q.triangles()) && same_bits(p.vertex_index(), q.vertex_index())
           && same_bits(p.triangle_index(), q.triangle_index()) && same_bits(p.vertex_normals(), q.vertex_normals())
           && same_bits(p.exit_distances(), q.exit_distances());
}

bool same_info(const Info& p, const Info& q) {
    return p.scene == q.scene && p.seed == q.seed && p.bodies == q.bodies && p.dt == q.dt
           && p.mesh_source == q.mesh_source && p.settings.method == q.settings.method
           && p.settings.paper.caster == q.settings.paper.caster && p.settings.direction == q.settings.direction
           && p.settings.execution.devices == q.settings.execution.devices
           && p.settings.execution.threads == q.settings.execution.threads
           && p.settings.paper.displacement_threshold == q.settings.paper.displacement_threshold
           && p.settings.paper.confidence == q.settings.paper.confidence
           && p.settings.paper.culling_distance == q.settings.paper.culling_distance
           && p.settings.paper.distance_extension == q.settings.paper.distance_extension
           && p.settings.paper.max_iterations == q.settings.paper.max_iterations
           && p.settings.paper.cast_lost_walks == q.settings.paper.cast_lost_walks
           && p.settings.paper.skip_outside == q.settings.paper.skip_outside
           && p.settings.max_contacts_per_pair == q.settings.max_contacts_per_pair
           && p.settings.max_contacts == q.settings.max_contacts;
}

} // namespace

std::string difference(const Sample& sample, Reader& reader, std::uint32_t steps) {
    if (!same_info(sample.info, reader.info())) return "info";
    if (reader.steps() != steps) return "steps: " + std::to_string(reader.steps()) + " for " + std::to_string(steps);
    if (reader.shapes().size() != sample.shapes.size()) return "number of shapes";
    for (std::size_t i = 0; i < sample.shapes.size(); ++i)
        if (!same_shape(*sample.shapes[i], *reader.shapes()[i])) return "shape " + std::to_string(i);
    std::vector<Pose> poses;
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < steps; ++i) {
        reader.read_step(i, poses, pairs);
        const std::string at = " of step " + std::to_string(i);
        if (pairs != sample.pairs[i]) return "pairs" + at;
        for (std::uint32_t id = 0; id < sample.bodies.size(); ++id) {
            const Body& body = sample.bodies[id];
            if (id >= reader.bodies().size()) {
                if (body.alive(i)) return "missing body" + at;
                continue;
            }
            if (reader.bodies()[id].shape != body.shape) return "shape of a body" + at;
            if (reader.bodies()[id].alive(i) != body.alive(i)) return "life of a body" + at;
            if (body.alive(i) && !same_bits(poses[id], sample.poses[i][id])) return "pose" + at;
        }
    }
    return {};
}

TemporaryFile::TemporaryFile() {
    std::string name = (std::filesystem::temp_directory_path() / "raycontact-recording-XXXXXX").string();
    const int descriptor = mkstemp(name.data());
    if (descriptor >= 0) close(descriptor);
    path_ = name;
}

TemporaryFile::~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    std::filesystem::remove(path_.string() + ".last.part", ignored);
}

std::vector<unsigned char> bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_bytes(const std::filesystem::path& file, const std::vector<unsigned char>& bytes) {
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

std::size_t side_chunk_at(const std::vector<unsigned char>& glb) {
    std::size_t at = 12;
    while (at + 8 <= glb.size()) {
        ByteSource header{std::span<const unsigned char>(glb).subspan(at, 8)};
        const auto length = header.get<std::uint32_t>();
        if (header.get<std::uint32_t>() == side_chunk) return at;
        at += 8 + length;
    }
    return glb.size();
}

void edit_json(const std::filesystem::path& file, BlockType type,
               const std::function<void(nlohmann::ordered_json&)>& change) {
    const Bytes bytes = bytes_of(file);
    const std::size_t side = side_chunk_at(bytes), data = side + 8;
    const auto end =
        bytes.begin()
        + static_cast<std::ptrdiff_t>(data + ByteSource(std::span(bytes).subspan(side, 4)).get<std::uint32_t>());
    Bytes edited(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(data + side_chunk_start.size()));
    for (auto at = bytes.begin() + static_cast<std::ptrdiff_t>(edited.size()); at != end;) {
        const std::span header_bytes(at, BlockHeader::size);
        const BlockHeader header = read_block_header(header_bytes);
        at += BlockHeader::size;
        const std::span stored(at, static_cast<std::size_t>(header.padded()));
        const auto place = static_cast<std::uint64_t>(header_bytes.data() - bytes.data()) - data;
        Bytes payload = unpack_block(header, stored, place);
        if (header.type == type) {
            auto document = nlohmann::ordered_json::parse(payload);
            change(document);
            const std::string text = document.dump();
            payload.assign(text.begin(), text.end());
        }
        const Bytes block =
            make_block(header.type, header.first_step, header.step_count, payload, edited.size() - data, Effort::quick);
        edited.insert(edited.end(), block.begin(), block.end());
        at += static_cast<std::ptrdiff_t>(header.padded());
    }
    for (std::size_t i = 0; i < 4; ++i) {
        edited[side + i] = static_cast<unsigned char>((edited.size() - data) >> (8 * i));
        edited[8 + i] = static_cast<unsigned char>(edited.size() >> (8 * i));
    }
    write_bytes(file, edited);
}
