// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace raycontact::reproduce {

using Json = nlohmann::ordered_json;

/// Results by the settings that decide them, one JSON file each: {"key", "result"}. A file is written beside and
/// renamed, so that a run that is ended at any moment leaves whole results or none.
class Cache {
public:
    /// The folder is made where missing. Throws InputError naming it if it cannot be.
    explicit Cache(const std::filesystem::path& folder);

    /// Nothing when it is not there, damaged, or has another key.
    std::optional<Json> find(const std::string& name, const Json& key) const;
    /// Throws std::runtime_error naming a file that cannot be written.
    void keep(const std::string& name, const Json& key, const Json& result) const;

    /// Where something larger with this key lies, or is to be written: FOLDER/name-<hash of the key>ending.
    std::filesystem::path file(const std::string& name, const Json& key, const std::string& ending) const;

private:
    std::filesystem::path folder_;
};

/// Writes beside and renames: a reader sees the old file or the whole new one. Throws std::runtime_error naming the
/// file.
void write_whole(const std::filesystem::path& file, const std::string& bytes);

} // namespace raycontact::reproduce
