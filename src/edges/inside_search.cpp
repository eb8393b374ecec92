// SPDX-License-Identifier: Apache-2.0
#include "edges/inside_search.h"

#include "device/launch.h"

namespace raycontact {

void InsideSearch::find(const Update& update, const Array<kernels::DirectedPair>& pairs,
                        const Array<kernels::Totals>& totals, std::size_t at) {
    Device& device = update.device;
    const ShapeStore::Arrays& arrays = update.arrays();
    counts_.resize(device, 1, pairs.size());
    launch<KernelId::count_inside>(device, pairs.size(), pairs, arrays.headers, arrays.memory, counts_.values());
    const Array<kernels::uint>& found = found_.room(device);
    counts_.scan(device, pairs.size(), totals, at, found.size());
    launch<KernelId::write_inside>(device, items_of(totals, at, pairs.size()), counts_.values(), counts_.firsts(),
                                   found);
}

std::uint64_t InsideSearch::bytes() const {
    return counts_.values().size() * 2 * sizeof(kernels::uint) + found().size_bytes() + marks_.size();
}

} // namespace raycontact
