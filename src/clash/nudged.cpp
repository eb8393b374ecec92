// SPDX-License-Identifier: Apache-2.0
#include "clash/nudged.h"

#include "clash/askew.h"

#include "mesh/vector.h"

#include <algorithm>
#include <numeric>

namespace raycontact::clash {

namespace {

constexpr double far_more = 20; // times what the nudge and rounding can make

/// Metres.
double nudge_of(const ShallowPair& pair) {
    return 2 * noise * smaller_size(*pair.a, *pair.b);
}

double deepest_of(std::span<const Contact> contacts) {
    double deepest = 0;
    for (const Contact& contact : contacts) deepest = std::max(deepest, double(contact.depth));
    return deepest;
}

} // namespace

std::vector<std::vector<Contact>> contacts_when_nudged(Scene& scene, std::span<const ShallowPair> pairs) {
    std::vector<std::vector<Contact>> shallowest(pairs.size());
    std::vector<std::size_t> left(pairs.size());
    std::iota(left.begin(), left.end(), std::size_t{0});
    for (const Vec3& way : askew) {
        std::vector<Pair> list;
        list.reserve(left.size());
        for (const std::size_t i : left) {
            const Part& b = *pairs[i].b;
            Pose pose = b.pose;
            pose.translation = pose.translation + nudge_of(pairs[i]) * way;
            list.emplace_back(pairs[i].body_a, scene.add(b.shape, pose)); // a later slot: normals still run from a to b
        }
        scene.find_contacts(list);
        std::vector<std::size_t> deep;
        for (std::size_t k = 0; k < left.size(); ++k) {
            const ShallowPair& pair = pairs[left[k]];
            const std::span<const Contact> contacts = scene.contacts(list[k].first, list[k].second);
            std::vector<Contact>& least = shallowest[left[k]];
            if (deepest_of(contacts) < far_more * std::max(nudge_of(pair), pair.depth)) {
                least.clear();
                continue;
            }
            if (least.empty() || deepest_of(contacts) < deepest_of(least))
                least.assign(contacts.begin(), contacts.end());
            deep.push_back(left[k]);
        }
        for (const auto& [a, nudged] : list) scene.remove(nudged);
        left = std::move(deep);
        if (left.empty()) break;
    }
    return shallowest;
}

} // namespace raycontact::clash
