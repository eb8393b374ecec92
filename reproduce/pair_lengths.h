// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace raycontact::reproduce {

/// How long the rays of each pair of bodies are in all steps together. Two bodies caught in each other have contacts in
/// every step, and one such pair can outweigh all others.
class PairLengths {
public:
    void add(std::span<const Contact> contacts) {
        for (const Contact& contact : contacts) {
            if (contact.is_speculative()) continue;
            Sums& sums = pairs_[{contact.body_a, contact.body_b}];
            sums.ray += static_cast<double>(contact.ray_length);
            sums.depth += static_cast<double>(contact.depth);
        }
    }
    /// Of the pair with the longest rays, metres.
    double longest_ray() const { return longest(&Sums::ray); }
    /// Of the pair with the largest depths, metres.
    double longest_depth() const { return longest(&Sums::depth); }

private:
    struct Sums {
        double ray = 0, depth = 0;
    };
    double longest(double Sums::*what) const {
        double most = 0;
        for (const auto& [pair, sums] : pairs_) most = std::max(most, sums.*what);
        return most;
    }

    std::map<std::pair<BodyId, BodyId>, Sums> pairs_;
};

} // namespace raycontact::reproduce
