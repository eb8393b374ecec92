// SPDX-License-Identifier: Apache-2.0
#include "interruption.h"
#include "shape/build.h"
#include "shape/cells.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace raycontact {

namespace {

// Part of a cell, far more than the rounding of a look-up or of a ray test could cross.
constexpr double margin = 1e-2;

enum State : unsigned char { Unknown, Surface, Outside };

struct Grid {
    // Cells about half as long as an edge of the surface's triangles: memory stays a small part of the triangles'.
    // A float32 scale: the kernels must find the very cells that are tested here. The farthest look-up is that of
    // the upper corner, and in float32 it may round up into one cell more than in double.
    explicit Grid(const ShapeData& shape) {
        const auto &low = shape.header.low, &high = shape.header.high;
        const Box own = box_of(shape);
        const Vec3 extent = own.high - own.low;
        const double wanted = std::clamp(1.6 * std::sqrt(double(shape.mesh.triangles.size())), 8.0, 256.0);
        scale = static_cast<float>(wanted / std::max({extent.x, extent.y, extent.z}));
        for (int k = 0; k < 3; ++k) cells.size[k] = static_cast<int>((high[k] - low[k]) * scale) + 1;
    }

    std::size_t words() const { return (static_cast<std::size_t>(cells.count()) + 31) / 32; }

    void enter(kernels::ShapeHeader& header) const {
        for (int k = 0; k < 3; ++k) header.grid_size[k] = static_cast<kernels::uint>(cells.size[k]);
        for (int k = 0; k < 3; ++k) header.grid_low[k] = header.low[k];
        header.grid_scale = scale;
    }

    Cells cells;
    float scale; ///< cells a metre
};

} // namespace

void build_outside_grid(const ShapeData& shape, Accelerators& made, const std::stop_token& stop) {
    if (made.header.outward == 0) return;
    const Grid grid(shape);
    const auto& [cells, scale] = grid;
    const Vec3 low = box_of(shape).low;
    const auto cell_of = [&](const Vec3& at, double grow) {
        Cell cell;
        for (std::size_t k = 0; k < 3; ++k) {
            const double place = std::floor((axis(at, k) - axis(low, k)) * double(grid.scale) + grow);
            cell[k] = std::clamp(static_cast<int>(place), 0, grid.cells.size[k] - 1);
        }
        return cell;
    };

    std::vector<State> states(static_cast<std::size_t>(cells.count()), Unknown);
    std::size_t visits_left = 20 * states.size() + 1000 * shape.mesh.triangles.size();
    const double step = 1 / double(scale), half = (0.5 + margin) / double(scale);
    const InterruptionCheck check;
    for (const auto& triangle : shape.mesh.triangles) {
        check();
        const Vec3 corners[] = {shape.point(triangle[0]), shape.point(triangle[1]), shape.point(triangle[2])};
        const Box box = box_of(corners);
        const Cell from = cell_of(box.low, -margin), to = cell_of(box.high, margin);
        const Cells around{{to[0] - from[0] + 1, to[1] - from[1] + 1, to[2] - from[2] + 1}};
        const auto visits = static_cast<std::size_t>(around.count());
        // So many visits cost more than a grid could save.
        if (visits > visits_left || stop.stop_requested()) return;
        visits_left -= visits;
        const Vec3 n = cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double reach = half * (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
        for (int z = from[2]; z <= to[2]; ++z)
            for (int y = from[1]; y <= to[1]; ++y)
                for (int x = from[0]; x <= to[0]; ++x) {
                    const Vec3 middle = low + Vec3{(x + 0.5) * step, (y + 0.5) * step, (z + 0.5) * step};
                    if (std::fabs(dot(n, middle - corners[0])) <= reach) states[cells.index({x, y, z})] = Surface;
                }
    }

    // A cell at the faces of the box that no triangle touches is outside, and so is every cell that can be reached from
    // it without touching a triangle.
    cells.flood([&](int i, int) {
        const bool enters = states[i] == Unknown;
        if (enters) states[i] = Outside;
        return enters;
    });
    grid.enter(made.header);
    made.outside_cells.assign(grid.words(), 0);
    for (std::size_t i = 0; i < states.size(); ++i)
        if (states[i] == Outside) made.outside_cells[i / 32] |= 1u << (i % 32);
}

bool restore_outside_grid(const ShapeData& shape, Accelerators& made, std::vector<kernels::uint> cells) {
    if (cells.empty()) return true;
    const Grid grid(shape);
    if (made.header.outward == 0 || cells.size() != grid.words()) return false;
    grid.enter(made.header);
    made.outside_cells = std::move(cells);
    return true;
}

} // namespace raycontact
