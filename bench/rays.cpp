// SPDX-License-Identifier: Apache-2.0
// The same rays through our casters, for each instruction set, and through Embree 3 (rtcIntersect1, one ray at a time),
// one thread, in alternated runs. Prints nanoseconds a ray, triangle tests a second of `basic`, and the hash of the
// hits.
#include "bench/peers/embree_scene.h"

#include "device/cpu/device.h"
#include "device/cpu/kernel_table.h"
#include "pairs/ordered_pairs.h"
#include "rays/cast_standard.h"
#include "rays/ray_queue.h"
#include "shape/shape_data.h"

#include <raycontact/error.h>
#include <raycontact/shape.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <xxhash.h>

namespace rc = raycontact;
namespace rk = raycontact::kernels;

namespace {

struct Random {
    std::uint64_t state;
    double next() // splitmix64, in [-1, 1)
    {
        std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return static_cast<double>((z ^ (z >> 31)) >> 11) / 4503599627370496.0 - 1;
    }
};

std::vector<rc::PlacedBody> random_pairs(const rc::Shape& shape, std::size_t pairs) {
    Random random{7};
    std::vector<rc::PlacedBody> bodies(2 * pairs);
    for (rc::PlacedBody& body : bodies) {
        const double apart = 0.35 * shape.data().diagonal;
        const rc::Vec3 at{apart * random.next(), apart * random.next(), apart * random.next()};
        body.shape = &shape;
        body.pose = rc::pose_from_quaternion(at, random.next(), random.next(), random.next(), random.next());
        body.centred = body.pose;
        body.centred.translation = rc::transform_point(body.pose, shape.centre());
    }
    return bodies;
}

// Contacts found; the transform of the vertex is part of the work, as it is of ours.
std::size_t cast(const rc::bench::EmbreeScene& scene, const std::vector<rk::OrderedPair>& pairs,
                 const rc::ShapeData& shape, const std::vector<rk::Ray>& rays) {
    std::size_t contacts = 0;
    for (const rk::Ray& ray : rays) {
        const rk::prototype::SourceRay source =
            rk::prototype::source_ray(&pairs[ray.pair], shape.vertex_blocks.data(), ray.slot);
        RTCRayHit hit;
        if (scene.cast(source.position, source.direction, source.reach, hit)) ++contacts;
    }
    return contacts;
}

// Of processor time: the work runs on this one thread, and other jobs on the machine then count less.
template <typename Work>
double milliseconds(Work&& work) {
    const auto now = [] {
        timespec time{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
        return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
    };
    const double start = now();
    work();
    return now() - start;
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

// One instruction set with its own copy of everything.
struct Contender {
    std::unique_ptr<rc::Device> device;
    std::unique_ptr<rc::ShapeStore> store;
    rc::Array<rk::OrderedPair> pairs;
    rc::RayQueue queue;
    rc::Array<rk::Hit> hits;
    std::vector<double> queue_ms, bvh_ms, basic_ms;
    std::uint64_t hash = 0, basic_hash = 0;

    std::uint64_t hash_hits() {
        std::vector<rk::Hit> host(hits.size());
        hits.read(*device, host);
        return XXH64(host.data(), host.size() * sizeof(rk::Hit), 0);
    }
};

} // namespace

int main(int argc, char** argv) try {
    if (argc < 2) {
        std::fprintf(stderr, "usage: raycontact_bench_rays MESH [PAIRS [RUNS]]\n");
        return 2;
    }
    const auto shape = rc::Shape::make(rc::load_mesh(argv[1]));
    const std::size_t pair_count = argc > 2 ? std::stoul(argv[2]) : 2000;
    const int runs = argc > 3 ? std::stoi(argv[3]) : 9;
    const std::vector<rc::PlacedBody> bodies = random_pairs(*shape, pair_count);
    std::vector<rc::SlotPair> pairs;
    for (rc::BodySlot i = 0; i < 2 * pair_count; i += 2) pairs.emplace_back(i, i + 1);

    rc::Executor executor(1);
    std::vector<rk::OrderedPair> ordered;
    rc::order_pairs(executor, bodies, pairs, ordered);
    std::vector<Contender> contenders;
    for (const rc::cpu::KernelTable* table : rc::cpu::usable_tables()) {
        Contender& c = contenders.emplace_back();
        c.device = rc::cpu::open(executor, table->instruction_set);
        c.store = std::make_unique<rc::ShapeStore>(*c.device);
        c.store->add(shape);
        c.pairs.write(*c.device, ordered);
    }
    const rc::bench::EmbreeDevice embree_device;
    const rc::bench::EmbreeScene embree(embree_device, *shape);
    std::vector<double> embree_ms;
    std::vector<rk::Ray> rays;
    std::size_t embree_contacts = 0;
    for (int run = 0; run <= runs; ++run) {
        for (Contender& c : contenders) {
            const double queue = milliseconds([&] { c.queue.fill(*c.device, c.store->arrays(), c.pairs, false); });
            const double bvh = milliseconds([&] {
                rc::cast_standard(*c.device, rc::Caster::bvh, c.store->arrays(), c.pairs, c.queue.rays(), c.hits,
                                  false);
            });
            c.hash = c.hash_hits();
            if (run == 0) continue; // warm-up
            c.queue_ms.push_back(queue);
            c.bvh_ms.push_back(bvh);
        }
        if (run == 0) {
            rays.resize(contenders[0].queue.rays().size());
            contenders[0].queue.rays().read(*contenders[0].device, rays);
        }
        const double theirs = milliseconds([&] { embree_contacts = cast(embree, ordered, shape->data(), rays); });
        if (run > 0) embree_ms.push_back(theirs);
    }
    for (int run = 0; run < 3; ++run)
        for (Contender& c : contenders) {
            c.basic_ms.push_back(milliseconds([&] {
                rc::cast_standard(*c.device, rc::Caster::basic, c.store->arrays(), c.pairs, c.queue.rays(), c.hits);
            }));
            c.basic_hash = c.hash_hits();
        }

    const double count = static_cast<double>(rays.size());
    const double triangles = static_cast<double>(shape->triangles().size());
    const double theirs = 1e6 * median(embree_ms) / count;
    std::printf("%zu pairs, %.0f rays (%.1f a pair and direction), %.0f triangles, %d runs, medians\n", pair_count,
                count, count / (2.0 * static_cast<double>(pair_count)), triangles, runs);
    std::printf("%-10s %12s %10s %10s %14s %18s\n", "", "queue ns/ray", "bvh ns/ray", "x Embree", "basic Mtri/s",
                "hash");
    for (const Contender& c : contenders)
        std::printf("%-10s %12.1f %10.1f %10.2f %14.0f %016llx%s\n", c.device->info().driver.c_str(),
                    1e6 * median(c.queue_ms) / count, 1e6 * median(c.bvh_ms) / count,
                    1e6 * median(c.bvh_ms) / count / theirs, count * triangles / median(c.basic_ms) / 1e3,
                    static_cast<unsigned long long>(c.hash), c.hash == c.basic_hash ? "" : "  basic differs!");
    std::printf("%-10s %12s %10.1f %10.2f   (%zu contacts)\n", "embree", "", theirs, 1.0, embree_contacts);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "raycontact_bench_rays: %s\n", error.what());
    return dynamic_cast<const rc::InputError*>(&error) ? 2 : 1;
}
