// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/input_file.h"

#include <nlohmann/json.hpp>

#include <array>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact {

/// A glTF 2.0 file, or a GLB, with its buffers: properties of the right kind, and the numbers of accessors. Places in
/// the file are named as the JSON names them: nodes[3]. Whatever is not as glTF has it throws InputError naming the
/// place, or an exception of the JSON library.
class GltfFile {
public:
    using json = nlohmann::json;

    /// A value of the JSON, and what errors call it.
    struct Item {
        const json& value;
        std::string name;
    };

    /// Extensions of primitives that are compressed, and of nodes.
    static constexpr const char *draco = "KHR_draco_mesh_compression", *instancing = "EXT_mesh_gpu_instancing",
                                *visibility = "KHR_node_visibility", *levels = "MSFT_lod", *centre = "CESIUM_RTC";

    /// Reads the JSON.
    explicit GltfFile(const InputFile& file);
    /// Refuses extensions without which the file cannot be read. Needed before read_accessor().
    void read_buffers();
    [[noreturn]] void fail_of_compression(const char* kind) const;
    /// Those that the file uses and that may move or make triangles, and are not read.
    std::vector<std::string> unread_extensions() const;
    bool has_extension(const Item& item, const char* name) const { return extension(item, name).has_value(); }
    std::optional<Item> extension(const Item& of, const char* name) const;
    [[noreturn]] void fail(const Item& item, const std::string& what) const;
    /// An entry of one of the lists of the file.
    Item item(const char* key, std::size_t index) const;
    /// Its own, or its place.
    std::string name_of(const Item& node) const;
    /// None where the key is missing. A null is a value, and of the wrong kind for every key.
    std::optional<Item> member(const Item& of, const char* key) const;
    Item needed(const Item& of, const char* key) const;
    /// Without entries where it is missing.
    const json& list(const Item& of, const char* key) const;
    const std::string& text_of(const Item& text) const;
    std::size_t whole(const Item& of, const char* key, std::optional<std::size_t> otherwise = {}) const;
    std::size_t whole(const Item& number) const;
    /// False where it is missing.
    bool flag(const Item& of, const char* key) const;
    /// As many numbers as told, or none where the list is missing.
    std::vector<double> numbers(const Item& of, const char* key, std::size_t size) const;
    const NumberType& index_type(const Item& of) const;
    /// All numbers of an accessor.
    std::vector<double> read_accessor(const Item& accessor, const char* type, std::size_t width) const;

    const Item& root() const { return root_; }
    /// Of the file and of all that its buffers fetched.
    std::size_t bytes() const { return bytes_; }
    const InputFile& file() const { return file_; }

private:
    static constexpr std::array<const char*, 2> meshopt{"EXT_meshopt_compression", "KHR_meshopt_compression"};

    struct ComponentType;
    /// Its lists were objects. A file may lack the version.
    bool is_version_1() const;
    [[noreturn]] void fail_of_version_1() const;
    /// The data of the chunk of a GLB that starts at `at`.
    std::string_view chunk(std::size_t at, std::string_view type) const;
    void check_object(const Item& item) const;
    bool is_data(const Item& uri) const;
    std::filesystem::path path_of(const Item& uri) const;
    /// The same for every way to write it.
    static std::filesystem::path key_of(const std::filesystem::path& path);
    /// As many bytes as the buffer announces; the rest of its file is not kept.
    std::string_view read_buffer(std::size_t index);
    std::string_view keep(std::string&& bytes);
    std::string_view fetched(const Item& uri);
    std::string decoded_data(const Item& uri, std::size_t most) const;
    const ComponentType& component_type(const Item& of) const;
    /// `count` records of `width` numbers from the buffer view that `from` names.
    std::vector<double> stored(const Item& from, const NumberType& type, std::size_t count, std::size_t width) const;

    const InputFile& file_;
    json json_;
    const Item root_{json_, "glTF"};
    std::optional<std::size_t> after_json_; ///< where the second chunk of a GLB starts
    std::size_t bytes_;
    std::deque<std::string> fetched_;                         ///< never moved: buffers look into it
    std::map<std::filesystem::path, std::size_t> longest_;    ///< of the buffers that name this file
    std::map<std::filesystem::path, std::string_view> files_; ///< that were read
    std::vector<std::string_view> buffers_;
};

} // namespace raycontact
