// SPDX-License-Identifier: Apache-2.0
// Runs steps of each method on fixed inputs, and what the host does beside, for callgrind to count instructions;
// scripts/instructions reads what is printed: the compiler, then a line `kernel,input,items` for each count. Everything
// is done once beforehand, so that no array has to grow while it counts.
#include "broadphase/broad_phase.h"
#include "contacts/place.h"
#include "device/cpu/device.h"
#include "device/forwarding.h"
#include "pairs/directed_pairs.h"
#include "part/part.h"
#include "scenes/models/model.h"
#include "scenes/random.h"
#include "shape/accelerators.h"
#include "shape/shape_data.h"

#include <raycontact/error.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <valgrind/callgrind.h>

namespace raycontact::bench {

namespace {

// What valgrind 3.19 knows; it has no AVX-512.
constexpr const char* instruction_set = "avx2";

/// The fixed input of the instruction counts: one shape, many overlapping pairs of it, some steps.
/// Equal arguments give equal bits on every machine, so that a count of instructions can be compared with an old one.
struct Batch {
    Mesh mesh;
    std::shared_ptr<const Shape> shape;
    std::vector<SlotPair> pairs; ///< bodies 2 i and 2 i + 1, at random: turned anyhow, middles up to 0.35 box diagonals
                                 ///< apart along each axis
    /// The bodies in each step. A quarter of the pairs creeps, and each further quarter moves four times as far: from
    /// 0.01 % of the diagonal a step along each axis and a hundredth of a degree, at most, to 0.64 %.
    std::vector<std::vector<PlacedBody>> steps;
};

using Matrix = std::array<double, 9>;

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            c[3 * i + j] = (a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j]) + a[3 * i + 2] * b[6 + j];
    return c;
}

/// A procedural knot of so many triangles, 1 m across.
Batch make_batch(std::uint32_t triangles, std::size_t pairs, std::size_t steps) {
    Batch batch;
    batch.mesh = scenes::scene_model("knot", triangles).mesh;
    batch.shape = Shape::make(batch.mesh);
    batch.shape->prepare();
    const double diagonal = batch.shape->data().diagonal;
    scenes::Random random(7);
    std::vector<PlacedBody> bodies;
    for (std::size_t i = 0; i < 2 * pairs; ++i) {
        double at[3], turn[4];
        for (double& x : at) x = 0.35 * diagonal * random.symmetric();
        for (double& x : turn) x = random.symmetric();
        PlacedBody& body = bodies.emplace_back();
        body.shape = batch.shape.get();
        body.pose = pose_from_quaternion({at[0], at[1], at[2]}, turn[0], turn[1], turn[2], turn[3]);
    }
    for (BodySlot i = 0; i < 2 * pairs; i += 2) batch.pairs.emplace_back(i, i + 1);

    std::vector<Pose> ways; // a step's
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double share = 0.0001 * static_cast<double>(1u << 2 * (i / 2 % 4));
        const auto shift = [&] { return share * diagonal * random.symmetric(); };
        const double x = shift(), y = shift(), z = shift();
        const std::array<double, 4> turn = random.tilt(2 * share);
        ways.push_back(pose_from_quaternion({x, y, z}, turn[0], turn[1], turn[2], turn[3]));
    }
    const auto moved = [](const Pose& pose, const Pose& by) {
        const Vec3 &at = pose.translation, &way = by.translation;
        return Pose{product(pose.rotation, by.rotation), {at.x + way.x, at.y + way.y, at.z + way.z}};
    };
    for (std::size_t step = 0; step < steps; ++step) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            PlacedBody& body = bodies[i];
            if (step > 0) body.pose = moved(body.pose, ways[i]);
            body.centred = centred_pose(*batch.shape, body.pose);
            body.next = centred_pose(*batch.shape, moved(body.pose, ways[i]));
        }
        batch.steps.push_back(bodies);
    }
    return batch;
}

