// SPDX-License-Identifier: Apache-2.0
#include "contacts/gather.h"

namespace raycontact {

std::uint64_t Gather::run(Device& device, const ShapeStore::Arrays& shapes, const Array<kernels::OrderedPair>& pairs,
                          const Array<kernels::Ray>& rays, const Array<kernels::Hit>& hits) {
    counts_.resize(device, hits.size());
    sides_.resize(device, hits.size());
    launch<KernelId::count_contacts>(device, hits.size(), hits, counts_, sides_);
    const kernels::uint side_tests = scan_.total(device, sides_);
    contacts_.resize(device, scan_.run(device, counts_, firsts_));
    launch<KernelId::write_contacts>(device, contacts_.size() > 0 ? hits.size() : 0, pairs, shapes.headers,
                                     shapes.vertex_blocks, shapes.face_normals, rays, hits, firsts_, contacts_.array());
    return side_tests;
}

} // namespace raycontact
