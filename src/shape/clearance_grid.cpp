// SPDX-License-Identifier: Apache-2.0
#include "shape/build.h"
#include "shape/cells.h"
#include "shape/mesh_rays.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace raycontact {

namespace {

using kernels::uint;

constexpr double half_diagonal = 0.8660254037844387; // of a unit cell
constexpr double far = 1e15;
constexpr int pad = 4;                         // cells around the box, for balls that touch it from outside
constexpr int farthest = CLEARANCE_OFFSET - 1; // cells from a cell to the middle of its ball, each axis

// A ball that contains no surface, around the middle of a cell; lengths in cells.
struct Ball {
    Cell middle{};
    double radius = -far; // none

    // About how deep the points of a cell lie in it, on average. At the middle alone the cell's own ball would always
    // win, and it is small.
    double depth_at(const Cell& cell) const {
        const int dx = middle[0] - cell[0], dy = middle[1] - cell[1], dz = middle[2] - cell[2];
        if (radius < 0 || std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) > farthest) return -far;
        return radius - std::sqrt(double(dx * dx + dy * dy + dz * dz) + 0.6);
    }
};

// Balls follow the surface, so cells may be as long as its edges. Fine meshes have longer cells, by the power 3/4: that
// costs a few more rays, but grids of finer meshes still fit the caches.
double wanted_cells(double triangles) {
    constexpr double each = 25, coarse = 1000;
    const double finer = triangles / coarse;
    const double counted = finer < 1 ? triangles : coarse * std::sqrt(finer) * std::sqrt(std::sqrt(finer));
    return std::clamp(each * counted, 6e2, 4e6);
}

/// Where the cells lie.
struct GridPlace {
    explicit GridPlace(const ShapeData& shape) {
        const float *low = shape.header.low, *high = shape.header.high;
        double extent[3];
        for (int axis = 0; axis < 3; ++axis) extent[axis] = double(high[axis]) - double(low[axis]);
        const double longest_side = std::max({extent[0], extent[1], extent[2]});
        const double wanted = wanted_cells(double(shape.mesh.triangles.size()));
        double side = std::max(std::cbrt(extent[0] * extent[1] * extent[2] / wanted), longest_side / 200);
        const auto count = [&] {
            double product = 1;
            for (const double length : extent) product *= std::ceil(length / side) + 2 * pad;
            return product;
        };
        while (count() > 8 * wanted + 8000) side *= 1.1; // a flat mesh has hardly a volume to be divided
        scale_ = static_cast<float>(1 / side);
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis] = static_cast<float>(double(low[axis]) - pad * side);
            cells_.size[axis] = static_cast<int>(std::ceil(extent[axis] * double(scale_))) + 2 * pad;
        }
    }

    void enter(kernels::ShapeHeader& header) const {
        for (int axis = 0; axis < 3; ++axis) {
            header.clearance_low[axis] = low_[axis];
            // A look-up at the upper end, however it is rounded, is in the last cell.
            header.clearance_high[axis] =
                static_cast<float>(double(low_[axis]) + (cells_.size[axis] - 0.01) / double(scale_));
            header.clearance_size[axis] = static_cast<uint>(cells_.size[axis]);
        }
        header.clearance_scale = scale_;
        header.clearance_cell = static_cast<float>(1 / double(scale_));
        header.clearance_unit = static_cast<float>(1 / (CLEARANCE_STEPS * double(scale_)));
    }

    float low_[3], scale_;
    Cells cells_;
};

class Grid : GridPlace {
public:
    explicit Grid(const ShapeData& shape) : GridPlace(shape) {
        distance_.resize(static_cast<std::size_t>(cells_.count()));
        outside_.resize(distance_.size());
    }

    // Distances of the middles from the surface, in cells: measured for all middles near it, which are few, farther off
    // for every second, then every fourth along each axis. The others get a lower bound from one that was measured.
    void measure(const ShapeData& shape, Executor& executor, const std::stop_token& stop) {
        distance_[0] = nearest(shape, {0, 0, 0}, 1e6);
        for (int stride = 256; stride >= 1; stride /= 2) {
            // Less than for the stride before by over a diagonal, so that a measured distance bounds each search.
            const double near = stride < 4 ? 4 * stride : far;
            // By rows, of which there are many: a cell is measured by itself, from what longer strides have measured.
            const auto rows_y = static_cast<std::size_t>((cells_.size[1] + stride - 1) / stride);
            const auto rows_z = static_cast<std::size_t>((cells_.size[2] + stride - 1) / stride);
            run_until(executor, stop, rows_y * rows_z, 16, [&](std::uint32_t row) {
                measure_row(shape, stride, near, static_cast<int>(row % rows_y) * stride,
                            static_cast<int>(row / rows_y) * stride);
            });
        }
    }

    // Two neighbouring middles whose empty balls meet lie on the same side.
    void find_outside() {
        cells_.flood([&](int i, int from) {
            const double before = from < 0 ? 2.0 : distance_[from]; // beyond the box
            const bool enters = !outside_[i] && distance_[i] + before > 1.001;
            if (enters) outside_[i] = true;
            return enters;
        });
    }

