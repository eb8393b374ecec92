// SPDX-License-Identifier: Apache-2.0
#include "schedule/moving_pairs.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>

namespace raycontact {

MovingPairs choose_moving(const PairList& list, std::span<const Contact> contacts, double share) {
    const std::span<const SlotPair> pairs = list.pairs;
    if (share >= 1) return {list, 1};
    std::vector<std::uint64_t> weights(pairs.size(), 1); // in contacts, and one more
    std::unordered_map<BodySlot, std::uint64_t> weight_of_body;
    std::uint64_t all = 0;
    auto contact = contacts.begin();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        while (contact != contacts.end() && pair_of(*contact) < pairs[i]) ++contact;
        for (; contact != contacts.end() && pair_of(*contact) == pairs[i]; ++contact) ++weights[i];
        all += weights[i];
        weight_of_body[pairs[i].first] += weights[i];
        weight_of_body[pairs[i].second] += weights[i];
    }
    std::vector<std::pair<std::uint64_t, BodySlot>> bodies;
    bodies.reserve(weight_of_body.size());
    for (const auto& [body, weight] : weight_of_body) bodies.emplace_back(weight, body);
    std::ranges::sort(bodies);

    MovingPairs moving;
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(all));
    std::unordered_set<BodySlot> chosen;
    std::uint64_t sum = 0;
    for (const auto& [weight, body] : bodies) {
        if (sum + weight > wanted) break;
        chosen.insert(body);
        sum += weight; // an upper bound: two chosen bodies may share a pair
    }
    std::uint64_t moved = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (!chosen.contains(pairs[i].first) && !chosen.contains(pairs[i].second)) continue;
        moving.pairs.add({pairs[i], list.slots[i]});
        moved += weights[i];
    }
    if (all > 0) moving.share = static_cast<double>(moved) / static_cast<double>(all);
    return moving;
}

} // namespace raycontact
