// SPDX-License-Identifier: Apache-2.0
// Every kernel by itself on a fixed input, one thread, for each instruction set this processor has; then building
// shapes and the broad phase. Options are Google Benchmark's: --benchmark_filter=cast --benchmark_repetitions=5 ...
#include "bench/micro/coherence.h"
#include "bench/micro/limits.h"
#include "bench/micro/pipeline.h"
#include "bench/micro/visits.h"

#include "contacts/place.h"
#include "device/cpu/kernel_table.h"
#include "shape/shape_data.h"

#include <benchmark/benchmark.h>
#include <cstdio>
#include <cstring>
#include <functional>

namespace rb = raycontact::bench;
namespace rc = raycontact;
namespace rk = raycontact::kernels;

namespace {

/// What one call of a benchmark's body works through.
struct Work {
    std::string item; ///< singular; the label of the line
    double items = 0;
    double bytes = 0; ///< an item, read and written; what several items share is counted for each
};

void add(const std::string& name, const Work& work, const std::function<void()>& body) {
    benchmark::RegisterBenchmark(name.c_str(), [work, body](benchmark::State& state) {
        for (auto _ : state) body();
        using benchmark::Counter;
        state.SetLabel(work.item);
        state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(work.items));
        state.counters["per_item"] = Counter(work.items, Counter::kIsIterationInvariantRate | Counter::kInvert);
        state.counters["bytes_per_item"] = Counter(work.bytes);
    });
}

void add_kernels(rb::Pipeline& on, const rb::Batch& batch, const rb::Visits& visits, std::string_view instruction_set) {
    const auto name = [&](const char* kernel) {
        return std::string(kernel) + "/" + batch.name + "/" + std::string(instruction_set);
    };
    const double pairs = static_cast<double>(on.ordered_pairs()), blocks = static_cast<double>(on.vertex_blocks()),
                 rays = static_cast<double>(on.rays()), contacts = static_cast<double>(on.contacts()),
                 elements = static_cast<double>(on.elements()), scan_blocks = static_cast<double>(on.scan_blocks()),
                 basic_rays = static_cast<double>(on.basic_rays());
    const double pair = sizeof(rk::OrderedPair), header = sizeof(rk::ShapeHeader);
    const bool small = batch.shape->data().header.vertex_block_count <= SMALL_BLOCKS;
    const double cluster_blocks = visits.cluster_blocks * sizeof(rk::ClusterBlock);
    const double vertex = 7 * sizeof(float);
    const double ray = sizeof(rk::Ray) + pair + header + vertex + sizeof(rk::Hit);
    const double triangles = static_cast<double>(batch.shape->triangles().size());
    const double all_blocks = batch.shape->data().header.triangle_block_count * double(sizeof(rk::TriangleBlock));

    add(name("count_clusters"), {"pair and direction", pairs, pair + header + cluster_blocks + 4 + 8},
        [&] { on.count_clusters(); });
    // A large source is walked again to write what was counted.
    add(name("write_clusters"),
        {"vertex block", blocks,
         sizeof(rk::Cluster) + pairs / blocks * (pair + header + 4 + (small ? 8 : cluster_blocks))},
        [&] { on.write_clusters(); });
    const double block_test = 2 * sizeof(rk::Cluster) + pair + 3 * sizeof(float) * VERTEX_LANES + 2 * 4;
    add(name("count_rays"), {"vertex block", blocks, block_test}, [&] { on.count_rays(false); });
    add(name("count_rays_grid"), {"vertex block", blocks, block_test + header + 4 * VERTEX_LANES},
        [&] { on.count_rays(true); });
    add(name("write_rays"), {"ray", rays, sizeof(rk::Ray) + blocks / rays * (sizeof(rk::Cluster) + 4)},
        [&] { on.write_rays(); });
    add(name("cast_rays_bvh"),
        {"ray", rays, ray + visits.nodes * sizeof(rk::Node) + visits.triangle_blocks * sizeof(rk::TriangleBlock)},
        [&] { on.cast_bvh(); });
    add(name("cast_rays_basic"), {"triangle test", basic_rays * triangles, (ray + all_blocks) / triangles},
        [&] { on.cast_basic(); });
    add(name("count_contacts"), {"ray", rays, sizeof(rk::Hit) + 2 * 4}, [&] { on.count_contacts(); });
    add(name("write_contacts"),
        {"contact", contacts,
         rays / contacts * sizeof(rk::Hit) + sizeof(rk::Ray) + 4 * sizeof(rk::uint) + sizeof(rk::Packed3)
             + sizeof(rk::LocalContact)},
        [&] { on.write_contacts(); });
    add(name("scan_sums"), {"element", elements, 4}, [&] { on.scan_sums(); });
    add(name("scan_offsets"), {"block of elements", scan_blocks, 8}, [&] { on.scan_offsets(); });
    add(name("scan_write"), {"element", elements, 8}, [&] { on.scan_write(); });
}

