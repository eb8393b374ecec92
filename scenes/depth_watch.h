// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

namespace raycontact::scenes {

/// Watches how long contacts stay deeper than a limit: a solver needs a few steps to push a body out, but no more.
class DepthWatch {
public:
    explicit DepthWatch(double limit) : limit_(limit) {}

    /// The contacts of one step; steps follow each other.
    void add(std::uint32_t step, std::span<const Contact> contacts);

    double limit() const { return limit_; }              ///< metres
    std::uint64_t contacts() const { return contacts_; } ///< deeper than the limit, all steps
    /// Most steps in a row for one key, of runs that end in `step` or later.
    std::uint32_t longest_since(std::uint32_t step) const;

private:
    using Key = std::tuple<BodyId, BodyId, std::uint64_t>; ///< body_a, body_b, Contact::key()
    double limit_;
    std::uint64_t contacts_ = 0;
    std::map<Key, std::uint32_t> runs_;  ///< of the last step: for how many steps
    std::vector<std::uint32_t> by_step_; ///< longest run that was alive in each step
};

} // namespace raycontact::scenes
