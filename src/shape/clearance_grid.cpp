// SPDX-License-Identifier: Apache-2.0
#include "shape/clearance_grid.h"

#include "mesh/vector.h"
#include "shape/triangle_distance.h"

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

using kernels::uint;

constexpr double half_diagonal = 0.8660254037844387; // of a unit cell
constexpr double band = 2.5;                         // cells around a triangle in which distances are exact
constexpr double far = 1e15;                         // squared cells; no triangle near
constexpr uint steps_per_cell = 8; // of a stored length
constexpr uint longest = CLEARANCE_OUTSIDE - 1;
constexpr uint outside_bit = CLEARANCE_OUTSIDE;

class Grid {
public:
    explicit Grid(const ShapeData& shape) : low_{shape.low.x, shape.low.y, shape.low.z} {
        const double extent[3] = {double(shape.high.x) - low_[0], double(shape.high.y) - low_[1],
                                  double(shape.high.z) - low_[2]};
        const double longest_side = std::max({extent[0], extent[1], extent[2]});
        // About as many cells as keep them half as long as an edge, up to what stays in a processor's cache.
        const double wanted = std::clamp(300.0 * double(shape.mesh.triangles.size()), 2e4, 15e5);
        const double side = std::max(std::cbrt(extent[0] * extent[1] * extent[2] / wanted), longest_side / 256);
        scale_ = static_cast<float>(1 / side);
        for (int axis = 0; axis < 3; ++axis)
            size_[axis] = static_cast<int>(static_cast<float>(extent[axis]) * scale_) + 1;
        squared_.assign(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2], far);
        visits_left_ = 60 * squared_.size() + 2000 * shape.mesh.triangles.size();
    }

    // Exact distances, in cells, of the middles near a triangle. False once triangles are so long that this costs more
    // than a grid could save.
    bool measure_near(const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 corner[3] = {in_cells(a), in_cells(b), in_cells(c)};
        int from[3], to[3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto [least, most] = std::minmax(
                {raycontact::axis(corner[0], axis), raycontact::axis(corner[1], axis), raycontact::axis(corner[2], axis)});
            from[axis] = std::clamp(static_cast<int>(std::floor(least - band)), 0, size_[axis] - 1);
            to[axis] = std::clamp(static_cast<int>(std::floor(most + band)), 0, size_[axis] - 1);
        }
        const std::size_t visits = static_cast<std::size_t>(to[0] - from[0] + 1)
                                   * static_cast<std::size_t>(to[1] - from[1] + 1)
                                   * static_cast<std::size_t>(to[2] - from[2] + 1);
        if (visits > visits_left_) return false;
        visits_left_ -= visits;
        const Vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
        const double size2 = has_plane(corner[0], corner[1], corner[2]) ? dot(normal, normal) : 0;
        for (int z = from[2]; z <= to[2]; ++z)
            for (int y = from[1]; y <= to[1]; ++y)
                for (int x = from[0]; x <= to[0]; ++x) {
                    const Vec3 middle{x + 0.5, y + 0.5, z + 0.5};
                    double& squared = squared_[index(x, y, z)];
                    const double plane = dot(normal, middle - corner[0]);
                    if (plane * plane >= std::min(squared, band * band) * size2 && size2 > 0) continue;
                    squared = std::min(squared, squared_distance(middle, corner[0], corner[1], corner[2]));
                }
        return true;
    }

    // Beyond the band: every point of the surface lies in a cell whose middle is no farther from it than half a
    // diagonal, so the distance to the nearest such middle, less that, is a bound. Exact transform after Felzenszwalb
    // and Huttenlocher 2012, one axis after the other.
    void measure_far() {
        std::vector<double> to_surface(squared_.size(), far);
        for (std::size_t i = 0; i < squared_.size(); ++i)
            if (squared_[i] <= 0.7501) to_surface[i] = 0;
        const std::size_t stride[3] = {1, static_cast<std::size_t>(size_[0]),
                                       static_cast<std::size_t>(size_[0]) * size_[1]};
        for (int axis = 0; axis < 3; ++axis) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            for (int i = 0; i < size_[u]; ++i)
                for (int j = 0; j < size_[v]; ++j)
                    transform_line(to_surface, i * stride[u] + j * stride[v], stride[axis], size_[axis]);
        }
        distance_.resize(squared_.size());
        for (std::size_t i = 0; i < squared_.size(); ++i) {
            const double beyond = std::sqrt(to_surface[i]) - half_diagonal;
            // In the band the triangles themselves were measured; what they missed is farther than the band.
            const double near = std::min(std::sqrt(squared_[i]), band);
            distance_[i] = std::max({beyond, near, 0.0});
        }
    }

    // Two neighbouring middles whose empty balls meet lie on the same side. From the box's faces inwards.
    void find_outside() {
        outside_.assign(distance_.size(), false);
        std::vector<std::array<int, 3>> open;
        const auto enter = [&](int x, int y, int z, double from) {
            const std::size_t i = index(x, y, z);
            if (outside_[i] || distance_[i] + from <= 1.001) return;
            outside_[i] = true;
            open.push_back({x, y, z});
        };
        for (int z = 0; z < size_[2]; ++z)
            for (int y = 0; y < size_[1]; ++y)
                for (int x = 0; x < size_[0]; ++x)
                    if (x == 0 || y == 0 || z == 0 || x == size_[0] - 1 || y == size_[1] - 1 || z == size_[2] - 1)
                        enter(x, y, z, 0.499); // the box's face is at most half a cell away
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

    void write(ShapeData& shape) const {
        for (int axis = 0; axis < 3; ++axis) shape.header.clearance_size[axis] = static_cast<uint>(size_[axis]);
        shape.header.clearance_scale = scale_;
        shape.header.clearance_cell = static_cast<float>(1 / double(scale_));
        shape.header.clearance_unit = static_cast<float>(1 / (steps_per_cell * double(scale_)));
        shape.clearances.assign((distance_.size() + 3) / 4, 0);
        for (std::size_t i = 0; i < distance_.size(); ++i) {
            // A thousandth of a cell is far more than the rounding above and in a look-up.
            const double units = std::clamp((distance_[i] - 1e-3) * steps_per_cell, 0.0, double(longest));
            uint byte = static_cast<uint>(units);
            if (!outside_.empty() && outside_[i]) byte |= outside_bit;
            shape.clearances[i / 4] |= byte << (8 * (i % 4));
        }
    }

private:
    std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * size_[1] + static_cast<std::size_t>(y)) * size_[0]
               + static_cast<std::size_t>(x);
    }
    Vec3 in_cells(const Vec3& p) const {
        return double(scale_) * Vec3{p.x - low_[0], p.y - low_[1], p.z - low_[2]};
    }

    void transform_line(std::vector<double>& values, std::size_t first, std::size_t stride, int count) {
        line_.resize(count);
        at_.resize(count);
        from_.resize(count + 1);
        int parabolas = 0;
        for (int i = 0; i < count; ++i) {
            line_[i] = values[first + i * stride];
            if (line_[i] >= far) continue;
            double begins = -far;
            while (parabolas > 0) {
                const int k = at_[parabolas - 1];
                begins = ((line_[i] + double(i) * i) - (line_[k] + double(k) * k)) / (2.0 * (i - k));
                if (begins > from_[parabolas - 1]) break;
                --parabolas;
                begins = -far;
            }
            at_[parabolas] = i;
            from_[parabolas] = begins;
            ++parabolas;
        }
        if (parabolas == 0) return;
        int p = 0;
        for (int i = 0; i < count; ++i) {
            while (p + 1 < parabolas && from_[p + 1] <= i) ++p;
            values[first + i * stride] = line_[at_[p]] + double(i - at_[p]) * (i - at_[p]);
        }
    }

    double low_[3];
    float scale_;
    int size_[3];
    std::vector<double> squared_, distance_; // in cells, of the middles
    std::vector<bool> outside_;
    std::vector<double> line_, from_;
    std::vector<int> at_;
    std::size_t visits_left_;
};

// One cell without an empty ball, so that a look-up needs no test for meshes that have no grid.
void know_nothing(ShapeData& shape) {
    for (uint& size : shape.header.clearance_size) size = 1;
    shape.clearances.assign(1, 0);
}

} // namespace

void build_clearance_grid(ShapeData& shape) {
    shape.header.clearance_low[0] = shape.low.x;
    shape.header.clearance_low[1] = shape.low.y;
    shape.header.clearance_low[2] = shape.low.z;
    shape.header.clearance_high[0] = shape.high.x;
    shape.header.clearance_high[1] = shape.high.y;
    shape.header.clearance_high[2] = shape.high.z;
    Grid grid(shape);
    const auto point = [&](std::uint32_t v) { return Vec3{shape.points[v].x, shape.points[v].y, shape.points[v].z}; };
    for (const auto& [a, b, c] : shape.mesh.triangles)
        if (!grid.measure_near(point(a), point(b), point(c))) return know_nothing(shape);
    grid.measure_far();
    if (shape.header.outward != 0) grid.find_outside();
    grid.write(shape);
}

} // namespace raycontact
