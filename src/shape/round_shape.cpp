// SPDX-License-Identifier: Apache-2.0
#include "shape/round_shape.h"

#include "executor/float_environment.h"
#include "mesh/vector.h"
#include "shape/shape_data.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

namespace raycontact {

namespace {

/// A column or a ring of the picture: of a quarter of a turn, eight.
constexpr std::uint32_t of_quarter = 8;

/// On the unit circle, `step` eighths of a quarter from (1, 0): along the diamond inside of it, by a root alone, so
/// that machines agree.
std::array<double, 2> on_circle(std::uint32_t step) {
    const double t = double(step % of_quarter) / of_quarter, size = std::sqrt((1 - t) * (1 - t) + t * t);
    const double x = (1 - t) / size, y = t / size;
    switch (step / of_quarter % 4) {
    case 0:
        return {x, y};
    case 1:
        return {-y, x};
    case 2:
        return {-x, -y};
    default:
        return {y, -x};
    }
}

// Rings from the lower pole to the upper one; a capsule has two at its equators.
Mesh picture_of(const Round& round) {
    constexpr std::uint32_t columns = 4 * of_quarter;
    const double half = round.to.z;
    Mesh mesh{half > 0 ? "capsule" : "ball", {{0, 0, -half - round.radius}}, {}};
    std::vector<std::pair<double, double>> rings; // radius and z
    for (std::uint32_t step = 1; step < 2 * of_quarter; ++step) {
        const auto [z, out] = on_circle(step);
        if (step <= of_quarter) rings.emplace_back(round.radius * out, -half - round.radius * z);
        if (step > of_quarter || (step == of_quarter && half > 0))
            rings.emplace_back(round.radius * out, half - round.radius * z);
    }
    for (const auto& [out, z] : rings)
        for (std::uint32_t column = 0; column < columns; ++column) {
            const auto [x, y] = on_circle(column);
            mesh.vertices.push_back({out * x, out * y, z});
        }
    mesh.vertices.push_back({0, 0, half + round.radius});
    const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    for (std::uint32_t column = 0; column < columns; ++column) {
        const std::uint32_t here = 1 + column, next = 1 + (column + 1) % columns;
        mesh.triangles.push_back({0, next, here});
        for (std::uint32_t ring = 0; ring + 1 < rings.size(); ++ring) {
            const std::uint32_t low = ring * columns, high = low + columns;
            mesh.triangles.push_back({low + here, low + next, high + next});
            mesh.triangles.push_back({low + here, high + next, high + here});
        }
        mesh.triangles.push_back({last, last - columns - 1 + here, last - columns - 1 + next});
    }
    return mesh;
}

// Its reach is that of the whole body, by which queries know what may be rounded.
std::shared_ptr<const ShapeData> core_of(const Round& round, double diagonal) {
    const auto core = std::make_shared<ShapeData>();
    core->round = round;
    core->centre = 0.5 * (round.from + round.to);
    core->file_vertices = {round.from, round.to};
    for (const Vec3& v : core->file_vertices) {
        const Vec3 offset = v - core->centre;
        core->points.push_back(
            {static_cast<float>(offset.x), static_cast<float>(offset.y), static_cast<float>(offset.z)});
        core->mesh.vertices.push_back(core->centre + core->point(static_cast<std::uint32_t>(core->points.size() - 1)));
    }
    core->mesh.triangles = {{0, 1, 1}};
    core->mesh.triangle_index = {Shape::no_triangle};
    core->component_vertices = {0};
    core->diagonal = diagonal;
    core->reach = 0.5 * length(round.to - round.from) + round.radius;
    core->header.tolerance = static_cast<float>(1e-6 * diagonal);
    const std::array<std::uint32_t, 1> chosen{0};
    Executor executor(1);
    if (!build_tree(*core, {core->points, core->mesh.triangles, chosen, 1e-6 * diagonal, true, NODE_LEVELS}, executor))
        throw std::logic_error("a tree of one triangle is too deep");
    return core;
}

} // namespace

std::shared_ptr<const Shape> make_round(const Round& round) {
    const FloatEnvironment environment;
    std::shared_ptr<const Shape> shape = Shape::make(picture_of(round), 1);
    // Nobody else has it yet.
    auto& data = const_cast<ShapeData&>(shape->data()); // NOLINT(cppcoreguidelines-pro-type-const-cast)
    const Vec3 grow{round.radius, round.radius, round.radius};
    data.box_min = least(round.from, round.to) - grow;
    data.box_max = most(round.from, round.to) + grow;
    data.diagonal = length(data.box_max - data.box_min);
    data.radius = data.reach = length(round.to) + round.radius;
    data.header.closed = 1;
    data.round = round;
    data.core = core_of(round, data.diagonal);
    return shape;
}

} // namespace raycontact
