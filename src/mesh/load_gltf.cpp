// SPDX-License-Identifier: Apache-2.0
// Our own reader over a JSON parser: tinygltf takes a property of the wrong kind for one that is not there, so that a
// damaged `indices` turns a mesh into a soup. Places in the file are named as the JSON names them: nodes[3].
#include "json_depth.h"
#include "mesh/input_file.h"
#include "mesh/vector.h"

#include <raycontact/assembly.h>
#include <raycontact/error.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

using nlohmann::json;

/// A value of the JSON, and what errors call it.
struct Item {
    const json& value;
    std::string name;
};

/// Normalised numbers are divided by `most` (KHR_mesh_quantization); 0 where a type has no such form.
struct ComponentType {
    std::size_t code;
    NumberType number;
    double most;
};

constexpr std::array component_types{
    ComponentType{5120, number_type<std::int8_t>, 127},    ComponentType{5121, number_type<std::uint8_t>, 255},
    ComponentType{5122, number_type<std::int16_t>, 32767}, ComponentType{5123, number_type<std::uint16_t>, 65535},
    ComponentType{5125, number_type<std::uint32_t>, 0},    ComponentType{5126, number_type<float>, 0}};

/// An affine map: where the axes and the origin go.
struct Placement {
    Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin;

    Vec3 turned(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
    Vec3 placed(const Vec3& p) const { return turned(p) + origin; }
    Placement after(const Placement& inner) const {
        return {turned(inner.x), turned(inner.y), turned(inner.z), placed(inner.origin)};
    }
};

// Stops at the padding, or at damage, which leaves too few bytes.
std::string decoded_base64(std::string_view text, std::size_t most) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    std::size_t bits = 0;
    int count = 0;
    bytes.reserve(std::min(most, text.size() / 4 * 3));
    for (const char c : text) {
        if (bytes.size() == most) break;
        const std::size_t digit = digits.find(c);
        if (digit == std::string_view::npos) break;
        bits = bits << 6 | digit;
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes += static_cast<char>(bits >> count & 0xff);
    }
    return bytes;
}

/// A path from a URI: %20 is a space.
std::string decoded_uri(std::string_view uri) {
    std::string path;
    for (; !uri.empty(); uri.remove_prefix(1)) {
        unsigned code = 0;
        if (uri[0] == '%' && uri.size() > 2 && std::from_chars(&uri[1], &uri[1] + 2, code, 16).ptr == &uri[1] + 2) {
            path += static_cast<char>(code);
            uri.remove_prefix(2);
        } else {
            path += uri[0];
        }
    }
    return path;
}

class GltfReader {
public:
    explicit GltfReader(const InputFile& file) : file_(file) {
        std::string_view text = file.bytes;
        if (text.starts_with("glTF")) {
            if (text.size() >= 8 && read_bytes<std::uint32_t>(&text[4]) == 1) fail_of_version_1();
            if (text.size() < 12 || read_bytes<std::uint32_t>(&text[8]) > text.size())
                file.fail("has fewer bytes than its GLB header says; it is truncated");
            if (read_bytes<std::uint32_t>(&text[4]) != 2) file.fail("is not of GLB version 2; export it as glTF 2.0");
            text = chunk(12, "JSON");
            after_json_ = 20 + text.size();
        }
        constexpr int deepest = 64; // extras may hold anything
        if (json_depth(text) > deepest)
            file.fail("nests its JSON more than " + std::to_string(deepest) + " deep; export without extras");
        json_ = json::parse(text);
        if (is_version_1()) fail_of_version_1();
        if (!text_of(needed(needed(root_, "asset"), "version")).starts_with("2"))
            file.fail("is no sound glTF file: it does not say that its version is 2");
        for (const char* key : {"scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers"}) {
            for (std::size_t i = 0; i < list(root_, key).size(); ++i) check_object(item(key, i));
        }
    }

