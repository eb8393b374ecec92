// SPDX-License-Identifier: Apache-2.0
#include "cli/clash_path.h"

#include <raycontact/error.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>

namespace raycontact {

namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == at)
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

double number_of(const std::string& text, const std::string& words) {
    double number = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (fault != std::errc() || end != text.data() + text.size() || !std::isfinite(number) || std::fabs(number) > 1e9)
        throw InputError("--range " + words + ": \"" + text + "\" is no number");
    return number;
}

Vec3 three_of(const std::string& text, const std::string& words) {
    const std::vector<std::string> numbers = split(text, ',');
    if (numbers.size() != 3)
        throw InputError("--range " + words + ": \"" + text + "\" is not three numbers with commas between");
    return {number_of(numbers[0], words), number_of(numbers[1], words), number_of(numbers[2], words)};
}

Pose turned(const Vec3& axis, const Vec3& point, double degrees) {
    const double half = degrees * std::numbers::pi / 360, s = std::sin(half);
    Pose pose = pose_from_quaternion({}, std::cos(half), s * axis.x, s * axis.y, s * axis.z);
    const Vec3 moved = transform_point(pose, point);
    pose.translation = {point.x - moved.x, point.y - moved.y, point.z - moved.z};
    return pose;
}

std::string line_of(const PathClash& c, std::span<const AssemblyPart> parts, const ClashPath& path,
                    const std::string& unit) {
    const std::string how = c.meet ? "meet" : fmt::format("{} {} apart", float(c.place.distance), unit);
    return fmt::format("{:>18}  {:>12}  {}  x  {}  at {}, {}, {}\n", how, path.at(c.place.time),
                       path_of(parts[c.moving]), path_of(parts[c.other]), c.place.point_a.x, c.place.point_a.y,
                       c.place.point_a.z);
}

} // namespace

std::string ClashPath::at(double time) const {
    const std::string value = fmt::format("{:.6g}", first + step * time);
    return word_is_first ? word + " " + value : value + " " + word;
}

ClashPath clash_path_along(const std::string& file, std::vector<AssemblyPart>& parts) {
    const auto fault = [&](const std::string& what) { return InputError("--along " + file + ": " + what); };
    std::ifstream input(file, std::ios::binary);
    if (!input) throw fault("cannot be read");
    Json json;
    try {
        json = Json::parse(input);
    } catch (const Json::exception&) {
        throw fault("is no JSON");
    }
    constexpr const char* form =
        R"(give {"moving": NAME or [NAMES], "moves": [[16 numbers], ...]}, or "poses" of one part)";
    if (!json.is_object() || !json.contains("moving") || json.contains("moves") == json.contains("poses"))
        throw fault(form);
    ClashPath path;
    path.word = "pose";
    path.word_is_first = true;
    const Json& moving = json["moving"];
    for (const Json& name : moving.is_array() ? moving : Json::array({moving})) {
        if (!name.is_string()) throw fault(form);
        path.moving.push_back(name.get<std::string>());
    }
    const bool absolute = json.contains("poses");
    const Json& list = json[absolute ? "poses" : "moves"];
    if (!list.is_array() || list.empty()) throw fault(form);
    for (std::size_t i = 0; i < list.size(); ++i) {
        std::array<double, 16> matrix{};
        if (!list[i].is_array() || list[i].size() != 16
            || !std::ranges::all_of(list[i], [](const Json& x) { return x.is_number(); }))
            throw fault(fmt::format("pose {} is not 16 numbers, the rows of a 4 x 4 matrix", i));
        for (std::size_t k = 0; k < 16; ++k) matrix[k] = list[i][k].get<double>();
        try {
            path.moves.push_back(pose_from_matrix(matrix));
        } catch (const InputError& error) {
            throw fault(fmt::format("pose {}: {}", i, error.what()));
        }
    }
    if (!absolute) return path;
    const auto named = [&](const AssemblyPart& part) { return path.moving.size() == 1 && part.name == path.moving[0]; };
    const auto part = std::ranges::find_if(parts, named);
    if (part == parts.end()) throw fault("\"poses\" are of one part, and no part has that name; give its whole name");
    part->pose = {};
    return path;
}

