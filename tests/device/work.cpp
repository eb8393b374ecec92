// SPDX-License-Identifier: Apache-2.0
#include "device/work.h"

#include "box_changes.h"
#include "device/cpu/device.h"
#include "device/listed_pairs.h"
#include "part/part.h"
#include "prepared_shape.h"
#include "reference/meshes.h"
#include "reference/random.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace raycontact::device_test {

namespace {

using namespace reference;

void place(Work& work, std::size_t shape, const Pose& pose) {
    PlacedBody& body = work.bodies.emplace_back();
    body.shape = work.shapes[shape].get();
    body.pose = pose;
}

// All bodies, as new ones: the scene's broad phase, on the part's device.
void find_pairs(Part& part, const std::vector<PlacedBody>& bodies) {
    BoxChanges changes;
    WorldBoxes world;
    Executor executor(1);
    const std::vector<BroadPhaseInput::Filter> filters(bodies.size());
    part.find_pairs(changes.list(executor, bodies, {}, filters, world, {}, part.known_slots()), false);
}

void place_centres(std::vector<PlacedBody>& bodies) {
    for (PlacedBody& body : bodies) body.centred = centred_pose(*body.shape, body.pose);
}

Outcome run_part(Part& part, const Work& work, const std::vector<Way>& ways) {
    for (const auto& shape : work.shapes) part.shapes().add(shape);
    Outcome outcome;
    SlotChanges moved;
    ListedPairs pairs;
    for (const Way& way : ways) {
        Settings settings;
        settings.method = way.method;
        settings.paper.caster = way.caster;
        settings.paper.skip_outside = way.skip_outside;
        if (way.method == Method::predictive) settings.paper.displacement_threshold = 0.05;
        std::vector<PlacedBody> bodies = work.bodies;
        for (PlacedBody& body : bodies) body.shape_index = part.shapes().index_of(body.shape);
        part.forget();
        for (const double by : {0.0, 1e-6, 0.004, 0.1}) {
            for (std::size_t i = 0; i < bodies.size(); i += 2) bodies[i].pose.translation.x += by;
            place_centres(bodies);
            moved.forget();
            if (way.method == Method::standard && part.can_find_in_double()) find_pairs(part, bodies);
            part.begin(bodies, moved, pairs.next(work.pairs), settings);
            std::vector<Contact> found;
            part.end(found);
            pairs.step_done();
            outcome.contacts.insert(outcome.contacts.end(), found.begin(), found.end());
            StepStats stats;
            part.count(stats);
            outcome.rays += stats.details.rays;
            outcome.side_tests += stats.details.side_tests;
        }
    }
    return outcome;
}

} // namespace

Work make_work(std::size_t random_pairs, bool fine) {
    Work work;
    for (const Mesh& mesh : {bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh(), tetrahedron_mesh(), bowl_mesh(8),
                             sheet_mesh(8), grid_box_mesh(4)})
        work.shapes.push_back(prepared_shape(mesh));
    const std::size_t grid_box = work.shapes.size() - 1;

    Random random(2013);
    for (std::size_t i = 0; i < 2 * random_pairs; ++i) {
        Pose pose = random.rotation();
        const Vec3 at = random.in_ball();
        pose.translation = {0.6 * at.x, 0.6 * at.y, 0.6 * at.z};
        place(work, random.below(static_cast<std::uint32_t>(work.shapes.size())), pose);
    }
    for (const double by : {0.25, 0.5, 0.75}) {
        Pose beside;
        beside.translation = {by, by / 2, 0};
        place(work, grid_box, Pose{});
        place(work, grid_box, beside);
        place(work, grid_box, beside);
        place(work, 1, Pose{});
    }
    // Of more vertex blocks than a bit each names, and than a segment of watches holds.
    if (fine) {
        work.shapes.push_back(prepared_shape(bumpy_octahedron_mesh(25)));
        for (const std::size_t partner : {grid_box + 1, grid_box + 1, grid_box + 1, std::size_t{0}}) {
            Pose beside = random.rotation();
            beside.translation = random.in_ball();
            place(work, grid_box + 1, Pose{});
            place(work, partner, beside);
        }
    }
    for (BodySlot i = 0; i < work.bodies.size(); i += 2) work.pairs.emplace_back(i, i + 1);
    return work;
}

Work make_heap(std::size_t bodies) {
    Work work;
    work.shapes = {prepared_shape(bumpy_octahedron_mesh(25)), prepared_shape(bumpy_octahedron_mesh(12))};
    Random random(7);
    for (std::size_t i = 0; i < bodies; ++i) {
        Pose pose = random.rotation();
        pose.translation = random.in_ball();
        place(work, i % 2, pose);
    }
    for (BodySlot a = 0; a < bodies; ++a)
        for (BodySlot b = a + 1; b < bodies; ++b) work.pairs.emplace_back(a, b);
    return work;
}

std::vector<Way> every_way() {
    return {{Method::standard, Caster::bvh, true},   {Method::standard, Caster::bvh, false},
            {Method::standard, Caster::basic, true}, {Method::iterative, Caster::bvh, true},
            {Method::predictive, Caster::bvh, true}, {Method::predictive, Caster::basic, true}};
}

std::vector<Way> cpu_ways() {
    return {{Method::certified, Caster::bvh, true}};
}

Outcome run_work(OpenDevice opened, const Work& work, const std::vector<Way>& ways) {
    auto trace = std::make_shared<Trace>();
    const bool shares = std::ranges::any_of(ways, [](const Way& way) { return way.method == Method::certified; });
    const bool may = opened.device->traits().shares_memory;
    opened.device = std::make_unique<TracingDevice>(std::move(opened.device), trace, shares && may);
    Part part(std::move(opened));
    Outcome outcome = run_part(part, work, ways);
    outcome.trace = std::move(*trace);
    return outcome;
}

Outcome run_on_cpu(const Work& work, const std::vector<Way>& ways, std::string_view instruction_set) {
    auto executor = std::make_unique<Executor>(1);
    auto device = cpu::open(*executor, instruction_set);
    return run_work({std::move(executor), std::move(device)}, work, ways);
}

std::vector<Contact> contacts_of(OpenDevice opened, const Work& work, const std::vector<Way>& ways) {
    Part part(std::move(opened));
    return run_part(part, work, ways).contacts;
}

std::string tested_device() {
    const char* named = std::getenv("RAYCONTACT_TEST_DEVICE");
    return named ? named : "opencl:0";
}

} // namespace raycontact::device_test
