// SPDX-License-Identifier: Apache-2.0
// Runs groups of kernels once each on a fixed input, for callgrind to count instructions; scripts/instructions reads
// what is printed: the compiler, then a line `group,item,items` for each group. Everything is done once beforehand, so
// that no array has to grow while it counts.
#include "bench/micro/coherence.h"
#include "bench/micro/pipeline.h"

#include "contacts/place.h"
#include "shape/shape_data.h"

#include <raycontact/error.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <valgrind/callgrind.h>

namespace rb = raycontact::bench;
namespace rc = raycontact;
namespace rk = raycontact::kernels;

namespace {

struct Group {
    std::string name, item;
    std::size_t items = 0;
    std::function<void()> body;
};

// What valgrind 3.19 knows; it has no AVX-512.
constexpr const char* instruction_set = "avx2";

class Input {
public:
    Input()
        : small_batch_(rb::make_batch(902, 64)), large_batch_(rb::make_batch(20000, 8)),
          small_(executor_, instruction_set, small_batch_), large_(executor_, instruction_set, large_batch_),
          kept_(executor_, instruction_set, small_batch_) {}

    std::vector<Group> groups() {
        return {
            {"clusters", "ordered pair", small_.ordered_pairs(), [this] { small_.find_clusters(); }},
            {"clusters_large", "ordered pair", large_.ordered_pairs(), [this] { large_.find_clusters(); }},
            {"rays_grid", "vertex block", small_.vertex_blocks(), [this] { small_.find_rays(); }},
            {"cast_bvh", "ray", small_.rays(), [this] { small_.cast_bvh(); }},
            {"cast_bvh_large", "ray", large_.rays(), [this] { large_.cast_bvh(); }},
            {"cast_basic", "ray", small_.basic_rays(), [this] { small_.cast_basic(); }},
            {"near_clusters", "ordered pair", kept_.pairs(), [this] { kept_.count_near_clusters(); }},
            {"near_rays", "vertex block", kept_.vertex_blocks(), [this] { kept_.find_near_rays(); }},
            {"follow_bvh", "ray", kept_.near_rays(), [this] { kept_.cast_near_rays(rc::Caster::bvh); }},
            {"follow_basic", "ray", kept_.basic_rays(), [this] { kept_.cast_near_rays(rc::Caster::basic); }},
            {"walk", "ray", kept_.walks(), [this] { kept_.walk(); }},
            {"begin_watches", "vertex block", kept_.vertex_blocks(), [this] { kept_.begin_watches(); }},
            {"look", "vertex block", kept_.vertex_blocks(), [this] { kept_.find_watch_rays(); }},
            {"seek_tubes", "ray", kept_.watch_rays(), [this] { kept_.seek_tubes(); }},
            {"held", "ray", kept_.watch_rays(), [this] { kept_.decide_held(); }},
            {"contacts", "contact", small_.contacts(), [this] { contacts(); }},
            {"order_pairs", "pair", small_batch_.pairs.size(), [this] { order_pairs(); }},
            {"sweep", "box", boxes_.size(), [this] { sweep(); }},
            {"shape", "triangle", small_batch_.mesh.triangles.size(), [this] { shape(); }},
        };
    }

private:
    void contacts() {
        small_.find_contacts();
        local_ = small_.host_contacts();
        placer_.run(executor_, rc::Direction::reprojected, small_batch_.bodies, small_batch_.pairs, local_, placed_);
    }
    void order_pairs() { rc::order_pairs(executor_, small_batch_.bodies, small_batch_.pairs, ordered_); }
    void sweep() {
        sorted_ = boxes_;
        rc::SweepAndPrune().find_pairs(sorted_, pairs_);
    }
    void shape() { shape_ = rc::Shape::make(small_batch_.mesh); }

    rc::Executor executor_{1};
    rb::Batch small_batch_, large_batch_;
    rb::Pipeline small_, large_;
    rb::Coherence kept_;
    std::vector<rk::LocalContact> local_;
    rc::Placer placer_;
    std::vector<rc::Contact> placed_;
    std::vector<rk::OrderedPair> ordered_;
    std::vector<rc::WorldBox> boxes_ = rb::make_boxes(4096), sorted_;
    std::vector<rc::SlotPair> pairs_;
    std::shared_ptr<const rc::Shape> shape_;
};

std::string compiler() {
#ifdef __clang__
    return "clang-" + std::to_string(__clang_major__) + "." + std::to_string(__clang_minor__);
#else
    return "gcc-" + std::to_string(__GNUC__) + "." + std::to_string(__GNUC_MINOR__);
#endif
}

void count(const Group& group) {
    group.body();
    CALLGRIND_START_INSTRUMENTATION;
    group.body();
    CALLGRIND_STOP_INSTRUMENTATION;
    // Names the dump after the group and sets the counters back to zero.
    CALLGRIND_DUMP_STATS_AT(group.name.c_str());
    std::printf("%s,%s,%zu\n", group.name.c_str(), group.item.c_str(), group.items);
}

} // namespace

int main(int argc, char** argv) try {
    Input input;
    const std::vector<Group> groups = input.groups();
    const auto named = [&](const char* name) {
        return std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.name == name; });
    };
    for (int i = 1; i < argc; ++i)
        if (named(argv[i]) == groups.end()) {
            std::string known;
            for (const Group& group : groups) known += " " + group.name;
            std::fprintf(stderr, "raycontact_instructions: no group '%s'; known:%s\n", argv[i], known.c_str());
            return 2;
        }
    std::printf("%s\n", compiler().c_str());
    for (int i = 1; i < argc; ++i) count(*named(argv[i]));
    if (argc == 1)
        for (const Group& group : groups) count(group);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "raycontact_instructions: %s\n", error.what());
    return dynamic_cast<const rc::InputError*>(&error) ? 2 : 1;
}
