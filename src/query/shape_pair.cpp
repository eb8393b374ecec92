// SPDX-License-Identifier: Apache-2.0
#include "query/shape_pair.h"

#include "broadphase/world_box.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Twice what two meshes reach, and some more; and far below what overflows in a predicate.
constexpr double farthest_translation = 1e10;

// Of the frame about the centre of `inner` in that about the centre of `outer`, once both are placed about `origin`.
Pose centred_relative(const Vec3& outer_centre, const Pose& outer, const Vec3& inner_centre, const Pose& inner) {
    const std::array<double, 9> back = inverse_of(outer.rotation);
    const Vec3 apart = (inner.translation - outer.translation)
                       + (rotated(inner.rotation, inner_centre) - rotated(outer.rotation, outer_centre));
    return {product_of(back, inner.rotation), rotated(back, apart)};
}

double size_of(const Vec3& v) {
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

} // namespace

std::array<double, 9> inverse_of(const std::array<double, 9>& r) {
    const std::array<double, 9> cofactors{
        r[4] * r[8] - r[5] * r[7], r[2] * r[7] - r[1] * r[8], r[1] * r[5] - r[2] * r[4],
        r[5] * r[6] - r[3] * r[8], r[0] * r[8] - r[2] * r[6], r[2] * r[3] - r[0] * r[5],
        r[3] * r[7] - r[4] * r[6], r[1] * r[6] - r[0] * r[7], r[0] * r[4] - r[1] * r[3]};
    const double determinant = r[0] * cofactors[0] + r[1] * cofactors[3] + r[2] * cofactors[6];
    std::array<double, 9> inverse;
    for (std::size_t i = 0; i < 9; ++i) inverse[i] = cofactors[i] / determinant;
    return inverse;
}

std::array<double, 9> product_of(const std::array<double, 9>& left, const std::array<double, 9>& right) {
    std::array<double, 9> product;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            product[3 * row + column] = (left[3 * row] * right[column] + left[3 * row + 1] * right[3 + column])
                                        + left[3 * row + 2] * right[6 + column];
    return product;
}

PlacedPoint PlacedShape::vertex(std::uint32_t vertex) const {
    const Vec3& own = shape_.file_vertex(vertex);
    return {own - shape_.centre, own_point(own), &placing_};
}

std::array<PlacedPoint, 3> PlacedShape::triangle(std::uint32_t triangle) const {
    const auto [u, v, w] = shape_.mesh.triangles[triangle];
    return {vertex(u), vertex(v), vertex(w)};
}

PlacedPoint PlacedShape::point(const Vec3& centred) const {
    const Vec3 own = own_point(centred + shape_.centre);
    return {own - shape_.centre, own, &placing_};
}

// Of what is decided; moved alike, shapes are where they were, and nothing has to be turned.
struct ShapePair::Poses {
    Pose a, b;
    Pose given_b;
    Poses(const Pose& given_a, const Pose& b_as_given) : given_b(b_as_given) {
        if (given_a == b_as_given) return;
        a = given_a;
        b = b_as_given;
    }
    Vec3 apart() const { return a.translation - b.translation; }
};

ShapePair::ShapePair(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b)
    : ShapePair(queried(a), queried(b), Poses(pose_a, pose_b)) {}

// Some twenty roundings of these sizes lie behind a rough point of a; b's has one.
ShapePair::ShapePair(const ShapeData& a, const ShapeData& b, const Poses& poses)
    : a_(a, poses.a, poses.b.translation,
         1e-14 * (a.reach + b.reach + size_of(poses.apart()) + size_of(a.centre) + size_of(b.centre))),
      b_(b, poses.b, poses.b.translation, 1e-15 * b.reach),
      a_in_b_(centred_relative(b.centre, poses.b, a.centre, poses.a)),
      b_in_a_(centred_relative(a.centre, poses.a, b.centre, poses.b)), b_in_world_{poses.given_b.rotation,
                                                                                   transform_point(poses.given_b,
                                                                                                   b.centre)},
      far_apart_(!(size_of(poses.apart()) < farthest_translation)) {} // also where it overflows

PlacedPoint ShapePair::vertex_of_a(std::uint32_t vertex) const {
    PlacedPoint point = a_.vertex(vertex);
    point.rough = transform_point(a_in_b_, point.rough);
    return point;
}

std::array<PlacedPoint, 3> ShapePair::triangle_of_a(std::uint32_t triangle) const {
    const auto [u, v, w] = a().mesh.triangles[triangle];
    return {vertex_of_a(u), vertex_of_a(v), vertex_of_a(w)};
}

std::array<Vec3, 3> ShapePair::corners_of_a(std::uint32_t triangle) const {
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
        corners[k] = transform_point(a_in_b_, a().file_vertex(a().mesh.triangles[triangle][k]) - a().centre);
    return corners;
}

std::array<Vec3, 3> ShapePair::corners_of_b(std::uint32_t triangle) const {
    const ShapeData& b = b_.shape();
    std::array<Vec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = b.file_vertex(b.mesh.triangles[triangle][k]) - b.centre;
    return corners;
}

Box ShapePair::box_in(Side side, const Box& of_other) const {
    return world_box(of_other, side == Side::a ? b_in_a_ : a_in_b_, error());
}

BlockBoxes::BlockBoxes(const kernels::TriangleBlock& block, double grow) {
    constexpr float nowhere = std::numeric_limits<float>::infinity();
    const auto by = static_cast<float>(grow);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto &p = block.corner[k], &q = block.corner[3 + k], &r = block.corner[6 + k];
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
            const bool empty = block.triangle[lane] == NONE;
            const float least = std::min(std::min(p[lane], q[lane]), r[lane]) - by;
            const float most = std::max(std::max(p[lane], q[lane]), r[lane]) + by;
            low[k][lane] = empty ? nowhere : least;
            high[k][lane] = empty ? -nowhere : most;
        }
    }
}

Box BlockBoxes::whole() const {
    const auto low_end = [&](std::size_t k) { return double(*std::min_element(low[k].begin(), low[k].end())); };
    const auto high_end = [&](std::size_t k) { return double(*std::max_element(high[k].begin(), high[k].end())); };
    return {{low_end(0), low_end(1), low_end(2)}, {high_end(0), high_end(1), high_end(2)}};
}

Lanes<float> BlockBoxes::squared_distances(const Box& box) const {
    constexpr float far = 1e37f; // squares beyond it may overflow
    Lanes<float> squares{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto from = static_cast<float>(axis(box.low, k)), to = static_cast<float>(axis(box.high, k));
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
            const float off = std::max(std::max(low[k][lane] - to, from - high[k][lane]), 0.0f);
            squares[lane] += off * off;
        }
    }
    for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane)
        squares[lane] = low[0][lane] > high[0][lane] ? squares[lane] : std::min(squares[lane], far);
    return squares;
}

Lanes<double> least_along(const kernels::TriangleBlock& block, const Vec3& direction) {
    Lanes<double> least;
    for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane) {
        const auto along = [&](std::size_t k) {
            return direction.x * double(block.corner[k][lane]) + direction.y * double(block.corner[k + 1][lane])
                   + direction.z * double(block.corner[k + 2][lane]);
        };
        least[lane] = block.triangle[lane] == NONE ? infinite : std::min(std::min(along(0), along(3)), along(6));
    }
    return least;
}

} // namespace raycontact
