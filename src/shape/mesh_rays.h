// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/measure.h"
#include "shape/shape_data.h"

#include <array>
#include <limits>
#include <span>

namespace raycontact {

/// Normal of a face, out of the mesh and as long as twice the area.
inline Vec3 area_normal(const ShapeData& mesh, std::uint32_t face) {
    const Vec3 a = mesh.corner(face, 0);
    return cross(mesh.corner(face, 1) - a, mesh.corner(face, 2) - a);
}

/// The mesh's own, in its centred frame.
inline Box box_of(const ShapeData& mesh) {
    const auto &low = mesh.header.low, &high = mesh.header.high;
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

/// Where a ray meets a mesh, in double and in the centred frame of the mesh.
struct MeshHit {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t face = NONE;
    bool from_inside = false;
};

struct MeshRay {
    Vec3 origin, direction;                   ///< direction: unit
    double least, most;                       ///< hits with least < distance <= most count
    bool from_inside = false;                 ///< faces met from outside do not count
    std::span<const std::uint32_t> skipped{}; ///< faces that do not count
};

/// The line of a ray in float32, centred frame, to find triangles that it may meet. direction: unit.
struct FloatLine {
    std::array<float, 3> origin{}, direction{};
    float error = 0; ///< of a volume, m^3

    FloatLine() = default;
    /// slack: how far the line may be off, metres.
    FloatLine(const ShapeData& mesh, const Vec3& origin, const Vec3& direction, double slack = 0);
};

/// A bit for each triangle of a block that a line passes within the rounding of floats: all that it meets, and some
/// more. outside: 1, or 0 where those met from outside do not count.
std::uint32_t triangles_on_line(const kernels::TriangleBlock& block, const FloatLine& line, std::uint32_t outside);

/// The closest face that counts; of equal ones the lowest.
MeshHit closest_hit(const ShapeData& mesh, const MeshRay& ray);

/// How a point is nearest to a mesh.
struct NearestFace {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t face = NONE;
};

/// The nearest face within `bound`; or, once one is found within `enough`, that one.
NearestFace nearest_face(const ShapeData& mesh, const Vec3& point, double enough,
                         double bound = std::numeric_limits<double>::infinity());

/// The nearest of the pieces into which a triangle of the file was cut.
NearestFace nearest_piece(const ShapeData& mesh, const Vec3& point, std::uint32_t file_triangle);

/// A vertex of another mesh, `source`, that is turned by `rotation`.
struct ForeignVertex {
    Vec3 point;
    const ShapeData& source;
    std::uint32_t vertex;
    const std::array<double, 9>& rotation;
};

/// The nearest of the faces by which a vertex can leave: they have it behind them, and look against a face at it, by a
/// cosine above 0.05, or the way that `known` does, by a cosine above 0.98. No farther than `known`, which was hit.
NearestFace nearest_exit(const ShapeData& mesh, const ForeignVertex& own, const NearestFace& known);

/// What of a triangle is nearest to a point.
struct NearestPoint {
    Vec3 point;
    std::uint32_t edges = 0; ///< a bit for each edge that it lies on, from corner k to the next; 0: within the face
};

/// The point of a triangle that is nearest to p. Of a needle, whose normal is not accurate to some 1e-10, only the
/// edges count; so it may be farther than that by a millionth of the needle's length.
NearestPoint nearest_of(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
inline Vec3 nearest_point(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    return nearest_of(p, a, b, c).point;
}

} // namespace raycontact
