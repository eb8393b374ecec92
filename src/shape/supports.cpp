// SPDX-License-Identifier: Apache-2.0
#include "shape/supports.h"

#include "mesh/vector.h"
#include "shape/accelerators.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace raycontact {

namespace {

// The axes of a face of the cube, its own first.
constexpr std::array<std::array<std::size_t, 3>, 3> axes{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}};
// Of the reach of a shape: more than float32 loses of a product.
constexpr float rounding = 1e-6f;

Vec3 along_axes(std::size_t own, double x, double y, double z) {
    return own == 0 ? Vec3{x, y, z} : own == 1 ? Vec3{z, x, y} : Vec3{y, z, x};
}

} // namespace

Supports::Supports(const ShapeData& shape, Executor& executor, const std::stop_token& stop) {
    std::array<std::vector<float>, 3> at;
    for (std::vector<float>& values : at) values.reserve(shape.points.size());
    for (const Point3f& point : shape.points) {
        at[0].push_back(point.x);
        at[1].push_back(point.y);
        at[2].push_back(point.z);
    }
    std::vector<float> reaches(std::size_t{6} * corners * corners);
    run_until(executor, stop, std::size_t{6} * corners, 1, [&](std::uint32_t row) {
        const std::size_t face = row / corners, own = face / 2;
        const float sign = face % 2 == 0 ? 1.0f : -1.0f, step = 2.0f / cells;
        const float u = static_cast<float>(row % corners) * step - 1;
        const std::vector<float>&x = at[axes[own][0]], &y = at[axes[own][1]], &z = at[axes[own][2]];
        for (std::size_t k = 0; k < corners; ++k) {
            const float v = static_cast<float>(k) * step - 1;
            float most = -std::numeric_limits<float>::infinity();
            for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, sign * x[i] + (u * y[i] + v * z[i]));
            reaches[row * corners + k] = most + rounding * static_cast<float>(shape.reach);
        }
    });
    if (!stop.stop_requested()) reaches_ = std::move(reaches);
}

Supports::Supports(std::vector<float> reaches) {
    const bool fits = reaches.size() == std::size_t{6} * corners * corners;
    if (fits && std::ranges::all_of(reaches, [](float reach) { return std::isfinite(reach); }))
        reaches_ = std::move(reaches);
}

Vec3 Supports::point(const Vec3& direction) const {
    const double x = std::fabs(direction.x), y = std::fabs(direction.y), z = std::fabs(direction.z);
    const std::size_t own = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    const double along = axis(direction, axes[own][0]), scale = 0.5 * cells / std::fabs(along);
    const double u = axis(direction, axes[own][1]) * scale + 0.5 * cells;
    const double v = axis(direction, axes[own][2]) * scale + 0.5 * cells;
    const int i = std::clamp(static_cast<int>(u), 0, cells - 1), j = std::clamp(static_cast<int>(v), 0, cells - 1);
    const int face = 2 * static_cast<int>(own) + (along < 0 ? 1 : 0);
    const float* low = reaches_.data() + (face * corners + i) * corners + j;
    const double here = double(low[0]), across = double(low[corners]), beside = double(low[1]),
                 far = double(low[corners + 1]);
    const bool lower = (u - i) + (v - j) <= 1;
    // On the triangle of the grid the bound is linear: its slopes are the point.
    const double by_u = 0.5 * cells * (lower ? across - here : far - beside);
    const double by_v = 0.5 * cells * (lower ? beside - here : far - across);
    const double at_u = (lower ? i : i + 1) * (2.0 / cells) - 1, at_v = (lower ? j : j + 1) * (2.0 / cells) - 1;
    const double rest = (lower ? here : far) - at_u * by_u - at_v * by_v;
    return along_axes(own, along < 0 ? -rest : rest, by_u, by_v);
}

} // namespace raycontact