/// Unit boxes scattered so that each meets about three others.
std::vector<Box> make_boxes(std::size_t count) {
    // Two unit cubes overlap when their middles are less than 1 apart on every axis: a volume of 8.
    const double half = 0.5 * std::cbrt(8.0 * static_cast<double>(count) / 3);
    scenes::Random random(11);
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        const double x = half * random.symmetric(), y = half * random.symmetric(), z = half * random.symmetric();
        boxes.push_back({{x - 0.5, y - 0.5, z - 0.5}, {x + 0.5, y + 0.5, z + 0.5}});
    }
    return boxes;
}

/// Over a device that works on this thread, in memory that the host shares. While it counts, under callgrind, what each
/// kernel took is dumped as `KERNEL,INPUT`, that of prefix sums as `scan,INPUT`, and what ran in between as
/// `host,INPUT`: a dump for each time, to be added up.
class CallgrindDevice : public ForwardingDevice {
public:
    CallgrindDevice(std::unique_ptr<Device> inner, std::string_view input) : ForwardingDevice(std::move(inner)) {
        if (!traits().shares_memory) throw std::logic_error("only a device on this thread can be counted");
        names_ = {
#define RAYCONTACT_KERNEL(name) #name,
#define RAYCONTACT_CPU_KERNEL(name) #name,
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
            "scan", "host"};
        for (std::string& name : names_) name.append(",").append(input);
    }

    /// From start() to stop() it counts.
    void start() {
        counts_ = true;
        CALLGRIND_START_INSTRUMENTATION;
    }
    void stop() {
        CALLGRIND_STOP_INSTRUMENTATION;
        dump(host_row);
        counts_ = false;
    }
    /// Prints `KERNEL,INPUT,ITEMS` of each kernel that ran since it was made, `host` by so many items.
    void print(std::uint64_t host_items) const {
        for (std::size_t row = 0; row < row_count; ++row) {
            const std::uint64_t items = row == host_row ? host_items : items_[row];
            if (items > 0) std::printf("%s,%llu\n", names_[row].c_str(), static_cast<unsigned long long>(items));
        }
    }

private:
    static constexpr std::size_t scan_row = static_cast<std::size_t>(KernelId::count), host_row = scan_row + 1,
                                 row_count = host_row + 1;

    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override {
        const auto row = static_cast<std::size_t>(kernel);
        add_items(row, count);
        dump(host_row);
        inner().launch(kernel, count, arguments);
        dump(row);
    }
    kernels::uint scan(const ScanOf& scan) override {
        add_items(scan_row, scan.count);
        dump(host_row);
        const kernels::uint launches = inner().scan(scan);
        dump(scan_row);
        return launches;
    }

    // A dump sets the counters back to zero.
    void dump(std::size_t row) const {
        if (counts_) CALLGRIND_DUMP_STATS_AT(names_[row].c_str());
    }
    void add_items(std::size_t row, const Count& count) {
        if (!counts_) return;
        items_[row] +=
            count.buffer ? static_cast<const kernels::uint*>(count.buffer->host())[count.value] : count.value;
    }

    std::array<std::string, row_count> names_; ///< made beforehand, so that no dump counts it
    std::array<std::uint64_t, row_count> items_{};
    bool counts_ = false;
};

/// A part that does every step of a batch.
class Run {
public:
    Run(const Batch& batch, const std::string& input, const Settings& settings) : batch_(batch), settings_(settings) {
        OpenDevice opened{std::make_unique<Executor>(1), nullptr};
        auto device = std::make_unique<CallgrindDevice>(cpu::open(*opened.executor, instruction_set), input);
        device_ = device.get();
        opened.device = std::move(device);
        part_ = std::make_unique<Part>(std::move(opened));
        part_->shapes().add(batch.shape);
        pairs_.set_all(part_->executor(), batch.pairs);
    }

