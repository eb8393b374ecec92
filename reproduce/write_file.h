// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace raycontact::reproduce {

/// Writes beside and renames: a reader sees the old file or the whole new one. Throws std::runtime_error naming the file.
void write_whole(const std::filesystem::path& file, const std::string& bytes);

} // namespace raycontact::reproduce
