// SPDX-License-Identifier: Apache-2.0
#include <clash/nudged.h>

#include "mesh/vector.h"

#include <raycontact/collide.h>

#include <algorithm>
#include <array>

namespace raycontact::clash {

namespace {

// The corners of a crooked tetrahedron: along no face that meshes have.
constexpr std::array<Vec3, 4> ways{
    {{0.5257, 0.6113, 0.5915}, {-0.7482, 0.1301, 0.6506}, {0.3137, -0.8819, 0.352}, {-0.091, 0.1405, -0.9859}}};
constexpr double far_more = 20; // times what the nudge and rounding can make

} // namespace

double smaller_size(const Part& a, const Part& b) {
    return std::min(length(a.shape->box_max() - a.shape->box_min()), length(b.shape->box_max() - b.shape->box_min()));
}

double deepest_of(const std::vector<Contact>& contacts) {
    double deepest = 0;
    for (const Contact& contact : contacts) deepest = std::max(deepest, double(contact.depth));
    return deepest;
}

std::vector<Contact> contacts_when_nudged(const Part& a, const Part& b, double depth) {
    const double by = 2 * noise * smaller_size(a, b), least = far_more * std::max(by, depth);
    std::vector<Contact> shallowest;
    for (const Vec3& way : ways) {
        Pose pose = b.pose;
        pose.translation = pose.translation + by * way;
        std::vector<Contact> contacts = collide(*a.shape, a.pose, *b.shape, pose);
        if (deepest_of(contacts) < least) return {};
        if (shallowest.empty() || deepest_of(contacts) < deepest_of(shallowest)) shallowest = std::move(contacts);
    }
    return shallowest;
}

} // namespace raycontact::clash
