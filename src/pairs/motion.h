// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/ordered_pairs.h"

#include <cmath>
#include <span>
#include <vector>

namespace raycontact {

/// How each body moved since the last step, and from it a bound for a pair that costs a few operations: no relative
/// pose is formed.
class Motion {
public:
    /// Once a step, with every body of the scene.
    void update(Executor& executor, std::span<const PlacedBody> bodies);

    /// Asks for what pair_bound() reads of the second body, its first line; the first's is that of the pair before.
    void prefetch(const Pair& pair) const { __builtin_prefetch(&bodies_[pair.second]); }
    /// No less than what any vertex of either body moved in the frame of the other, metres. Here, where callers can see
    /// it: thousands of pairs a step are asked.
    float pair_bound(const Pair& pair) const {
        const Body &a = bodies_[pair.first], &b = bodies_[pair.second];
        const float still = distance(a.shift, b.shift) + (a.shift_lost + b.shift_lost);
        // The target's turn sweeps the source along, at its distance. Rotations are rigid to 1e-4, hence the
        // thousandth.
        const float apart = distance(a.centre, b.centre) + (a.centre_lost + b.centre_lost);
        const float first = a.turn * a.reach + b.turn * (apart + a.reach);
        const float second = b.turn * b.reach + a.turn * (apart + b.reach);
        return 1.001F * (still + (first < second ? second : first));
    }
    /// Neither body has moved by a bit since the last step.
    bool is_still(const Pair& pair) const { return bodies_[pair.first].still && bodies_[pair.second].still; }
    /// About how fast the two bodies' surfaces move past each other, metres a step.
    double pair_speed(const Pair& pair) const;
    /// How far the pair's relative rotation may be from an orthonormal matrix.
    double pair_shear(const Pair& pair) const { return lasts_[pair.first].shear + lasts_[pair.second].shear + 1e-15; }

private:
    static float distance(const float (&a)[3], const float (&b)[3]) {
        const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
        return std::sqrt((x * x + y * y) + z * z);
    }
    /// What a pair asks of a body. Small, so that those of thousands of bodies stay near: in float, each with what its
    /// rounding may have taken.
    struct Body {
        float centre[3]{};
        float shift[3]{};      ///< of the centre, metres
        float centre_lost = 0; ///< by rounding, metres
        float shift_lost = 0;
        float turn = 0;  ///< turn_bound
        float reach = 0; ///< of the shape, about its centre
        bool still = false;
    };
    struct Last {
        Pose centred; ///< of the last step
        double shear = 0;
        bool known = false;
    };
    std::vector<Body> bodies_;
    std::vector<Last> lasts_;
};

} // namespace raycontact
