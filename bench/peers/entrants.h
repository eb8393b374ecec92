// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/work.h>
#include <scenes/peers/peer.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raycontact::bench {

/// All there are, ours first.
std::vector<Entrant> entrants();

/// Which steps of a work an entrant is given: all, or one in the middle of every `stride`.
std::uint32_t stride(const Entrant& entrant, const Work& work);
bool is_given(const Entrant& entrant, const Work& work, std::size_t step);

// One a file; those of libraries that CMake did not find are answered by entrants() itself.
Entrant fcl();
Entrant ode();
Entrant embree();
Entrant rays_of_ours();
Entrant spared_rays_of_ours();
Entrant rays_of_embree();

} // namespace raycontact::bench
