// SPDX-License-Identifier: Apache-2.0
#include <raycontact/primitives.h>

#include "mesh/vector.h"
#include "number_text.h"
#include "shape/round_shape.h"

#include <raycontact/error.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace raycontact {

namespace {

void check_measure(double metres, double least, const char* what) {
    if (metres >= least && metres <= 1e8) return; // not so if it is not a number
    throw InputError(std::string(what) + " is " + text_of(metres) + " m; give " + text_of(least) + " to 1e8 m");
}
constexpr double least_measure = 1e-6;

std::shared_ptr<const Shape> box_between(const Vec3& low, const Vec3& high, const char* name) {
    Mesh mesh{name, {}, {}};
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back(
            {(i & 4) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 1) != 0 ? high.z : low.z});
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                      {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
    return Shape::make(mesh, 1);
}

void check_heights(std::span<const double> heights, const HeightGrid& grid, double floor) {
    if (grid.rows < 2 || grid.columns < 2)
        throw InputError("height field: " + std::to_string(grid.rows) + " rows and " + std::to_string(grid.columns)
                         + " columns; give two at least of each");
    const std::uint64_t count = std::uint64_t{grid.rows} * grid.columns;
    if (heights.size() != count)
        throw InputError("height field: " + std::to_string(heights.size()) + " heights; give rows * columns, "
                         + std::to_string(count));
    check_measure(grid.step_x, least_measure, "height field: the step between rows");
    check_measure(grid.step_y, least_measure, "height field: the step between columns");
    if (!std::isfinite(floor)) throw InputError("height field: the floor is not a finite number");
    for (std::size_t i = 0; i < heights.size(); ++i)
        if (!(std::isfinite(heights[i]) && heights[i] > floor))
            throw InputError("height field: height " + std::to_string(i)
                             + " is not finite, or not above the floor; give a lower floor");
}

} // namespace

std::shared_ptr<const Shape> make_ball(double radius) {
    check_measure(radius, least_measure, "ball: the radius");
    return make_round({{}, {}, radius});
}

std::shared_ptr<const Shape> make_capsule(double radius, double half_length) {
    check_measure(radius, least_measure, "capsule: the radius");
    check_measure(half_length, 0, "capsule: the half length");
    return make_round({{0, 0, -half_length}, {0, 0, half_length}, radius});
}

// A cylinder and two halves of a ball.
Mass mass_of(const Round& round) {
    const Vec3 axis = unit(round.to - round.from);
    const double size = length(round.to - round.from), square = round.radius * round.radius;
    const double cylinder = std::numbers::pi * square * size, ball = 4 * std::numbers::pi / 3 * square * round.radius;
    const double along = cylinder * square / 2 + ball * 0.4 * square;
    const double across = cylinder * (size * size / 12 + square / 4)
                          + ball * (0.4 * square + size * size / 4 + 3 * size * round.radius / 8);
    Mass mass{cylinder + ball, 0.5 * (round.from + round.to), {}};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            mass.inertia[3 * i + k] =
                (i == k ? across : 0) + (along - across) * raycontact::axis(axis, i) * raycontact::axis(axis, k);
    return mass;
}

std::shared_ptr<const Shape> make_box(const Vec3& half) {
    for (std::size_t k = 0; k < 3; ++k) check_measure(axis(half, k), least_measure, "box: a half");
    return box_between(-half, half, "box");
}

std::shared_ptr<const Shape> make_plane(double half_extent, double thickness) {
    check_measure(half_extent, least_measure, "plane: the half extent");
    check_measure(thickness, least_measure, "plane: the thickness");
    return box_between({-half_extent, -half_extent, -thickness}, {half_extent, half_extent, 0}, "plane");
}

// The bottom has the corners of the border and one in the middle.
std::shared_ptr<const Shape> make_height_field(std::span<const double> heights, const HeightGrid& grid, double floor,
                                               std::uint32_t threads) {
    check_heights(heights, grid, floor);
    Mesh mesh{"height field", {}, {}};
    const std::uint32_t rows = grid.rows, columns = grid.columns;
    const auto number = [&](std::uint32_t i, std::uint32_t j) { return i * columns + j; };
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (std::uint32_t i = 0; i < rows; ++i)
        for (std::uint32_t j = 0; j < columns; ++j) {
            mesh.vertices.push_back({i * grid.step_x, j * grid.step_y, heights[number(i, j)]});
            if (i > 0 && j > 0) quad(number(i - 1, j - 1), number(i, j - 1), number(i, j), number(i - 1, j));
        }
    std::vector<std::uint32_t> border; // counter-clockwise seen from above
    for (std::uint32_t i = 0; i + 1 < rows; ++i) border.push_back(number(i, 0));
    for (std::uint32_t j = 0; j + 1 < columns; ++j) border.push_back(number(rows - 1, j));
    for (std::uint32_t i = rows - 1; i > 0; --i) border.push_back(number(i, columns - 1));
    for (std::uint32_t j = columns - 1; j > 0; --j) border.push_back(number(0, j));
    const std::uint32_t below = rows * columns, count = static_cast<std::uint32_t>(border.size());
    for (std::uint32_t k = 0; k < count; ++k) {
        const std::uint32_t next = (k + 1) % count;
        const Vec3& top = mesh.vertices[border[k]];
        mesh.vertices.push_back({top.x, top.y, floor});
        quad(below + k, below + next, border[next], border[k]);
        mesh.triangles.push_back({below + count, below + next, below + k});
    }
    mesh.vertices.push_back({(rows - 1) * grid.step_x / 2, (columns - 1) * grid.step_y / 2, floor});
    return Shape::make(mesh, threads);
}

} // namespace raycontact
