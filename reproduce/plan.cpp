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
    Plan plan;
    plan.name = "quick";
    plan.avalanche = {343, 300};
    plan.volume_every = 30;
    plan.rain = {160, 960};
    plan.seeds = 1;
    plan.thresholds = {0.01};
    plan.orientations = 100;
    plan.depths = 10;
    plan.picture_width = 1280;
    return plan;
}

Plan tiny_plan() {
    Plan plan;
    plan.name = "tiny";
    plan.avalanche = {8, 90};
    plan.rain = {6, 90};
    plan.volume_every = 10;
    plan.seeds = 2;
    plan.thresholds = {0.01};
    plan.orientations = 6;
    plan.depths = 3;
    plan.picture_width = 96;
    return plan;
}

Settings as_in_the_paper(Method method, const Constants& constants) {
    Settings settings;
    settings.features = Features::vertices; // the paper's rule
    settings.method = method;
    settings.paper.displacement_threshold = constants.displacement_threshold;
    settings.paper.confidence = constants.confidence;
    settings.paper.distance_extension = constants.distance_extension;
    settings.paper.max_iterations = constants.max_iterations;
    settings.paper.cast_lost_walks = false;
    settings.paper.skip_outside = false; // grids are not the paper's
    return settings;
}

// But for edges, which the paper has not.
Settings by_default(Method method) {
    Settings settings;
    settings.features = Features::vertices;
    settings.method = method;
    return settings;
}

} // namespace raycontact::reproduce
