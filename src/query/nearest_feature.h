// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <array>
#include <cstdint>

namespace raycontact {

/// A triangle of a mesh, and the numbers that its corners have there.
struct NumberedTriangle {
    std::array<Vec3, 3> corners;
    std::array<std::uint32_t, 3> vertices;
};

/// What of a triangle is nearest to a point: a corner, an edge or the face. Which of them is decided exactly; point
/// and distance are rounded.
class NearestFeature {
public:
    NearestFeature(const Vec3& sought, const NumberedTriangle& triangle);

    const Vec3& point() const { return point_; }
    const Vec3& away() const { return away_; } ///< from there to what is sought; less rounded than their difference
    bool is_face() const { return kind_ == Kind::face; } ///< not a corner or an edge
    double distance() const { return distance_; }
    double error() const { return error_; } ///< of the distance, at most
    /// -1: nearer than another one, which is of the same mesh and the same point; 0: as near. Exact.
    int order(const NearestFeature& other) const;

private:
    enum class Kind { corner, edge, face };
    struct Squared;
    Squared squared() const;
    void set_corner(std::size_t k);
    void set_edge(std::size_t k);
    void set_nearest_of_edge(std::size_t k);
    void set_face();

    Vec3 sought_;
    NumberedTriangle triangle_; ///< turned: the feature is corner 0, or the edge from 0 to 1, or the face
    Kind kind_ = Kind::corner;
    Vec3 point_, away_;
    double distance_ = 0, error_ = 0;
};

} // namespace raycontact
