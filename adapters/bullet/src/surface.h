// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <convert.h>

#include <array>
#include <cstdint>
#include <vector>

class btHeightfieldTerrainShape;

namespace raycontact::bullet {

/// A triangle of a surface, with its box. Frame of the surface, metres.
struct Facet {
    std::array<Vec3, 3> corner;
    Vec3 normal; ///< unit; by the winding
    Vec3 low, high;
    std::uint32_t triangle = 0; ///< of the shape; of a height field 0
    PlaceName name{};           ///< of a height field
};

/// The point of a facet that is nearest to another point.
struct Nearest {
    Vec3 point;
    double away2 = 0; ///< squared distance
    unsigned on = 7;  ///< the corners that span what it lies on: bits 0 to 2
};
Nearest nearest(const Facet& facet, const Vec3& p);
/// Metres that a facet is at least away from the segment between two points.
double least_away(const Facet& facet, const Vec3& a, const Vec3& b);

/// What a ball or capsule meets: a mesh, or a height field as it is now, of which no mesh is made. In double.
class Surface {
public:
    explicit Surface(const Shape& shape) : shape_(&shape) {}
    explicit Surface(const btHeightfieldTerrainShape& field) : field_(&field) {}

    /// Those whose own boxes touch [low, high], in an order that stays.
    void near(const Vec3& low, const Vec3& high, std::vector<Facet>& out) const;
    /// Null of a height field.
    const Shape* shape() const { return shape_; }
    bool has_inside() const { return shape_ && shape_->has_inside(); }
    /// Metres that rounding grows with: its reach from its origin.
    double size() const;

private:
    const Shape* shape_ = nullptr;
    const btHeightfieldTerrainShape* field_ = nullptr;
};

} // namespace raycontact::bullet
