// SPDX-License-Identifier: Apache-2.0
// The same rays through our casters, for each instruction set, and through Embree 3 (rtcIntersect1, one ray at a time),
// one thread, in alternated runs. Prints nanoseconds a ray, triangle tests a second of `basic`, and the hash of the
// hits.
#include "bench/commands.h"
#include "bench/options.h"
#include "bench/peers/embree_scene.h"
#include "device/cpu/device.h"
#include "device/cpu/kernel_table.h"
#include "device/forwarding.h"
#include "pairs/directed_pairs.h"
#include "pairs/motion.h"
#include "rays/standard.h"
#include "scenes/random.h"
#include "shape/shape_data.h"

#include <raycontact/error.h>
#include <raycontact/shape.h>
#include <scenes/peers/clock.h>

#include <algorithm>
#include <cstdio>
#include <xxhash.h>

namespace raycontact::bench {

namespace rk = kernels;

namespace {

std::vector<PlacedBody> random_pairs(const Shape& shape, std::size_t pairs) {
    scenes::Random random(7);
    std::vector<PlacedBody> bodies(2 * pairs);
    for (PlacedBody& body : bodies) {
        const double apart = 0.35 * shape.data().diagonal;
        const Vec3 at{apart * random.symmetric(), apart * random.symmetric(), apart * random.symmetric()};
        body.shape = &shape;
        body.pose =
            pose_from_quaternion(at, random.symmetric(), random.symmetric(), random.symmetric(), random.symmetric());
        body.centred = centred_pose(shape, body.pose);
    }
    return bodies;
}

// Contacts found; the transform of the vertex is part of the work, as it is of ours.
std::size_t cast(const EmbreeScene& scene, const std::vector<rk::DirectedPair>& pairs, const rk::ShapeHeader& shape,
                 const std::vector<rk::Ray>& rays) {
    std::size_t contacts = 0;
    for (const rk::Ray& ray : rays) {
        const rk::prototype::SourceRay source =
            rk::prototype::source_ray(&pairs[ray.pair], &shape, nullptr, ray.vertex_lane);
        RTCRayHit hit;
        if (scene.cast(source.position, source.direction, source.reach, hit)) ++contacts;
    }
    return contacts;
}

// Of processor time: the work runs on this one thread, and other jobs on the machine then count less.
template <typename Work>
double milliseconds(Work&& work) {
    const double start = peers::now().cpu;
    work();
    return 1e-3 * (peers::now().cpu - start);
}

// Passes everything on to a device that works on this thread, and takes the time in which it casts rays.
class CastClock : public ForwardingDevice {
public:
    using ForwardingDevice::ForwardingDevice;

    double cast_ms = 0;

private:
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override {
        const double ms = milliseconds([&] { inner().launch(kernel, count, arguments); });
        if (kernel == KernelId::cast_rays_bvh || kernel == KernelId::cast_rays_basic) cast_ms += ms;
    }
};

// One instruction set with its own copy of everything.
class Contender {
public:
    Contender(Executor& executor, std::string_view instruction_set, const std::shared_ptr<const Shape>& shape,
              std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs)
        : executor_(executor), device_(cpu::open(executor, instruction_set)), store_(device_), bodies_(bodies) {
        for (const SlotPair& pair : pairs) pairs_.open(pair);
        store_.add(shape);
        settings_.paper.skip_outside = false; // every ray of the rule
        standard_.begin(update(), batch_);
        for (;;) {
            batch_.totals.read(device_, batch_.sums);
            if (standard_.had_room(device_, batch_)) break;
            standard_.cast(update(), batch_);
        }
    }

    void run_bvh() {
        const double all = run(Caster::bvh);
        bvh_ms.push_back(device_.cast_ms);
        queue_ms.push_back(all - device_.cast_ms);
        hash = hash_hits();
    }
    void run_basic() {
        run(Caster::basic);
        basic_ms.push_back(device_.cast_ms);
        basic_hash = hash_hits();
    }

    const std::string& driver() const { return device_.info().driver; }
    std::vector<rk::Ray> rays() { return read(batch_.rays, batch_.sums[RayBatch::ray_sum].results); }
    std::vector<rk::DirectedPair> ordered() { return read(*batch_.pairs, batch_.pairs->size()); }

