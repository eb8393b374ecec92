// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/settings.h>

#include <cstdint>
#include <string>
#include <vector>

namespace raycontact::reproduce {

struct SceneSize {
    std::uint32_t bodies = 0, steps = 0;
};

/// The paper names its constants and gives no value. Ours are equal for `iterative` and `predictive`; a body's largest
/// extent is 1 m in both scenes. docs/internals/reproduction.md says how they were chosen.
struct Constants {
    double displacement_threshold = 0.04; ///< metres: 4 % of a body's size
    double confidence = 1;                ///< the least; so cullingDist (equation 1) is 0.04 m
    double distance_extension = 0.0404;   ///< metres; just above displacement_threshold (section 3.1)
    std::uint32_t max_iterations = 16;    ///< maxIt

    /// With another threshold, and a distanceExtension in proportion.
    Constants at(double threshold) const {
        Constants other = *this;
        other.displacement_threshold = threshold;
        other.distance_extension = distance_extension * threshold / displacement_threshold;
        return other;
    }
};

/// How much is run.
struct Plan {
    std::string name = "full"; ///< "full", "quick" or "tiny"
    SceneSize avalanche{512, 600};
    SceneSize rain{500, 3000};
    std::uint32_t seeds = 5;                          ///< 1, 2, ...; for lengths and table2
    std::vector<double> thresholds{0.01, 0.02, 0.08}; ///< metres, beside the fixed one; for lengths
    std::uint32_t volume_every = 20;                  ///< steps; for volume
    std::uint32_t orientations = 400, depths = 20;
    Constants constants{};

    bool is_full() const { return name == "full"; }
    SceneSize size(const std::string& scene) const { return scene == "rain" ? rain : avalanche; }
    /// One sentence that says that this is not the paper's amount of work; empty for the full plan.
    std::string warning() const;
};

/// Aims at three minutes on two cores.
Plan quick_plan();
/// For tests: every experiment, a few bodies and steps.
Plan tiny_plan();

/// A method as the paper has it: with these constants, no full cast for a walk that ends nowhere, and a ray for every
/// vertex inside the bounds.
Settings as_in_the_paper(Method method, const Constants& constants);
/// A method as the library runs it unless told otherwise.
Settings by_default(Method method);

} // namespace raycontact::reproduce
