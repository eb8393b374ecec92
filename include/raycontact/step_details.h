// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/device.h>

#include <cstdint>
#include <vector>

namespace raycontact {

/// How a step found its contacts: counts of work, the same in each run of the same build once shapes are prepared.
struct StepDetails {
    std::uint64_t vertices = 0; ///< tested against bounds, after whole clusters were ruled out
    /// `standard`: rays of the rule, the vertices inside the other body's bounds. `certified`: the vertices that it
    /// cannot prove safe; for pairs too fast for it, the vertices in the bounds whose block it cannot prove safe.
    /// `iterative` and `predictive`: the vertices in the bounds (`predictive` widens them) that a full test tested, and
    /// the rays followed.
    std::uint64_t rays = 0;
    /// Traced through the mesh, along the ray or ahead of it; the rest were followed or known already.
    std::uint64_t rays_cast = 0;
    /// Directions cast to tell inside from outside where the closest hits lay within rounding.
    std::uint64_t side_tests = 0;
    double ray_length = 0;               ///< sum over the contacts that touch, metres (paper section 5.2)
    std::uint64_t pairs_full = 0;        ///< ordered pairs tested in full: those new, fast, or moved far
    std::uint64_t pairs_skipped = 0;     ///< ordered pairs without rays, of which no vertex was tested
    std::uint64_t pairs_as_standard = 0; ///< ordered pairs that `certified` left to `standard`, which costs less there
    std::uint64_t walks = 0;             ///< rays followed from last step's triangle (iterative, predictive)
    std::uint64_t walks_lost = 0;        ///< of these, how many ended nowhere
    std::uint64_t walk_casts = 0;        ///< of those, how many were cast in full instead
    std::uint64_t predictions = 0;       ///< vertices followed without contact (predictive)
    std::uint64_t pairs_moved = 0;       ///< from one device to another
    std::uint64_t bytes_moved = 0;       ///< of what was kept for them
    std::vector<DeviceWork> work;        ///< one entry a device, those lost included
};

} // namespace raycontact
