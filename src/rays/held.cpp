// SPDX-License-Identifier: Apache-2.0
#include "rays/held.h"

#include "device/launch.h"

#include <utility>

namespace raycontact {

void HeldRays::cast(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                    const Array<kernels::Ray>& rays, const Array<kernels::Holder>& holders, Array<kernels::Hit>& hits) {
    std::swap(held_, before_);
    if (before_.size() == 0) before_.resize(device, 1); // an argument is never nothing
    held_.resize(device, rays.size());
    hits.resize(device, rays.size());
    casts_.resize(device, rays.size());
    launch<KernelId::hold_rays>(device, rays.size(), pairs, holders, shapes.headers, shapes.vertex_blocks, shapes.nodes,
                                shapes.triangle_blocks, shapes.faces, shapes.face_normals, rays, before_, held_, hits,
                                casts_);
    cast_in_full_ = scan_.total(device, casts_);
}

} // namespace raycontact
