// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <limits>

namespace raycontact {

/// Names one body of one scene and is never given again. Scene::add() makes them; one of your own making is not valid.
struct BodyId {
    /// The slot of an id that is not valid.
    static constexpr std::uint32_t no_slot = std::numeric_limits<std::uint32_t>::max();

    /// The body's place in the scene, as small as can be: use it as an index into arrays of your own. It passes to
    /// another body once this one is removed.
    std::uint32_t slot = no_slot;
    std::uint32_t generation = 0; ///< how many bodies had the slot before

    /// It was given by a scene, where its body may have been removed since (Scene::has()).
    constexpr bool valid() const noexcept { return slot != no_slot; }
    /// By slot, then generation.
    // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 takes the 0 that the compiler compares with for a pointer
    friend constexpr auto operator<=>(const BodyId&, const BodyId&) = default;
};

} // namespace raycontact

template <>
struct std::hash<raycontact::BodyId> {
    std::size_t operator()(const raycontact::BodyId& id) const noexcept {
        return std::hash<std::uint64_t>()(std::uint64_t{id.generation} << 32 | id.slot);
    }
};
