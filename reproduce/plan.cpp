// SPDX-License-Identifier: Apache-2.0
#include <reproduce/plan.h>

#include <fmt/format.h>

namespace raycontact::reproduce {

std::string Plan::warning() const {
    if (is_full()) return {};
    return fmt::format("Short version ({}): avalanche of {} bodies and {} steps (the paper: 512 and 600), rain of {} "
                       "bodies and {} steps (500 and 3 000), {} seed{} (5), {} orientations x {} depths (400 x 20). "
                       "Its figures are not those of the paper's amount of work; run without --quick for them.",
                       name, avalanche.bodies, avalanche.steps, rain.bodies, rain.steps, seeds, seeds == 1 ? "" : "s",
                       orientations, depths);
}

Plan quick_plan() {
    return {.name = "quick",
            .avalanche = {343, 300},
            .rain = {160, 960},
            .seeds = 1,
            .thresholds = {0.01},
            .volume_every = 30,
            .orientations = 100,
            .depths = 10};
}

Plan tiny_plan() {
    return {.name = "tiny",
            .avalanche = {8, 90},
            .rain = {6, 90},
            .seeds = 2,
            .thresholds = {0.01},
            .volume_every = 10,
            .orientations = 6,
            .depths = 3};
}

// But for edges, which the paper has not.
Settings by_default(Method method) {
    Settings settings;
    settings.features = Features::vertices;
    settings.method = method;
    return settings;
}

Settings as_in_the_paper(Method method, const Constants& constants) {
    Settings settings = by_default(method);
    settings.paper.displacement_threshold = constants.displacement_threshold;
    settings.paper.confidence = constants.confidence;
    settings.paper.distance_extension = constants.distance_extension;
    settings.paper.max_iterations = constants.max_iterations;
    settings.paper.cast_lost_walks = false;
    settings.paper.skip_outside = false; // grids are not the paper's
    return settings;
}

} // namespace raycontact::reproduce