    /// What both ways of reading begin with.
    void begin() {
        for (const json& entry : list(root_, "extensionsRequired")) {
            const std::string extension = text_of({entry, "extensionsRequired"});
            if (extension == draco) fail_of_compression("Draco");
            if (std::ranges::find(meshopt, extension) != meshopt.end()) fail_of_compression("meshopt");
            if (extension != "KHR_mesh_quantization" && extension.find("materials") == std::string::npos
                && extension.find("texture") == std::string::npos && extension.find("lights") == std::string::npos) {
                file_.fail("needs the extension " + in_quotes(extension) + "; export without it");
            }
        }
        read_buffers();
        place_nodes();
    }

    Mesh read() {
        for_each_placed_mesh([&](const Item& node, std::size_t, const Item& mesh, const Placement& placement) {
            read_mesh(mesh, node.name, placement);
        });
        return std::move(mesh_);
    }

    /// Each node that places a mesh by itself, but for those without triangles.
    std::vector<AssemblyPart> read_parts() {
        std::map<std::pair<std::size_t, std::string>, std::shared_ptr<const Mesh>> known;
        std::vector<AssemblyPart> parts;
        for_each_placed_mesh([&](const Item& node, std::size_t number, const Item& mesh, const Placement& placement) {
            if (!is_finite(placement.origin)) fail(node, "is placed where no number is finite");
            const auto [pose, own] = split(placement);
            auto& made = known[{number, key_of(own)}];
            if (!made) {
                read_mesh(mesh, node.name, own);
                before_ += mesh_.vertices.size() + mesh_.triangles.size();
                mesh_.name = name_of(node);
                made = std::make_shared<const Mesh>(std::exchange(mesh_, {}));
            }
            if (!made->triangles.empty()) parts.push_back({name_of(node), made, pose});
        });
        return parts;
    }

private:
    struct Node {
        std::vector<std::size_t> children;
        bool waits = false; ///< for its parent to be placed
        bool in_scene = false;
        Placement placement; ///< in its parent, then in the scene
    };

