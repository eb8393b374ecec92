// SPDX-License-Identifier: Apache-2.0
#include "query/checks.h"
#include "query/overlap_patches.h"

#include <raycontact/query.h>

#include <algorithm>
#include <functional>
#include <string>

namespace raycontact {

namespace {

void check_inside(const Shape& shape, const char* what) {
    check_is_mesh(shape, what);
    if (!shape.has_inside())
        throw InputError(std::string(what) + " has no inside (raycontact mesh says why): close it first");
}

PlacedBody body_of(const Shape& shape, const Pose& pose) {
    PlacedBody body;
    body.shape = &shape;
    body.pose = pose;
    body.centred = centred_pose(shape, pose);
    return body;
}

} // namespace

std::vector<ContactPatch> contact_patches(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    check_placed(pose_a, "pose of the first mesh");
    check_placed(pose_b, "pose of the second mesh");
    check_inside(a, "the first mesh");
    check_inside(b, "the second mesh");
    OverlapPatches overlap;
    const PlacedBody body_b = body_of(b, pose_b);
    if (!overlap.find(body_of(a, pose_a), body_b, true, true)) return {};
    std::vector<ContactPatch> patches(overlap.patches().size());
    for (const FaceOverlap& face : overlap.faces()) {
        ContactPatch& patch = patches[face.patch];
        patch.area += face.area;
        patch.volume += face.volume;
        patch.centre = patch.centre + face.volume * face.middle;
    }
    for (std::size_t i = 0; i < patches.size(); ++i) {
        ContactPatch& patch = patches[i];
        const OverlapPatch& own = overlap.patches()[i];
        const Vec3 centre = (1 / patch.volume) * patch.centre;
        patch.depth = patch.volume / patch.area;
        patch.centre = transform_point(body_b.centred, centre);
        patch.normal = unit(rotated(body_b.centred.rotation, own.normal));
        for (const Vec3& corner : own.hull)
            patch.hull.push_back(transform_point(body_b.centred, corner + dot(centre, own.normal) * own.normal));
    }
    std::ranges::stable_sort(patches, std::greater(), &ContactPatch::volume);
    return patches;
}

std::vector<Wrench> wrench_basis(const ContactPatch& patch, const Vec3& about) {
    std::vector<Wrench> basis;
    for (const Vec3& corner : patch.hull) basis.push_back({patch.normal, cross(corner - about, patch.normal)});
    return basis;
}

} // namespace raycontact
