// SPDX-License-Identifier: Apache-2.0
#include <clash/coloured.h>

#include "mesh/measure.h"

#include <raycontact/error.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <map>
#include <optional>

namespace raycontact::clash {

namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

template <class T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The triangles of a mesh are written once. Positions are relative to the middle of its box, so that float32 keeps
/// detail far from the origin.
class Writer {
public:
    void add(const AssemblyPart& part, bool clashes) {
        const auto [known, is_new] = places_.try_emplace(part.mesh.get());
        Place& place = known->second;
        if (is_new) place = write(*part.mesh);
        std::optional<std::size_t>& mesh = place.mesh[clashes ? 0 : 1];
        if (!mesh) {
            mesh = meshes_.size();
            const Json primitive{{"attributes", {{"POSITION", place.accessor}}},
                                 {"indices", place.accessor + 1},
                                 {"material", clashes ? 0 : 1}};
            meshes_.push_back({{"primitives", Json::array({primitive})}});
        }
        const auto& r = part.pose.rotation;
        const Vec3 t = transform_point(part.pose, place.middle);
        nodes_.push_back(
            {{"name", part.name},
             {"mesh", *mesh},
             {"matrix", {r[0], r[3], r[6], 0, r[1], r[4], r[7], 0, r[2], r[5], r[8], 0, t.x, t.y, t.z, 1}}});
    }

    void mark(const std::string& name, const Clash& clash) {
        nodes_.push_back({{"name", name},
                          {"translation", {clash.point.x, clash.point.y, clash.point.z}},
                          {"extras",
                           {{"a", clash.a},
                            {"b", clash.b},
                            {"kind", to_string(clash.kind)},
                            {"depth", clash.depth ? Json(*clash.depth) : Json()},
                            {"contacts", clash.contacts}}}});
    }

    std::string glb() {
        std::vector<std::size_t> all(nodes_.size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
        const auto material = [](const char* name, std::array<double, 4> colour) -> Json {
            return {{"name", name},
                    {"doubleSided", true},
                    {"alphaMode", colour[3] < 1 ? "BLEND" : "OPAQUE"},
                    {"pbrMetallicRoughness",
                     {{"baseColorFactor", colour}, {"metallicFactor", 0}, {"roughnessFactor", 0.8}}}};
        };
        const Json root{
            {"asset", {{"version", "2.0"}, {"generator", "raycontact clash"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", all}}}},
            {"nodes", nodes_},
            {"meshes", meshes_},
            {"materials", {material("clashes", {0.8, 0.05, 0.05, 1}), material("others", {0.6, 0.6, 0.6, 0.25})}},
            {"accessors", accessors_},
            {"bufferViews", views_},
            {"buffers", {{{"byteLength", bytes_.size()}}}}};
        std::string text = root.dump(-1, ' ', false, Json::error_handler_t::replace);
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const std::size_t size = 12 + 8 + text.size() + 8 + bytes_.size();
        if (size > std::numeric_limits<std::uint32_t>::max())
            throw InputError("the coloured assembly would exceed the 4 GiB of a .glb; give fewer parts");
        const auto word = [](std::string& to, std::size_t value) { append(to, static_cast<std::uint32_t>(value)); };
        std::string glb = "glTF";
        word(glb, 2);
        word(glb, size);
        word(glb, text.size());
        glb += "JSON" + text;
        word(glb, bytes_.size());
        glb += std::string("BIN\0", 4) + bytes_;
        return glb;
    }

private:
    struct Place {
        std::size_t accessor = 0;                         ///< of the positions; the next is that of the corners
        Vec3 middle;                                      ///< of the box, the part's frame
        std::array<std::optional<std::size_t>, 2> mesh{}; ///< that clashes, and that does not
    };

    Place write(const Mesh& mesh) {
        const Vec3 middle = box_of(mesh.vertices).middle();
        std::array<float, 3> low, high;
        low.fill(std::numeric_limits<float>::infinity());
        high.fill(-std::numeric_limits<float>::infinity());
        const std::size_t positions = bytes_.size();
        for (const Vec3& v : mesh.vertices) {
            const std::array p{static_cast<float>(v.x - middle.x), static_cast<float>(v.y - middle.y),
                               static_cast<float>(v.z - middle.z)};
            for (std::size_t k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], p[k]);
                high[k] = std::max(high[k], p[k]);
            }
            append(bytes_, p);
        }
        const std::size_t indices = bytes_.size(), view = views_.size();
        for (const auto& triangle : mesh.triangles) append(bytes_, triangle);
        const auto add_view = [&](std::size_t from, std::size_t to, int target) {
            views_.push_back({{"buffer", 0}, {"byteOffset", from}, {"byteLength", to - from}, {"target", target}});
        };
        add_view(positions, indices, 34962);
        add_view(indices, bytes_.size(), 34963);
        accessors_.push_back({{"bufferView", view},
                              {"componentType", 5126},
                              {"count", mesh.vertices.size()},
                              {"type", "VEC3"},
                              {"min", low},
                              {"max", high}});
        accessors_.push_back({{"bufferView", view + 1},
                              {"componentType", 5125},
                              {"count", 3 * mesh.triangles.size()},
                              {"type", "SCALAR"}});
        return {view, middle, {}};
    }

    std::map<const Mesh*, Place> places_;
    std::string bytes_;
    Json views_ = Json::array(), accessors_ = Json::array(), meshes_ = Json::array(), nodes_ = Json::array();
};

} // namespace

std::string coloured_glb(const std::vector<AssemblyPart>& parts, const std::vector<Clash>& clashes) {
    std::vector<char> clashing(parts.size(), 0);
    for (const Clash& clash : clashes) clashing[clash.a] = clashing[clash.b] = 1;
    Writer writer;
    for (std::size_t i = 0; i < parts.size(); ++i) writer.add(parts[i], clashing[i] != 0);
    for (const Clash& clash : clashes) writer.mark(parts[clash.a].name + " x " + parts[clash.b].name, clash);
    return writer.glb();
}

} // namespace raycontact::clash
