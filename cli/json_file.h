// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// A text from a file as JSON would print it, so that a message stays one line.
std::string quoted(const std::string& text);

/// A value of a JSON document and where it is, "pile.json: bodies[3].position". Every reading function throws
/// InputError naming the place for a value of another kind or out of range.
class JsonField {
public:
    using Json = nlohmann::json;
    JsonField(const Json& value, std::string file, std::string path = {})
        : value_(&value), file_(std::move(file)), path_(std::move(path)) {}

    [[noreturn]] void refuse(const std::string& why) const; ///< "FILE: PATH: WHY"

    /// An object; keys that are none of these are refused.
    void only(std::initializer_list<const char*> keys) const;
    std::optional<JsonField> find(const char* key) const;
    JsonField at(const char* key) const;
    std::vector<std::pair<std::string, JsonField>> members() const; ///< of an object, not empty
    std::vector<JsonField> items() const;                           ///< of an array

    bool is_text() const { return value_->is_string(); }
    std::string text() const; ///< not empty
    bool truth() const;
    double number() const;       ///< finite
    double positive() const;     ///< > 0
    double not_negative() const; ///< >= 0
    double share() const;        ///< 0 to 1
    std::uint32_t count(std::uint32_t least, std::uint32_t most = std::numeric_limits<std::uint32_t>::max()) const;
    std::uint64_t whole() const;
    raycontact::Vec3 vector() const; ///< three numbers
    raycontact::Pose rigid() const;  ///< 16 numbers, row-major 4 x 4
    raycontact::Pose turned() const; ///< a quaternion w, x, y, z: a rotation about the origin

private:
    [[noreturn]] void wanted(const char* what) const;
    std::vector<double> numbers(std::size_t count, const char* what) const;
    const Json* value_;
    std::string file_, path_;
};

/// The document of an ordinary file; `what` it should be, for messages: "a scene file". A key given twice is refused,
/// as are more than `depth` lists and objects in one another. `item`: what the entries of a list of all are called.
nlohmann::json read_json_file(const std::filesystem::path& file, const std::string& what, std::size_t depth,
                              const std::string& item = {});
