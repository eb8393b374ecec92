// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/touch.h>

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact::bullet {

class PairState;

/// Which pairs of objects touch, from dispatch to dispatch.
class Touches {
public:
    /// First in a dispatch, and last.
    void begin();
    void done() { in_dispatch_ = false; }
    /// Once all pairs are gone: nothing is told of them.
    void forget() { *this = {}; }
    /// Of a pair whose contacts were found in this dispatch. seconds: until the next one.
    void update(PairState& pair, btScalar seconds);
    /// Its contacts are gone, or it is.
    void end(PairState& pair);

    std::span<const Touch> begun() const { return begun_; }
    std::span<const Touch> ended() const { return ended_; }
    std::uint64_t count() const { return count_; }

private:
    std::vector<Touch> begun_, ended_;
    std::vector<Touch> gone_; ///< since the last dispatch
    std::uint64_t count_ = 0;
    bool in_dispatch_ = false;
};

} // namespace raycontact::bullet