    std::vector<double> queue_ms, bvh_ms, basic_ms; ///< of each run; queue: finding the rays
    std::uint64_t hash = 0, basic_hash = 0;         ///< of the last

private:
    double run(Caster caster) {
        settings_.paper.caster = caster;
        device_.cast_ms = 0;
        return milliseconds([&] { standard_.cast(update(), batch_); });
    }
    Update update() { return {device_, executor_, store_, bodies_, moved_, pairs_, {}, {}, motion_, settings_}; }

    template <typename T>
    std::vector<T> read(const Array<T>& array, std::size_t count) {
        std::vector<T> host(count);
        array.read(device_, host);
        return host;
    }
    std::uint64_t hash_hits() {
        const std::vector<rk::Hit> hits = read(batch_.hits, batch_.sums[RayBatch::ray_sum].results);
        return XXH64(hits.data(), hits.size() * sizeof(rk::Hit), 0);
    }

    Executor& executor_;
    CastClock device_;
    ShapeStore store_;
    std::span<const PlacedBody> bodies_;
    PairSlots pairs_;
    SlotChanges moved_;
    Motion motion_;
    Settings settings_;
    StandardRays standard_;
    RayBatch batch_;
};

void compare(const std::string& file, std::size_t pair_count, int runs) {
    const auto shape = Shape::make(load_mesh(file));
    const std::vector<PlacedBody> bodies = random_pairs(*shape, pair_count);
    std::vector<SlotPair> pairs;
    for (BodySlot i = 0; i < 2 * pair_count; i += 2) pairs.emplace_back(i, i + 1);

    Executor executor(1);
    std::vector<std::unique_ptr<Contender>> contenders;
    for (const cpu::KernelTable* table : cpu::usable_tables())
        contenders.push_back(std::make_unique<Contender>(executor, table->instruction_set, shape, bodies, pairs));
    const std::vector<rk::Ray> rays = contenders[0]->rays();
    const std::vector<rk::DirectedPair> ordered = contenders[0]->ordered();
    const EmbreeDevice embree_device;
    const EmbreeScene embree(embree_device, *shape);
    std::vector<double> embree_ms;
    std::size_t embree_contacts = 0;
    const auto cast_theirs = [&] { embree_contacts = cast(embree, ordered, shape->data().header, rays); };
    cast_theirs(); // to warm up; ours have done so
    for (int run = 0; run < runs; ++run) {
        for (const auto& c : contenders) c->run_bvh();
        embree_ms.push_back(milliseconds(cast_theirs));
    }
    for (int run = 0; run < 3; ++run)
        for (const auto& c : contenders) c->run_basic();

    const double count = static_cast<double>(rays.size());
    const double triangles = static_cast<double>(shape->triangles().size());
    const double theirs = 1e6 * median(embree_ms) / count;
    std::printf("%zu pairs, %.0f rays (%.1f a pair and direction), %.0f triangles, %d runs, medians\n", pair_count,
                count, count / (2.0 * static_cast<double>(pair_count)), triangles, runs);
    std::printf("%-10s %12s %10s %10s %14s %18s\n", "", "queue ns/ray", "bvh ns/ray", "x Embree", "basic Mtri/s",
                "hash");
    for (const auto& c : contenders)
        std::printf("%-10s %12.1f %10.1f %10.2f %14.0f %016llx%s\n", c->driver().c_str(),
                    1e6 * median(c->queue_ms) / count, 1e6 * median(c->bvh_ms) / count,
                    1e6 * median(c->bvh_ms) / count / theirs, count * triangles / median(c->basic_ms) / 1e3,
                    static_cast<unsigned long long>(c->hash), c->hash == c->basic_hash ? "" : "  basic differs!");
    std::printf("%-10s %12s %10.1f %10.2f   (%zu contacts)\n", "embree", "", theirs, 1.0, embree_contacts);
}

} // namespace

void add_rays(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("rays", "Our casters, for each instruction set, and Embree on the same rays");
    struct Options {
        std::string mesh;
        std::uint32_t pairs = 2000;
        int runs = 9;
    };
    auto o = std::make_shared<Options>();
    command->add_option("mesh", o->mesh, "a mesh file")->required()->type_name("MESH");
    add_number(*command, "pairs", o->pairs, "of bodies that overlap at random", 1u, 1'000'000u);
    add_number(*command, "runs", o->runs, "by turns; figures are medians", 1, 1000);
    command->callback([o] { compare(o->mesh, o->pairs, o->runs); });
}

} // namespace raycontact::bench
