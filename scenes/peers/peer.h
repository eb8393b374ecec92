// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/peers/work.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace raycontact::peers {

/// What one step of a peer gave. The sum is of what a caller reads of each contact, so that reading it costs its price.
struct Found {
    std::uint64_t rays = 0, contacts = 0;
    double depth_sum = 0;
};

/// One way to find the contacts of a work. Made once per work, then given the same steps again and again.
class Peer {
public:
    virtual ~Peer() = default;
    /// Not timed: before each run; what is kept from step to step is forgotten.
    virtual void restart(const WorkStep&) {}
    /// Not timed: what is no part of the question.
    virtual void prepare(const WorkStep&) {}
    /// Timed: poses set, pairs collided, contacts read, on the calling thread alone.
    virtual Found detect(const WorkStep& step) = 0;
    /// For those that are a scene of ours: what the last step found and did.
    virtual const Scene* scene() const { return nullptr; }
    /// Bytes by the library's own count, for those that allocate behind the C library's back.
    virtual std::optional<std::uint64_t> own_memory() const { return {}; }
    /// Bytes it uses that were there before it was made.
    virtual std::uint64_t shared_memory() const { return 0; }
};

struct Entrant {
    std::string name; ///< as in --only
    std::string what; ///< for a person: library, version, how it is asked
    bool rays_alone = false;
    bool all_steps = false;                                 ///< it keeps something from step to step, or is quick
    bool exact = false;                                     ///< its contacts must be those of `bvh`, bit for bit
    std::uint32_t every = 1;                                ///< else, of the steps, for one too slow to be given all
    std::function<std::unique_ptr<Peer>(const Work&)> make; ///< empty: not built
    std::string why_not;                                    ///< what to install, where it was not built
};

Entrant ours(std::string name, Method method, Caster caster, Features features = Features::vertices);
Entrant gimpact();

} // namespace raycontact::peers
