// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/entrants.h>

#include <algorithm>

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
        ours("bvh", Method::standard, Caster::bvh),
        ours("basic", Method::standard, Caster::basic),
        ours("iterative", Method::iterative, Caster::bvh),
        ours("iterative-basic", Method::iterative, Caster::basic),
        ours("predictive", Method::predictive, Caster::bvh),
        ours("certified", Method::certified, Caster::bvh),
        ours("edges", Method::certified, Caster::bvh, Features::edges),
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

bool is_given(const Entrant& entrant, const Work& work, std::size_t step) {
    const std::size_t apart = entrant.all_steps ? 1 : std::max(entrant.every, work.stride);
    return step % apart == std::min(apart / 2, work.steps.size() - 1);
}

} // namespace raycontact::bench