    void count() {
        for (const auto& bodies : batch_.steps) step(bodies);
        part_->forget();
        for (auto bodies : batch_.steps) {
            // Others in the same slots: that the bodies went back to where they began is no motion.
            for (PlacedBody& body : bodies) ++body.generation;
            device_->start();
            step(bodies);
            device_->stop();
            if (contacts_.empty()) throw std::logic_error("a step without contacts is nothing to count");
        }
        device_->print(batch_.pairs.size() * batch_.steps.size());
    }

private:
    void step(std::span<const PlacedBody> bodies) {
        moved_.forget(); // all of them
        const PairList& all = pairs_.all(part_->executor());
        part_->begin(bodies, moved_, {pairs_.slots(), all.pairs, all.slots}, settings_);
        part_->end(contacts_);
        pairs_.step_done();
    }

    const Batch& batch_;
    Settings settings_;
    CallgrindDevice* device_ = nullptr; ///< the part's
    std::unique_ptr<Part> part_;
    SlotChanges moved_;
    OpenPairs pairs_;
    std::vector<Contact> contacts_;
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

Settings settings(Method method, Caster caster = Caster::bvh) {
    Settings settings;
    settings.features = Features::vertices;
    settings.method = method;
    settings.paper.caster = caster;
    return settings;
}

void count_all() {
    const Batch small = make_batch(902, 64, 4), large = make_batch(20000, 8, 4);
    for (const Batch* batch : {&small, &large}) {
        const std::string size = batch == &small ? "" : "_large";
        Run(*batch, "standard" + size, settings(Method::standard)).count();
        Run(*batch, "certified" + size, settings(Method::certified)).count();
        Run(*batch, "predictive" + size, settings(Method::predictive)).count();
    }
    for (const Features features : {Features::vertices, Features::edges}) {
        const std::string input = features == Features::edges ? "edges" : "vertices";
        Settings of = settings(Method::certified);
        of.features = features;
        if (features == Features::edges) Run(small, input, of).count(); // those of vertices are `certified`
        of.speculative = Speculative::on;
        Run(small, input + "_ahead", of).count();
    }
    // Every triangle for every ray; more of them would only be more of the same.
    const Batch few = make_batch(902, 8, 2);
    Run(few, "standard_basic", settings(Method::standard, Caster::basic)).count();
    Run(few, "predictive_basic", settings(Method::predictive, Caster::basic)).count();

    OpenDevice opened = open_device("cpu", 1);
    Executor& executor = *opened.executor;
    ShapeStore shapes(*opened.device);
    shapes.add(small.shape);
    const Settings standard = settings(Method::standard);
    const Motion motion;
    const SlotChanges moved;
    PairSlots open;
    for (const SlotPair& pair : small.pairs) open.open(pair);
    const Update update{*opened.device, executor, shapes, small.steps[0], moved, open, {}, {}, motion, standard};
    Pipeline pipeline;
    pipeline.begin(update);
    const Update found = pipeline.end(update);
    const auto& local = pipeline.contacts();
    Placer placer;
    std::vector<Contact> placed;
    count_host("place_contacts,standard", local.all().size(),
               [&] { placer.run(executor, Direction::reprojected, small.steps[0], found.pairs, local, {}, placed); });

    const std::vector<Box> boxes = make_boxes(4096);
    count_host("broad_phase,boxes", boxes.size(), [&] {
        BoxTree tree;
        tree.build(executor, boxes);
        BroadPhase().find(executor, tree, {boxes, {}});
    });
    count_host("make_shape,knot", small.mesh.triangles.size(), [&] { Shape::make(small.mesh); });
    const auto made = Shape::make(small.mesh);
    Executor one_thread(1);
    count_host("prepare_shape,knot", small.mesh.triangles.size(),
               [&] { build_accelerators(made->data(), one_thread, {}); });
}

std::string compiler() {
#ifdef __clang__
    return "clang-" + std::to_string(__clang_major__) + "." + std::to_string(__clang_minor__);
#else
    return "gcc-" + std::to_string(__GNUC__) + "." + std::to_string(__GNUC_MINOR__);
#endif
}

} // namespace

} // namespace raycontact::bench

int main() try {
    std::printf("%s\n", raycontact::bench::compiler().c_str());
    raycontact::bench::count_all();
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "raycontact_instructions: %s\n", error.what());
    return dynamic_cast<const raycontact::InputError*>(&error) ? 2 : 1;
}
