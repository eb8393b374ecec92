// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/descent.h"
#include "query/placed_point.h"
#include "shape/shape_data.h"

#include <array>

namespace raycontact {

/// The inverse of a rotation that is rigid to 1e-4, to rounding; what it is of entries 0, 1 and -1 is exact.
std::array<double, 9> inverse_of(const std::array<double, 9>& rotation);
std::array<double, 9> product_of(const std::array<double, 9>& left, const std::array<double, 9>& right);

/// A placed shape; rough points lie in its centred frame.
class PlacedShape {
public:
    /// Placed about `origin`. error: of its rough points, metres, at most.
    PlacedShape(const ShapeData& shape, const Pose& pose, const Vec3& origin, double error)
        : shape_(shape), placing_(pose.rotation, pose.translation, origin) {
        placing_.error = error;
    }

    const ShapeData& shape() const { return shape_; }
    PlacedPoint vertex(std::uint32_t vertex) const;
    std::array<PlacedPoint, 3> triangle(std::uint32_t triangle) const;
    /// A point of the centred frame, rounded to one of the body frame, which is then exact.
    PlacedPoint point(const Vec3& centred) const;
    const Placing& placing() const { return placing_; }

    /// Calls visit(tree) for that of the triangles, and that of the slivers.
    template <class Visit>
    void each_tree(Visit&& visit) const {
        visit(static_cast<const TriangleTree&>(shape_));
        if (!shape_.slivers.nodes.empty()) visit(shape_.slivers);
    }

private:
    const ShapeData& shape_;
    Placing placing_;
};

/// Two placed shapes; of round ones the cores. Rough points lie in the centred frame of b; where both poses are equal,
/// they count as none.
class ShapePair {
public:
    ShapePair(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

    const ShapeData& a() const { return a_.shape(); }
    const PlacedShape& b() const { return b_; }
    /// So far apart, by their translations alone, that they cannot meet.
    bool far_apart() const { return far_apart_; }

    PlacedPoint vertex_of_a(std::uint32_t vertex) const;
    std::array<PlacedPoint, 3> triangle_of_a(std::uint32_t triangle) const;
    /// Rough corners alone.
    std::array<Vec3, 3> corners_of_a(std::uint32_t triangle) const;
    std::array<Vec3, 3> corners_of_b(std::uint32_t triangle) const;
    /// Rough points of a in the centred frame of b.
    const Pose& a_in_b() const { return a_in_b_; }
    /// Out of the centred frame of `side` into that of the other one.
    const Pose& out_of(Side side) const { return side == Side::a ? a_in_b_ : b_in_a_; }
    /// How far the bodies reach around what is walked here, together: 0 of meshes. Metres.
    double radius() const { return radius_of(a()) + radius_of(b().shape()); }
    Vec3 to_world(const Vec3& rough) const { return transform_point(b_in_world_, rough); }

    /// About a box of the other tree, in the frame of `side`.
    Box box_in(Side side, const Box& of_other) const;
    double error() const { return a_.placing().error; } ///< of rough points, metres, at most

    /// Calls descend(tree of a, tree of b) for each pair of their trees.
    template <class Descend>
    void each_tree(Descend&& descend) const {
        a_.each_tree([&](const TriangleTree& a) { b_.each_tree([&](const TriangleTree& b) { descend(a, b); }); });
    }

private:
    struct Poses;
    explicit ShapePair(const ShapeData& a, const ShapeData& b, const Poses& poses);
    PlacedShape a_, b_;
    Pose a_in_b_, b_in_a_; ///< of centred frames; affine rather than rigid, as the poses are
    Pose b_in_world_;      ///< of b's centred frame
    bool far_apart_;
};

/// The boxes of the triangles of a block, as its tree has them, in float32; empty lanes are nowhere.
struct BlockBoxes {
    std::array<Lanes<float>, 3> low, high;
    /// Grown by `grow`, metres, which must be more than what is rounded here (float_rounding_of).
    BlockBoxes(const kernels::TriangleBlock& block, double grow);
    /// About them all.
    Box whole() const;
    /// The squared distance of each from a box, m^2, or less; 0: they may touch. Never infinite, but in empty lanes.
    Lanes<float> squared_distances(const Box& box) const;
};

/// How far along a direction each triangle of a block begins: the least of direction . corner; infinite in empty lanes.
Lanes<double> least_along(const kernels::TriangleBlock& block, const Vec3& direction);

/// How far a file's vertex can be from the float32 one, metres, with a margin.
inline double rounding_of(const ShapeData& shape) {
    return double(shape.header.tolerance);
}

/// More than some ten roundings to float32 of numbers of this size.
inline double float_rounding_of(double size) {
    return 2e-6 * size;
}
/// The same of what two shapes are and lie apart, and how far their rough points are off, metres.
inline double float_rounding_of(const ShapePair& pair) {
    const double apart = length(pair.a_in_b().translation);
    return pair.error() + float_rounding_of(pair.a().reach + pair.b().shape().reach + apart);
}

} // namespace raycontact
