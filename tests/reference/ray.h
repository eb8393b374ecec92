// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/solid.h"

#include <limits>

namespace raycontact::reference {

struct Hit {
    static constexpr std::uint32_t none = 0xffffffffu;
    std::uint32_t triangle = none; ///< index into Solid::triangles
    double distance = std::numeric_limits<double>::infinity();
    bool from_inside = false; ///< direction . normal > 0
};

/// Casts rays against every triangle of one solid; watertight after Woop, Benthin, Wald 2013, in double, with edge
/// signs that are exact for the sheared positions. Keeps scratch memory: one per thread.
class RayCaster {
public:
    explicit RayCaster(const Solid& solid);
    /// `direction` is unit. Closest hit at a distance >= 0; equal distances go to the lower triangle.
    Hit closest(const Vec3& origin, const Vec3& direction);
    /// The closest triangle met from inside, triangles with corner `skip` apart.
    Hit closest_from_inside(const Vec3& origin, const Vec3& direction, std::uint32_t skip);

private:
    template <class Visit>
    void each_hit(const Vec3& origin, const Vec3& direction, Visit visit);

    const Solid& solid_;
    std::vector<double> x_, y_, z_; ///< vertices in the frame of the ray: sheared, its direction along +z
};

} // namespace raycontact::reference
