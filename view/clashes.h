// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/assembly.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace raycontact::view {

/// A node that `raycontact clash --out` puts at the point of a clash.
struct ClashMark {
    std::string name, kind;
    std::size_t a = 0, b = 0;    ///< parts
    std::optional<double> depth; ///< in the unit of the file
    Vec3 point;
};

/// What `raycontact clash --out` writes, read again.
struct ClashFile {
    std::vector<AssemblyPart> parts;
    std::vector<ClashMark> marks;
};

/// Whether the file says so of itself; false for what cannot be read.
bool is_clash_file(const std::filesystem::path& file);
/// Throws InputError as load_assembly(), and for a file that another program changed.
ClashFile read_clash_file(const std::filesystem::path& file);

} // namespace raycontact::view
