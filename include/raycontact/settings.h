// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace raycontact {

/// How rays are kept from step to step. Only `standard` exists so far: every ray in full, every step.
enum class Method { standard };

/// How a ray meets a mesh. Both give the same bits.
enum class Caster {
    basic, ///< every triangle (paper section 5.1, "basic traversal")
    bvh,   ///< stackless bounding volume hierarchy (paper section 5.1)
};

/// What a contact's normal and depth are made of.
enum class Direction {
    ray,         ///< along the ray itself, depth = |r| (Hermann et al. 2008)
    reprojected, ///< along the normal of the face that was hit, depth = r . n (paper section 3.2, equation 2)
};

struct Settings {
    Method method = Method::standard;
    Caster caster = Caster::bvh;
    Direction direction = Direction::reprojected;
    /// Leave out the rays of vertices that a mesh's outside grid knows to be outside (caster bvh; docs/design.md). No
    /// contact depends on it; off, every ray is cast.
    bool skip_outside = true;
    std::string device = "auto"; ///< "auto", "cpu" or "cpu/k" (the k-th core alone)
    std::uint32_t threads = 0;   ///< of the CPU device; 0: one per core. No count changes a bit of the result
};

/// The words of the command line; throw InputError naming what is known.
Method method_from(std::string_view word);
Caster caster_from(std::string_view word);
Direction direction_from(std::string_view word);
std::string_view to_string(Method);
std::string_view to_string(Caster);
std::string_view to_string(Direction);

} // namespace raycontact
