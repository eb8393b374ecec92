// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace raycontact {

/// A whole file in memory, and the way its readers complain: one line that names the file.
struct InputFile {
    std::filesystem::path path;
    std::string shown; ///< the path, fit for a message
    std::string bytes;

    /// Throws InputError unless it is an ordinary file that can be read and holds something.
    static InputFile read(const std::filesystem::path& path);
    [[noreturn]] void fail(const std::string& what) const;
    [[noreturn]] void fail_at(std::size_t line, const std::string& what) const;
};

/// Text from a file, cut to a length and freed of control characters, in quotes.
std::string in_quotes(std::string_view text);
/// The same for a whole path or a library's message: one line, no quotes, not cut.
std::string printable(std::string_view text);

/// A complaint about an index, at a place that the caller names.
std::string no_vertex(std::int64_t index, std::size_t vertex_count);

// One reader a format; each throws InputError as load_mesh says. The name is set by load_mesh.
Mesh read_obj(const InputFile& file);
Mesh read_stl(const InputFile& file);
Mesh read_ply(const InputFile& file);
Mesh read_off(const InputFile& file);
Mesh read_gltf(const InputFile& file);

/// Appends the fan of a polygon. Its corners are vertex indices already checked.
template <class Corners>
void append_fan(Mesh& mesh, const Corners& corners) {
    for (std::size_t i = 2; i < corners.size(); ++i) mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

} // namespace raycontact
