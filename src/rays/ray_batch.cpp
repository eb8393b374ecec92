// SPDX-License-Identifier: Apache-2.0
#include "rays/ray_batch.h"

#include "device/launch.h"

namespace raycontact {

void cast_in_full(const Update& update, RayBatch& batch) {
    const ShapeStore::Arrays& arrays = update.arrays();
    const auto run = [&]<KernelId kernel>() {
        launch<kernel>(update.device, batch.count, batch.outcomes.stride(), *batch.pairs, arrays.headers,
                       arrays.vertex_blocks, arrays.nodes, arrays.triangle_blocks, arrays.face_normals, batch.rays,
                       batch.hits, batch.outcomes.values());
    };
    if (update.settings.caster == Caster::basic)
        run.operator()<KernelId::cast_rays_basic>();
    else
        run.operator()<KernelId::cast_rays_bvh>();
}

} // namespace raycontact
