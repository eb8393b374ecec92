// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/turns.h>
#include <bench/peers/work.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::bench {

/// Two bodies that meet: the second lies along `way` from the first, each turns about an axis of its own.
struct Encounter {
    Vec3 home; ///< of the first body, metres
    std::array<double, 3> way, spin_a, spin_b;
    Quaternion a, b;

    /// Of one of the two, `distance` metres apart, turned by the angle whose half has this sine and cosine (or any
    /// multiple of both).
    Pose pose(bool second, double distance, double sine, double cosine) const;
};

/// Always the same ones, in cells of 4 m: meshes are 1 m, so no pair sees another.
std::vector<Encounter> encounters(std::uint32_t count);

/// Bodies 2 i and 2 i + 1 are pair i, all of one shape; no steps yet.
Work encounter_work(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                    std::uint32_t count);

std::vector<Pair> encounter_pairs(std::size_t count);

/// Sets both poses of each pair; `place` is called with (pair, whether the second body).
template <typename Place>
void place_encounters(Scene& scene, std::size_t count, Place&& place) {
    for (std::uint32_t i = 0; i < count; ++i) {
        scene.set_pose({2 * i, 0}, place(i, false));
        scene.set_pose({2 * i + 1, 0}, place(i, true));
    }
}

} // namespace raycontact::bench
