// SPDX-License-Identifier: Apache-2.0
#include "device/pipeline.h"

#include "contacts/gather.h"
#include "device/cpu/device.h"
#include "pairs/motion.h"
#include "pairs/ordered_pairs.h"
#include "rays/cast_standard.h"
#include "rays/certified.h"
#include "rays/coherent.h"
#include "reference/meshes.h"
#include "reference/random.h"

#include <algorithm>
#include <cstring>

namespace raycontact::device_test {

namespace {

PlacedBody place(const Work& work, std::size_t shape, const Pose& pose) {
    PlacedBody body;
    body.shape = work.shapes[shape].get();
    body.shape_index = static_cast<kernels::uint>(shape);
    body.pose = pose;
    body.centred = pose;
    body.centred.translation = transform_point(pose, body.shape->centre());
    return body;
}

// The pairs of [first, last) that are there in both directions.
std::vector<SlotPair> whole_pairs(std::size_t first, std::size_t last) {
    std::vector<SlotPair> pairs;
    for (std::size_t i = (first + 1) / 2; i < (last + 1) / 2; ++i)
        pairs.emplace_back(static_cast<BodySlot>(2 * i), static_cast<BodySlot>(2 * i + 1));
    return pairs;
}

// Four steps: where the bodies are, hardly farther, a little farther, and so far that what was kept has run out.
template <class Step>
void four_steps(const Work& work, Step step) {
    Executor executor(1);
    std::vector<PlacedBody> bodies = work.bodies;
    Motion motion;
    for (const double by : {0.0, 1e-6, 0.004, 0.1}) {
        for (std::size_t i = 0; i < bodies.size(); i += 2) {
            bodies[i].pose.translation.x += by;
            bodies[i].centred.translation.x += by;
        }
        motion.update(executor, bodies);
        step(executor, bodies, motion, by == 0);
    }
}

template <class T>
std::vector<T> last_argument(const std::vector<Written>& trace, KernelId kernel, std::size_t argument) {
    const auto found = std::find_if(trace.rbegin(), trace.rend(), [&](const Written& written) {
        return written.kernel == kernel && written.argument == argument;
    });
    std::vector<T> all(found == trace.rend() ? 0 : found->bytes.size() / sizeof(T));
    if (!all.empty()) std::memcpy(all.data(), found->bytes.data(), all.size() * sizeof(T));
    return all;
}

// Contacts of the last hold_rays that were not cast, and have no tube: by its arguments `after`, `hits` and `casts`.
std::size_t known_by_caps(const std::vector<Written>& trace, std::size_t rays) {
    const auto held = last_argument<kernels::Held>(trace, KernelId::hold_rays, 10);
    const auto hits = last_argument<kernels::Hit>(trace, KernelId::hold_rays, 11);
    const auto casts = last_argument<kernels::uint>(trace, KernelId::hold_rays, 12);
    std::size_t known = 0;
    for (std::size_t i = 0; i < std::min({rays, held.size(), hits.size(), casts.size()}); ++i)
        known += casts[i] == 0 && held[i].safe <= 0 && hits[i].triangle != NONE;
    return known;
}

// A first look, rays repeated, a look at blocks that woke up, and new lists in the place of old ones.
void run_certified(TracingDevice& tracing, const ShapeStore& store, const Work& work, std::size_t first,
                   std::size_t last, Outcome& outcome) {
    const std::vector<SlotPair> pairs = whole_pairs(first, last);
    CertifiedRays certified;
    Gather gather;
    Array<kernels::Hit> hits;
    four_steps(work, [&](Executor& executor, const std::vector<PlacedBody>& bodies, const Motion& motion, bool begin) {
        certified.fill(tracing, executor, store, bodies, pairs, motion, 0.05);
        certified.cast(tracing, executor, Caster::bvh, store);
        outcome.known_by_caps += known_by_caps(tracing.trace(), certified.rays().size());
        gather.run(tracing, store.arrays(), certified.pairs(), certified.rays(), certified.hits());
        const auto found = gather.contacts(tracing);
        if (!begin) return;
        std::vector<kernels::LocalContact> contacts(found.begin(), found.end());
        for (kernels::LocalContact& contact : contacts)
            contact.pair = certified.ordered()[contact.pair] + static_cast<kernels::uint>(2 * ((first + 1) / 2));
        outcome.watched = contacts;
    });
}

// Rays in full, rays followed, and rays in full again; by either caster.
void run_coherent(TracingDevice& tracing, const ShapeStore& store, const Work& work, std::size_t first,
                  std::size_t last) {
    const std::vector<SlotPair> pairs = whole_pairs(first, last);
    for (const Caster caster : {Caster::bvh, Caster::basic}) {
        Settings settings;
        settings.method = Method::predictive;
        settings.caster = caster;
        settings.displacement_threshold = 0.05;
        CoherentRays coherent;
        Gather gather;
        four_steps(work, [&](Executor& executor, const std::vector<PlacedBody>& bodies, const Motion& motion, bool) {
            coherent.follow(tracing, executor, store, bodies, pairs, motion, settings);
            gather.run(tracing, store.arrays(), coherent.pairs(), coherent.rays(), coherent.hits());
        });
    }
}

} // namespace

Work make_work(std::size_t random_pairs, bool fine) {
    using namespace reference;
    Work work;
    for (const Mesh& mesh : {bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh(), tetrahedron_mesh(), bowl_mesh(8),
                             sheet_mesh(8), grid_box_mesh(4)})
        work.shapes.push_back(Shape::make(mesh));
    const std::size_t grid_box = work.shapes.size() - 1;

    std::vector<PlacedBody>& bodies = work.bodies;
    Random random(2013);
    for (std::size_t i = 0; i < 2 * random_pairs; ++i) {
        Pose pose = random.rotation();
        const Vec3 at = random.in_ball();
        pose.translation = {0.6 * at.x, 0.6 * at.y, 0.6 * at.z};
        bodies.push_back(place(work, random.below(static_cast<std::uint32_t>(work.shapes.size())), pose));
    }
    for (const double by : {0.25, 0.5, 0.75}) {
        Pose beside;
        beside.translation = {by, by / 2, 0};
        bodies.push_back(place(work, grid_box, Pose{}));
        bodies.push_back(place(work, grid_box, beside));
        bodies.push_back(place(work, grid_box, beside));
        bodies.push_back(place(work, 1, Pose{}));
    }
    // Of more vertex blocks than a bit each names, and than a segment of watches holds.
    if (fine) {
        work.shapes.push_back(Shape::make(bumpy_octahedron_mesh(25)));
        for (const std::size_t partner : {grid_box + 1, grid_box + 1, grid_box + 1, std::size_t{0}}) {
            Pose beside = random.rotation();
            beside.translation = random.in_ball();
            bodies.push_back(place(work, grid_box + 1, Pose{}));
            bodies.push_back(place(work, partner, beside));
        }
    }
    std::vector<SlotPair> pairs;
    for (BodySlot i = 0; i < bodies.size(); i += 2) pairs.emplace_back(i, i + 1);
    Executor executor(1);
    order_pairs(executor, bodies, pairs, work.pairs);
    return work;
}

Outcome run_pipeline(Device& device, const Work& work, std::size_t first, std::size_t last) {
    TracingDevice tracing(device);
    ShapeStore store(tracing);
    for (const auto& shape : work.shapes) store.add(shape);
    Array<kernels::OrderedPair> pairs;
    pairs.write(tracing, std::span(work.pairs).subspan(first, last - first));
    RayQueue queue;
    queue.fill(tracing, store.arrays(), pairs, true);
    Array<kernels::Hit> hits, basic_hits;
    cast_standard(tracing, Caster::bvh, store.arrays(), pairs, queue.rays(), hits);
    cast_standard(tracing, Caster::basic, store.arrays(), pairs, queue.rays(), basic_hits);

    Outcome outcome;
    Gather gather;
    outcome.side_tests = gather.run(tracing, store.arrays(), pairs, queue.rays(), hits);
    const auto found = gather.contacts(tracing);
    outcome.contacts.assign(found.begin(), found.end());
    for (kernels::LocalContact& contact : outcome.contacts) contact.pair += static_cast<kernels::uint>(first);
    outcome.rays = queue.rays().size();
    run_certified(tracing, store, work, first, last, outcome);
    run_coherent(tracing, store, work, first, last);
    outcome.trace = tracing.trace();
    return outcome;
}

Outcome run_pipeline(Device& device, const Work& work) {
    return run_pipeline(device, work, 0, work.pairs.size());
}

Outcome run_on_cpu(const Work& work, std::string_view instruction_set) {
    Executor executor(1);
    return run_pipeline(*cpu::open(executor, instruction_set), work);
}

bool same_bits(const std::vector<kernels::LocalContact>& a, const std::vector<kernels::LocalContact>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

} // namespace raycontact::device_test
