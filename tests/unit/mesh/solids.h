// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>

#include <unistd.h>

namespace raycontact::test {

/// To float32 and back. Volatile because g++ 12 vectorises the two conversions away.
inline Vec3 rounded(const Vec3& p) {
    const volatile float x = static_cast<float>(p.x), y = static_cast<float>(p.y), z = static_cast<float>(p.z);
    return {x, y, z};
}

/// Appends a box of 8 vertices and 12 triangles, wound outward unless told otherwise.
inline void append_box(Mesh& mesh, const Vec3& low, const Vec3& high, bool outward = true) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i < 8; ++i) {
        mesh.vertices.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    }
    constexpr std::array<std::array<std::uint32_t, 4>, 6> faces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (auto [a, b, c, d] : faces) {
        if (!outward) std::swap(b, d);
        mesh.triangles.push_back({base + a, base + b, base + c});
        mesh.triangles.push_back({base + a, base + c, base + d});
    }
}

inline Mesh box(double size = 1) {
    Mesh mesh{"box", {}, {}};
    append_box(mesh, {0, 0, 0}, {size, size, size});
    return mesh;
}

/// Cubes in each other, the outermost outward, the others its cavities.
inline Mesh shells(int count) {
    Mesh mesh{"shells", {}, {}};
    for (int i = 0; i < count; ++i) {
        const double h = 1 - double(i) / (count + 1);
        append_box(mesh, {-h, -h, -h}, {h, h, h}, i == 0);
    }
    return mesh;
}

/// A torus about z with a tube that may be pinched; closed, outward. (major > minor)
inline Mesh torus(std::uint32_t around, std::uint32_t across, double major, double minor, double bump = 0) {
    Mesh mesh{"torus", {}, {}};
    constexpr double turn = 6.283185307179586;
    for (std::uint32_t i = 0; i < around; ++i) {
        for (std::uint32_t k = 0; k < across; ++k) {
            const double u = turn * i / around, v = turn * k / across;
            const double r = minor * (1 + bump * std::sin(5 * u) * std::cos(3 * v));
            mesh.vertices.push_back(
                {(major + r * std::cos(v)) * std::cos(u), (major + r * std::cos(v)) * std::sin(u), r * std::sin(v)});
            const std::uint32_t i1 = (i + 1) % around, k1 = (k + 1) % across;
            const std::uint32_t a = i * across + k, b = i1 * across + k, c = i1 * across + k1, d = i * across + k1;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    }
    return mesh;
}

inline void turn_over(Mesh& mesh) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
}

inline void append(Mesh& mesh, const Mesh& more, const Vec3& offset = {}) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& v : more.vertices) mesh.vertices.push_back({v.x + offset.x, v.y + offset.y, v.z + offset.z});
    for (const auto& t : more.triangles) mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
}

/// A folder of its own that goes with the object.
class TempFolder {
public:
    TempFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "raycontact-test-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
        path_ = pattern;
    }
    ~TempFolder() { std::filesystem::remove_all(path_); }
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::string& name, std::string_view bytes) const {
        std::ofstream out(path_ / name, std::ios::binary);
        out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        if (!out.flush()) throw std::runtime_error("cannot write " + name);
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

} // namespace raycontact::test
