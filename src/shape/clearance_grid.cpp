// SPDX-License-Identifier: Apache-2.0
#include "shape/clearance_grid.h"

#include "mesh/triangle_bvh.h"
#include "mesh/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>

namespace raycontact {

namespace {

using kernels::uint;

constexpr double half_diagonal = 0.8660254037844387; // of a unit cell
constexpr double far = 1e15;
constexpr int pad = 4;                         // cells around the box, for balls that touch it from outside
constexpr int farthest = CLEARANCE_OFFSET - 1; // cells from a cell to the middle of its ball, each axis

// Without surface, around the middle of a cell; lengths in cells.
struct Ball {
    int x = 0, y = 0, z = 0;
    double radius = -1; // none

    // About how deep the points of a cell lie in it, on average. At the middle alone its own ball would always win, and
    // be small.
    double depth_at(int at_x, int at_y, int at_z) const {
        const int dx = x - at_x, dy = y - at_y, dz = z - at_z;
        if (radius < 0 || std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) > farthest) return -far;
        return radius - std::sqrt(double(dx * dx + dy * dy + dz * dz) + 0.6);
    }
};

// Balls follow the surface, so cells may be as long as its edges. Of a fine mesh longer ones, by the power 3/4: what
// they no longer tell costs a few rays, and the grid stays within the caches for longer.
double wanted_cells(double triangles) {
    constexpr double each = 25, coarse = 1000;
    const double finer = triangles / coarse;
    const double counted = finer < 1 ? triangles : coarse * std::sqrt(finer) * std::sqrt(std::sqrt(finer));
    return std::clamp(each * counted, 6e2, 4e6);
}

class Grid {
public:
    explicit Grid(const ShapeData& shape) {
        const float *low = shape.header.low, *high = shape.header.high;
        double extent[3];
        for (int axis = 0; axis < 3; ++axis) extent[axis] = double(high[axis]) - double(low[axis]);
        const double longest_side = std::max({extent[0], extent[1], extent[2]});
        const double wanted = wanted_cells(double(shape.mesh.triangles.size()));
        double side = std::max(std::cbrt(extent[0] * extent[1] * extent[2] / wanted), longest_side / 200);
        const auto cells = [&] {
            double product = 1;
            for (const double length : extent) product *= std::ceil(length / side) + 2 * pad;
            return product;
        };
        while (cells() > 8 * wanted + 8000) side *= 1.1; // a flat mesh has hardly a volume to be divided
        scale_ = static_cast<float>(1 / side);
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis] = static_cast<float>(double(low[axis]) - pad * side);
            size_[axis] = static_cast<int>(std::ceil(extent[axis] * double(scale_))) + 2 * pad;
        }
    }

    // Of the middles, in cells: exactly near the surface, where there are few, and farther off for every second, then
    // every fourth along each axis. The others keep what follows from the one before them, which is no more.
    void measure(const ShapeData& shape) {
        std::vector<Vec3> points;
        points.reserve(shape.points.size());
        for (const Point3f& p : shape.points) points.push_back(in_cells({p.x, p.y, p.z}));
        std::vector<std::uint32_t> every(shape.mesh.triangles.size());
        std::iota(every.begin(), every.end(), 0u);
        const TriangleBvh tree(points, shape.mesh.triangles, std::move(every));
        distance_.resize(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2]);
        for (int z = 0; z < size_[2]; z += 4)
            for (int y = 0; y < size_[1]; y += 4) {
                double last = 1e6;
                for (int x = 0; x < size_[0]; x += 4)
                    distance_[index(x, y, z)] = last = nearest(tree, x, y, z, last + 4);
            }
        measure_between(tree, 2, 8);
        measure_between(tree, 1, 4); // less than 8 by more than a diagonal: what bounds a search was measured itself
    }

    // Two neighbouring middles whose empty balls meet lie on the same side. From the box's faces inwards.
    void find_outside() {
        outside_.assign(distance_.size(), false);
        std::vector<std::array<int, 3>> open;
        const auto enter = [&](int x, int y, int z, double from) {
            const std::size_t i = index(x, y, z);
            if (outside_[i] || distance_[i] + from <= 1.001) return; // the two balls do not meet
            outside_[i] = true;
            open.push_back({x, y, z});
        };
        for (int z = 0; z < size_[2]; ++z)
            for (int y = 0; y < size_[1]; ++y)
                for (int x = 0; x < size_[0]; ++x)
                    if (x == 0 || y == 0 || z == 0 || x == size_[0] - 1 || y == size_[1] - 1 || z == size_[2] - 1)
                        enter(x, y, z, 2.0); // beyond the box
        while (!open.empty()) {
            const auto [x, y, z] = open.back();
            open.pop_back();
            const double own = distance_[index(x, y, z)];
            if (x > 0) enter(x - 1, y, z, own);
            if (y > 0) enter(x, y - 1, z, own);
            if (z > 0) enter(x, y, z - 1, own);
            if (x + 1 < size_[0]) enter(x + 1, y, z, own);
            if (y + 1 < size_[1]) enter(x, y + 1, z, own);
            if (z + 1 < size_[2]) enter(x, y, z + 1, own);
        }
    }

    // For each cell, of the empty balls around middles near it the one that reaches farthest past its own middle. A
    // large ball that touches the surface tells the distance of the points between almost exactly.
    std::vector<Ball> choose_balls(bool outside) const {
        std::vector<Ball> balls(distance_.size());
        for (int z = 0; z < size_[2]; ++z)
            for (int y = 0; y < size_[1]; ++y)
                for (int x = 0; x < size_[0]; ++x) {
                    const std::size_t i = index(x, y, z);
                    if (outside_.empty() || outside_[i] == outside) balls[i] = {x, y, z, distance_[i]};
                }
        for (const int step : {1, -1}) {
            const auto from = [&](int axis) { return step > 0 ? 0 : size_[axis] - 1; };
            const auto within = [&](int at, int axis) { return at >= 0 && at < size_[axis]; };
            for (int z = from(2); within(z, 2); z += step)
                for (int y = from(1); within(y, 1); y += step)
                    for (int x = from(0); within(x, 0); x += step) {
                        Ball& own = balls[index(x, y, z)];
                        double best = own.depth_at(x, y, z);
                        const auto offer = [&](int nx, int ny, int nz) {
                            if (!within(nx, 0) || !within(ny, 1) || !within(nz, 2)) return;
                            const Ball& other = balls[index(nx, ny, nz)];
                            const double depth = other.depth_at(x, y, z);
                            if (depth <= best) return;
                            best = depth;
                            own = other;
                        };
                        for (int dx = -1; dx <= 1; ++dx)
                            for (int dy = -1; dy <= 1; ++dy) offer(x + dx, y + dy, z - step);
                        for (int dx = -1; dx <= 1; ++dx) offer(x + dx, y - step, z);
                        offer(x - step, y, z);
                    }
        }
        return balls;
    }

    void write(ShapeData& shape) const {
        for (int axis = 0; axis < 3; ++axis) {
            shape.header.clearance_low[axis] = low_[axis];
            // A look-up at the upper end, however it is rounded, is in the last cell.
            shape.header.clearance_high[axis] =
                static_cast<float>(double(low_[axis]) + (size_[axis] - 0.01) / double(scale_));
            shape.header.clearance_size[axis] = static_cast<uint>(size_[axis]);
        }
        shape.header.clearance_scale = scale_;
        shape.header.clearance_cell = static_cast<float>(1 / double(scale_));
        shape.header.clearance_unit = static_cast<float>(1 / (CLEARANCE_STEPS * double(scale_)));
        shape.clearances.assign(distance_.size(), 0);
        const std::vector<Ball> outer = choose_balls(true);
        const std::vector<Ball> other = outside_.empty() ? outer : choose_balls(false);
        for (int z = 0; z < size_[2]; ++z)
            for (int y = 0; y < size_[1]; ++y)
                for (int x = 0; x < size_[0]; ++x) {
                    const std::size_t i = index(x, y, z);
                    // A ball outside first, where it reaches into the cell at all: vertices there are the many.
                    const Ball& ball = outer[i].depth_at(x, y, z) > -half_diagonal ? outer[i] : other[i];
                    if (ball.radius >= 0) shape.clearances[i] = word(ball, x, y, z);
                }
    }