// Of the methods that keep something. Bytes of casts are those of cast_rays_*, which ask for the same.
void add_coherence(rb::Coherence& on, const rb::Batch& batch, std::string_view instruction_set) {
    const auto name = [&](const char* kernel) {
        return std::string(kernel) + "/" + batch.name + "/" + std::string(instruction_set);
    };
    const double blocks = static_cast<double>(on.vertex_blocks()), near = static_cast<double>(on.near_rays()),
                 basic = static_cast<double>(on.basic_rays()), walks = static_cast<double>(on.walks()),
                 watch_rays = static_cast<double>(on.watch_rays());
    const double pair = sizeof(rk::OrderedPair), header = sizeof(rk::ShapeHeader);
    const double triangles = static_cast<double>(batch.shape->triangles().size());
    // Positions and exits of a block, and a word of the clearance grid for each vertex.
    const double block_look = pair + header + 5 * sizeof(float) * VERTEX_LANES;
    const double ray = sizeof(rk::Ray) + 4 + pair + header + 7 * sizeof(float) + sizeof(rk::Hit) + 2 * 4;
    const double pairs = static_cast<double>(on.pairs());
    const double cluster_blocks = sizeof(rk::ClusterBlock) * blocks / pairs / VERTEX_LANES;
    add(name("count_near_clusters"), {"pair and direction", pairs, pair + 2 * header + cluster_blocks + 4 + 8 + 4},
        [&] { on.count_near_clusters(); });
    add(name("write_near_clusters"), {"vertex block", blocks, sizeof(rk::Cluster) + pairs / blocks * (header + 12)},
        [&] { on.write_near_clusters(); });
    add(name("count_near_rays"), {"vertex block", blocks, block_look + 2 * sizeof(rk::Cluster) + 2 * 4},
        [&] { on.count_near_rays(); });
    add(name("write_near_rays"), {"ray", near, sizeof(rk::Ray) + 4 + blocks / near * (sizeof(rk::Cluster) + 4)},
        [&] { on.write_near_rays(); });
    add(name("follow_rays_bvh/full"), {"ray", near, ray}, [&] { on.cast_near_rays(rc::Caster::bvh); });
    add(name("follow_rays_basic/full"), {"triangle test", basic * triangles, ray / triangles},
        [&] { on.cast_near_rays(rc::Caster::basic); });
    // Of each triangle of a walk its neighbours and its nine coordinates; one or two of them.
    add(name("follow_rays_bvh/walk"), {"ray", walks, ray + 1.5 * (sizeof(rk::Face) + 9 * sizeof(float))},
        [&] { on.walk(); });
    add(name("begin_watches"),
        {"vertex block", blocks, pair + 2 * header + 7 * 4 + sizeof(rk::Cluster) + sizeof(rk::Watch)},
        [&] { on.begin_watches(); });
    add(name("look_at_watches"), {"vertex block", blocks, block_look + 2 * sizeof(rk::Watch)},
        [&] { on.look_at_watches(); });
    add(name("write_watch_rays"), {"ray", watch_rays, sizeof(rk::Ray) + sizeof(rk::Watch)},
        [&] { on.write_watch_rays(); });
    const double held = ray + sizeof(rk::Holder) + sizeof(rk::Held);
    add(name("hold_rays/seek"), {"ray", watch_rays, held}, [&] { on.seek_tubes(); });
    add(name("hold_rays/held"), {"ray", watch_rays, held + sizeof(rk::Held) + 9 * sizeof(float)},
        [&] { on.decide_held(); });
}

void add_host(rc::Executor& executor, const rb::Batch& batch, const std::vector<rk::LocalContact>& contacts) {
    add("order_pairs/" + batch.name,
        {"pair", static_cast<double>(batch.pairs.size()), 2 * sizeof(rc::PlacedBody) + 2 * sizeof(rk::OrderedPair)},
        [&executor, &batch, ordered = batch.ordered]() mutable {
            rc::order_pairs(executor, batch.bodies, batch.pairs, ordered);
        });
    add("place_contacts/" + batch.name,
        {"contact", static_cast<double>(contacts.size()), sizeof(rk::LocalContact) + sizeof(rc::Contact)},
        [&executor, &batch, contacts, placer = rc::Placer(), placed = std::vector<rc::Contact>()]() mutable {
            placer.run(executor, rc::Direction::reprojected, batch.bodies, batch.pairs, contacts, placed);
        });
    const double triangles = static_cast<double>(batch.mesh.triangles.size());
    const double vertices = static_cast<double>(batch.mesh.vertices.size());
    const double mesh_bytes = 12 + sizeof(rc::Vec3) * vertices / triangles;
    add("prepare_mesh/" + batch.name, {"triangle", triangles, 2 * mesh_bytes},
        [&batch] { benchmark::DoNotOptimize(rc::prepare_mesh(batch.mesh)); });
    add("make_shape/" + batch.name,
        {"triangle", triangles, mesh_bytes + static_cast<double>(batch.shape->memory_bytes()) / triangles},
        [mesh = rc::prepare_mesh(batch.mesh)] { benchmark::DoNotOptimize(rc::Shape::make(mesh)); });
}

