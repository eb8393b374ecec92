// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/peer.h>

namespace raycontact::bench {

namespace {

[[maybe_unused]] Entrant not_built(std::string name, std::string what, const std::string& package) {
    Entrant entrant;
    entrant.name = std::move(name);
    entrant.why_not = what + " was not found when this program was built; install " + package + " and build again";
    entrant.what = std::move(what);
    return entrant;
}

} // namespace

std::vector<Entrant> entrants() {
    return {
        ours(true),
        ours(false),
        gimpact(),
#ifdef RAYCONTACT_HAS_FCL
        fcl(),
#else
        not_built("fcl", "FCL", "libfcl-dev"),
#endif
#ifdef RAYCONTACT_HAS_ODE
        ode(),
#else
        not_built("ode", "ODE", "libode-dev"),
#endif
        embree(),
        rays_of_ours(),
        spared_rays_of_ours(),
        rays_of_embree(),
    };
}

} // namespace raycontact::bench
