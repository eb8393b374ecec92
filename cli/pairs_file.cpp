// SPDX-License-Identifier: Apache-2.0
#include "cli/pairs_file.h"

#include "cli/json_file.h"

#include <raycontact/error.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace {

using Json = nlohmann::json;
using raycontact::InputError;

constexpr std::array<std::string_view, 6> known_keys{"a", "b", "pose_a", "pose_b", "scale_a", "scale_b"};

std::filesystem::path read_path(const Json& pair, const char* key, const std::string& where,
                                const std::filesystem::path& folder) {
    const auto found = pair.find(key);
    if (found == pair.end())
        throw InputError(where + fmt::format(": the key \"{}\" is missing; give a mesh file", key));
    if (!found->is_string()) {
        throw InputError(where + fmt::format(", {}: must be the name of a mesh file, is {}", key, found->type_name()));
    }
    const auto name = found->get<std::string>();
    // A zero byte would end the name early, and another file would be opened than the one that was named.
    if (name.empty() || name.find('\0') != std::string::npos) {
        throw InputError(where + fmt::format(", {}: is not the name of a file", key));
    }
    return folder / name;
}

raycontact::Pose read_pose(const Json& pair, const std::string& key, const std::string& where) {
    const auto found = pair.find(key);
    if (found == pair.end()) return {};
    const std::string at = where + ", " + key;
    if (!found->is_array()) throw InputError(at + ": must be 16 numbers (row-major 4x4), is " + found->type_name());
    if (found->size() != 16) {
        throw InputError(at + fmt::format(": must be 16 numbers (row-major 4x4), has {}", found->size()));
    }
    std::array<double, 16> matrix{};
    for (std::size_t i = 0; i < 16; ++i) {
        const Json& number = (*found)[i];
        if (!number.is_number()) {
            throw InputError(at + fmt::format(": entry {} must be a number, is {}", i, number.type_name()));
        }
        matrix[i] = number.get<double>();
    }
    try {
        return raycontact::pose_from_matrix(matrix);
    } catch (const InputError& error) {
        throw InputError(at + ": " + error.what());
    }
}

double read_scale(const Json& pair, const std::string& key, const std::string& where) {
    const auto found = pair.find(key);
    if (found == pair.end()) return 1;
    if (!found->is_number()) throw InputError(where + ", " + key + ": must be a number > 0, is " + found->type_name());
    const double scale = found->get<double>();
    if (!std::isfinite(scale) || !(scale > 0)) {
        throw InputError(where + fmt::format(", {}: must be a finite number > 0, is {}", key, scale));
    }
    return scale;
}

} // namespace

std::vector<QueryPair> read_pairs_file(const std::filesystem::path& file) {
    const Json document = read_json_file(file, "a pairs file", 3, "pair");
    if (!document.is_array()) {
        throw InputError(file.string() + ": must be an array of pairs, is " + document.type_name());
    }
    std::vector<QueryPair> pairs;
    pairs.reserve(document.size());
    for (const Json& pair : document) {
        const std::string where = file.string() + fmt::format(": pair {}", pairs.size());
        if (!pair.is_object()) throw InputError(where + ": must be an object, is " + pair.type_name());
        for (const auto& [key, value] : pair.items()) {
            if (std::find(known_keys.begin(), known_keys.end(), key) == known_keys.end()) {
                throw InputError(where + ": the key " + quoted(key)
                                 + " is not known; known are a, b, pose_a, pose_b, scale_a, scale_b");
            }
        }
        QueryPair query;
        for (std::size_t side = 0; side < 2; ++side) {
            const char* name = side == 0 ? "a" : "b";
            const std::string suffix = side == 0 ? "_a" : "_b";
            query[side].file = read_path(pair, name, where, file.parent_path());
            query[side].pose = read_pose(pair, "pose" + suffix, where);
            query[side].scale = read_scale(pair, "scale" + suffix, where);
            query[side].where = where + ", " + name;
        }
        pairs.push_back(std::move(query));
    }
    return pairs;
}
