// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "pairs/directed_pairs.h"
#include "platform/prefetch.h"
#include "slot_changes.h"

#include <span>
#include <vector>

namespace raycontact {

/// How each body moved since the last step. From this follows a bound for any pair in a few operations, without a
/// relative pose.
class Motion {
public:
    /// Once a step, with every body of the scene.
    void update(Executor& executor, std::span<const PlacedBody> bodies, const SlotChanges& moved);
    /// After update(), with where the bodies are expected at the next step.
    void expect(Executor& executor, std::span<const PlacedBody> bodies, const SlotChanges& moved);

    /// Prefetches what pair_bound() reads of the second body; the first body is mostly that of the last pair.
    void prefetch(const SlotPair& pair) const { platform::prefetch(&bodies_[pair.second]); }
    /// Upper bounds for a pair, metres.
    struct Bound {
        double moved;       ///< how far any vertex of either body moved in the frame of the other
        double moved_least; ///< the same in that of the two frames in which vertices moved less
        double
            nearer; ///< by how much any point of the one came nearer to the other, on a straight way in its frame, too
    };
    Bound pair_bound(const SlotPair& pair) const { return bound(bodies_, pair); }
    /// Bound::nearer of the way that is before the bodies (PlacedBody::next), if Bound::moved_least of it is more than
    /// `margin`, metres; else 0, as until expect().
    double pair_way(const SlotPair& pair, double margin) const;
    /// About how fast the two bodies' surfaces move past each other, metres a step.
    double pair_speed(const SlotPair& pair) const;
    /// How far the pair's relative rotation may be from an orthonormal matrix.
    double pair_shear(const SlotPair& pair) const {
        return lasts_[pair.first].shear + lasts_[pair.second].shear + 1e-15;
    }

private:
    /// What pair_bound() reads of a body. In float, with bounds of the rounding, so that thousands of bodies fit the
    /// caches.
    struct Body {
        float centre[3]{};
        float shift[3]{};      ///< of the centre, metres
        float centre_lost = 0; ///< rounding of centre, at most, metres
        float shift_lost = 0;
        float turn = 0;  ///< turn_bound
        float warp = 0;  ///< of its frame, by rotations that are rigid only nearly: a part of lengths
        float reach = 0; ///< of the shape, about its centre
    };
    struct Last {
        Pose centred; ///< of the last step
        double shear = 0;
        std::uint32_t generation = 0;
        bool known = false;
    };
    static Body body_of(const PlacedBody& body, const Pose& from, const Pose& to, double shear);
    static Bound bound(std::span<const Body> bodies, const SlotPair& pair);

    void follow(std::span<const PlacedBody> bodies, BodySlot body);

    std::vector<Body> bodies_, next_;
    std::vector<Last> lasts_;
    std::vector<BodySlot> moving_; ///< in the last step, unless that may be any
    SlotChanges::Seen seen_ = 0, expected_ = 0;
    bool any_moving_ = false; ///< more than moving_ lists
};

} // namespace raycontact
