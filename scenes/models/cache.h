// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace raycontact::scenes {

/// $XDG_CACHE_HOME/raycontact, else ~/.cache/raycontact, else an empty path: then nothing is cached.
std::filesystem::path cache_folder();

/// XXH64 of a file's bytes; nothing when it cannot be read.
std::optional<std::uint64_t> hash_of_file(const std::filesystem::path& file);

/// A mesh from the cache; nothing when it is missing, truncated or damaged (checked by length and XXH64). Never throws.
std::optional<Mesh> read_cached(const std::filesystem::path& file);

/// Written beside and renamed, so that a reader sees all of it or nothing. A cache that cannot be written is no error:
/// returns whether it was. Never throws.
bool write_cached(const std::filesystem::path& file, const Mesh& mesh);

} // namespace raycontact::scenes
