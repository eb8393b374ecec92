// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/shape.h>

#include <array>
#include <cstdint>
#include <vector>

namespace raycontact {

/// A triangle of a surface, with its box. Frame of the surface, metres.
struct Facet {
    std::array<Vec3, 3> corner;
    Vec3 normal; ///< unit; by the winding
    Vec3 low, high;
    std::uint32_t triangle = 0;      ///< of the shape; of other facets 0
    std::array<int, 2> name{-1, -1}; ///< of other facets: what their source calls it
};

/// Adds a triangle that has an area, with its normal and box.
RAYCONTACT_API void add_facet(const std::array<Vec3, 3>& corner, std::uint32_t triangle, const std::array<int, 2>& name,
                              std::vector<Facet>& out);

/// The point of a facet that is nearest to another point.
struct Nearest {
    Vec3 point;
    double away2 = 0; ///< squared distance
    unsigned on = 7;  ///< the corners that span what it lies on: bits 0 to 2
};
Nearest nearest(const Facet& facet, const Vec3& p);
/// Metres that a facet is at least away from the segment between two points.
double least_away(const Facet& facet, const Vec3& a, const Vec3& b);

/// Facets of something of which no mesh is made, as it is now.
class FacetSource {
public:
    virtual ~FacetSource() = default;
    /// As Facets has them.
    virtual void near(const Vec3& low, const Vec3& high, std::vector<Facet>& out) const = 0;
    virtual double size() const = 0;
};

/// What a ball or capsule meets: a mesh, or facets of something else. In double.
class Facets {
public:
    explicit Facets(const Shape& shape) : shape_(&shape) {}
    explicit Facets(const FacetSource& source) : source_(&source) {}

    /// Those whose own boxes touch [low, high], in an order that stays.
    void near(const Vec3& low, const Vec3& high, std::vector<Facet>& out) const;
    /// Null of others than meshes.
    const Shape* shape() const { return shape_; }
    bool has_inside() const { return shape_ && shape_->has_inside(); }
    /// Metres that rounding grows with: its reach from its origin.
    double size() const;

private:
    const Shape* shape_ = nullptr;
    const FacetSource* source_ = nullptr;
};

} // namespace raycontact