    void write(Accelerators& to, Executor& executor) const {
        enter(to.header);
        to.clearances.assign(distance_.size(), 0);
        std::vector<Ball> outer, other;
        executor.each(2, 1, [&](std::uint32_t side) { (side == 0 ? outer : other) = choose_balls(side == 0); });
        executor.each(distance_.size(), 4096, [&](std::uint32_t i) {
            const Cell cell = cells_.at(static_cast<int>(i));
            // Prefers a ball outside if it reaches into the cell at all: most vertices are outside.
            const Ball& ball = outer[i].depth_at(cell) > -half_diagonal ? outer[i] : other[i];
            if (ball.radius >= 0) to.clearances[i] = word(ball, cell);
        });
    }

private:
    void measure_row(const ShapeData& shape, int stride, double near, int y, int z) {
        for (int x = 0; x < cells_.size[0]; x += stride) {
            const int dx = x % (2 * stride), dy = y % (2 * stride), dz = z % (2 * stride);
            const double off = length({double(dx), double(dy), double(dz)});
            if (off == 0) continue; // measured with a longer stride
            const double known = distance_[cells_.index({x - dx, y - dy, z - dz})];
            distance_[cells_.index({x, y, z})] =
                known - off > near ? known - off : nearest(shape, {x, y, z}, known + off);
        }
    }

    // The distance of a middle, known to be no more than `bound`; both in cells.
    double nearest(const ShapeData& shape, const Cell& cell, double bound) const {
        const double side = 1 / double(scale_);
        const Vec3 point = Vec3{low_[0], low_[1], low_[2]} + side * Vec3{cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
        const double most = side * (bound + 1e-3);
        return std::min(nearest_face(shape, point, 0, most).distance, most) * double(scale_);
    }

    // Chooses for each cell, among the empty balls on one side around nearby middles, the one that reaches farthest
    // past the cell's middle. A large ball at the surface gives the distance of the points between almost exactly.
    std::vector<Ball> choose_balls(bool outside) const {
        std::vector<Ball> balls(distance_.size());
        for (int i = 0; i < cells_.count(); ++i)
            if (outside_[i] == outside) balls[i] = {cells_.at(i), distance_[i]};
        for (const int step : {1, -1})
            for (int n = 0; n < cells_.count(); ++n) {
                const int i = step > 0 ? n : cells_.count() - 1 - n;
                const Cell cell = cells_.at(i);
                double best = balls[i].depth_at(cell);
                const auto offer = [&](int dx, int dy, int dz) {
                    const Cell next{cell[0] + dx, cell[1] + dy, cell[2] + dz};
                    if (!cells_.has(next)) return;
                    const Ball& other = balls[i + cells_.index({dx, dy, dz})];
                    if (other.radius <= best) return; // the depth is less
                    const double depth = other.depth_at(cell);
                    if (depth <= best) return;
                    best = depth;
                    balls[i] = other;
                };
                for (int dx = -1; dx <= 1; ++dx)
                    for (int dy = -1; dy <= 1; ++dy) offer(dx, dy, -step);
                for (int dx = -1; dx <= 1; ++dx) offer(dx, -step, 0);
                offer(-step, 0, 0);
            }
        return balls;
    }

    uint word(const Ball& ball, const Cell& cell) const {
        const auto offset = [&](int axis) {
            return static_cast<uint>(ball.middle[axis] - cell[axis] + CLEARANCE_OFFSET) << 5 * axis;
        };
        // A thousandth of a cell is far more than the rounding above and in a look-up.
        const uint radius = static_cast<uint>(std::clamp((ball.radius - 1e-3) * CLEARANCE_STEPS, 0.0, 65535.0));
        return offset(0) | offset(1) | offset(2) | (outside_[cells_.index(ball.middle)] ? CLEARANCE_OUTSIDE : 0u)
               | radius << 16;
    }

    std::vector<double> distance_; // of the middles, in cells
    std::vector<bool> outside_;
};

} // namespace

void build_clearance_grid(const ShapeData& shape, Accelerators& to, Executor& executor, const std::stop_token& stop) {
    Grid grid(shape);
    grid.measure(shape, executor, stop);
    if (stop.stop_requested()) return;
    if (to.header.outward != 0) grid.find_outside();
    grid.write(to, executor);
}

bool restore_clearance_grid(const ShapeData& shape, Accelerators& to, std::vector<kernels::uint> words) {
    const GridPlace place(shape);
    if (words.size() != static_cast<std::size_t>(place.cells_.count())) return false;
    place.enter(to.header);
    to.clearances = std::move(words);
    return true;
}

// A scale of 0 leads every look-up to the one cell; its word is 0, no ball.
void set_box_clearance(kernels::ShapeHeader& header) {
    for (int axis = 0; axis < 3; ++axis) {
        header.clearance_low[axis] = header.low[axis];
        header.clearance_high[axis] = header.high[axis];
        header.clearance_size[axis] = 1;
    }
    header.clearance_scale = header.clearance_cell = header.clearance_unit = 0;
}

} // namespace raycontact
