// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/same_contacts.h"
#include "device/trace.h"
#include "pairs/directed_pairs.h"

#include <raycontact/settings.h>
#include <raycontact/shape.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact::device_test {

/// Bodies, closed and open, and pairs of them.
struct Work {
    std::vector<std::shared_ptr<const Shape>> shapes;
    std::vector<PlacedBody> bodies; ///< 2 i and 2 i + 1 are those of pair i
    std::vector<SlotPair> pairs;
};

/// Random placements, and boxes on a common grid whose rays run along faces and through edges. fine: also pairs
/// of some fine meshes, which an interpreter takes many minutes for.
Work make_work(std::size_t random_pairs, bool fine);
/// Every body with every other, all in one place: more blocks, rays and contacts than a part has room for at first.
Work make_heap(std::size_t bodies);

/// One way of finding the contacts.
struct Way {
    Method method = Method::standard;
    Caster caster = Caster::bvh;
    bool skip_outside = true;
};
/// All that any device runs; and those that need the host's memory.
std::vector<Way> every_way();
std::vector<Way> cpu_ways();

/// What a part made of some work.
struct Outcome {
    Trace trace;
    std::vector<Contact> contacts; ///< of every way and step, in order
    std::uint64_t rays = 0, side_tests = 0;
};

/// Four steps in each way: where the bodies are, hardly farther, a little farther, and so far that what was kept has
/// run out.
Outcome run_work(OpenDevice opened, const Work& work, const std::vector<Way>& ways);
/// The same on the CPU device, one thread. instruction_set: of cpu::usable_tables(), empty for the widest.
Outcome run_on_cpu(const Work& work, const std::vector<Way>& ways, std::string_view instruction_set = "");

/// The same without a trace: the contacts alone.
std::vector<Contact> contacts_of(OpenDevice opened, const Work& work, const std::vector<Way>& ways);

/// The device that the tests of any device try: `opencl:0`, or what RAYCONTACT_TEST_DEVICE names (`cuda:0`).
std::string tested_device();

} // namespace raycontact::device_test