private:
    // Of a middle whose distance is known to be no more than `bound`.
    static double nearest(const TriangleBvh& tree, int x, int y, int z, double bound) {
        return std::sqrt(tree.nearest({x + 0.5, y + 0.5, z + 0.5}, (bound + 1e-3) * (bound + 1e-3)));
    }

    // The middles that a stride twice as long has left out; those that may be nearer than `near` exactly.
    void measure_between(const TriangleBvh& tree, int stride, double near) {
        const auto before = [&](int at) { return at - at % (2 * stride); };
        for (int z = 0; z < size_[2]; z += stride)
            for (int y = 0; y < size_[1]; y += stride)
                for (int x = 0; x < size_[0]; x += stride) {
                    const int bx = before(x), by = before(y), bz = before(z);
                    const double known = distance_[index(bx, by, bz)];
                    const double off = length({double(x - bx), double(y - by), double(z - bz)});
                    if (off == 0) continue;
                    distance_[index(x, y, z)] = known - off > near ? known - off : nearest(tree, x, y, z, known + off);
                }
    }
    std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * size_[1] + static_cast<std::size_t>(y)) * size_[0]
               + static_cast<std::size_t>(x);
    }
    uint word(const Ball& ball, int x, int y, int z) const {
        const auto at = [](int offset) { return static_cast<uint>(offset + CLEARANCE_OFFSET); };
        // A thousandth of a cell is far more than the rounding above and in a look-up.
        const uint radius = static_cast<uint>(std::clamp((ball.radius - 1e-3) * CLEARANCE_STEPS, 0.0, 65535.0));
        const bool outside = !outside_.empty() && outside_[index(ball.x, ball.y, ball.z)];
        return at(ball.x - x) | at(ball.y - y) << 5 | at(ball.z - z) << 10 | (outside ? CLEARANCE_OUTSIDE : 0u)
               | radius << 16;
    }
    Vec3 in_cells(const Vec3& p) const {
        return double(scale_) * Vec3{p.x - double(low_[0]), p.y - double(low_[1]), p.z - double(low_[2])};
    }

    float low_[3], scale_;
    int size_[3];
    std::vector<double> distance_; // of the middles, in cells
    std::vector<bool> outside_;
};

} // namespace

void build_clearance_grid(ShapeData& shape) {
    Grid grid(shape);
    grid.measure(shape);
    if (shape.header.outward != 0) grid.find_outside();
    grid.write(shape);
}

} // namespace raycontact
