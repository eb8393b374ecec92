// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/models/model.h>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace raycontact::scenes {

/// Where Debian's package glmark2-data keeps the Stanford bunny (34 835 vertices, closed).
std::filesystem::path bunny_file();

/// `file` reduced to exactly `triangles`, verified by prepare_mesh, normalised; kept in the cache folder. Nothing when
/// the file is not there, cannot be read, or no reduction passes the checks; `why_not` then says which in a few words.
std::optional<Model> reduced_bunny(const std::filesystem::path& file, std::uint32_t triangles, std::string& why_not);

} // namespace raycontact::scenes
