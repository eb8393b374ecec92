// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/assembly.h>
#include <raycontact/mesh.h>

#include "printable.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>

namespace raycontact {

/// What programs fill the end of a text with: NUL and Ctrl-Z.
constexpr std::string_view text_padding("\0\x1a", 2);

/// The limits on one mesh: three corners of every triangle are counted in 32 bits.
constexpr std::size_t most_vertices = 0xfffffffeu;
constexpr std::size_t most_triangles = 0x7fffffffu / 3 - 1; // an edge has a number of 31 bits: ContactFeature::key()

/// A whole file in memory; without a path where it never was a file. Its readers report errors in one line that names
/// the file.
struct InputFile {
    std::filesystem::path path;
    std::string shown; ///< the path, fit for a message
    std::string bytes;

    /// Throws InputError unless it is an ordinary file that can be read and is not empty. Stops after `most` bytes.
    static InputFile read(const std::filesystem::path& path, std::size_t most = std::string::npos);
    /// Of the file without its folder, fit for a message.
    std::string name() const;
    [[noreturn]] void fail(const std::string& what) const;
    [[noreturn]] void fail_at(std::size_t line, const std::string& what) const;
};

/// The file itself; or `room`, filled with it in UTF-8, where it is UTF-16 with a byte order mark. No binary format
/// that is read starts so. Throws InputError where half of a unit is missing.
const InputFile& as_utf8(const InputFile& file, InputFile& room);

/// Capitals of ASCII become small letters.
std::string lower_case(std::string text);

/// An error message about an index; the caller names the place.
std::string no_vertex(std::int64_t index, std::size_t vertex_count);

// One reader a format; each throws InputError as documented at load_mesh, which sets the mesh's name.
Mesh read_obj(const InputFile& file);
Mesh read_stl(const InputFile& file);
Mesh read_ply(const InputFile& file);
Mesh read_off(const InputFile& file);
Mesh read_gltf(const InputFile& file);
Mesh read_3mf(const InputFile& file);
// Of the formats that have parts; what was left out or mended is appended to `notes`.
std::vector<AssemblyPart> read_obj_parts(const InputFile& file, std::vector<std::string>& notes);
std::vector<AssemblyPart> read_stl_parts(const InputFile& file, std::vector<std::string>& notes);
std::vector<AssemblyPart> read_gltf_parts(const InputFile& file, std::vector<std::string>& notes);
std::vector<AssemblyPart> read_3mf_parts(const InputFile& file, std::vector<std::string>& notes);

/// A number at `at` in the byte order of the file; the caller has checked that sizeof(T) bytes are there.
template <class T>
T read_bytes(const char* at, bool little_endian = true) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), at, sizeof(T));
    if (little_endian != (std::endian::native == std::endian::little)) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

/// How a binary file stores a kind of number. A double can represent every value of all kinds.
struct NumberType {
    std::size_t size;
    bool whole;
    double (*read)(const char* at, bool little_endian);
};

template <class T>
constexpr NumberType number_type{sizeof(T), std::is_integral_v<T>, [](const char* at, bool little_endian) {
                                     return static_cast<double>(read_bytes<T>(at, little_endian));
                                 }};

} // namespace raycontact
