// SPDX-License-Identifier: Apache-2.0
#include "contacts/gather.h"

#include "device/launch.h"
#include "give_back.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr std::size_t least_room = 1024; // contacts

} // namespace

void Gather::run(const Update& update, const RayBatch& batch) {
    const ShapeStore::Arrays& arrays = update.arrays();
    contacts_.grow(update.device, least_room);
    batch.outcomes.scan(update.device, batch.count, batch.totals, RayBatch::contact_sum, contacts_.size());
    launch<KernelId::write_contacts>(update.device, items_of(batch.totals, RayBatch::contact_sum, batch.count.most),
                                     *batch.pairs, arrays.headers, arrays.vertex_blocks, arrays.face_normals,
                                     batch.rays, batch.hits, batch.outcomes.firsts(), contacts_);
}

bool Gather::read(Device& device, RayBatch& batch) {
    const std::size_t expected = std::min(expected_, contacts_.size());
    if (found_.size() < expected) found_.resize(expected);
    const Piece pieces[] = {batch.totals.piece(batch.sums), contacts_.piece(std::span(found_).first(expected))};
    device.queue().read(pieces);
    check_sums(batch.sums);
    const std::size_t count = batch.sums[RayBatch::contact_sum].sums[0], known = std::min(count, expected);
    if (count > contacts_.size()) {
        contacts_.grow(device, count);
        return false;
    }
    if (known < count) {
        if (found_.size() < count) found_.resize(count);
        const Piece rest = contacts_.piece(std::span(found_).first(count).subspan(known), known);
        device.queue().read({&rest, 1});
    }
    count_ = count;
    expected_ = count + count / 4;
    return true;
}

void Gather::give_back() {
    contacts_.give_back(expected_);
    if (found_.size() > 4 * expected_) found_.resize(expected_);
    count_ = std::min(count_, found_.size());
    raycontact::give_back(found_);
}

} // namespace raycontact
