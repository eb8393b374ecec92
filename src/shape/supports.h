// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "shape/shape_data.h"

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

namespace raycontact {

/// How far a shape reaches in any direction, as a table: a bound from above that is read in constant time. It holds the
/// true reach in the directions of a grid on a cube's faces. Reach is a sublinear function of the direction (a support
/// function; Rockafellar 1970), so between three directions of the grid what it is there, weighted, is a bound.
class Supports {
public:
    /// Empty: it knows nothing, and must not be asked.
    Supports() = default;
    /// Empty if it was asked to stop.
    Supports(const ShapeData& shape, Executor& executor, const std::stop_token& stop);
    /// Of a table that was made. Empty if it is none: another number of values, or one that is not finite.
    explicit Supports(std::vector<float> reaches);
    std::span<const float> reaches() const { return reaches_; }

    /// Of a table that is not empty. No vertex is farther along `direction` than `point` is; the point need not be of
    /// the shape. Frame of the shape's centre, metres; the direction not zero.
    Vec3 point(const Vec3& direction) const;

    std::uint64_t bytes() const { return reaches_.capacity() * sizeof(float); }

private:
    static constexpr int cells = 16; ///< along an edge of a face: a ball reaches 0.4 % too far, at most
    static constexpr int corners = cells + 1;
    std::vector<float> reaches_; ///< of each face, by its two other axes; along vectors that end on the cube
};

} // namespace raycontact
