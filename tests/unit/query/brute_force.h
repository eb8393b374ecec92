// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>
#include <raycontact/pose.h>

#include <array>
#include <optional>
#include <vector>

// What queries must find, by trying all triangles in double, with other formulas than the library's.
namespace raycontact::brute {

using Triangle = std::array<Vec3, 3>;

struct Hit {
    std::size_t triangle;
    double distance;
};

/// The triangles of a mesh in the world.
std::vector<Triangle> placed(const Mesh& mesh, const Pose& pose);
/// Largest distance of two corners of its box.
double size_of(const std::vector<Triangle>& mesh);

double distance(const Vec3& point, const Triangle& triangle);
/// 0 where they cross; touching may be off by rounding. No more than `most`.
double distance(const Triangle& a, const Triangle& b, double most);
double distance(const Vec3& point, const std::vector<Triangle>& mesh);
/// 0 where they cross, or a corner of one is inside the other, of those that are closed.
double distance(const std::vector<Triangle>& a, bool a_is_closed, const std::vector<Triangle>& b, bool b_is_closed);

/// direction: unit. Edges may be missed.
std::optional<Hit> raycast(const std::vector<Triangle>& mesh, const Vec3& origin, const Vec3& direction);

/// The winding number about a point, not rounded: near a whole number unless the point is on the surface.
double winding(const std::vector<Triangle>& mesh, const Vec3& point);

} // namespace raycontact::brute