ClashPath clash_path_of_range(const std::string& words, const std::string& unit) {
    const std::size_t sign = words.rfind('=');
    const std::string joint = sign == std::string::npos ? "" : words.substr(sign + 1);
    const std::vector<std::string> parts = split(joint, ':');
    const bool turns = parts.size() == 5 && parts[0] == "turn", slides = parts.size() == 4 && parts[0] == "slide";
    if (sign == 0 || (!turns && !slides))
        throw InputError("--range " + words
                         + ": give NAME=turn:AXIS:POINT:FROM:TO with degrees, or NAME=slide:WAY:FROM:TO; AXIS, POINT "
                           "and WAY as x,y,z");
    ClashPath path;
    path.moving = {words.substr(0, sign)};
    path.word = turns ? "deg" : unit;
    Vec3 way = three_of(parts[1], words);
    const double size = std::hypot(way.x, way.y, way.z);
    if (size == 0) throw InputError("--range " + words + ": the " + (turns ? "axis" : "way") + " is zero");
    way = {way.x / size, way.y / size, way.z / size};
    path.first = number_of(parts[parts.size() - 2], words);
    const double last = number_of(parts.back(), words), far = last - path.first;
    if (turns) {
        const Vec3 point = three_of(parts[2], words);
        // A screw from one to the next turns by less than half a round.
        const double count = std::max(1.0, std::ceil(std::fabs(far) / 90));
        if (count > 4000) throw InputError("--range " + words + ": more than a thousand rounds");
        for (double i = 0; i <= count; ++i) path.moves.push_back(turned(way, point, path.first + far * (i / count)));
        path.step = far / count;
    } else {
        for (const double value : {path.first, last})
            path.moves.push_back({.translation = {value * way.x, value * way.y, value * way.z}});
        path.step = far;
    }
    return path;
}

std::string path_table(const PathClashReport& report, std::span<const AssemblyPart> parts, const ClashPath& path,
                       const std::string& unit) {
    std::string text;
    for (const PathClash& c : report.clashes) text += line_of(c, parts, path, unit);
    return text;
}

std::string path_json(const PathClashReport& report, std::span<const AssemblyPart> parts, const ClashPath& path) {
    std::string text;
    const auto three = [](const Vec3& v) { return Json{v.x, v.y, v.z}; };
    for (const PathClash& c : report.clashes) {
        const Json line{{"moving", parts[c.moving].name},
                        {"other", parts[c.other].name},
                        {"path_moving", path_of(parts[c.moving])},
                        {"path_other", path_of(parts[c.other])},
                        {"meet", c.meet},
                        {"at", path.first + path.step * c.place.time},
                        {"time", c.place.time},
                        {"distance", c.place.distance},
                        {"point_moving", three(c.place.point_a)},
                        {"point_other", three(c.place.point_b)}};
        text += line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    }
    return text;
}

std::string path_summary(const PathClashReport& report, std::span<const AssemblyPart> parts, const ClashPath& path,
                         const std::string& unit) {
    const auto meet = std::ranges::count(report.clashes, true, &PathClash::meet);
    std::string text = fmt::format("{} meet{} between {} and {}", meet == 1 ? "1 pair" : fmt::format("{} pairs", meet),
                                   meet == 1 ? "s" : "", path.at(0), path.at(double(path.moves.size() - 1)));
    if (report.nearest)
        text += fmt::format("; of the others {} and {} come nearest, {} {} apart at {}",
                            path_of(parts[report.nearest->moving]), path_of(parts[report.nearest->other]),
                            float(report.nearest->place.distance), unit, path.at(report.nearest->place.time));
    if (!report.faults.empty())
        text +=
            fmt::format("; {} part{} not checked", report.faults.size(), report.faults.size() == 1 ? " was" : "s were");
    return text + "\n";
}

} // namespace raycontact
