// SPDX-License-Identifier: Apache-2.0
#include "cli/json_file.h"

#include <raycontact/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>
#include <system_error>

using raycontact::InputError;
using Json = nlohmann::json;

namespace {

std::string read_text_file(const std::filesystem::path& file, const std::string& what) {
    const auto fail = [&](const std::string& why) { throw InputError(file.string() + ": " + why); };
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (status.type() == std::filesystem::file_type::directory) fail("is a folder, not " + what);
    if (error) fail("cannot be opened: " + error.message());
    // A pipe or device could block for ever or never end.
    if (status.type() != std::filesystem::file_type::regular) fail("is not an ordinary file; copy it to one");
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) fail("cannot be read: " + error.message());
    constexpr std::uintmax_t most = 1 << 30;
    if (size > most) fail(fmt::format("has {} bytes; at most {} are read: split it", size, most));
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), &std::fclose);
    if (!stream) fail(std::string("cannot be opened: ") + std::strerror(errno));
    std::string text(size, '\0');
    text.resize(std::fread(text.data(), 1, text.size(), stream.get()));
    if (std::ferror(stream.get()) != 0) fail(std::string("cannot be read: ") + std::strerror(errno));
    return text;
}

/// A parser's own words without its error code, short enough for one line.
std::string words_of(const Json::exception& error) {
    std::string text = error.what();
    if (const auto end = text.find("] "); end != std::string::npos) text.erase(0, end + 2);
    constexpr std::size_t most = 160;
    if (text.size() > most) text = text.substr(0, most) + " ...";
    return text;
}

/// Builds a document and refuses what the library would let pass. Its own parser with a callback would look through a
/// list again after each object of it.
class StrictJson : public nlohmann::json_sax<Json> {
public:
    StrictJson(std::string file, std::string what, std::size_t depth, std::string item)
        : file_(std::move(file)), what_(std::move(what)), item_(std::move(item)), depth_(depth) {}

    Json take() { return std::move(root_); }

    bool null() override { return put(nullptr); }
    bool boolean(bool value) override { return put(value); }
    bool number_integer(number_integer_t value) override { return put(value); }
    bool number_unsigned(number_unsigned_t value) override { return put(value); }
    bool number_float(number_float_t value, const string_t&) override { return put(value); }
    bool string(string_t& value) override { return put(std::move(value)); }
    bool binary(binary_t& value) override { return put(std::move(value)); }
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }
    bool key(string_t& key) override {
        const auto [member, is_new] = open_.back()->emplace(key, nullptr);
        if (!is_new) refuse("the key " + ::quoted(key) + " is given twice");
        member_ = &*member;
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const Json::exception& error) override {
        throw InputError(file_ + ": is not JSON: " + words_of(error));
    }

private:
    [[noreturn]] void refuse(const std::string& why) const {
        const bool in_item = !item_.empty() && open_.size() > 1 && root_.is_array();
        throw InputError(file_ + (in_item ? fmt::format(": {} {}: ", item_, root_.size() - 1) : ": ") + why);
    }

    Json& add(Json&& value) {
        if (open_.empty()) return root_ = std::move(value);
        if (!open_.back()->is_array()) return *member_ = std::move(value);
        open_.back()->push_back(std::move(value));
        return open_.back()->back();
    }
    bool put(Json&& value) {
        add(std::move(value));
        return true;
    }
    // What is open is the last of its parent, which does not grow meanwhile: pointers stay.
    bool open(Json&& value) {
        if (open_.size() == depth_) refuse("nested too deeply for " + what_);
        open_.push_back(&add(std::move(value)));
        return true;
    }
    bool close() {
        open_.pop_back();
        return true;
    }

    std::string file_, what_, item_;
    std::size_t depth_;
    Json root_;
    std::vector<Json*> open_;
    Json* member_ = nullptr; ///< of the innermost object, whose value comes next
};

} // namespace

std::string quoted(const std::string& text) {
    constexpr std::size_t most = 80;
    return Json(text.size() > most ? text.substr(0, most) + " ..." : text)
        .dump(-1, ' ', true, Json::error_handler_t::replace);
}

Json read_json_file(const std::filesystem::path& file, const std::string& what, std::size_t depth,
                    const std::string& item) {
    StrictJson document(file.string(), what, depth, item);
    Json::sax_parse(read_text_file(file, what), &document);
    return document.take();
}

void JsonField::refuse(const std::string& why) const {
    throw InputError(file_ + ": " + (path_.empty() ? "" : path_ + ": ") + why);
}

