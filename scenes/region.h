// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <limits>

namespace raycontact::scenes {

/// A box of the world, metres, that bodies are meant to stay in: what stands still, and the space above it.
struct Region {
    static constexpr double inf = std::numeric_limits<double>::infinity();
    Vec3 low{-inf, -inf, -inf}, high{inf, inf, inf};

    static Region empty() { return {{inf, inf, inf}, {-inf, -inf, -inf}}; }
    void include(const Vec3& point);
    /// Takes away its limits on the side that gravity pulls bodies from.
    void open_above(const Vec3& gravity);

    /// Whether it ends on the side that gravity pulls bodies to: without, nothing can be below it or leave it.
    bool has_ground(const Vec3& gravity) const;
    bool is_below(const Vec3& gravity, const Vec3& point) const; ///< lower than all of it, or straight under it
    bool has_left(const Vec3& gravity, const Vec3& point) const; ///< neither in it nor straight under it
};

} // namespace raycontact::scenes
