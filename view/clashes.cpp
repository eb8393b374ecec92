// SPDX-License-Identifier: Apache-2.0
#include <view/clashes.h>

#include <raycontact/error.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <fstream>

namespace raycontact::view {

namespace {

using Json = nlohmann::json;

constexpr std::size_t chunk_at = 20; // behind the file's header and the chunk's

std::string first_bytes(const std::filesystem::path& file, std::size_t count) {
    std::ifstream in(file, std::ios::binary);
    std::string bytes(count, '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    return bytes;
}

ClashMark mark_of(const Json& node, std::size_t parts) {
    const Json& extras = node.at("extras");
    const auto point = node.at("translation").get<std::array<double, 3>>();
    ClashMark mark{node.at("name").get<std::string>(),
                   extras.at("kind").get<std::string>(),
                   extras.at("a").get<std::size_t>(),
                   extras.at("b").get<std::size_t>(),
                   {},
                   {point[0], point[1], point[2]}};
    if (!extras.at("depth").is_null()) mark.depth = extras.at("depth").get<double>();
    if (mark.a >= parts || mark.b >= parts) throw std::out_of_range("no such part");
    return mark;
}

} // namespace

bool is_clash_file(const std::filesystem::path& file) {
    const std::string start = first_bytes(file, 128); // the generator comes first
    return start.starts_with("glTF") && start.find("\"generator\":\"raycontact clash\"") != std::string::npos;
}

ClashFile read_clash_file(const std::filesystem::path& file) {
    ClashFile found{load_assembly(file), {}};
    try {
        // It is a sound glTF file, or it would not have been read; so there is as much of it.
        std::uint32_t length = 0;
        std::memcpy(&length, first_bytes(file, chunk_at).data() + 12, sizeof length);
        const Json root = Json::parse(first_bytes(file, chunk_at + length).substr(chunk_at));
        for (const Json& node : root.at("nodes"))
            if (!node.contains("mesh")) found.marks.push_back(mark_of(node, found.parts.size()));
    } catch (const std::exception&) {
        throw InputError(file.string() + ": is not as raycontact clash wrote it; let clash write it again (--out)");
    }
    return found;
}

} // namespace raycontact::view
