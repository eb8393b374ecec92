// SPDX-License-Identifier: Apache-2.0
#include "mesh/measure.h"

#include <raycontact/mass.h>

namespace raycontact {

void LongSum::add(double x) {
    const double sum = sum_ + x;
    const double shadow = sum - sum_;
    rest_ += (sum_ - (sum - shadow)) + (x - shadow);
    sum_ = sum;
}

Box box_of(std::span<const Vec3> points) {
    Box box{points.front(), points.front()};
    for (const Vec3& p : points) box.add({p, p});
    return box;
}

double volume_of(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
    LongSum volume;
    if (triangles.empty()) return 0;
    const Vec3 q = box_of(vertices).middle(); // near the mesh, so that nothing cancels far from the origin
    for (const auto& [i, j, k] : triangles)
        volume.add(dot(vertices[i] - q, cross(vertices[j] - q, vertices[k] - q)) / 6);
    return volume.value();
}

// Sums over the tetrahedra (q, a, b, c), q near the mesh so that nothing cancels far from the origin. Seen from q, with
// s = a + b + c, the integral of x over one is volume / 4 * s, that of x x^T is volume / 20 * (s s^T + a a^T + b b^T +
// c c^T). The volume is the one that reports show; the centre is a quotient of plain sums, since the procedural meshes
// depend on its bits.
Mass mass_of(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
    Mass mass;
    if (triangles.empty()) return mass;
    const Vec3 q = box_of(vertices).middle();
    double six_volumes = 0;
    Vec3 first;
    std::array<double, 9> second{};
    for (const auto& [i, j, k] : triangles) {
        const Vec3 a = vertices[i] - q, b = vertices[j] - q, c = vertices[k] - q, s = a + b + c;
        const double six = dot(a, cross(b, c));
        six_volumes += six;
        first = first + six * s;
        for (std::size_t m = 0; m < 9; ++m)
            for (const Vec3& v : {s, a, b, c}) second[m] += six * axis(v, m / 3) * axis(v, m % 3);
    }
    mass.volume = volume_of(vertices, triangles);
    if (six_volumes == 0) return mass;
    const double quarter = 4 * six_volumes;
    const Vec3 centre{first.x / quarter, first.y / quarter, first.z / quarter};
    const auto about_centre = [&](std::size_t row, std::size_t column) {
        return second[3 * row + column] / 120 - mass.volume * axis(centre, row) * axis(centre, column);
    };
    const double trace = about_centre(0, 0) + about_centre(1, 1) + about_centre(2, 2);
    for (std::size_t m = 0; m < 9; ++m) mass.inertia[m] = (m % 4 == 0 ? trace : 0) - about_centre(m / 3, m % 3);
    mass.centre = q + centre;
    return mass;
}

} // namespace raycontact
