// SPDX-License-Identifier: Apache-2.0
// Our own reader over a JSON parser: tinygltf takes a property of the wrong kind for one that is not there, so that a
// damaged `indices` turns a mesh into a soup. Places in the file are named as the JSON names them: nodes[3].
#include "mesh/gltf_file.h"

#include "interruption.h"
#include "json_depth.h"

#include <raycontact/error.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace raycontact {

using nlohmann::json;

/// Normalised numbers are divided by `most` (KHR_mesh_quantization); 0 where a type has no such form.
struct GltfFile::ComponentType {
    std::size_t code;
    NumberType number;
    double most;
};

namespace {

bool is_read(std::string_view extension) {
    return std::ranges::any_of(std::array{"KHR_mesh_quantization", GltfFile::instancing, GltfFile::visibility,
                                          GltfFile::levels, GltfFile::centre},
                               [&](const char* name) { return extension == name; });
}

/// By words in its name: it neither moves nor makes any while the file is at rest.
bool leaves_triangles(std::string_view extension) {
    return std::ranges::any_of(std::array{"materials", "texture", "lights", "metadata", "features", "xmp", "animation",
                                          "interactivity", "audio", "selectability", "hoverability", "manifold",
                                          "outline", "edge_visibility"},
                               [&](const char* word) { return extension.find(word) != std::string_view::npos; });
}

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

} // namespace

