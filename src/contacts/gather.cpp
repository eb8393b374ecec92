// SPDX-License-Identifier: Apache-2.0
#include "contacts/gather.h"

#include "device/launch.h"

namespace raycontact {

void Gather::run(const Update& update, const RayBatch& batch) {
    const ShapeStore::Arrays& arrays = update.arrays();
    const Array<kernels::LocalContact>& contacts = contacts_.room(update.device);
    batch.outcomes.scan(update.device, batch.count, batch.totals, RayBatch::contact_sum, contacts.size());
    launch<KernelId::write_contacts>(update.device, items_of(batch.totals, RayBatch::contact_sum, batch.count.most),
                                     *batch.pairs, arrays.headers, arrays.vertex_blocks, arrays.face_normals,
                                     batch.rays, batch.hits, batch.outcomes.firsts(), contacts);
}

bool Gather::read(Device& device, RayBatch& batch, Results<kernels::NearEdge>* near) {
    const Piece pieces[] = {batch.totals.piece(batch.sums), contacts_.piece(),
                            near != nullptr ? near->piece() : Piece{}};
    device.queue().read(pieces);
    check_sums(batch.sums);
    return contacts_.take(device, batch.sums[RayBatch::contact_sum].sums[0]);
}

} // namespace raycontact
