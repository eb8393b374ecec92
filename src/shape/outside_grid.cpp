// SPDX-License-Identifier: Apache-2.0
#include "shape/outside_grid.h"

#include "mesh/vector.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

using kernels::uint;

// Share of a cell that a look-up's rounding, or the rounding of a ray test, could cross. Far more than either.
constexpr double margin = 1e-2;

class Grid {
public:
    explicit Grid(const ShapeData& shape) : low_{shape.header.low[0], shape.header.low[1], shape.header.low[2]} {
        const float *low = shape.header.low, *high = shape.header.high;
        const double extent[3] = {double(high[0]) - low_[0], double(high[1]) - low_[1], double(high[2]) - low_[2]};
        const double longest = std::max({extent[0], extent[1], extent[2]});
        // Cells about half as long as an edge of the surface's triangles: memory stays a small part of the triangles'.
        const double wanted = std::clamp(1.6 * std::sqrt(double(shape.mesh.triangles.size())), 8.0, 256.0);
        // A float32 scale: the kernels must find the very cells that are tested here. The farthest look-up is that of
        // the upper corner, and in float32 it may round up into one cell more than in double.
        scale_ = static_cast<float>(wanted / longest);
        for (int axis = 0; axis < 3; ++axis) size_[axis] = static_cast<int>((high[axis] - low[axis]) * scale_) + 1;
        cells_.assign(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2], Unknown);
        visits_left_ = 20 * cells_.size() + 1000 * shape.mesh.triangles.size();
    }

    // False once the triangles are so long that going through the cells around them costs more than a grid could save.
    bool mark_surface(const Vec3& a, const Vec3& b, const Vec3& c) {
        const double corner[3][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}};
        int from[3], to[3];
        for (int axis = 0; axis < 3; ++axis) {
            const auto [least, most] = std::minmax({corner[0][axis], corner[1][axis], corner[2][axis]});
            from[axis] = cell_of(axis, least, -margin);
            to[axis] = cell_of(axis, most, margin);
        }
        const std::size_t visits = static_cast<std::size_t>(to[0] - from[0] + 1)
                                   * static_cast<std::size_t>(to[1] - from[1] + 1)
                                   * static_cast<std::size_t>(to[2] - from[2] + 1);
        if (visits > visits_left_) return false;
        visits_left_ -= visits;
        const Vec3 n = cross(b - a, c - a);
        const double half = (0.5 + margin) / double(scale_);
        const double reach = half * (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
        for (int z = from[2]; z <= to[2]; ++z)
            for (int y = from[1]; y <= to[1]; ++y)
                for (int x = from[0]; x <= to[0]; ++x)
                    if (std::fabs(dot(n, middle(x, y, z) - a)) <= reach) cells_[index(x, y, z)] = Surface;
        return true;
    }

    // From the faces of the box inwards: a cell there that no triangle touches is outside, and so is every cell that
    // can be reached from it without touching one.
    void flood() {
        std::vector<std::array<int, 3>> open;
        const auto enter = [&](int x, int y, int z) {
            auto& cell = cells_[index(x, y, z)];
            if (cell != Unknown) return;
            cell = Outside;
            open.push_back({x, y, z});
        };
        for (int z = 0; z < size_[2]; ++z)
            for (int y = 0; y < size_[1]; ++y)
                for (int x = 0; x < size_[0]; ++x)
                    if (x == 0 || y == 0 || z == 0 || x == size_[0] - 1 || y == size_[1] - 1 || z == size_[2] - 1)
                        enter(x, y, z);
        while (!open.empty()) {
            const auto [x, y, z] = open.back();
            open.pop_back();
            if (x > 0) enter(x - 1, y, z);
            if (y > 0) enter(x, y - 1, z);
            if (z > 0) enter(x, y, z - 1);
            if (x + 1 < size_[0]) enter(x + 1, y, z);
            if (y + 1 < size_[1]) enter(x, y + 1, z);
            if (z + 1 < size_[2]) enter(x, y, z + 1);
        }
    }

    void write(ShapeData& shape) const {
        for (int axis = 0; axis < 3; ++axis) shape.header.grid_size[axis] = static_cast<uint>(size_[axis]);
        for (int axis = 0; axis < 3; ++axis) shape.header.grid_low[axis] = static_cast<float>(low_[axis]);
        shape.header.grid_scale = scale_;
        shape.outside_cells.assign((cells_.size() + 31) / 32, 0);
        for (std::size_t i = 0; i < cells_.size(); ++i)
            if (cells_[i] == Outside) shape.outside_cells[i / 32] |= 1u << (i % 32);
    }

private:
    enum State : unsigned char { Unknown, Surface, Outside };

    std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * size_[1] + static_cast<std::size_t>(y)) * size_[0]
               + static_cast<std::size_t>(x);
    }
    int cell_of(int axis, double at, double grow) const {
        const double cell = std::floor((at - low_[axis]) * double(scale_) + grow);
        return std::clamp(static_cast<int>(cell), 0, size_[axis] - 1);
    }
    Vec3 middle(int x, int y, int z) const {
        const double step = 1 / double(scale_);
        return {low_[0] + (x + 0.5) * step, low_[1] + (y + 0.5) * step, low_[2] + (z + 0.5) * step};
    }

    double low_[3];
    float scale_;
    int size_[3];
    std::vector<State> cells_;
    std::size_t visits_left_;
};

} // namespace

void build_outside_grid(ShapeData& shape) {
    if (shape.header.outward == 0) return;
    Grid grid(shape);
    const auto point = [&](std::uint32_t v) { return Vec3{shape.points[v].x, shape.points[v].y, shape.points[v].z}; };
    for (const auto& [a, b, c] : shape.mesh.triangles)
        if (!grid.mark_surface(point(a), point(b), point(c))) return;
    grid.flood();
    grid.write(shape);
}

} // namespace raycontact
