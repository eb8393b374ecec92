// SPDX-License-Identifier: Apache-2.0
#include <recording/viewer_part.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace raycontact::recording {

namespace {

using Json = nlohmann::ordered_json;

enum : int { unsigned_int = 5125, float_32 = 5126, array_buffer = 34962, element_array_buffer = 34963 };

// Bodies of one mesh are told apart by colour; linear RGB.
constexpr double colours[][3] = {{0.60, 0.22, 0.10}, {0.10, 0.33, 0.55}, {0.62, 0.47, 0.13},
                                 {0.16, 0.42, 0.20}, {0.38, 0.20, 0.46}, {0.55, 0.53, 0.48}};
constexpr std::size_t colour_count = std::size(colours);

std::array<float, 3> in_float(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// The BIN chunk and what the JSON says of it.
class Buffer {
public:
    /// Everything added until the next call lies in one view; `target` 0: neither vertices nor indices.
    void start_view(int target) {
        view_ = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", 0}};
        if (target != 0) view_["target"] = target;
        views_.push_back(view_);
    }

    /// The index of the accessor.
    template <class Record>
    std::size_t add(std::span<const Record> records, const char* type, const Json& extra = Json::object()) {
        constexpr std::size_t per_record = sizeof(Record) / 4;
        Json& view = views_.back();
        const std::size_t start = view["byteOffset"].get<std::size_t>();
        Json accessor{{"bufferView", views_.size() - 1},
                      {"byteOffset", bytes_.size() - start},
                      {"componentType", float_32},
                      {"count", records.size()},
                      {"type", type}};
        accessor.update(extra);
        for (const Record& record : records) {
            if constexpr (per_record == 1)
                put(bytes_, record);
            else
                for (const auto number : record) put(bytes_, number);
        }
        view["byteLength"] = bytes_.size() - start;
        accessors_.push_back(std::move(accessor));
        return accessors_.size() - 1;
    }

    void describe(Json& document) const {
        if (accessors_.empty()) return; // glTF allows no empty lists
        document["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
        document["bufferViews"] = views_;
        document["accessors"] = accessors_;
    }

    const Bytes& bytes() const { return bytes_; }

private:
    Bytes bytes_;
    Json view_;
    Json views_ = Json::array(), accessors_ = Json::array();
};

// A mesh once per colour; they share their vertices and triangles.
Json make_meshes(std::span<const std::shared_ptr<const Shape>> shapes, Buffer& buffer) {
    Json list = Json::array();
    for (const auto& shape : shapes) {
        std::vector<std::array<float, 3>> points;
        for (const Vec3& v : shape->vertices()) points.push_back(in_float(v));
        std::array<float, 3> low = points.at(0), high = low;
        for (const auto& p : points) {
            for (std::size_t i = 0; i < 3; ++i) {
                low[i] = std::min(low[i], p[i]);
                high[i] = std::max(high[i], p[i]);
            }
        }
        buffer.start_view(array_buffer);
        const std::size_t positions =
            buffer.add(std::span<const std::array<float, 3>>(points), "VEC3", {{"min", low}, {"max", high}});
        std::vector<std::uint32_t> corners;
        for (const auto& triangle : shape->triangles()) corners.insert(corners.end(), triangle.begin(), triangle.end());
        buffer.start_view(element_array_buffer);
        const std::size_t indices =
            buffer.add(std::span<const std::uint32_t>(corners), "SCALAR", {{"componentType", unsigned_int}});
        for (std::size_t colour = 0; colour < colour_count; ++colour) {
            const Json primitive{{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", colour}};
            list.push_back({{"name", shape->name()}, {"primitives", Json::array({primitive})}});
        }
    }
    return list;
}

Json make_materials() {
    Json list = Json::array();
    for (const auto& c : colours) {
        list.push_back({{"pbrMetallicRoughness",
                         {{"baseColorFactor", {c[0], c[1], c[2], 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0.8}}},
                        {"doubleSided", true}});
    }
    return list;
}

// Node 0 turns the world upright, node i + 1 is body i.
Json make_nodes(std::span<const ViewerBody> bodies, std::span<const ViewerTrack> tracks) {
    Json list = Json::array();
    Json world{{"name", "world"}, {"rotation", {-0.7071067811865476, 0, 0, 0.7071067811865476}}};
    for (std::size_t i = 0; i < bodies.size(); ++i) world["children"].push_back(i + 1);
    list.push_back(std::move(world));
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const Vec3& t = bodies[i].start.translation;
        // What never moves is ground, in the last, dull colour.
        const bool still = !tracks.empty() && tracks[i].translations.empty();
        const std::size_t colour = still ? colour_count - 1 : i % (colour_count - 1);
        list.push_back({{"name", "body " + std::to_string(i)},
                        {"mesh", bodies[i].shape * colour_count + colour},
                        {"translation", {t.x, t.y, t.z}},
                        {"rotation", quaternion(bodies[i].start.rotation)}});
    }
    return list;
}

Json make_animation(std::span<const float> times, std::span<const ViewerTrack> tracks, Buffer& buffer) {
    Json samplers = Json::array(), channels = Json::array();
    buffer.start_view(0);
    const std::size_t time = buffer.add(times, "SCALAR", {{"min", {times.front()}}, {"max", {times.back()}}});
    const auto add = [&](std::size_t body, const char* path, std::size_t output, const char* interpolation) {
        channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", body + 1}, {"path", path}}}});
        samplers.push_back({{"input", time}, {"output", output}, {"interpolation", interpolation}});
    };
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        const ViewerTrack& track = tracks[i];
        if (!track.translations.empty()) {
            add(i, "translation", buffer.add(std::span(track.translations), "VEC3"), "LINEAR");
            add(i, "rotation", buffer.add(std::span(track.rotations), "VEC4"), "LINEAR");
        }
        if (track.sizes.empty()) continue;
        std::vector<std::array<float, 3>> scales;
        for (const float size : track.sizes) scales.push_back({size, size, size});
        add(i, "scale", buffer.add(std::span<const std::array<float, 3>>(scales), "VEC3"), "STEP");
    }
    return {{"name", "recording"}, {"channels", channels}, {"samplers", samplers}};
}

void put_chunk(Bytes& to, std::uint32_t type, std::span<const unsigned char> data, unsigned char filling) {
    const std::size_t padded = (data.size() + 3) & ~std::size_t{3};
    put(to, static_cast<std::uint32_t>(padded));
    put(to, type);
    to.insert(to.end(), data.begin(), data.end());
    to.insert(to.end(), padded - data.size(), filling);
}

} // namespace

std::array<double, 4> quaternion(const std::array<double, 9>& r) {
    const double squares[] = {1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8], 1 - r[0] - r[4] + r[8],
                              1 + r[0] + r[4] + r[8]}; // 4x^2, 4y^2, 4z^2, 4w^2
    std::array<double, 4> q{};
    switch (std::max_element(std::begin(squares), std::end(squares)) - std::begin(squares)) {
    case 0:
        q = {squares[0], r[1] + r[3], r[2] + r[6], r[7] - r[5]};
        break;
    case 1:
        q = {r[1] + r[3], squares[1], r[5] + r[7], r[2] - r[6]};
        break;
    case 2:
        q = {r[2] + r[6], r[5] + r[7], squares[2], r[3] - r[1]};
        break;
    default:
        q = {r[7] - r[5], r[2] - r[6], r[3] - r[1], squares[3]};
    }
    const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& x : q) x /= size;
    return q;
}

void ViewerTrack::add(const Pose& pose) {
    translations.push_back(in_float(pose.translation));
    const std::array<double, 4> q = quaternion(pose.rotation);
    std::array<float, 4> next{};
    for (std::size_t i = 0; i < 4; ++i) next[i] = static_cast<float>(q[i]);
    // q and -q are one rotation; viewers that interpolate number by number must not go the long way round.
    if (!rotations.empty()) {
        const auto& last = rotations.back();
        if (next[0] * last[0] + next[1] * last[1] + next[2] * last[2] + next[3] * last[3] < 0)
            for (float& x : next) x = -x;
    }
    rotations.push_back(next);
}

Bytes viewer_part(std::span<const std::shared_ptr<const Shape>> shapes, std::span<const ViewerBody> bodies,
                  std::span<const float> times, std::span<const ViewerTrack> tracks) {
    Json document{{"asset", {{"version", "2.0"}, {"generator", "RayContact"}}},
                  {"scene", 0},
                  {"scenes", Json::array({{{"nodes", {0}}}})},
                  {"nodes", make_nodes(bodies, tracks)}};
    Buffer buffer;
    if (!shapes.empty()) {
        document["materials"] = make_materials();
        document["meshes"] = make_meshes(shapes, buffer);
    }
    if (!times.empty()) {
        Json animation = make_animation(times, tracks, buffer);
        if (!animation["channels"].empty()) document["animations"] = Json::array({std::move(animation)});
    }
    buffer.describe(document);

    // A mesh's name may be any bytes; in JSON what is not UTF-8 is replaced.
    const std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (buffer.bytes().size() + text.size() > 0xffffff00u)
        throw std::length_error(
            "the meshes and the animation are more than a .glb file can hold (4 GiB); record fewer");
    Bytes file;
    put(file, glb::magic);
    put(file, glb::version);
    put(file, std::uint32_t{0});
    put_chunk(file, glb::json, {reinterpret_cast<const unsigned char*>(text.data()), text.size()}, ' ');
    if (!buffer.bytes().empty()) put_chunk(file, glb::binary, buffer.bytes(), 0);
    Bytes length;
    put(length, static_cast<std::uint32_t>(file.size()));
    std::copy(length.begin(), length.end(), file.begin() + glb::length_at);
    return file;
}

} // namespace raycontact::recording
