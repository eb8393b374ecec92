// SPDX-License-Identifier: Apache-2.0
#include "shape/vertex_normals.h"

#include "shape/angle.h"

namespace raycontact {

std::vector<Vec3> face_normals(std::span<const Vec3> vertices,
                               std::span<const std::array<std::uint32_t, 3>> triangles) {
    std::vector<Vec3> normals;
    normals.reserve(triangles.size());
    for (const auto& t : triangles) {
        const Vec3 n = cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]);
        const double size = length(n);
        normals.push_back(size > 0 ? (1 / size) * n : Vec3{});
    }
    return normals;
}

std::vector<Vec3> angle_weighted_normals(std::span<const Vec3> vertices,
                                         std::span<const std::array<std::uint32_t, 3>> triangles,
                                         std::span<const Vec3> face_normals) {
    std::vector<Vec3> normals(vertices.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const std::uint32_t at = triangles[i][c];
            const Vec3 a = vertices[triangles[i][(c + 1) % 3]] - vertices[at];
            const Vec3 b = vertices[triangles[i][(c + 2) % 3]] - vertices[at];
            normals[at] = normals[at] + angle_between(a, b) * face_normals[i];
        }
    }
    for (Vec3& n : normals) {
        // Faces that fold back on each other leave only rounding, which points anywhere.
        const double size = length(n);
        n = size > 1e-9 ? (1 / size) * n : Vec3{};
    }
    return normals;
}

} // namespace raycontact
