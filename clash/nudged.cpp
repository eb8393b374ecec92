// SPDX-License-Identifier: Apache-2.0
#include <clash/nudged.h>

#include <clash/askew.h>

#include "mesh/vector.h"

#include <raycontact/collide.h>

#include <algorithm>

namespace raycontact::clash {

namespace {

constexpr double far_more = 20; // times what the nudge and rounding can make

double deepest_of(const std::vector<Contact>& contacts) {
    double deepest = 0;
    for (const Contact& contact : contacts) deepest = std::max(deepest, double(contact.depth));
    return deepest;
}

} // namespace

std::vector<Contact> contacts_when_nudged(const Part& a, const Part& b, double depth) {
    const double by = 2 * noise * smaller_size(a, b), least = far_more * std::max(by, depth);
    std::vector<Contact> shallowest;
    for (const Vec3& way : askew) {
        Pose pose = b.pose;
        pose.translation = pose.translation + by * way;
        std::vector<Contact> contacts = collide(*a.shape, a.pose, *b.shape, pose);
        if (deepest_of(contacts) < least) return {};
        if (shallowest.empty() || deepest_of(contacts) < deepest_of(shallowest)) shallowest = std::move(contacts);
    }
    return shallowest;
}

} // namespace raycontact::clash
