// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/scan.h"
#include "pairs/update.h"

#include <array>

namespace raycontact {

/// The rays of a step on the device, and how they ended. With `standard` the host learns their number only at the end
/// of the step.
struct RayBatch {
    /// What the scans of a step count: vertex blocks found; rays; contacts, side tests and rays cast in full; what a
    /// method counts besides; edge blocks found; edges cast; faces near these; the same of vertices as points; pairs
    /// of which one body may have a part inside the other.
    enum Sum : std::size_t {
        block_sum,
        ray_sum,
        contact_sum,
        method_sum,
        edge_block_sum,
        edge_ray_sum,
        edge_sum,
        point_block_sum,
        point_ray_sum,
        point_sum,
        inside_sum,
        sum_count
    };

    /// Makes room for so many rays.
    void resize(Device& device, std::size_t size) {
        raycontact::resize(device, size, rays, hits);
        outcomes.resize(device, 3, size);
        if (totals.size() == 0) totals.write(device, sums);
    }

    static constexpr std::uint64_t bytes_of_ray =
        sizeof(kernels::Ray) + sizeof(kernels::Hit) + 4 * sizeof(kernels::uint);

    Count count{0};
    const Array<kernels::DirectedPair>* pairs = nullptr; ///< Ray::pair is a place in it
    /// Of these: their directed indices among the pairs that are asked about; empty: they are 2 x slot and so on.
    std::span<const std::uint32_t> directed;
    Array<kernels::Ray> rays;
    Array<kernels::Hit> hits;
    Columns outcomes; ///< a column for each sum of contact_sum (record_hit())
    Array<kernels::Totals> totals;
    std::array<kernels::Totals, sum_count> sums{}; ///< totals, as the host has read them
};

/// Casts every ray in full (paper section 2.1).
void cast_in_full(const Update& update, RayBatch& batch);

} // namespace raycontact
