// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/mass_properties.h>

#include <raycontact/error.h>

#include <algorithm>

namespace raycontact::scenes {

namespace {

Vec3 middle_of_box(std::span<const Vec3> vertices) {
    if (vertices.empty()) return {};
    Vec3 low = vertices[0], high = vertices[0];
    for (const Vec3& v : vertices) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    return {(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
}

} // namespace

MassProperties mass_of_solid(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles) {
    // Sums over the tetrahedra (q, a, b, c), q near the mesh so that nothing cancels far from the origin. The integral
    // of x x^T over a tetrahedron at the origin is det / 120 * (s s^T + a a^T + b b^T + c c^T), s = a + b + c.
    const Vec3 q = middle_of_box(vertices);
    double volume6 = 0;
    std::array<double, 3> first{};  // 24 x the integral of x
    std::array<double, 9> second{}; // 120 x the integral of x x^T
    for (const auto& triangle : triangles) {
        std::array<std::array<double, 3>, 4> p{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& v = vertices[triangle[k]];
            p[k] = {v.x - q.x, v.y - q.y, v.z - q.z};
        }
        for (std::size_t i = 0; i < 3; ++i) p[3][i] = p[0][i] + p[1][i] + p[2][i];
        const double det = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1])
                           - p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0])
                           + p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
        volume6 += det;
        for (std::size_t i = 0; i < 3; ++i) first[i] += det * p[3][i];
        for (const auto& point : p)
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j) second[3 * i + j] += det * point[i] * point[j];
    }
    MassProperties mass;
    if (!(volume6 > 0)) return mass;
    mass.volume = volume6 / 6;
    std::array<double, 3> centre{};
    for (std::size_t i = 0; i < 3; ++i) centre[i] = first[i] / (4 * volume6);
    std::array<double, 9> covariance{}; // about the centre of volume
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            covariance[3 * i + j] = second[3 * i + j] / 120 - mass.volume * centre[i] * centre[j];
    const double trace = covariance[0] + covariance[4] + covariance[8];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) mass.inertia[3 * i + j] = (i == j ? trace : 0.0) - covariance[3 * i + j];
    mass.centre = {q.x + centre[0], q.y + centre[1], q.z + centre[2]};
    return mass;
}

MassProperties mass_properties(const PreparedMesh& mesh) {
    if (!mesh.report.closed || !mesh.report.oriented || !mesh.report.outward)
        throw InputError(mesh.name + ": no mass without an inside: the mesh must be closed and wound outward");
    const MassProperties mass = mass_of_solid(mesh.vertices, mesh.triangles);
    if (!(mass.volume > 0)) throw InputError(mesh.name + ": encloses no volume, so it has no mass");
    return mass;
}

} // namespace raycontact::scenes
