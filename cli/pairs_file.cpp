// SPDX-License-Identifier: Apache-2.0
#include "cli/pairs_file.h"

#include "cli/json_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace {

using Json = nlohmann::json;

void read_file(const Json& value, const JsonField& field, const std::filesystem::path& folder, PairBody& body) {
    if (!value.is_string()) field.refuse(fmt::format("must be the name of a mesh file, is {}", value.type_name()));
    const auto name = value.get<std::string>();
    // A zero byte would end the name early, and another file would be opened than the one that was named.
    if (name.empty() || name.find('\0') != std::string::npos) field.refuse("is not the name of a file");
    body.file = folder / name;
}

void read_pose(const Json& value, const JsonField& field, PairBody& body) {
    for (std::size_t i = 0; value.is_array() && value.size() == 16 && i < 16; ++i)
        if (!value[i].is_number())
            field.refuse(fmt::format("entry {} must be a number, is {}", i, value[i].type_name()));
    body.pose = field.rigid();
}

void read_scale(const Json& value, const JsonField& field, PairBody& body) {
    if (!value.is_number()) field.refuse(fmt::format("must be a number > 0, is {}", value.type_name()));
    body.scale = value.get<double>();
    if (!std::isfinite(body.scale) || !(body.scale > 0))
        field.refuse(fmt::format("must be a finite number > 0, is {}", body.scale));
}

QueryPair read_pair(const Json& pair, const std::string& where, const std::filesystem::path& folder) {
    const JsonField field(pair, where);
    field.only({"a", "b", "pose_a", "pose_b", "scale_a", "scale_b"});
    QueryPair query;
    for (std::size_t side = 0; side < 2; ++side) {
        const std::string name = side == 0 ? "a" : "b";
        PairBody& body = query[side];
        body.where = where + ", " + name;
        const auto member = [&](const std::string& key) { return JsonField(pair.at(key), where + ", " + key); };
        if (!pair.contains(name)) field.refuse(fmt::format("the key \"{}\" is missing; give a mesh file", name));
        read_file(pair[name], member(name), folder, body);
        if (const std::string key = "pose_" + name; pair.contains(key)) read_pose(pair[key], member(key), body);
        if (const std::string key = "scale_" + name; pair.contains(key)) read_scale(pair[key], member(key), body);
    }
    return query;
}

} // namespace

std::vector<QueryPair> read_pairs_file(const std::filesystem::path& file) {
    const Json document = read_json_file(file, "a pairs file", 3, "pair");
    if (!document.is_array())
        JsonField(document, file.string()).refuse(std::string("must be an array of pairs, is ") + document.type_name());
    std::vector<QueryPair> pairs;
    pairs.reserve(document.size());
    for (const Json& pair : document)
        pairs.push_back(read_pair(pair, file.string() + fmt::format(": pair {}", pairs.size()), file.parent_path()));
    return pairs;
}
