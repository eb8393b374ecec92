// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace raycontact::test {

// Writers for tests: what a sound file of each format looks like.

/// Little endian on every machine the tests run on; `reverse` for big-endian files.
template <class T>
void put(std::string& out, T value, bool reverse = false) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), &value, sizeof(T));
    if (reverse) std::reverse(raw.begin(), raw.end());
    out.append(raw.data(), raw.size());
}

inline std::string text(double value) { // shortest that reads back to the same double
    std::array<char, 40> digits{};
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

inline std::string text(const Vec3& v) {
    return text(v.x) + " " + text(v.y) + " " + text(v.z);
}

inline std::string as_obj(const Mesh& mesh) {
    std::string out = "# a comment\no thing\n";
    for (const Vec3& v : mesh.vertices) out += "v " + text(v) + "\n";
    for (const auto& [a, b, c] : mesh.triangles) {
        out += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
    }
    return out;
}

inline std::string as_off(const Mesh& mesh) {
    std::string out =
        "OFF\n" + std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n";
    for (const Vec3& v : mesh.vertices) out += text(v) + "\n";
    for (const auto& [a, b, c] : mesh.triangles) {
        out += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
    }
    return out;
}

inline std::string as_ascii_stl(const Mesh& mesh) {
    std::string out = "solid a name of three words\n";
    for (const auto& t : mesh.triangles) {
        out += "facet normal 0 0 0\n outer loop\n";
        for (const std::uint32_t v : t) out += "  vertex " + text(mesh.vertices[v]) + "\n";
        out += " endloop\nendfacet\n";
    }
    return out + "endsolid a name of three words\n";
}

inline std::string as_binary_stl(const Mesh& mesh) {
    std::string out = "solid that is binary all the same";
    out.resize(80, ' ');
    put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) put(out, 0.0f);
        for (const std::uint32_t v : t) {
            put(out, static_cast<float>(mesh.vertices[v].x));
            put(out, static_cast<float>(mesh.vertices[v].y));
            put(out, static_cast<float>(mesh.vertices[v].z));
        }
        put(out, std::uint16_t{0});
    }
    return out;
}

inline std::string ply_header(const Mesh& mesh, std::string_view format) {
    return "ply\nformat " + std::string(format) + " 1.0\ncomment made by a test\nelement vertex "
           + std::to_string(mesh.vertices.size())
           + "\nproperty double x\nproperty double y\nproperty uchar red\nproperty double z\nelement face "
           + std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

inline std::string as_ascii_ply(const Mesh& mesh) {
    std::string out = ply_header(mesh, "ascii");
    for (const Vec3& v : mesh.vertices) out += text(v.x) + " " + text(v.y) + " 7 " + text(v.z) + "\n";
    for (const auto& [a, b, c] : mesh.triangles) {
        out += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
    }
    return out;
}

inline std::string as_binary_ply(const Mesh& mesh, bool big_endian = false) {
    std::string out = ply_header(mesh, big_endian ? "binary_big_endian" : "binary_little_endian");
    for (const Vec3& v : mesh.vertices) {
        put(out, v.x, big_endian);
        put(out, v.y, big_endian);
        out += '\7';
        put(out, v.z, big_endian);
    }
    for (const auto& t : mesh.triangles) {
        out += '\3';
        for (const std::uint32_t v : t) put(out, v, big_endian);
    }
    return out;
}

/// Positions, then 32-bit indices.
inline std::string gltf_buffer(const Mesh& mesh) {
    std::string out;
    for (const Vec3& v : mesh.vertices) {
        put(out, static_cast<float>(v.x));
        put(out, static_cast<float>(v.y));
        put(out, static_cast<float>(v.z));
    }
    for (const auto& t : mesh.triangles) {
        for (const std::uint32_t v : t) put(out, v);
    }
    return out;
}

/// `nodes` as JSON; `uri` is empty for the binary chunk of a GLB.
inline std::string gltf_json(const Mesh& mesh, const std::string& nodes, const std::string& uri) {
    const std::size_t points = 12 * mesh.vertices.size(), corners = 12 * mesh.triangles.size();
    const auto number = [](std::size_t n) { return std::to_string(n); };
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes
           + R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":)"
           + number(mesh.vertices.size()) + R"(,"type":"VEC3"},{"bufferView":1,"componentType":5125,"count":)"
           + number(3 * mesh.triangles.size())
           + R"(,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" + number(points)
           + R"(},{"buffer":0,"byteOffset":)" + number(points) + R"(,"byteLength":)" + number(corners)
           + R"(}],"buffers":[{"byteLength":)" + number(points + corners)
           + (uri.empty() ? "" : R"(,"uri":")" + uri + '"') + "}]}";
}

inline std::string glb(std::string json, std::string buffer) {
    while (json.size() % 4 != 0) json += ' ';
    while (buffer.size() % 4 != 0) buffer += '\0';
    std::string out = "glTF";
    put(out, std::uint32_t{2});
    put(out, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
    put(out, static_cast<std::uint32_t>(json.size()));
    out += "JSON" + json;
    put(out, static_cast<std::uint32_t>(buffer.size()));
    out += std::string("BIN\0", 4) + buffer;
    return out;
}

inline std::string as_glb(const Mesh& mesh) {
    return glb(gltf_json(mesh, R"([{"mesh":0}])", ""), gltf_buffer(mesh));
}

} // namespace raycontact::test
