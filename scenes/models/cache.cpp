// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/cache.h>

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace raycontact::scenes {
namespace {

static_assert(std::endian::native == std::endian::little, "cached meshes and their hash are little-endian");

constexpr char magic[8] = {'R', 'A', 'Y', 'C', 'M', 'S', 'H', '1'};
struct Header {
    char magic[8];
    std::uint64_t vertices, triangles, hash;
};

std::optional<std::string> bytes_of(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
    std::ifstream in(file, std::ios::binary);
    if (!in) return std::nullopt;
    try {
        return std::string{std::istreambuf_iterator<char>(in), {}};
    } catch (const std::ios_base::failure&) { // a read error leaves the iterator this way
        return std::nullopt;
    }
}

std::string payload_of(const Mesh& mesh) {
    static_assert(sizeof mesh.vertices[0] == 24 && sizeof mesh.triangles[0] == 12);
    std::string bytes(reinterpret_cast<const char*>(mesh.vertices.data()), 24 * mesh.vertices.size());
    return bytes.append(reinterpret_cast<const char*>(mesh.triangles.data()), 12 * mesh.triangles.size());
}

} // namespace

std::filesystem::path cache_folder() {
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder == '/')
        return std::filesystem::path(folder) / "raycontact";
    if (const char* home = std::getenv("HOME"); home && *home == '/')
        return std::filesystem::path(home) / ".cache" / "raycontact";
    return {};
}

std::optional<std::uint64_t> hash_of_file(const std::filesystem::path& file) {
    const auto bytes = bytes_of(file);
    if (!bytes) return std::nullopt;
    return XXH64(bytes->data(), bytes->size(), 0);
}

std::optional<Mesh> read_cached(const std::filesystem::path& file) {
    const auto bytes = bytes_of(file);
    Header header{};
    if (!bytes || bytes->size() < sizeof header) return std::nullopt;
    std::memcpy(&header, bytes->data(), sizeof header);
    const std::uint64_t room = bytes->size() - sizeof header;
    if (std::memcmp(header.magic, magic, sizeof magic) != 0 || header.vertices > room / 24
        || header.triangles > room / 12 || 24 * header.vertices + 12 * header.triangles != room)
        return std::nullopt;
    const char* at = bytes->data() + sizeof header;
    if (XXH64(at, room, 0) != header.hash) return std::nullopt;
    Mesh mesh;
    mesh.name = file.stem().string();
    mesh.vertices.resize(header.vertices);
    mesh.triangles.resize(header.triangles);
    const std::uint64_t points = 24 * header.vertices;
    std::copy_n(at, points, reinterpret_cast<char*>(mesh.vertices.data()));
    std::copy_n(at + points, room - points, reinterpret_cast<char*>(mesh.triangles.data()));
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t)
            if (v >= mesh.vertices.size()) return std::nullopt;
    return mesh;
}

bool write_cached(const std::filesystem::path& file, const Mesh& mesh) {
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) return false;
    // The process id keeps two programs that fill the cache at once from writing into one file.
    const std::filesystem::path draft = file.string() + "." + std::to_string(::getpid()) + ".part";
    const std::string payload = payload_of(mesh);
    Header header{{}, mesh.vertices.size(), mesh.triangles.size(), XXH64(payload.data(), payload.size(), 0)};
    std::memcpy(header.magic, magic, sizeof magic);
    std::ofstream out(draft, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(&header), sizeof header);
    out.write(payload.data(), static_cast<std::streamsize>(payload.size()));
    out.close();
    if (out) std::filesystem::rename(draft, file, error);
    if (!out || error) {
        std::filesystem::remove(draft, error);
        return false;
    }
    return true;
}

} // namespace raycontact::scenes
