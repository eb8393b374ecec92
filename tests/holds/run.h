// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/holds/hold.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace raycontact::scenes {

struct HoldOptions {
    double seconds = 60;              ///< at most; a scene may have fewer
    double patience = 1e9;            ///< seconds of the computer's time after which a run ends early
    bool recommended_for_all = false; ///< Bullet's own finders get the recommended solver, too
    bool speculative = true;
    int iterations = 0;                 ///< of the solver; 0: as it is
    std::optional<double> slop;         ///< metres, of the recommended solver; empty: that of the scene
    double hertz = 0;                   ///< 0: the scene's
    int print_from = -1, print_to = -1; ///< steps whose contacts are printed
};

/// What became of a scene. Lengths in metres.
struct HoldResult {
    double seconds = 0;       ///< that were run
    bool ended_early = false; ///< patience was at an end
    double deepest = 0;       ///< of the sampled steps
    double deepest_time = 0;  ///< when, seconds
    double deepest_end = 0;   ///< of the last look
    int passed = 0;           ///< bodies, the most of the sampled steps
    double speed_max = 0;     ///< of any body in any step of the last second, m/s; turning counts with half a size
    double speed_median = 0;  ///< of all bodies and steps of that second
    double drift = 0;         ///< the most that a centre is from where it began
    double asleep = -1;       ///< seconds after which all slept, with deactivation switched on at the end; -1: not in 5
    double step_ms = 0;
    std::vector<Figure> figures;
    std::vector<std::string> failures;             ///< what did not hold, in words; none: it holds
    std::vector<std::pair<double, double>> speeds; ///< seconds, median speed of the bodies then

    bool holds() const { return failures.empty(); }
};

HoldResult run_hold(const Hold& hold, Finder finder, const HoldOptions& options = {});

} // namespace raycontact::scenes
