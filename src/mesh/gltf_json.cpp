// SPDX-License-Identifier: Apache-2.0
#include "mesh/gltf_json.h"

#include "mesh/byte_reader.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact {
namespace {

// tinygltf takes a property of the wrong kind for one that is not there: an `indices` of -1 would turn a mesh into a
// soup. A stack of our own, as a hostile file may nest its lists deeper than the machine's.
void check_numbers(const InputFile& file, const nlohmann::json& document) {
    static constexpr std::array whole{"mesh",       "mode",   "indices",       "bufferView", "byteOffset", "byteLength",
                                      "byteStride", "buffer", "componentType", "count",      "POSITION",   "scene"};
    std::vector<const nlohmann::json*> open;
    for (const char* section : {"nodes", "meshes", "accessors", "bufferViews", "buffers"}) {
        const auto found = document.find(section);
        if (found != document.end()) open.push_back(&*found);
    }
    const auto check = [&](const std::string& key, const nlohmann::json& value) {
        if (value.is_object() || std::find(whole.begin(), whole.end(), key) == whole.end()) return;
        if (!value.is_number_unsigned())
            file.fail("property " + in_quotes(key) + " is not a whole number of at least 0");
    };
    if (document.contains("scene")) check("scene", document["scene"]);
    while (!open.empty()) {
        const nlohmann::json& at = *open.back();
        open.pop_back();
        for (const auto& [key, value] : at.items()) {
            if (at.is_object() && (key == "extras" || key == "extensions" || key == "name")) continue;
            if (at.is_object()) check(key, value);
            if (value.is_structured()) open.push_back(&value);
        }
    }
}

/// The text of the file: all of it, or the first chunk of a GLB.
std::string_view json_of(const InputFile& file) {
    const std::string_view bytes = file.bytes;
    if (!bytes.starts_with("glTF")) return bytes;
    if (bytes.size() < 20) file.fail("is truncated in its header");
    const std::uint32_t length = read_bytes<std::uint32_t>(bytes.data() + 12);
    if (length > bytes.size() - 20) file.fail("is truncated: its first chunk has " + std::to_string(length) + " bytes");
    return bytes.substr(20, length);
}

} // namespace

void check_gltf_json(const InputFile& file) {
    const nlohmann::json document = nlohmann::json::parse(json_of(file), nullptr, false);
    if (!document.is_object()) file.fail("is no sound glTF file: its JSON is damaged");
    check_numbers(file, document);
}

} // namespace raycontact
