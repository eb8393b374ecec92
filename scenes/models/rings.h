// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstdint>
#include <vector>

namespace raycontact::scenes {

/// `total` points shared out among rings in proportion to `weights`, at least `least` each, the remainder spread
/// evenly. A closed tube of rings of n_i points has exactly 2 x sum(n_i) triangles, and so has a sphere of rings with
/// two poles: that is how every even count is met without a single split edge.
std::vector<std::uint32_t> share_out(std::uint32_t total, const std::vector<double>& weights, std::uint32_t least);

/// A ring of points already in the mesh: first, first + 1, ... counter-clockwise; `turn[k]` in [0, 1) grows along it.
struct Ring {
    std::uint32_t first = 0;
    std::vector<double> turn;
};

/// The band from ring a to ring b: one triangle per edge of either, always advancing the ring that lags. Outward when
/// both run counter-clockwise about the way from a to b. b starts at its point `b_start`; unless that is 0, the two
/// first points are taken to be level.
void stitch(Mesh& mesh, const Ring& a, const Ring& b, std::uint32_t b_start = 0);

/// The point of b nearest to the first of a, for rings that are twisted against each other.
std::uint32_t nearest_start(const Mesh& mesh, const Ring& a, const Ring& b);

} // namespace raycontact::scenes
