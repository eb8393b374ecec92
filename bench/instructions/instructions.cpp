// SPDX-License-Identifier: Apache-2.0
// Runs steps of each method on fixed inputs, and what the host does beside, for callgrind to count instructions;
// scripts/instructions reads what is printed: the compiler, then a line `kernel,input,items` for each count. Everything
// is done once beforehand, so that no array has to grow while it counts.
#include "bench/instructions/batch.h"
#include "bench/instructions/callgrind_device.h"

#include "contacts/place.h"
#include "device/cpu/device.h"
#include "part/part.h"
#include "shape/accelerators.h"

#include <raycontact/error.h>

#include <cstdio>
#include <functional>
#include <stdexcept>
#include <valgrind/callgrind.h>

namespace rb = raycontact::bench;
namespace rc = raycontact;

namespace {

// What valgrind 3.19 knows; it has no AVX-512.
constexpr const char* instruction_set = "avx2";

/// A part that does every step of a batch.
class Run {
public:
    Run(const rb::Batch& batch, const std::string& input, const rc::Settings& settings)
        : batch_(batch), settings_(settings) {
        rc::OpenDevice opened{std::make_unique<rc::Executor>(1), nullptr};
        auto device = std::make_unique<rb::CallgrindDevice>(rc::cpu::open(*opened.executor, instruction_set), input);
        device_ = device.get();
        opened.device = std::move(device);
        part_ = std::make_unique<rc::Part>(std::move(opened));
        part_->shapes().add(batch.shape);
    }

    void count() {
        for (const auto& bodies : batch_.steps) step(bodies);
        part_->forget();
        for (auto bodies : batch_.steps) {
            // Others in the same slots: that the bodies went back to where they began is no motion.
            for (rc::PlacedBody& body : bodies) ++body.generation;
            device_->start();
            step(bodies);
            device_->stop();
            if (contacts_.empty()) throw std::logic_error("a step without contacts is nothing to count");
        }
        device_->print(batch_.pairs.size() * batch_.steps.size());
    }

private:
    void step(std::span<const rc::PlacedBody> bodies) {
        part_->begin(bodies, batch_.pairs, settings_);
        part_->end(contacts_);
    }

    const rb::Batch& batch_;
    rc::Settings settings_;
    rb::CallgrindDevice* device_ = nullptr; ///< the part's
    std::unique_ptr<rc::Part> part_;
    std::vector<rc::Contact> contacts_;
};

/// Counts what needs no device.
void count_host(const char* name, std::size_t items, const std::function<void()>& work) {
    work();
    CALLGRIND_START_INSTRUMENTATION;
    work();
    CALLGRIND_STOP_INSTRUMENTATION;
    CALLGRIND_DUMP_STATS_AT(name);
    std::printf("%s,%zu\n", name, items);
}

rc::Settings settings(rc::Method method, rc::Caster caster = rc::Caster::bvh) {
    rc::Settings settings;
    settings.features = rc::Features::vertices;
    settings.method = method;
    settings.paper.caster = caster;
    return settings;
}

void count_all() {
    const rb::Batch small = rb::make_batch(902, 64, 4), large = rb::make_batch(20000, 8, 4);
    for (const rb::Batch* batch : {&small, &large}) {
        const std::string size = batch == &small ? "" : "_large";
        Run(*batch, "standard" + size, settings(rc::Method::standard)).count();
        Run(*batch, "certified" + size, settings(rc::Method::certified)).count();
        Run(*batch, "predictive" + size, settings(rc::Method::predictive)).count();
    }
    // Every triangle for every ray; more of them would only be more of the same.
    const rb::Batch few = rb::make_batch(902, 8, 2);
    Run(few, "standard_basic", settings(rc::Method::standard, rc::Caster::basic)).count();
    Run(few, "predictive_basic", settings(rc::Method::predictive, rc::Caster::basic)).count();

    rc::OpenDevice opened = rc::open_device("cpu", 1);
    rc::Executor& executor = *opened.executor;
    rc::ShapeStore shapes(*opened.device);
    shapes.add(small.shape);
    const rc::Settings standard = settings(rc::Method::standard);
    const rc::Motion motion;
    const rc::Update update{*opened.device, executor, shapes, small.steps[0], small.pairs, motion, standard};
    rc::Pipeline pipeline;
    pipeline.begin(update);
    pipeline.end(update);
    const auto local = pipeline.contacts().all();
    rc::Placer placer;
    std::vector<rc::Contact> placed;
    count_host("place_contacts,standard", local.size(),
               [&] { placer.run(executor, rc::Direction::reprojected, small.steps[0], small.pairs, local, placed); });

    const std::vector<rc::WorldBox> boxes = rb::make_boxes(4096);
    std::vector<rc::WorldBox> sorted;
    std::vector<rc::SlotPair> pairs;
    count_host("sweep,boxes", boxes.size(), [&] {
        sorted = boxes;
        rc::sweep_and_prune(sorted, pairs);
    });
    count_host("make_shape,knot", small.mesh.triangles.size(), [&] { rc::Shape::make(small.mesh); });
    const auto made = rc::Shape::make(small.mesh);
    rc::Executor one_thread(1);
    count_host("prepare_shape,knot", small.mesh.triangles.size(),
               [&] { rc::build_accelerators(made->data(), one_thread, {}); });
}

std::string compiler() {
#ifdef __clang__
    return "clang-" + std::to_string(__clang_major__) + "." + std::to_string(__clang_minor__);
#else
    return "gcc-" + std::to_string(__GNUC__) + "." + std::to_string(__GNUC_MINOR__);
#endif
}

} // namespace

int main() try {
    std::printf("%s\n", compiler().c_str());
    count_all();
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "raycontact_instructions: %s\n", error.what());
    return dynamic_cast<const rc::InputError*>(&error) ? 2 : 1;
}
