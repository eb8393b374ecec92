// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace raycontact::bench {

struct GrowthOptions {
    std::uint32_t bodies = 2048;      ///< the largest avalanche: 64 and its doubles up to here; 0: none
    std::uint32_t steps = 150;        ///< of each avalanche; the last fifth of them is measured
    std::uint32_t triangles = 100000; ///< the largest mesh: 100, 316, 1 000, ... up to here; 0: none
    std::uint32_t pairs = 16;         ///< of that mesh, at each size
    std::uint32_t threads = 1;
};

/// The narrow phase of `standard bvh` at one size, a step: medians over the steps for bodies, means for
/// triangles (of each step the fastest of five runs).
struct GrowthRow {
    std::string part;       ///< "bodies" or "triangles"
    std::uint32_t size = 0; ///< bodies in motion, or triangles of each mesh
    std::uint32_t steps = 0;
    double pairs = 0, rays = 0, contacts = 0;
    double narrow_ms = 0; ///< wall
    double us_per_pair = 0;
};

std::vector<GrowthRow> growth(const GrowthOptions& options, const std::function<void(const std::string&)>& progress);

} // namespace raycontact::bench
