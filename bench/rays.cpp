// SPDX-License-Identifier: Apache-2.0
// The same rays through our casters, for each instruction set, and through Embree 3 (rtcIntersect1, one ray at a time),
// one thread, in alternated runs. Prints nanoseconds a ray, triangle tests a second of `basic`, and the hash of the
// hits.
#include "device/cpu/device.h"
#include "device/cpu/kernel_table.h"
#include "pairs/ordered_pairs.h"
#include "rays/ray_queue.h"
#include "rays/standard.h"
#include "shape/shape_data.h"

#include <raycontact/error.h>
#include <raycontact/shape.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <embree3/rtcore.h>
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

class Embree {
public:
    explicit Embree(const rc::Shape& shape) : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
        RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        const auto& points = shape.data().points;
        auto* v = static_cast<float*>(
            rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, points.size()));
        for (std::size_t i = 0; i < points.size(); ++i) {
            v[3 * i] = points[i].x;
            v[3 * i + 1] = points[i].y;
            v[3 * i + 2] = points[i].z;
        }
        auto* t = static_cast<unsigned*>(
            rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, shape.triangles().size()));
        for (const auto& triangle : shape.triangles())
            for (const auto corner : triangle) *t++ = corner;
        rtcSetGeometryBuildQuality(mesh, RTC_BUILD_QUALITY_HIGH);
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(scene_, mesh);
        rtcReleaseGeometry(mesh);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
        rtcCommitScene(scene_);
    }
    ~Embree() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Embree(const Embree&) = delete;
    Embree& operator=(const Embree&) = delete;

    // Contacts found; the transform of the vertex is part of the work, as it is of ours.
    std::size_t cast(const std::vector<rk::OrderedPair>& pairs, const rc::ShapeData& shape,
                     const std::vector<rk::Ray>& rays) const {
        std::size_t contacts = 0;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        for (const rk::Ray& ray : rays) {
            const rk::prototype::SourceRay source = rk::prototype::source_ray(
                &pairs[ray.pair], &shape.vertex_blocks[ray.slot / VERTEX_LANES], ray.slot % VERTEX_LANES);
            RTCRayHit hit{};
            hit.ray.org_x = source.position[0];
            hit.ray.org_y = source.position[1];
            hit.ray.org_z = source.position[2];
            hit.ray.dir_x = source.direction[0];
            hit.ray.dir_y = source.direction[1];
            hit.ray.dir_z = source.direction[2];
            hit.ray.tfar = source.reach;
            hit.ray.mask = 0xffffffffu;
            hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene_, &context, &hit);
            if (hit.hit.geomID != RTC_INVALID_GEOMETRY_ID
                && hit.hit.Ng_x * hit.ray.dir_x + hit.hit.Ng_y * hit.ray.dir_y + hit.hit.Ng_z * hit.ray.dir_z > 0)
                ++contacts;
        }
        return contacts;
    }

private:
    RTCDevice device_;
    RTCScene scene_;
};

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
    std::vector<rc::Pair> pairs;
    for (rc::BodyId i = 0; i < 2 * pair_count; i += 2) pairs.emplace_back(i, i + 1);

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
    const Embree embree(*shape);
    std::vector<double> embree_ms;
    std::vector<rk::Ray> rays;
    std::size_t embree_contacts = 0;
    for (int run = 0; run <= runs; ++run) {
        for (Contender& c : contenders) {
            const double queue = milliseconds([&] { c.queue.fill(*c.device, c.store->arrays(), c.pairs, false); });
            const double bvh = milliseconds([&] {
                rc::cast_standard(*c.device, rc::Caster::bvh, c.store->arrays(), c.pairs, c.queue.rays(), c.hits);
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
        const double theirs = milliseconds([&] { embree_contacts = embree.cast(ordered, shape->data(), rays); });
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
