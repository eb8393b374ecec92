// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/trace.h"
#include "pairs/ordered_pairs.h"

#include <raycontact/shape.h>

#include <memory>
#include <string_view>
#include <vector>

namespace raycontact::device_test {

/// Pairs of meshes, closed and open, each pair in both directions: what a step hands to a device.
struct Work {
    std::vector<std::shared_ptr<const Shape>> shapes;
    std::vector<kernels::OrderedPair> pairs;
    std::vector<PlacedBody> bodies; ///< 2 i and 2 i + 1 are those of pairs 2 i and 2 i + 1
};

/// Random placements, and boxes on a common grid whose rays run along faces and through edges. fine: also pairs
/// of some fine meshes, which an interpreter takes many minutes for.
Work make_work(std::size_t random_pairs, bool fine);

/// What the narrow phase's kernels made of some work.
struct Outcome {
    std::vector<Written> trace;
    std::vector<kernels::LocalContact> contacts; ///< pair: counted over the whole work
    std::vector<kernels::LocalContact> watched;  ///< the same by the certified method, of whole pairs
    std::size_t rays = 0;
    std::size_t known_by_caps = 0; ///< rays of the certified method
    std::uint64_t side_tests = 0;
};

/// Every kernel of a step, both casters, on pairs [first, last) of the work; then some steps of the certified
/// and of the predictive method.
Outcome run_pipeline(Device& device, const Work& work, std::size_t first, std::size_t last);
Outcome run_pipeline(Device& device, const Work& work);
/// The same on the CPU device, one thread. instruction_set: of cpu::usable_tables(), empty for the widest.
Outcome run_on_cpu(const Work& work, std::string_view instruction_set = "");

bool same_bits(const std::vector<kernels::LocalContact>& a, const std::vector<kernels::LocalContact>& b);

} // namespace raycontact::device_test