GltfFile::GltfFile(const InputFile& file) : file_(file), bytes_(file.bytes.size()) {
    std::string_view text = file.bytes;
    if (text.starts_with("glTF")) {
        if (text.size() >= 8 && read_bytes<std::uint32_t>(&text[4]) == 1) fail_of_version_1();
        if (text.size() < 12 || read_bytes<std::uint32_t>(&text[8]) > text.size())
            file.fail("has fewer bytes than its GLB header says; it is truncated");
        if (read_bytes<std::uint32_t>(&text[4]) != 2) file.fail("is not of GLB version 2; export it as glTF 2.0");
        text = chunk(12, "JSON");
        after_json_ = 20 + text.size();
    }
    text = text.substr(0, text.find_last_not_of(text_padding) + 1); // some fill chunks with NUL
    constexpr int deepest = 64;                                     // extras may hold anything
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

void GltfFile::read_buffers() {
    for (const json& entry : list(root_, "extensionsRequired")) {
        const std::string extension = text_of({entry, "extensionsRequired"});
        if (extension == draco) fail_of_compression("Draco");
        if (std::ranges::find(meshopt, extension) != meshopt.end()) fail_of_compression("meshopt");
        if (!is_read(extension) && !leaves_triangles(extension))
            file_.fail("needs the extension " + in_quotes(extension) + "; export without it");
    }
    // A file that several buffers name is read once, as far as the longest of them needs.
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

void GltfFile::fail_of_compression(const char* kind) const {
    file_.fail("its meshes are compressed with " + std::string(kind)
               + ", which is not read; decompress it (`gltf-transform copy IN.glb OUT.glb` does), or export it "
                 "without compression");
}

bool GltfFile::is_version_1() const {
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

void GltfFile::fail_of_version_1() const {
    file_.fail("is of glTF 1.0, which is not read; convert it to glTF 2.0 (`gltf-pipeline -i IN -o OUT` does)");
}

std::vector<std::string> GltfFile::unread_extensions() const {
    std::vector<std::string> found;
    for (const json& entry : list(root_, "extensionsUsed")) {
        const std::string& name = text_of({entry, "extensionsUsed"});
        // Compressed data that can be read lies uncompressed beside.
        if (!is_read(name) && !leaves_triangles(name) && name != draco
            && std::ranges::find(meshopt, name) == meshopt.end())
            found.push_back(printable(name));
    }
    return found;
}

std::optional<GltfFile::Item> GltfFile::extension(const Item& of, const char* name) const {
    const std::optional<Item> extensions = member(of, "extensions");
    if (!extensions || !extensions->value.is_object()) return {};
    return member(*extensions, name);
}

void GltfFile::fail(const Item& item, const std::string& what) const {
    file_.fail(item.name + ": " + what);
}

std::string_view GltfFile::chunk(std::size_t at, std::string_view type) const {
    const std::string_view bytes = file_.bytes, rest = bytes.substr(std::min(at, bytes.size()));
    const std::size_t length = rest.size() < 8 ? 0 : read_bytes<std::uint32_t>(rest.data());
    if (rest.size() < 8 || !rest.substr(4).starts_with(type) || length > rest.size() - 8)
        file_.fail("has no whole chunk " + in_quotes(type) + "; it is truncated or damaged");
    return rest.substr(8, length);
}

GltfFile::Item GltfFile::item(const char* key, std::size_t index) const {
    const std::string name = std::string(key) + "[" + std::to_string(index) + "]";
    const json& entries = list(root_, key);
    if (index >= entries.size()) file_.fail(name + " does not exist");
    return {entries[index], name};
}

void GltfFile::check_object(const Item& item) const {
    if (!item.value.is_object()) fail(item, "is no object");
}

std::string GltfFile::name_of(const Item& node) const {
    const std::optional<Item> name = member(node, "name");
    if (!name || !name->value.is_string()) return node.name;
    const std::string text = printable(text_of(*name));
    return text.empty() ? node.name : text;
}

std::optional<GltfFile::Item> GltfFile::member(const Item& of, const char* key) const {
    check_object(of);
    const auto found = of.value.find(key);
    if (found == of.value.end()) return {};
    return Item{*found, of.name + "." + key};
}

GltfFile::Item GltfFile::needed(const Item& of, const char* key) const {
    if (const std::optional<Item> found = member(of, key)) return *found;
    fail(of, "has no " + std::string(key));
}

const json& GltfFile::list(const Item& of, const char* key) const {
    static const json none = json::array();
    const std::optional<Item> found = member(of, key);
    if (found && !found->value.is_array()) fail(*found, "is no list");
    return found ? found->value : none;
}

const std::string& GltfFile::text_of(const Item& text) const {
    if (!text.value.is_string()) fail(text, "is no text");
    return text.value.get_ref<const std::string&>();
}

bool GltfFile::flag(const Item& of, const char* key) const {
    const std::optional<Item> found = member(of, key);
    if (found && !found->value.is_boolean()) fail(*found, "is neither true nor false");
    return found && found->value.get<bool>();
}

std::size_t GltfFile::whole(const Item& of, const char* key, std::optional<std::size_t> otherwise) const {
    return otherwise && !member(of, key) ? *otherwise : whole(needed(of, key));
}

std::size_t GltfFile::whole(const Item& number) const {
    if (!number.value.is_number_unsigned()) fail(number, "is not a whole number of at least 0");
    return number.value.get<std::size_t>();
}

std::vector<double> GltfFile::numbers(const Item& of, const char* key, std::size_t size) const {
    const json& entries = list(of, key);
    if (!member(of, key)) return {};
    if (entries.size() != size || !std::ranges::all_of(entries, [](const json& e) { return e.is_number(); }))
        fail(of, std::string(key) + " has not " + std::to_string(size) + " numbers");
    return entries.get<std::vector<double>>();
}

bool GltfFile::is_data(const Item& uri) const {
    return text_of(uri).starts_with("data:");
}

std::filesystem::path GltfFile::path_of(const Item& uri) const {
    if (file_.path.empty())
        fail(uri, "names the file " + in_quotes(text_of(uri))
                      + ", and bytes in memory have none beside them; make it a GLB, or load it by its path");
    return file_.path.parent_path() / decoded_uri(text_of(uri));
}

std::filesystem::path GltfFile::key_of(const std::filesystem::path& path) {
    std::error_code error;
    const std::filesystem::path key = std::filesystem::weakly_canonical(path, error);
    return error ? path : key;
}

std::string_view GltfFile::read_buffer(std::size_t index) {
    const Item buffer = item("buffers", index);
    const std::size_t length = whole(buffer, "byteLength");
    std::string_view bytes;
    if (const std::optional<Item> uri = member(buffer, "uri")) {
        bytes = is_data(*uri) ? keep(decoded_data(*uri, length)) : fetched(*uri);
    } else {
        for (const char* name : meshopt)
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

std::string_view GltfFile::keep(std::string&& bytes) {
    bytes_ += bytes.size();
    return fetched_.emplace_back(std::move(bytes));
}

std::string_view GltfFile::fetched(const Item& uri) {
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

std::string GltfFile::decoded_data(const Item& uri, std::size_t most) const {
    const std::string& text = text_of(uri);
    const std::size_t data = text.find(',') + 1; // 0 where there is none
    if (!std::string_view(text).substr(0, data).ends_with(";base64,"))
        fail(uri, in_quotes(text) + " is no base64; export the buffer as a file or in base64");
    return decoded_base64(std::string_view(text).substr(data), most);
}

const GltfFile::ComponentType& GltfFile::component_type(const Item& of) const {
    static constexpr std::array types{
        ComponentType{5120, number_type<std::int8_t>, 127},    ComponentType{5121, number_type<std::uint8_t>, 255},
        ComponentType{5122, number_type<std::int16_t>, 32767}, ComponentType{5123, number_type<std::uint16_t>, 65535},
        ComponentType{5125, number_type<std::uint32_t>, 0},    ComponentType{5126, number_type<float>, 0}};
    const std::size_t code = whole(of, "componentType");
    for (const ComponentType& type : types) {
        if (type.code == code) return type;
    }
    fail(of, "component type " + std::to_string(code) + " is unknown");
}

const NumberType& GltfFile::index_type(const Item& of) const {
    const ComponentType& type = component_type(of);
    if (type.code != 5121 && type.code != 5123 && type.code != 5125)
        fail(of, "component type " + std::to_string(type.code) + ": indices must be unsigned whole numbers");
    return type.number;
}

std::vector<double> GltfFile::stored(const Item& from, const NumberType& type, std::size_t count,
                                     std::size_t width) const {
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
    const InterruptionCheck check;
    for (std::size_t i = 0; i < count; ++i) {
        check();
        const char* const at = bytes.data() + start + offset + i * stride;
        for (std::size_t k = 0; k < width; ++k) found.push_back(type.read(at + k * type.size, true));
    }
    return found;
}

std::vector<double> GltfFile::read_accessor(const Item& accessor, const char* type, std::size_t width) const {
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
            if (where[i] >= static_cast<double>(count)) fail(*sparse, "replaces a record that its accessor has not");
            for (std::size_t k = 0; k < width; ++k)
                found[static_cast<std::size_t>(where[i]) * width + k] = with[i * width + k];
        }
    }
    if (flag(accessor, "normalized") && component.most > 0) {
        for (double& number : found) number = std::max(number / component.most, -1.0);
    }
    return found;
}

} // namespace raycontact
