// SPDX-License-Identifier: Apache-2.0
#include "cli/json_file.h"

#include <raycontact/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <span>

using raycontact::InputError;
using Json = nlohmann::json;

std::string read_text_file(const std::filesystem::path& file, const std::string& what) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) throw InputError(file.string() + ": is a folder, not " + what);
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(file.string() + ": cannot be opened: " + std::strerror(errno));
    std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (stream.bad()) throw InputError(file.string() + ": cannot be read: " + std::strerror(errno));
    return text;
}

std::string words_of(const Json::exception& error) {
    std::string text = error.what();
    if (const auto end = text.find("] "); end != std::string::npos) text.erase(0, end + 2);
    constexpr std::size_t most = 160;
    if (text.size() > most) text = text.substr(0, most) + " ...";
    return text;
}

std::string quoted(const std::string& text) {
    constexpr std::size_t most = 80;
    return Json(text.size() > most ? text.substr(0, most) + " ..." : text)
        .dump(-1, ' ', true, Json::error_handler_t::replace);
}

Json read_json_file(const std::filesystem::path& file, const std::string& what, int depth) {
    std::vector<std::set<std::string>> keys; // of the objects around the place that is read
    const auto watch = [&](int now, Json::parse_event_t event, Json& parsed) {
        if (now > depth) throw InputError(file.string() + ": nested too deeply for " + what);
        if (event == Json::parse_event_t::object_start) keys.emplace_back();
        if (event == Json::parse_event_t::object_end) keys.pop_back();
        if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
            throw InputError(file.string() + ": the key " + quoted(parsed.get<std::string>()) + " is given twice");
        return true;
    };
    try {
        return Json::parse(read_text_file(file, what), watch);
    } catch (const Json::exception& error) {
        throw InputError(file.string() + ": is not JSON: " + words_of(error));
    }
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
