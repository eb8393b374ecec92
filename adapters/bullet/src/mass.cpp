// SPDX-License-Identifier: Apache-2.0
#include <raycontact/bullet/mass.h>

#include <cmath>

namespace raycontact::bullet {

namespace {

using Matrix = std::array<double, 9>;

struct Moments {
    double volume = 0;
    std::array<double, 3> first{};
    Matrix second{}; ///< integrals of x_i x_j
};

/// Sum over the tetrahedra between `origin` and each triangle: exact for any closed mesh, wherever the origin.
Moments integrate(const Shape& shape, const Vec3& origin) {
    Moments m;
    for (const auto& t : shape.triangles()) {
        double p[3][3];
        for (int k = 0; k < 3; ++k) {
            const Vec3& v = shape.vertices()[t[k]];
            p[k][0] = v.x - origin.x;
            p[k][1] = v.y - origin.y;
            p[k][2] = v.z - origin.z;
        }
        const double det = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1])
                           - p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0])
                           + p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
        m.volume += det / 6;
        double sum[3];
        for (int i = 0; i < 3; ++i) {
            sum[i] = p[0][i] + p[1][i] + p[2][i];
            m.first[i] += det / 24 * sum[i];
        }
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const double own = p[0][i] * p[0][j] + p[1][i] * p[1][j] + p[2][i] * p[2][j];
                m.second[3 * i + j] += det / 120 * (sum[i] * sum[j] + own);
            }
        }
    }
    return m;
}

Matrix inertia_from(const Matrix& s) {
    const double trace = s[0] + s[4] + s[8];
    return {trace - s[0], -s[1], -s[2], -s[3], trace - s[4], -s[5], -s[6], -s[7], trace - s[8]};
}

/// Jacobi's rotations; only + - * / and square roots, so the same bits from every compiler.
void principal_axes(const MassProperties& in, MassProperties& out) {
    Matrix a = in.inertia, axes{1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int sweep = 0; sweep < 32; ++sweep) {
        const double off = a[1] * a[1] + a[2] * a[2] + a[5] * a[5];
        if (off <= 1e-30 * (a[0] * a[0] + a[4] * a[4] + a[8] * a[8])) break;
        for (int i = 0; i < 2; ++i) {
            for (int j = i + 1; j < 3; ++j) {
                if (a[3 * i + j] == 0) continue;
                const double theta = (a[4 * j] - a[4 * i]) / (2 * a[3 * i + j]);
                const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 3; ++k) {
                    const double x = a[3 * k + i], y = a[3 * k + j];
                    a[3 * k + i] = c * x - s * y;
                    a[3 * k + j] = s * x + c * y;
                }
                for (int k = 0; k < 3; ++k) {
                    const double x = a[3 * i + k], y = a[3 * j + k];
                    a[3 * i + k] = c * x - s * y;
                    a[3 * j + k] = s * x + c * y;
                }
                for (int k = 0; k < 3; ++k) {
                    const double x = axes[3 * k + i], y = axes[3 * k + j];
                    axes[3 * k + i] = c * x - s * y;
                    axes[3 * k + j] = s * x + c * y;
                }
            }
        }
    }
    out.principal = Pose{axes, in.centre}; // products of rotations: determinant +1
    out.principal_inertia = {a[0], a[4], a[8]};
}

} // namespace

MassProperties mass_properties(const Shape& shape) {
    MassProperties p;
    const Vec3 low = shape.box_min(), high = shape.box_max();
    const Vec3 middle{(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
    const Moments near_origin = shape.report().closed ? integrate(shape, middle) : Moments{};
    if (near_origin.volume > 0) {
        p.volume = near_origin.volume;
        p.centre = {middle.x + near_origin.first[0] / p.volume, middle.y + near_origin.first[1] / p.volume,
                    middle.z + near_origin.first[2] / p.volume};
        p.inertia = inertia_from(integrate(shape, p.centre).second);
    } else {
        const double x = high.x - low.x, y = high.y - low.y, z = high.z - low.z;
        p.volume = x * y * z;
        // A flat sheet: its box has no volume, so the mass is spread over unit thickness instead.
        if (p.volume <= 0) p.volume = 1;
        p.centre = middle;
        p.inertia = {p.volume / 12 * (y * y + z * z), 0, 0, 0, p.volume / 12 * (x * x + z * z), 0, 0, 0,
                     p.volume / 12 * (x * x + y * y)};
    }
    principal_axes(p, p);
    return p;
}

} // namespace raycontact::bullet
