// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/contacts.h"

#include <map>
#include <span>
#include <string>

namespace raycontact::reference {

/// Sums of any number of comparisons, for a test to assert on and a reader to see.
struct Comparison {
    std::uint64_t pairs = 0;
    std::uint64_t rays = 0;     ///< cast by the reference
    std::uint64_t contacts = 0; ///< found by the reference
    std::uint64_t agreed = 0;   ///< contacts alike in triangle, point, normal, depth, ray length and weight
    std::uint64_t excused = 0;  ///< rays that differ, within 1e-5 of an edge, t_max, the surface or the bounds
    std::map<std::string, std::uint64_t> excuses; ///< excused rays by what they were closest to
    std::uint64_t wrong = 0;                      ///< rays that differ without excuse
    double worst_normal = 0;                      ///< over the contacts that agree
    double worst_depth = 0;                       ///< relative to the larger diagonal
    double worst_ray_length = 0;                  ///< relative to the larger diagonal
    double worst_weight = 0;                      ///< relative to the weight
    std::vector<std::string> complaints; ///< the first few wrong rays in words: meshes, poses in hex, both answers
    std::string summary() const;
};

/// Smallest margin (see Margins) below which a ray is excused.
constexpr double excuse = 1e-5;

/// Holds the library's contacts of one pair of bodies, of direction `direction`, against the reference. Contacts of the
/// pair only, any order; those of edges are passed over (compare_edges.h).
void compare(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b, std::span<const Contact> contacts,
             Comparison& sum, Direction direction = Direction::reprojected);

} // namespace raycontact::reference