void JsonField::wanted(const char* what) const {
    refuse(fmt::format("must be {}, is {}", what, value_->type_name()));
}

void JsonField::only(std::initializer_list<const char*> keys) const {
    if (!value_->is_object()) wanted("an object");
    for (const auto& [key, value] : value_->items()) {
        if (std::any_of(keys.begin(), keys.end(), [&key = key](const char* known) { return key == known; })) continue;
        std::string known;
        for (const char* one : keys) known += (known.empty() ? "" : ", ") + std::string(one);
        refuse("the key " + quoted(key) + " is not known; known are " + known);
    }
}

std::optional<JsonField> JsonField::find(const char* key) const {
    if (!value_->is_object()) wanted("an object");
    const auto found = value_->find(key);
    if (found == value_->end()) return std::nullopt;
    return JsonField(*found, file_, path_.empty() ? key : path_ + "." + key);
}

JsonField JsonField::at(const char* key) const {
    auto found = find(key);
    if (!found) refuse(fmt::format("the key \"{}\" is missing", key));
    return *found;
}

std::vector<std::pair<std::string, JsonField>> JsonField::members() const {
    if (!value_->is_object() || value_->empty()) wanted("an object with at least one key");
    std::vector<std::pair<std::string, JsonField>> all;
    for (const auto& [key, value] : value_->items()) {
        const std::string shown = quoted(key);
        all.emplace_back(key, JsonField(value, file_, path_ + "." + shown.substr(1, shown.size() - 2)));
    }
    return all;
}

std::vector<JsonField> JsonField::items() const {
    if (!value_->is_array()) wanted("an array");
    std::vector<JsonField> all;
    for (const Json& item : *value_) all.emplace_back(item, file_, fmt::format("{}[{}]", path_, all.size()));
    return all;
}

std::string JsonField::text() const {
    if (!value_->is_string()) wanted("a text");
    auto text = value_->get<std::string>();
    // A zero byte would end a file's name early, and another file would be opened than the one that was named.
    if (text.empty() || text.find('\0') != std::string::npos) refuse("must not be empty or hold a zero byte");
    return text;
}

bool JsonField::truth() const {
    if (!value_->is_boolean()) wanted("true or false");
    return value_->get<bool>();
}

double JsonField::number() const {
    if (!value_->is_number()) wanted("a number");
    const double number = value_->get<double>();
    if (!std::isfinite(number)) refuse("must be finite");
    return number;
}

double JsonField::positive() const {
    const double value = number();
    if (!(value > 0)) refuse(fmt::format("must be positive, is {}", value));
    return value;
}

double JsonField::not_negative() const {
    const double value = number();
    if (!(value >= 0)) refuse(fmt::format("must not be negative, is {}", value));
    return value;
}

double JsonField::share() const {
    const double value = number();
    if (!(value >= 0 && value <= 1)) refuse(fmt::format("must be from 0 to 1, is {}", value));
    return value;
}

std::uint32_t JsonField::count(std::uint32_t least, std::uint32_t most) const {
    const std::uint64_t value = whole();
    if (value < least || value > most) refuse(fmt::format("must be from {} to {}, is {}", least, most, value));
    return static_cast<std::uint32_t>(value);
}

std::uint64_t JsonField::whole() const {
    if (!value_->is_number()) wanted("a whole number");
    if (!value_->is_number_unsigned()) refuse("must be a whole number, not negative, is " + value_->dump());
    return value_->get<std::uint64_t>();
}

std::vector<double> JsonField::numbers(std::size_t count, const char* what) const {
    if (!value_->is_array()) wanted(what);
    if (value_->size() != count) refuse(fmt::format("must be {}, has {}", what, value_->size()));
    std::vector<double> all;
    for (const JsonField& item : items()) all.push_back(item.number());
    return all;
}

raycontact::Vec3 JsonField::vector() const {
    const auto v = numbers(3, "3 numbers");
    return {v[0], v[1], v[2]};
}

raycontact::Pose JsonField::rigid() const {
    const auto matrix = numbers(16, "16 numbers (row-major 4x4)");
    try {
        return raycontact::pose_from_matrix(std::span<const double, 16>(matrix));
    } catch (const InputError& error) {
        refuse(error.what());
    }
}

raycontact::Pose JsonField::turned() const {
    const auto q = numbers(4, "4 numbers (a quaternion w, x, y, z)");
    try {
        return raycontact::pose_from_quaternion({}, q[0], q[1], q[2], q[3]);
    } catch (const InputError& error) {
        refuse(error.what());
    }
}
