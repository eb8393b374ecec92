// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/results.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raycontact::bench {

// The parts:
//   triangles     approaching pairs of ever finer meshes: contacts grow with the vertices that are inside
//   contacts      rolling pairs of ever finer meshes, each with about the same number of contacts; creeping: the same,
//                 as slowly as a pile at rest creeps; still: the same pairs, which do not move at all
//   displacement  rolling pairs of one mesh, faster and faster
//   bodies        avalanches, larger and larger
inline constexpr const char* growth_parts[] = {"triangles", "contacts", "creeping", "still", "displacement", "bodies"};

struct GrowthOptions {
    std::vector<std::string> parts;   ///< empty: all
    std::uint32_t bodies = 2048;      ///< the largest avalanche: 64 and its doubles up to here; 0: none
    std::uint32_t steps = 150;        ///< of each avalanche; the last fifth of them is measured
    std::uint32_t triangles = 100000; ///< the largest mesh: 100, 316, 1 000, ... up to here; 0: none
    std::uint32_t pairs = 16;         ///< of that mesh, at each size
    std::uint32_t contacts = 6;       ///< a pair, of rolling pairs
    std::uint32_t threads = 1;
};

/// The narrow phase of one method at one size, a step: medians over the steps for bodies, means for the others. The
/// first step, in which every pair is new, is left out; of each step the fastest of the runs counts.
struct GrowthRow {
    std::string part;
    double size = 0; ///< triangles of each mesh, bodies in motion, or displacement a step as a part of the size
    Method method = Method::standard;
    std::uint32_t steps = 0;
    double pairs = 0, rays = 0, contacts = 0, rays_cast = 0, walks = 0;
    double narrow_ms = 0; ///< wall
    double us_per_pair = 0;
    double pace = 0; ///< what a pair really moved a step, as a part of the size: the median
};

/// Where `progress` throws Stopped, the rows before.
std::vector<GrowthRow> growth(const GrowthOptions& options, const Progress& progress);

/// The time a pair takes grows as its size to this power: the slope of a line through the logarithms, least squares.
struct Slope {
    std::string part;
    Method method = Method::standard;
    double power = 0;
    double from = 0, to = 0; ///< sizes; of meshes those from 1 000 triangles
};

std::vector<Slope> slopes(std::span<const GrowthRow> rows);

/// For a person.
std::string table(std::span<const GrowthRow> rows);
Json json(const GrowthRow& row);
Json json(const Slope& slope);
inline constexpr const char* growth_columns =
    "part,size,steps,pairs,rays,contacts,narrow_ms,us_per_pair,method,rays_cast,walks,pace_median";
std::string chart(std::span<const GrowthRow> rows);

} // namespace raycontact::bench
