// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/ordered_pairs.h"

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
    void prefetch(const SlotPair& pair) const { __builtin_prefetch(&bodies_[pair.second]); }
    /// No less than what any vertex of either body moved in the frame of the other, metres.
    double pair_bound(const SlotPair& pair) const;
    /// Neither body has moved by a bit since the last step.
    bool is_still(const SlotPair& pair) const { return bodies_[pair.first].still && bodies_[pair.second].still; }
    /// About how fast the two bodies' surfaces move past each other, metres a step.
    double pair_speed(const SlotPair& pair) const;
    /// How far the pair's relative rotation may be from an orthonormal matrix.
    double pair_shear(const SlotPair& pair) const {
        return lasts_[pair.first].shear + lasts_[pair.second].shear + 1e-15;
    }

private:
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
        std::uint32_t generation = 0;
        bool known = false;
    };
    std::vector<Body> bodies_;
    std::vector<Last> lasts_;
};

} // namespace raycontact
