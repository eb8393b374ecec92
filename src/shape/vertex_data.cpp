// SPDX-License-Identifier: Apache-2.0
#include "shape/angle.h"
#include "shape/build.h"
#include "shape/mesh_rays.h"

namespace raycontact {

namespace {

// Each component in [-1, 1), by splitmix64.
Vec3 shaken(std::uint64_t vertex) {
    std::uint64_t state = vertex;
    const auto next = [&state] {
        std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
    };
    const double x = next(), y = next();
    return {x, y, next()};
}

} // namespace

std::vector<Vec3> face_normals(const ShapeData& shape) {
    std::vector<Vec3> normals;
    normals.reserve(shape.mesh.triangles.size());
    for (std::uint32_t t = 0; t < shape.mesh.triangles.size(); ++t) normals.push_back(unit(area_normal(shape, t)));
    return normals;
}

std::vector<Vec3> angle_weighted_normals(const ShapeData& shape, std::span<const Vec3> normals, Executor& executor) {
    // Angles take most of the time. Sums are made in the order of the triangles.
    std::vector<std::array<double, 3>> angles(normals.size());
    executor.each(normals.size(), 1024, [&](std::uint32_t t) {
        angles[t] = corner_angles({shape.corner(t, 0), shape.corner(t, 1), shape.corner(t, 2)});
    });
    std::vector<Vec3> sums(shape.points.size());
    for (std::uint32_t t = 0; t < normals.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            Vec3& sum = sums[shape.mesh.triangles[t][c]];
            sum = sum + angles[t][c] * normals[t];
        }
    for (Vec3& n : sums) {
        // Faces that fold back on each other leave only rounding, which points anywhere.
        const double size = length(n);
        n = size > 1e-9 ? (1 / size) * n : Vec3{};
    }
    return sums;
}

std::vector<float> measure_areas(const ShapeData& shape) {
    std::vector<double> sums(shape.points.size());
    for (std::uint32_t t = 0; t < shape.mesh.triangles.size(); ++t) {
        const double area = 0.5 * length(area_normal(shape, t));
        for (const std::uint32_t v : shape.mesh.triangles[t]) sums[v] += area / 3;
    }
    std::vector<float> areas;
    areas.reserve(sums.size());
    for (const double sum : sums) areas.push_back(static_cast<float>(sum));
    return areas;
}

void find_perturbations(ShapeData& shape) {
    shape.perturbations.resize(shape.points.size());
    for (std::uint32_t v = 0; v < shape.points.size(); ++v)
        shape.perturbations[v] = 0.01 * shaken(v) - shape.vertex_normals[v];
}

} // namespace raycontact