    /// Calls visit(node, number of its mesh, mesh, placement) in node order.
    template <class Visit>
    void for_each_placed_mesh(Visit&& visit) {
        begin();
        constexpr std::size_t most_primitives = 1u << 22; // empty ones cost time, too
        std::size_t placed = 0;
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            const Item node = item("nodes", n);
            const std::optional<Item> named = member(node, "mesh");
            if (!named) continue;
            const std::size_t number = whole(*named);
            const Item mesh = item("meshes", number);
            if (!nodes_[n].in_scene) continue;
            placed += list(mesh, "primitives").size();
            if (placed > most_primitives) file_.fail("places too many primitives; split or reduce it");
            visit(node, number, mesh, nodes_[n].placement);
        }
    }

    void read_mesh(const Item& mesh, const std::string& node, const Placement& placement) {
        const json& primitives = list(mesh, "primitives");
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            const std::string name = mesh.name + ".primitives[" + std::to_string(i) + "]";
            read_primitive({primitives[i], name}, node, placement);
        }
    }

    /// A pose, and what is left to be done to the mesh first: a scale where the placement turns and scales alike in all
    /// directions, else all but its translation.
    static std::pair<Pose, Placement> split(const Placement& placement) {
        Pose pose;
        pose.translation = placement.origin;
        const auto& [x, y, z, origin] = placement;
        const double size = std::cbrt(dot(x, cross(y, z)));
        // Files have such numbers in float32.
        constexpr double alike = 1e-5;
        const auto is_one = [&](double square) { return std::fabs(square / (size * size) - 1) < alike; };
        const auto is_none = [&](double product) { return std::fabs(product / (size * size)) < alike; };
        if (!(size > 0) || !is_one(dot(x, x)) || !is_one(dot(y, y)) || !is_one(dot(z, z)) || !is_none(dot(x, y))
            || !is_none(dot(y, z)) || !is_none(dot(z, x)))
            return {pose, {x, y, z, {}}};
        // Scales that differ by rounding alone are one: a ten-millionth is lost in float32.
        const double unit = std::pow(10.0, std::floor(std::log10(size)) - 7), scale = std::round(size / unit) * unit;
        const Vec3 &u = (1 / size) * x, &v = (1 / size) * y, &w = (1 / size) * z;
        pose = pose_from_matrix(
            std::array{u.x, v.x, w.x, origin.x, u.y, v.y, w.y, origin.y, u.z, v.z, w.z, origin.z, 0.0, 0.0, 0.0, 1.0});
        return {pose, {{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}, {}}};
    }

    static std::string key_of(const Placement& placement) {
        std::string key;
        for (const Vec3& v : {placement.x, placement.y, placement.z})
            key.append(reinterpret_cast<const char*>(&v), sizeof v);
        return key;
    }

    static constexpr std::string_view draco = "KHR_draco_mesh_compression";
    static constexpr std::array<std::string_view, 2> meshopt{"EXT_meshopt_compression", "KHR_meshopt_compression"};

    [[noreturn]] void fail_of_compression(const char* kind) const {
        file_.fail("its meshes are compressed with " + std::string(kind)
                   + ", which is not read; decompress it (`gltf-transform copy IN.glb OUT.glb` does), or export it "
                     "without compression");
    }

    /// Its lists were objects. A file may lack the version.
    bool is_version_1() const {
        if (!json_.is_object()) return false;
        const auto asset = json_.find("asset");
        if (asset != json_.end() && asset->is_object() && asset->contains("version")) {
            const json& version = (*asset)["version"];
            return version.is_string() ? version.get_ref<const std::string&>().starts_with("1")
                                       : version.is_number() && version.get<double>() < 2;
        }
        return std::ranges::any_of(std::array{"meshes", "nodes", "accessors"}, [&](const char* key) {
            const auto found = json_.find(key);
            return found != json_.end() && found->is_object();
        });
    }

    [[noreturn]] void fail_of_version_1() const {
        file_.fail("is of glTF 1.0, which is not read; convert it to glTF 2.0 (`gltf-pipeline -i IN -o OUT` does)");
    }

    bool has_extension(const Item& item, std::string_view name) const {
        const std::optional<Item> extensions = member(item, "extensions");
        return extensions && extensions->value.is_object() && extensions->value.contains(name);
    }

    [[noreturn]] void fail(const Item& item, const std::string& what) const { file_.fail(item.name + ": " + what); }

    /// The data of the chunk of a GLB that starts at `at`.
    std::string_view chunk(std::size_t at, std::string_view type) const {
        const std::string_view bytes = file_.bytes, rest = bytes.substr(std::min(at, bytes.size()));
        const std::size_t length = rest.size() < 8 ? 0 : read_bytes<std::uint32_t>(rest.data());
        if (rest.size() < 8 || !rest.substr(4).starts_with(type) || length > rest.size() - 8)
            file_.fail("has no whole chunk " + in_quotes(type) + "; it is truncated or damaged");
        return rest.substr(8, length);
    }

    /// An entry of one of the lists of the file.
    Item item(const char* key, std::size_t index) const {
        const std::string name = std::string(key) + "[" + std::to_string(index) + "]";
        const json& entries = list(root_, key);
        if (index >= entries.size()) file_.fail(name + " does not exist");
        return {entries[index], name};
    }

    void check_object(const Item& item) const {
        if (!item.value.is_object()) fail(item, "is no object");
    }

    std::string name_of(const Item& node) const {
        const std::optional<Item> name = member(node, "name");
        return name && name->value.is_string() ? printable(text_of(*name)) : node.name;
    }

    /// None where the key is missing. A null is a value, and of the wrong kind for every key.
    std::optional<Item> member(const Item& of, const char* key) const {
        check_object(of);
        const auto found = of.value.find(key);
        if (found == of.value.end()) return {};
        return Item{*found, of.name + "." + key};
    }

    Item needed(const Item& of, const char* key) const {
        if (const std::optional<Item> found = member(of, key)) return *found;
        fail(of, "has no " + std::string(key));
    }

    /// Without entries where it is missing.
    const json& list(const Item& of, const char* key) const {
        static const json none = json::array();
        const std::optional<Item> found = member(of, key);
        if (found && !found->value.is_array()) fail(*found, "is no list");
        return found ? found->value : none;
    }

    const std::string& text_of(const Item& text) const {
        if (!text.value.is_string()) fail(text, "is no text");
        return text.value.get_ref<const std::string&>();
    }

    /// False where it is missing.
    bool flag(const Item& of, const char* key) const {
        const std::optional<Item> found = member(of, key);
        if (found && !found->value.is_boolean()) fail(*found, "is neither true nor false");
        return found && found->value.get<bool>();
    }

    std::size_t whole(const Item& of, const char* key, std::optional<std::size_t> otherwise = {}) const {
        return otherwise && !member(of, key) ? *otherwise : whole(needed(of, key));
    }

    std::size_t whole(const Item& number) const {
        if (!number.value.is_number_unsigned()) fail(number, "is not a whole number of at least 0");
        return number.value.get<std::size_t>();
    }

    /// A list of nodes.
    std::vector<std::size_t> node_list(const Item& of, const char* key) const {
        std::vector<std::size_t> found;
        for (const json& entry : list(of, key)) {
            found.push_back(whole({entry, of.name + "." + key}));
            if (found.back() >= nodes_.size()) fail(of, "node " + std::to_string(found.back()) + " does not exist");
        }
        return found;
    }

    /// As many numbers as told, or none where the list is missing.
    std::vector<double> numbers(const Item& of, const char* key, std::size_t size) const {
        const json& entries = list(of, key);
        if (!member(of, key)) return {};
        if (entries.size() != size || !std::ranges::all_of(entries, [](const json& e) { return e.is_number(); }))
            fail(of, std::string(key) + " has not " + std::to_string(size) + " numbers");
        return entries.get<std::vector<double>>();
    }

    bool is_data(const Item& uri) const { return text_of(uri).starts_with("data:"); }

    std::filesystem::path path_of(const Item& uri) const {
        return file_.path.parent_path() / decoded_uri(text_of(uri));
    }

    /// The same for every way to write it.
    static std::filesystem::path key_of(const std::filesystem::path& path) {
        std::error_code error;
        const std::filesystem::path key = std::filesystem::weakly_canonical(path, error);
        return error ? path : key;
    }

    /// A file that several buffers name is read once, as far as the longest of them needs.
    void read_buffers() {
        const std::size_t count = list(root_, "buffers").size();
        for (std::size_t i = 0; i < count; ++i) {
            const Item buffer = item("buffers", i);
            const std::optional<Item> uri = member(buffer, "uri");
            if (!uri || is_data(*uri)) continue;
            std::size_t& longest = longest_[key_of(path_of(*uri))];
            longest = std::max(longest, whole(buffer, "byteLength"));
        }
        for (std::size_t i = 0; i < count; ++i) buffers_.push_back(read_buffer(i));
    }

    /// As many bytes as the buffer announces; the rest of its file is not kept.
    std::string_view read_buffer(std::size_t index) {
        const Item buffer = item("buffers", index);
        const std::size_t length = whole(buffer, "byteLength");
        std::string_view bytes;
        if (const std::optional<Item> uri = member(buffer, "uri")) {
            bytes = is_data(*uri) ? keep(decoded_data(*uri, length)) : fetched(*uri);
        } else {
            for (const std::string_view name : meshopt)
                if (has_extension(buffer, name)) fail_of_compression("meshopt");
            // The chunk of a GLB is its first buffer (glTF 2.0, section 3.6.1.2).
            if (index > 0 || !after_json_) file_.fail(buffer.name + " has no uri; it is damaged");
            bytes = chunk(*after_json_, {"BIN\0", 4});
        }
        if (bytes.size() < length) {
            fail(buffer, "has " + std::to_string(bytes.size()) + " bytes of " + std::to_string(length)
                             + "; it is truncated or damaged");
        }
        return bytes.substr(0, length);
    }

    std::string_view keep(std::string&& bytes) {
        bytes_ += bytes.size();
        return fetched_.emplace_back(std::move(bytes));
    }

    std::string_view fetched(const Item& uri) {
        const std::filesystem::path path = path_of(uri), key = key_of(path);
        std::string_view& bytes = files_[key];
        if (bytes.empty()) {
            try {
                bytes = keep(InputFile::read(path, longest_.at(key)).bytes);
            } catch (const InputError& error) {
                fail(uri, error.what());
            }
        }
        return bytes;
    }

    std::string decoded_data(const Item& uri, std::size_t most) const {
        const std::string& text = text_of(uri);
        const std::size_t data = text.find(',') + 1; // 0 where there is none
        if (!std::string_view(text).substr(0, data).ends_with(";base64,"))
            fail(uri, in_quotes(text) + " is no base64; export the buffer as a file or in base64");
        return decoded_base64(std::string_view(text).substr(data), most);
    }

    // From the roots down, so that a deep chain costs each of its nodes once.
    void place_nodes() {
        nodes_.resize(list(root_, "nodes").size());
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            const Item node = item("nodes", n);
            nodes_[n].placement = own_placement(node);
            nodes_[n].children = node_list(node, "children");
            for (const std::size_t child : nodes_[n].children) {
                if (nodes_[child].waits)
                    fail(node, "its child " + std::to_string(child) + " has two parents; nodes must form a tree");
                nodes_[child].waits = true;
            }
        }
        // The default scene, or the first; all nodes where the file has no scene.
        std::vector<std::size_t> order(nodes_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        const bool has_scene = !list(root_, "scenes").empty() || member(root_, "scene");
        for (const std::size_t n : has_scene ? node_list(item("scenes", whole(root_, "scene", 0)), "nodes") : order)
            nodes_[n].in_scene = true;
        std::erase_if(order, [&](std::size_t n) { return nodes_[n].waits; });
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Node& parent = nodes_[order[i]];
            for (const std::size_t c : parent.children) {
                Node& child = nodes_[c];
                child.placement = parent.placement.after(child.placement);
                child.in_scene = child.in_scene || parent.in_scene;
                child.waits = false;
                order.push_back(c);
            }
        }
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            if (nodes_[n].waits) fail(item("nodes", n), "is its own ancestor; nodes must form a tree");
        }
    }

    Placement own_placement(const Item& node) const {
        if (const std::vector<double> m = numbers(node, "matrix", 16); !m.empty()) // by columns
            return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
        Placement own;
        if (const std::vector<double> q = numbers(node, "rotation", 4); !q.empty()) {
            const double x = q[0], y = q[1], z = q[2], w = q[3];
            const double norm = x * x + y * y + z * z + w * w;
            if (!(norm > 0)) fail(node, "its rotation is zero");
            const double s = 2 / norm;
            own.x = {1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)};
            own.y = {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)};
            own.z = {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)};
        }
        if (const std::vector<double> scale = numbers(node, "scale", 3); !scale.empty()) {
            own.x = scale[0] * own.x;
            own.y = scale[1] * own.y;
            own.z = scale[2] * own.z;
        }
        if (const std::vector<double> t = numbers(node, "translation", 3); !t.empty()) own.origin = {t[0], t[1], t[2]};
        return own;
    }

    const ComponentType& component_type(const Item& of) const {
        const std::size_t code = whole(of, "componentType");
        for (const ComponentType& type : component_types) {
            if (type.code == code) return type;
        }
        fail(of, "component type " + std::to_string(code) + " is unknown");
    }

    const NumberType& index_type(const Item& of) const {
        const ComponentType& type = component_type(of);
        if (type.code != 5121 && type.code != 5123 && type.code != 5125)
            fail(of, "component type " + std::to_string(type.code) + ": indices must be unsigned whole numbers");
        return type.number;
    }

    /// `count` records of `width` numbers from the buffer view that `from` names.
    std::vector<double> stored(const Item& from, const NumberType& type, std::size_t count, std::size_t width) const {
        const Item view = item("bufferViews", whole(from, "bufferView"));
        const std::size_t buffer = whole(view, "buffer");
        if (buffer >= buffers_.size()) fail(view, "names a buffer that does not exist");
        const std::string_view bytes = buffers_[buffer];
        const std::size_t start = whole(view, "byteOffset", 0), length = whole(view, "byteLength");
        if (start > bytes.size() || length > bytes.size() - start)
            fail(view, "reaches beyond its buffer of " + std::to_string(bytes.size()) + " bytes");
        const std::size_t size = width * type.size, stride = whole(view, "byteStride", size);
        if (stride < size) fail(view, "has a stride of " + std::to_string(stride) + ", less than a record");
        const std::size_t offset = whole(from, "byteOffset", 0);
        const bool fits = offset <= length && size <= length - offset && count <= (length - offset - size) / stride + 1;
        if (!fits) fail(view, "is too short for the " + std::to_string(count) + " records in it");
        std::vector<double> found;
        found.reserve(count * width);
        for (std::size_t i = 0; i < count; ++i) {
            const char* const at = bytes.data() + start + offset + i * stride;
            for (std::size_t k = 0; k < width; ++k) found.push_back(type.read(at + k * type.size, true));
        }
        return found;
    }

    /// All numbers of an accessor.
    std::vector<double> read_accessor(const Item& accessor, const char* type, std::size_t width) const {
        if (text_of(needed(accessor, "type")) != type) fail(accessor, "is not of type " + std::string(type));
        const ComponentType& component = component_type(accessor);
        const std::size_t count = whole(accessor, "count");
        const std::optional<Item> sparse = member(accessor, "sparse");
        const bool has_data = member(accessor, "bufferView").has_value();
        if (!has_data && !sparse) fail(accessor, "has neither a bufferView nor sparse records");
        // Without data it starts from zeros. More than the file could ever replace are damage.
        if (!has_data && count > bytes_) fail(accessor, "has more records than the file has bytes");
        std::vector<double> found(has_data ? 0 : count * width);
        if (has_data) found = stored(accessor, component.number, count, width);
        if (sparse) {
            const Item indices = needed(*sparse, "indices"), values = needed(*sparse, "values");
            const std::size_t replaced = whole(*sparse, "count");
            if (replaced > count) fail(*sparse, "replaces more records than its accessor has");
            const std::vector<double> where = stored(indices, index_type(indices), replaced, 1);
            const std::vector<double> with = stored(values, component.number, replaced, width);
            for (std::size_t i = 0; i < replaced; ++i) {
                if (where[i] >= static_cast<double>(count))
                    fail(*sparse, "replaces a record that its accessor has not");
                for (std::size_t k = 0; k < width; ++k)
                    found[static_cast<std::size_t>(where[i]) * width + k] = with[i * width + k];
            }
        }
        if (flag(accessor, "normalized") && component.most > 0) {
            for (double& number : found) number = std::max(number / component.most, -1.0);
        }
        return found;
    }

    std::vector<std::uint32_t> corners(const Item& primitive, std::size_t vertices) const {
        std::vector<std::uint32_t> list(vertices);
        std::iota(list.begin(), list.end(), 0u);
        const std::optional<Item> indices = member(primitive, "indices");
        if (!indices) return list;
        const Item accessor = item("accessors", whole(*indices));
        index_type(accessor);
        if (flag(accessor, "normalized")) fail(accessor, "indices must not be normalized");
        list.clear();
        for (const double index : read_accessor(accessor, "SCALAR", 1)) {
            if (index >= static_cast<double>(vertices)) {
                fail(accessor, "record " + std::to_string(list.size()) + ": "
                                   + no_vertex(static_cast<std::int64_t>(index), vertices));
            }
            list.push_back(static_cast<std::uint32_t>(index));
        }
        return list;
    }

    /// Nodes times primitives grow faster than any file: what they place is bounded by what the file holds.
    void check_growth(std::size_t more) const {
        constexpr std::size_t always = 1u << 20, for_a_byte = 4;
        const std::size_t most = std::max(always, for_a_byte * bytes_);
        if (before_ + mesh_.vertices.size() + mesh_.triangles.size() + more > most) {
            file_.fail("places the same meshes so often that over " + std::to_string(most)
                       + " vertices and triangles come of its " + std::to_string(bytes_)
                       + " bytes; split it or reduce the meshes");
        }
    }

    void read_primitive(const Item& primitive, const std::string& node, const Placement& placement) {
        constexpr std::size_t triangles = 4, strip = 5, fan = 6;
        const std::size_t mode = whole(primitive, "mode", triangles);
        if (mode > fan) fail(primitive, "mode " + std::to_string(mode) + " is not in 0 to 6");
        const std::optional<Item> position = member(needed(primitive, "attributes"), "POSITION");
        if (mode < triangles || !position) return; // allowed, and nothing to see
        const Item accessor = item("accessors", whole(*position));
        if (has_extension(primitive, draco) && !member(accessor, "bufferView")) fail_of_compression("Draco");
        const std::vector<double> points = read_accessor(accessor, "VEC3", 3);
        const std::size_t base = mesh_.vertices.size();
        if (base + points.size() / 3 > most_vertices) file_.fail("has too many vertices; split or reduce it");
        check_growth(points.size() / 3);
        const std::vector<std::uint32_t> list = corners(primitive, points.size() / 3);
        const std::size_t more = mode == triangles ? list.size() / 3 : std::max<std::size_t>(list.size(), 2) - 2;
        if (mesh_.triangles.size() + more > most_triangles) file_.fail("has too many triangles; split or reduce it");
        check_growth(points.size() / 3 + more);
        for (std::size_t i = 0; i < points.size(); i += 3) {
            mesh_.vertices.push_back(placement.placed({points[i], points[i + 1], points[i + 2]}));
            if (!is_finite(mesh_.vertices.back()))
                fail(accessor, "record " + std::to_string(i / 3) + " is not finite where " + node + " places it");
        }
        // A mirroring node turns the winding over (glTF 2.0, section 3.7.4).
        const auto& [x, y, z, origin] = placement;
        const bool mirrors = dot({x.x, y.x, z.x}, cross({x.y, y.y, z.y}, {x.z, y.z, z.z})) < 0;
        if (mode == triangles && list.size() % 3 != 0) {
            fail(primitive, "triangles have " + std::to_string(list.size()) + " corners, not a multiple of 3");
        }
        for (std::size_t i = 0; i + 2 < list.size(); i += mode == triangles ? 3 : 1) {
            const std::size_t odd = mode == strip ? i % 2 : 0;
            std::array triangle{list[mode == fan ? 0 : i], list[i + 1 + odd], list[i + 2 - odd]};
            if (mirrors) std::swap(triangle[1], triangle[2]);
            for (std::uint32_t& corner : triangle) corner += static_cast<std::uint32_t>(base);
            mesh_.triangles.push_back(triangle);
        }
    }

    const InputFile& file_;
    json json_;
    const Item root_{json_, "glTF"};
    std::optional<std::size_t> after_json_;                   ///< where the second chunk of a GLB starts
    std::size_t bytes_ = file_.bytes.size();                  ///< of the file and of all that its buffers fetched
    std::deque<std::string> fetched_;                         ///< never moved: buffers look into it
    std::map<std::filesystem::path, std::size_t> longest_;    ///< of the buffers that name this file
    std::map<std::filesystem::path, std::string_view> files_; ///< that were read
    std::vector<std::string_view> buffers_;
    std::vector<Node> nodes_;
    std::size_t before_ = 0; ///< vertices and triangles of the meshes before this one, where they are read apart
    Mesh mesh_;
};

} // namespace

namespace {

template <class Read>
auto told(const InputFile& file, Read&& read) {
    try {
        return read();
    } catch (const json::parse_error& damage) {
        file.fail("is no sound glTF file: its JSON is damaged at byte " + std::to_string(damage.byte));
    } catch (const json::out_of_range&) {
        file.fail("is no sound glTF file: a number of its JSON is too large");
    } catch (const json::exception& error) {
        file.fail("is no sound glTF file: " + printable(error.what()));
    }
}

} // namespace

Mesh read_gltf(const InputFile& file) {
    return told(file, [&] { return GltfReader(file).read(); });
}

std::vector<AssemblyPart> read_gltf_parts(const InputFile& file) {
    return told(file, [&] { return GltfReader(file).read_parts(); });
}

} // namespace raycontact
