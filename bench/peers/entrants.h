// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/work.h>
#include <scenes/peers/peer.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace raycontact::bench {

/// All there are, ours first.
std::vector<Entrant> entrants();

/// Whether an entrant is given a step of a work: it gets all, or one in the middle of every `stride`.
bool is_given(const Entrant& entrant, const Work& work, std::size_t step);

/// One whose peer is a Made.
template <class Made>
Entrant entrant_of(std::string name, std::string what, bool rays_alone = false) {
    Entrant entrant;
    entrant.name = std::move(name);
    entrant.what = std::move(what);
    entrant.rays_alone = rays_alone;
    entrant.make = [](const Work& work) { return std::make_unique<Made>(work); };
    return entrant;
}

// One a file; those of libraries that CMake did not find are answered by entrants() itself.
Entrant fcl();
Entrant ode();
Entrant embree();
Entrant rays_of_ours();
Entrant spared_rays_of_ours();
Entrant rays_of_embree();

} // namespace raycontact::bench
