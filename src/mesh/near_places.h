// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/vector.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include <xxhash.h>

namespace raycontact {

/// Places, found by a grid: in a cell lie few, as no two are nearer than a length.
class NearPlaces {
public:
    NearPlaces(const std::vector<Vec3>& places, std::size_t count, double length)
        : places_(places), length_(length), first_(std::bit_ceil(count + 1), none), next_(places.size(), none) {}

    void add(std::uint32_t i) {
        const Vec3& p = places_[i];
        std::uint32_t& first = first_[slot({cell(p.x), cell(p.y), cell(p.z)})];
        next_[i] = std::exchange(first, i);
    }

    /// The nearest one that is nearer than the length, of several the first by its coordinates; else `otherwise`.
    std::uint32_t nearest(const Vec3& p, std::uint32_t otherwise) const {
        const std::array low{cell(p.x - length_), cell(p.y - length_), cell(p.z - length_)},
            high{cell(p.x + length_), cell(p.y + length_), cell(p.z + length_)};
        double least = length_;
        std::uint32_t found = otherwise;
        for (unsigned corner = 0; corner < 8; ++corner) {
            std::array<double, 3> at = low;
            bool again = false;
            for (unsigned k = 0; k < 3; ++k) {
                if ((corner >> k & 1) == 0) continue;
                at[k] = high[k];
                again = again || low[k] == high[k];
            }
            if (again) continue;
            for (std::uint32_t i = first_[slot(at)]; i != none; i = next_[i]) {
                const double distance = length(places_[i] - p);
                if (distance < least || (found != otherwise && distance == least && before(places_[i], places_[found])))
                    std::tie(least, found) = std::pair(distance, i);
            }
        }
        return found;
    }

    static bool before(const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

private:
    static constexpr std::uint32_t none = 0xffffffffu;
    /// Cells are so wide that what is near a place lies in two of them along an axis, mostly in one.
    double cell(double x) const { return std::floor(x / (8 * length_)) + 0.0; } // + 0: no -0
    std::size_t slot(const std::array<double, 3>& cell) const {
        return XXH3_64bits(cell.data(), sizeof cell) & (first_.size() - 1);
    }

    const std::vector<Vec3>& places_;
    double length_;
    std::vector<std::uint32_t> first_, next_; ///< lists of the places that share a slot
};

} // namespace raycontact
