// SPDX-License-Identifier: Apache-2.0
#include <box_cache.h>

#include <algorithm>
#include <bit>

namespace raycontact::bullet {

namespace {

bool same(const btVector3& a, const btVector3& b) { // whatever lies in the fourth number
    return a.x() == b.x() && a.y() == b.y() && a.z() == b.z();
}

bool same(const btTransform& a, const btTransform& b) {
    return same(a.getOrigin(), b.getOrigin()) && same(a.getBasis()[0], b.getBasis()[0])
           && same(a.getBasis()[1], b.getBasis()[1]) && same(a.getBasis()[2], b.getBasis()[2]);
}

} // namespace

BoxCache::Entry* BoxCache::set_of(const btTransform& transform) {
    const std::size_t sets = entries_.size() / ways;
    // Bodies lie at even distances, which one multiplication leaves even.
    std::uint64_t hash = reinterpret_cast<std::uintptr_t>(&transform);
    hash = (hash ^ (hash >> 33)) * 0xff51afd7ed558ccdull;
    hash = (hash ^ (hash >> 33)) * 0xc4ceb9fe1a85ec53ull;
    return &entries_[ways * static_cast<std::size_t>(hash >> (64 - std::countr_zero(sets)))];
}

bool BoxCache::find(const btTransform& transform, btVector3& low, btVector3& high) {
    if (entries_.empty()) return false;
    Entry* const set = set_of(transform);
    Entry* const found = std::find_if(set, set + ways, [&](const Entry& e) { return e.owner == &transform; });
    if (found == set + ways || !same(found->transform, transform)) return false;
    low = found->low;
    high = found->high;
    return true;
}

void BoxCache::put(const btTransform& transform, const btVector3& low, const btVector3& high) {
    if (entries_.empty()) entries_.resize(ways * first_sets);
    Entry* set = set_of(transform);
    Entry* place = std::find_if(set, set + ways, [&](const Entry& e) { return e.owner == &transform; });
    if (place == set + ways && set[ways - 1].owner != nullptr && ++evicted_ > entries_.size() / 16
        && entries_.size() < ways * most_sets) {
        // Emptied as well: who is still there asks again in the next step.
        const std::size_t larger = 2 * entries_.size();
        entries_.clear();
        entries_.resize(larger);
        evicted_ = 0;
        set = set_of(transform);
        place = set + ways;
    }
    if (place == set + ways) { // in place of the oldest
        std::move_backward(set, set + ways - 1, set + ways);
        place = set;
    }
    *place = {&transform, transform, low, high};
}

} // namespace raycontact::bullet
