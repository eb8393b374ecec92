// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/body_id.h>
#include <raycontact/settings.h>

#include <cstdint>
#include <string>
#include <utility>

namespace raycontact::recording {

/// What was recorded, as far as it does not change from step to step.
struct Info {
    std::string scene; ///< its name
    std::uint64_t seed = 0;
    std::uint32_t bodies = 0; ///< as the scene counts them, its ground not among them
    double dt = 1.0 / 60;     ///< seconds between steps, > 0
    Settings settings;        ///< of the scene whose contacts were hashed
    std::string mesh_source;  ///< what the meshes are and where they came from, for a person
};

/// A body of a recording. Its number is its place in the list, in which every body ever added has one of its own.
struct Body {
    static constexpr std::uint32_t never = 0xffffffffu;
    std::uint32_t shape = 0;        ///< index into the recording's shapes
    std::uint32_t first_step = 0;   ///< the first step it takes part in
    std::uint32_t end_step = never; ///< the first step it takes no part in any more
    BodyId id;                      ///< as Scene::add gave it; of recordings of version 1 its number is the slot

    bool alive(std::uint32_t step) const { return first_step <= step && step < end_step; }
};

/// Two bodies by their numbers, first < second.
using NumberPair = std::pair<std::uint32_t, std::uint32_t>;

/// A body that comes or goes.
struct BodyEvent {
    enum Kind : std::uint32_t { comes = 0, goes = 1 };
    std::uint32_t step = 0; ///< the first step it takes part in, or takes no part in any more
    Kind kind = comes;
    std::uint32_t body = 0; ///< its number
    std::uint32_t shape = 0;
};

} // namespace raycontact::recording
