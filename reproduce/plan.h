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

/// How much is run.
struct Plan {
    std::string name = "full"; ///< "full", "quick" or "tiny"
    SceneSize avalanche{512, 600};
    SceneSize rain{500, 3000};
    std::uint32_t seeds = 5;                          ///< 1, 2, ...; for lengths and table2
    std::vector<double> thresholds{0.01, 0.02, 0.08}; ///< metres, beside the fixed one; for lengths
    std::uint32_t orientations = 400, depths = 20;
    std::uint32_t picture_width = 1920;

    bool is_full() const { return name == "full"; }
    SceneSize size(const std::string& scene) const { return scene == "rain" ? rain : avalanche; }
    /// One sentence that says that this is not the paper's amount of work; empty for the full plan.
    std::string warning() const;
};

Plan full_plan();
/// Aims at three minutes on two cores.
Plan quick_plan();
/// For tests: every experiment, a few bodies and steps.
Plan tiny_plan();

/// The paper names its constants and gives no value. Ours are equal for `iterative` and `predictive`; a body's largest
/// extent is 1 m in both scenes. The threshold alone was chosen by a figure, that of section 5.2 (lengths.cpp); the
/// others were fixed before anything was measured.
namespace constants {
inline constexpr double displacement_threshold = 0.04; ///< metres: 4 % of a body's size
inline constexpr double confidence = 2;                ///< so cullingDist (equation 1) is 0.08 m
inline constexpr std::uint32_t max_iterations = 16;    ///< maxIt
} // namespace constants

/// A method as the paper has it: the constants above, distanceExtension as long as cullingDist, no full cast for a walk
/// that ends nowhere, and a ray for every vertex inside the bounds. displacement_threshold: metres.
Settings as_in_the_paper(Method method, double displacement_threshold = constants::displacement_threshold);
/// A method as the library runs it unless told otherwise.
Settings by_default(Method method);

} // namespace raycontact::reproduce
