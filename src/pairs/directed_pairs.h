// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"

#include "slot_pair.h"

#include <raycontact/settings.h>
#include <raycontact/shape.h>

#include <algorithm>
#include <array>
#include <bit>

namespace raycontact {

/// A body as the pipeline sees it.
struct PlacedBody {
    const Shape* shape = nullptr;
    kernels::uint shape_index = 0; ///< in the shape store
    std::uint32_t generation = 0;  ///< tells it from another that had its slot
    Pose pose;                     ///< of the body frame
    Pose centred;                  ///< of the frame about the shape's centre, in which the kernels work
    Pose next{};                   ///< of that frame, where it is expected at the next step; with speculative contacts
    double margin = -1;            ///< of its own for speculative contacts, metres; negative: none
    bool is_sensor = false;        ///< its contacts are not the scene's
};

/// Bits, not values: 0 and -0 are one place, but not one contact.
inline bool same_bits(const Pose& p, const Pose& q) {
    using Bits = std::array<std::uint64_t, 12>;
    const auto bits = [](const Pose& pose) {
        std::array<double, 12> numbers{pose.translation.x, pose.translation.y, pose.translation.z};
        std::ranges::copy(pose.rotation, numbers.begin() + 3);
        return std::bit_cast<Bits>(numbers);
    };
    return bits(p) == bits(q);
}

/// As a device has it.
inline kernels::BodyPlace place_of(const Pose& pose, kernels::uint shape, BodySlot slot) {
    const Vec3& t = pose.translation;
    kernels::BodyPlace place{{}, {t.x, t.y, t.z}, shape, slot};
    std::ranges::copy(pose.rotation, place.rotation);
    return place;
}

/// The pose of the frame about the shape's centre.
inline Pose centred_pose(const Shape& shape, const Pose& pose) {
    return {pose.rotation, transform_point(pose, shape.centre())};
}

/// The box diagonal of the smaller body, metres: the size of the pair.
double smaller_size(const PlacedBody& a, const PlacedBody& b);

/// Whether a pair is answered in closed form, on the host, and by no method.
inline bool is_round(std::span<const PlacedBody> bodies, const SlotPair& pair) {
    return bodies[pair.first].shape->round() != nullptr || bodies[pair.second].shape->round() != nullptr;
}

/// How near two bodies have speculative contacts that do not hurry, metres.
double speculative_margin(const Settings& settings, const PlacedBody& a, const PlacedBody& b);
/// What stops a body at one end throws its other end, beyond where it goes, by up to this part of the pair's way: as
/// much as of a rod that falls flat (docs/internals/speculative.md, Thin bodies).
inline constexpr double thrown_share = 0.5;

/// One direction of a pair. Its directed index in a list of pairs is 2 x place of the pair, + 0 for vertices of a
/// against b, + 1 for vertices of b against a (docs/internals/pipeline.md).
struct DirectedBodies {
    const PlacedBody& source;
    const PlacedBody& target;
};
inline DirectedBodies directed_bodies(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs,
                                      std::uint32_t directed) {
    const auto [a, b] = pairs[directed / 2];
    return directed % 2 == 0 ? DirectedBodies{bodies[a], bodies[b]} : DirectedBodies{bodies[b], bodies[a]};
}

/// The source seen from the target: the relative pose is formed in double and only then rounded, so that nothing is
/// lost far from the origin.
void place_source(const PlacedBody& source, const PlacedBody& target, kernels::DirectedPair& placed);
/// The same where the relative pose is known already: with the bits that relative_pose() gives.
void place_source(const PlacedBody& source, const PlacedBody& target, const Pose& relative,
                  kernels::DirectedPair& placed);

/// The bounds grown by some metres on every side.
void widen(kernels::DirectedPair& pair, float by);

} // namespace raycontact
