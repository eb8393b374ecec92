// SPDX-License-Identifier: Apache-2.0
#include "mesh/input_file.h"

#include "interruption.h"

#include <raycontact/error.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

namespace raycontact {

std::string lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

std::string no_vertex(std::int64_t index, std::size_t vertex_count) {
    return "vertex index " + std::to_string(index) + " is not in 0 to " + std::to_string(vertex_count) + " - 1";
}

std::string InputFile::name() const {
    return printable(path.filename().string());
}

void InputFile::fail(const std::string& what) const {
    throw InputError(shown + ": " + what);
}

void InputFile::fail_at(std::size_t line, const std::string& what) const {
    fail("line " + std::to_string(line) + ": " + what);
}

InputFile InputFile::read(const std::filesystem::path& path, std::size_t most) {
    InputFile file{path, printable(path.string()), {}};
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found) file.fail("no such file; check the path");
    if (error) file.fail("cannot be read: " + error.message());
    if (status.type() == std::filesystem::file_type::directory) file.fail("is a folder; name a mesh file in it");
    // A pipe or device could block for ever or never end.
    if (status.type() != std::filesystem::file_type::regular) file.fail("is not an ordinary file; copy it to one");
    const std::uintmax_t whole = std::filesystem::file_size(path, error), size = std::min<std::uintmax_t>(whole, most);
    if (error) file.fail("cannot be read: " + error.message());
    if (whole == 0) file.fail("is empty; export the mesh again");

    std::ifstream stream(path, std::ios::binary);
    if (!stream) file.fail(std::string("cannot be read: ") + std::strerror(errno));
    try {
        file.bytes.resize(size);
    } catch (const std::exception&) {
        file.fail("is too large for memory (" + std::to_string(size) + " bytes)");
    }
    constexpr std::size_t piece = std::size_t{1} << 24;
    for (std::size_t at = 0; at < file.bytes.size(); at += piece) {
        InterruptionCheck()();
        if (!stream.read(file.bytes.data() + at, static_cast<std::streamsize>(std::min(piece, file.bytes.size() - at))))
            file.fail("could not be read to its end; is it still being written?");
    }
    return file;
}

const InputFile& as_utf8(const InputFile& file, InputFile& room) {
    const bool little = file.bytes.starts_with("\xff\xfe");
    if (!little && !file.bytes.starts_with("\xfe\xff")) return file;
    const std::size_t size = file.bytes.size();
    if (size % 2 != 0) file.fail("is in UTF-16 and has an odd number of bytes; it is truncated");
    room = {file.path, file.shown, {}};
    room.bytes.reserve(size / 2);
    const auto unit = [&](std::size_t at) { return read_bytes<std::uint16_t>(&file.bytes[at], little); };
    const auto add = [&](std::uint32_t byte) { room.bytes += static_cast<char>(byte); };
    for (std::size_t at = 2; at < size; at += 2) {
        std::uint32_t code = unit(at);
        if (code >= 0xd800 && code < 0xe000) { // half of a pair
            const std::uint32_t low = code < 0xdc00 && at + 2 < size ? unit(at + 2) : 0;
            const bool pair = low >= 0xdc00 && low < 0xe000;
            code = pair ? 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00) : 0xfffd; // else the replacement character
            if (pair) at += 2;
        }
        if (code < 0x80) {
            add(code);
        } else if (code < 0x800) {
            add(0xc0 | code >> 6);
            add(0x80 | (code & 0x3f));
        } else {
            if (code < 0x10000) {
                add(0xe0 | code >> 12);
            } else {
                add(0xf0 | code >> 18);
                add(0x80 | (code >> 12 & 0x3f));
            }
            add(0x80 | (code >> 6 & 0x3f));
            add(0x80 | (code & 0x3f));
        }
    }
    return room;
}

} // namespace raycontact
