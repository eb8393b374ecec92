// SPDX-License-Identifier: Apache-2.0
#include "rays/cast_standard.h"

namespace raycontact {

void cast_standard(Device& device, Caster caster, const ShapeStore::Arrays& shapes,
                   const Array<kernels::OrderedPair>& pairs, const Array<kernels::Ray>& rays, Array<kernels::Hit>& hits,
                   bool short_first) {
    hits.resize(device, rays.size());
    if (caster == Caster::basic)
        launch<KernelId::cast_rays_basic>(device, rays.size(), pairs, shapes.headers, shapes.vertex_blocks,
                                          shapes.nodes, shapes.triangle_blocks, shapes.face_normals, rays, hits);
    else
        launch<KernelId::cast_rays_bvh>(device, rays.size(), short_first ? 1u : 0u, pairs, shapes.headers,
                                        shapes.vertex_blocks, shapes.nodes, shapes.triangle_blocks, shapes.face_normals,
                                        rays, hits);
}

} // namespace raycontact
