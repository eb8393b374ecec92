// SPDX-License-Identifier: Apache-2.0
#include "rays/ray_batch.h"

#include "device/launch.h"

namespace raycontact {

void cast_in_full(const Update& update, RayBatch& batch, bool short_first) {
    const ShapeStore::Arrays& arrays = update.arrays();
    const kernels::uint stride = batch.outcomes.stride();
    if (update.settings.caster == Caster::basic)
        launch<KernelId::cast_rays_basic>(update.device, batch.count, stride, *batch.pairs, arrays.headers,
                                          arrays.vertex_blocks, arrays.nodes, arrays.triangle_blocks,
                                          arrays.face_normals, batch.rays, batch.hits, batch.outcomes.values());
    else
        launch<KernelId::cast_rays_bvh>(update.device, batch.count, short_first ? 1u : 0u, stride, *batch.pairs,
                                        arrays.headers, arrays.vertex_blocks, arrays.nodes, arrays.triangle_blocks,
                                        arrays.face_normals, batch.rays, batch.hits, batch.outcomes.values());
}

} // namespace raycontact
