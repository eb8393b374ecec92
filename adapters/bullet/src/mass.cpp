// SPDX-License-Identifier: Apache-2.0
#include <raycontact/bullet/mass.h>

#include <cmath>

namespace raycontact::bullet {

namespace {

using Matrix = std::array<double, 9>;

/// Jacobi's rotations; only + - * / and square roots, so the same bits from every compiler.
void find_principal_axes(MassProperties& mass) {
    Matrix a = mass.inertia, axes{1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int sweep = 0; sweep < 32; ++sweep) {
        const double off = a[1] * a[1] + a[2] * a[2] + a[5] * a[5];
        if (off <= 1e-30 * (a[0] * a[0] + a[4] * a[4] + a[8] * a[8])) break;
        for (int i = 0; i < 2; ++i) {
            for (int j = i + 1; j < 3; ++j) {
                if (a[3 * i + j] == 0) continue;
                const double theta = (a[4 * j] - a[4 * i]) / (2 * a[3 * i + j]);
                const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                const auto rotate = [&](double& x, double& y) {
                    const double before = x;
                    x = c * before - s * y;
                    y = s * before + c * y;
                };
                for (int k = 0; k < 3; ++k) rotate(a[3 * k + i], a[3 * k + j]);
                for (int k = 0; k < 3; ++k) rotate(a[3 * i + k], a[3 * j + k]);
                for (int k = 0; k < 3; ++k) rotate(axes[3 * k + i], axes[3 * k + j]);
            }
        }
    }
    mass.principal = Pose{axes, mass.centre}; // products of rotations: determinant +1
    mass.principal_inertia = {a[0], a[4], a[8]};
}

} // namespace

MassProperties mass_properties(const Shape& shape) {
    MassProperties p;
    const Vec3 low = shape.box_min(), high = shape.box_max();
    if (shape.has_inside()) static_cast<Mass&>(p) = mass_of(shape.vertices(), shape.triangles());
    if (!(p.volume > 0)) {
        const double x = high.x - low.x, y = high.y - low.y, z = high.z - low.z;
        p.volume = x * y * z;
        // A flat sheet: its box has no volume, so the mass is spread over unit thickness instead.
        if (p.volume <= 0) p.volume = 1;
        p.centre = {(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
        p.inertia = {p.volume / 12 * (y * y + z * z), 0, 0, 0, p.volume / 12 * (x * x + z * z), 0, 0, 0,
                     p.volume / 12 * (x * x + y * y)};
    }
    find_principal_axes(p);
    return p;
}

} // namespace raycontact::bullet