void add_broad_phase(std::size_t count) {
    // The copy belongs to the work: the boxes are sorted where they lie.
    add("sweep_and_prune/" + std::to_string(count), {"box", static_cast<double>(count), 2 * sizeof(rc::WorldBox)},
        [boxes = rb::make_boxes(count), sorted = std::vector<rc::WorldBox>(),
         pairs = std::vector<rc::SlotPair>()]() mutable {
            sorted = boxes;
            rc::SweepAndPrune().find_pairs(sorted, pairs);
        });
}

void add_limits() {
    add("limit/clock", {"cycle", static_cast<double>(rb::spend_cycles(1000)), 0}, [] { rb::spend_cycles(1000); });
    for (const rc::cpu::KernelTable* table : rc::cpu::usable_tables()) {
        const std::string_view set = table->instruction_set;
        add("limit/operations/" + std::string(set),
            {"operation of one float", static_cast<double>(rb::spend_operations(set, 1000)), 0},
            [set] { rb::spend_operations(set, 1000); });
    }
}

} // namespace

int main(int argc, char** argv) try {
    // Short runs, many of them, resist a busy machine better than long ones; an option given comes later and wins.
    char min_time[] = "--benchmark_min_time=0.05";
    std::vector<char*> arguments(argv, argv + argc);
    arguments.insert(arguments.begin() + 1, min_time);
    int count = static_cast<int>(arguments.size());
    arguments.push_back(nullptr);
    benchmark::Initialize(&count, arguments.data());
    if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
    rc::Executor executor(1);
    const rb::Batch batches[] = {rb::make_batch(902, 256), rb::make_batch(20000, 32)};
    std::vector<std::unique_ptr<rb::Pipeline>> pipelines;
    std::vector<std::unique_ptr<rb::Coherence>> coherences;
    add_limits();
    for (const rb::Batch& batch : batches) {
        std::vector<rk::Hit> expected, expected_walks;
        for (const rc::cpu::KernelTable* table : rc::cpu::usable_tables()) {
            auto& on = *pipelines.emplace_back(std::make_unique<rb::Pipeline>(executor, table->instruction_set, batch));
            const std::vector<rk::Hit> hits = on.host_hits();
            if (expected.empty()) {
                expected = hits;
                const rb::Visits visits = rb::count_visits(batch, on.host_rays());
                std::fprintf(stderr,
                             "%s: %zu ordered pairs, %.2f cluster tests each; %zu vertex blocks, %zu rays; a ray meets "
                             "%.2f nodes, %.2f triangle blocks, %.2f triangles closely; %zu contacts\n",
                             batch.name.c_str(), on.ordered_pairs(), visits.cluster_blocks, on.vertex_blocks(),
                             on.rays(), visits.nodes, visits.triangle_blocks, visits.close_looks, on.contacts());
            }
            if (std::memcmp(hits.data(), expected.data(), hits.size() * sizeof(rk::Hit)) != 0)
                throw std::logic_error(std::string(table->instruction_set) + ": other hits than the first set gave");
            add_kernels(on, batch, rb::count_visits(batch, on.host_rays()), table->instruction_set);
            auto& kept =
                *coherences.emplace_back(std::make_unique<rb::Coherence>(executor, table->instruction_set, batch));
            const std::vector<rk::Hit> walks = kept.host_walk_hits();
            if (expected_walks.empty()) {
                expected_walks = walks;
                std::fprintf(stderr,
                             "  %zu vertex blocks near; %zu rays cast or cast ahead, %zu walks; %zu rays of watches\n",
                             kept.vertex_blocks(), kept.near_rays(), kept.walks(), kept.watch_rays());
            }
            if (walks.size() != expected_walks.size()
                || std::memcmp(walks.data(), expected_walks.data(), walks.size() * sizeof(rk::Hit)) != 0)
                throw std::logic_error(std::string(table->instruction_set) + ": walks end elsewhere");
            add_coherence(kept, batch, table->instruction_set);
        }
        add_host(executor, batch, pipelines.back()->host_contacts());
    }
    for (const std::size_t boxes : {512u, 4096u}) add_broad_phase(boxes);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "raycontact_bench_kernels: %s\n", error.what());
    return 1;
}
