// SPDX-License-Identifier: Apache-2.0
// The broad phase on every device of this machine, the CPU's included: the host's pairs, in the host's order.
#include "box_changes.h"
#include "device/counting.h"
#include "device/launch.h"
#include "prepared_shape.h"
#include "reference/meshes.h"
#include "reference/random.h"

#include <raycontact/device.h>
#include <raycontact/scene.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <vector>

namespace raycontact {
namespace {

using namespace reference;
using Filter = BroadPhaseInput::Filter;

// Solids of all sizes, and an open mesh, whose box is grown by the longest ray.
const std::vector<std::shared_ptr<const Shape>>& shapes() {
    static const auto made = [] {
        std::vector<std::shared_ptr<const Shape>> all{Shape::make(sheet_mesh(2))};
        for (const double size : {0.01, 0.3, 1.0, 1.0, 7.0})
            all.push_back(Shape::make(box_mesh({size, 0.5 * size, 0.2 * size})));
        return all;
    }();
    return made;
}

std::vector<std::string> devices() {
    std::vector<std::string> ids;
    for (const DeviceInfo& info : list_devices())
        if (info.usable) ids.push_back(info.id);
    return ids;
}

/// Bodies, and what a scene keeps of their boxes for both broad phases.
class Bodies {
public:
    explicit Bodies(const std::string& id) : id_(id), opened_(open_device(id, 2)), device_(std::move(opened_.device)) {}

    std::size_t size() const { return bodies_.size(); }
    void add(std::size_t shape, const Pose& pose) {
        const auto slot = static_cast<BodySlot>(bodies_.size());
        world_.make_room(slot + 1);
        changes_.make_room(slot + 1);
        bodies_.push_back({shapes()[shape].get(), 0, 0, pose, pose, pose});
        filters_.push_back({});
        world_.add_shape(*bodies_[slot].shape);
        mark(slot);
    }
    void remove(BodySlot slot) {
        if (bodies_[slot].shape == nullptr) return;
        world_.remove_shape(*bodies_[slot].shape);
        bodies_[slot].shape = nullptr;
        mark(slot);
    }
    void cut(std::size_t slots) {
        bodies_.resize(slots);
        filters_.resize(slots);
        world_.cut(slots);
        changes_.cut(slots);
    }
    /// Where none is.
    void put(BodySlot slot, std::size_t shape, const Pose& pose) {
        if (bodies_[slot].shape != nullptr) return;
        bodies_[slot] = {shapes()[shape].get(), 0, 0, pose, pose, pose};
        world_.add_shape(*bodies_[slot].shape);
        mark(slot);
    }
    void move(BodySlot slot, const Pose& pose) {
        bodies_[slot].pose = pose;
        mark(slot);
    }
    const Pose& pose(BodySlot slot) const { return bodies_[slot].pose; }
    void filter(BodySlot slot, const Filter& filter) {
        filters_[slot] = filter;
        changes_.mark(slot);
    }
    void expect(std::vector<Pose> next, double margin) {
        next_ = std::move(next);
        settings_.speculative = Speculative::on;
        settings_.speculative_margin = margin;
        world_.forget();
        changes_.forget();
    }

    /// whole: the pairs that were found are lost. Returns the number of pairs.
    std::size_t compare(bool whole = false) {
        world_.update(*opened_.executor, bodies_, next_, settings_);
        BroadPhase broad_phase;
        const auto on_host = broad_phase.find(*opened_.executor, world_.tree(), {world_.boxes(), filters_});
        const std::vector<SlotPair> expected(on_host.begin(), on_host.end());
        const DeviceBroadPhase::Changes changes =
            changes_.list(*opened_.executor, bodies_, next_, filters_, world_, settings_, broad_phase_.slots());
        const bool knows_all = broad_phase_.slots() == changes.slots;
        device_.take_work();
        const DeviceBroadPhase::Found found = broad_phase_.find(device_, changes, whole);
        work = device_.take_work();
        EXPECT_TRUE(found.whole || gave_up() || (knows_all && !whole)) << id_;
        opened = found.opened.size();
        closed = found.closed.size();
        wholes += found.whole ? 1 : 0;
        if (found.whole) pairs_.clear();
        EXPECT_TRUE(std::ranges::is_sorted(found.opened) && std::ranges::is_sorted(found.closed)) << id_;
        // Nothing closes that was not open, or opens that was.
        for (const SlotPair& pair : found.closed) EXPECT_EQ(pairs_.erase(pair), 1u) << id_;
        for (const SlotPair& pair : found.opened) {
            EXPECT_TRUE(pairs_.insert(pair).second) << id_;
            EXPECT_FALSE(std::ranges::binary_search(found.closed, pair)) << id_;
        }
        EXPECT_EQ(pairs_.size(), expected.size()) << id_;
        EXPECT_TRUE(std::ranges::equal(pairs_, expected)) << id_;
        return pairs_.size();
    }

    bool gave_up() const { return broad_phase_.gave_up(); }

    DeviceWork work; ///< of the last compare()
    std::size_t opened = 0, closed = 0;
    unsigned wholes = 0; ///< of all

private:
    void mark(BodySlot slot) {
        world_.mark(slot);
        changes_.mark(slot);
    }

    std::string id_;
    OpenDevice opened_;
    CountingDevice device_;
    DeviceBroadPhase broad_phase_;
    BoxChanges changes_;
    WorldBoxes world_;
    Settings settings_;
    std::vector<PlacedBody> bodies_;
    std::vector<Filter> filters_;
    std::vector<Pose> next_;
    std::set<SlotPair> pairs_; ///< by what opened and closed
};

using Place = std::function<Vec3(std::uint32_t)>;

Pose pose_at(Random& random, const Vec3& at) {
    Pose pose = random.rotation();
    pose.translation = at;
    return pose;
}

// Some steps: a few bodies move, all do, none; some come and go; filters change.
std::size_t run(const std::string& device, std::uint32_t count, const Place& place) {
    Bodies bodies(device);
    Random random(count);
    const auto shape = [&] { return random.below(static_cast<std::uint32_t>(shapes().size())); };
    for (std::uint32_t i = 0; i < count; ++i) bodies.add(shape(), pose_at(random, place(i)));
    std::size_t pairs = bodies.compare();
    for (int step = 0; step < 7; ++step) {
        for (BodySlot i = 0; i < bodies.size(); ++i)
            if (step % 3 == 0 || (step % 3 == 1 && i % 50 == 0)) bodies.move(i, pose_at(random, place(i + 7 * step)));
        if (step == 3)
            for (BodySlot i = 0; i < bodies.size(); i += 3) bodies.filter(i, {1u << (i % 2), 1u + i % 3, i % 4 == 0});
        if (step == 4)
            for (BodySlot i = 0; i < bodies.size(); i += 5) bodies.remove(i);
        if (step == 5)
            for (std::uint32_t i = 0; i < count / 5; ++i) bodies.add(shape(), pose_at(random, place(i)));
        if (step == 6) bodies.cut(bodies.size() / 5);
        pairs += bodies.compare();
        if (testing::Test::HasFailure()) break;
    }
    return pairs;
}

class Devices : public testing::TestWithParam<std::string> {};

std::array<std::uint64_t, 6> bits_of(const Vec3& low, const Vec3& high) {
    return std::bit_cast<std::array<std::uint64_t, 6>>(std::array{low.x, low.y, low.z, high.x, high.y, high.z});
}

// Pairs alone would not tell the last bits.
TEST_P(Devices, make_the_hosts_boxes) {
    const OpenDevice opened = open_device(GetParam(), 1);
    Device& device = *opened.device;
    Random random(2);
    for (const std::size_t places : {1, 2}) {
        std::vector<kernels::BodyExtent> extents;
        std::vector<kernels::BodyPlace> moved;
        std::vector<Box> expected;
        for (BodySlot slot = 0; slot < 5000; ++slot) {
            const double scale = std::pow(10.0, random.uniform(-3, 9));
            const Vec3 corner = random.in_ball(), size{random.uniform(0, 1), random.uniform(0, 1), 0};
            const Box own{corner, corner + size};
            const double growth = slot % 2 == 0 ? 0 : random.uniform(0, 0.1);
            const Vec3 middle = own.middle(), half = 0.5 * (own.high - own.low) + Vec3{growth, growth, growth};
            extents.push_back({{middle.x, middle.y, middle.z},
                               {half.x, half.y, half.z},
                               slot,
                               3,
                               slot % 3 == 0 ? IS_THERE | IS_STATIC : IS_THERE,
                               slot});
            Box box = no_box;
            for (std::size_t k = 0; k < places; ++k) {
                const Pose pose = slot % 7 == 0 ? Pose{} : pose_at(random, scale * random.in_ball());
                moved.push_back(place_of(pose, 0, slot));
                box.add(world_box(own, pose, growth));
            }
            expected.push_back(box);
        }
        Array<kernels::BodyExtent> sent, on_device;
        Array<kernels::BodyPlace> poses;
        Array<kernels::WorldBox> boxes;
        sent.write(device, extents);
        poses.write(device, moved);
        on_device.resize(device, extents.size());
        boxes.resize(device, extents.size());
        launch<KernelId::set_extents>(device, extents.size(), sent, on_device);
        launch<KernelId::make_boxes>(device, extents.size(), static_cast<kernels::uint>(places), poses, on_device,
                                     boxes);
        std::vector<kernels::WorldBox> found(extents.size());
        boxes.read(device, found);
        for (BodySlot slot = 0; slot < found.size(); ++slot) {
            const auto& [low, high, groups, mask, moves, unused] = found[slot];
            ASSERT_EQ(bits_of({low[0], low[1], low[2]}, {high[0], high[1], high[2]}),
                      bits_of(expected[slot].low, expected[slot].high))
                << slot;
            ASSERT_EQ(groups, slot);
            ASSERT_EQ(mask, 3u);
            ASSERT_EQ(moves, slot % 3 == 0 ? 0u : 1u);
        }
    }
}

TEST_P(Devices, find_the_hosts_pairs) {
    Random random(3);
    const auto in_ball = [&](double radius) {
        return [&random, radius](std::uint32_t) { return radius * random.in_ball(); };
    };
    for (const std::uint32_t count : {0u, 1u, 2u, 15u, 17u, 300u}) {
        EXPECT_EQ(run(GetParam(), count, in_ball(2)) > 0, count > 2) << count;
        if (HasFailure()) return;
    }
    EXPECT_GT(run(GetParam(), 3000, in_ball(40)), 3000u);
    EXPECT_GT(run(GetParam(), 3000, [&](std::uint32_t i) { return Vec3{0.2 * i, 0, random.in_ball().z}; }), 3000u);
    EXPECT_GT(run(GetParam(), 3000, [&](std::uint32_t) { return Vec3{1e7, -1e7, 0} + 40 * random.in_ball(); }), 3000u);
    EXPECT_GT(run(GetParam(), 3000,
                  [&](std::uint32_t i) { return i % 9 == 0 ? 1e60 * random.in_ball() : 9 * random.in_ball(); }),
              3000u);
}

// Each is near more than a walk lists.
TEST_P(Devices, find_bodies_that_are_all_in_one_place) {
    EXPECT_EQ(run(GetParam(), 400, [](std::uint32_t) { return Vec3{}; }) > 79800u, true);
}

TEST_P(Devices, find_pairs_of_many_bodies) {
    Random random(4);
    EXPECT_GT(run(GetParam(), 20000, [&](std::uint32_t) { return 90 * random.in_ball(); }), 20000u);
}

// Boxes hold the way to where the bodies are expected.
TEST_P(Devices, look_ahead) {
    Bodies bodies(GetParam());
    Random random(5);
    std::vector<Pose> next;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        bodies.add(i % shapes().size(), pose_at(random, 40 * random.in_ball()));
        next.push_back(pose_at(random, bodies.pose(i).translation + 3 * random.in_ball()));
    }
    const std::size_t before = bodies.compare();
    bodies.expect(next, 0.1);
    EXPECT_GT(bodies.compare(), before + 1000);
    for (BodySlot i = 0; i < 1000; i += 10) bodies.move(i, next[i]);
    EXPECT_GT(bodies.compare(), before + 1000);
}

// Once the device has a list, it tells of changes alone: whatever comes, but for other slots, and until asked for all.
TEST_P(Devices, tell_what_opened_and_closed) {
    Bodies bodies(GetParam());
    Random random(7);
    const auto anywhere = [&] { return pose_at(random, 8 * random.in_ball()); };
    for (std::uint32_t i = 0; i < 800; ++i) bodies.add(1 + i % 4, anywhere());
    EXPECT_GT(bodies.compare(), 800u);
    std::size_t opened = 0, closed = 0;
    for (unsigned step = 0; step < 40; ++step) {
        const std::uint32_t few = 1 + random.below(40);
        for (std::uint32_t k = 0; k < few; ++k) {
            const BodySlot slot = random.below(800);
            switch (random.below(4)) {
            case 0:
                bodies.filter(slot, {1u + random.below(3), 1u + random.below(3)});
                break;
            case 1:
                bodies.remove(slot);
                break;
            case 2:
                bodies.put(slot, 1 + slot % 4, anywhere());
                break;
            default:
                bodies.move(slot, anywhere());
            }
        }
        bodies.compare(step == 20);
        if (step == 20) continue;
        EXPECT_EQ(bodies.work.reads, 1u);
        opened += bodies.opened;
        closed += bodies.closed;
    }
    EXPECT_EQ(bodies.wholes, 2u);
    EXPECT_GT(opened, 400u);
    EXPECT_GT(closed, 400u);
    EXPECT_LT(opened + closed, 20'000u);
    for (BodySlot slot = 0; slot < 800; ++slot) bodies.remove(slot);
    EXPECT_EQ(bodies.compare(), 0u); // and all close
    EXPECT_GT(bodies.closed, 200u);
    EXPECT_EQ(bodies.wholes, 2u);
    EXPECT_EQ(bodies.work.reads, 1u);
    EXPECT_EQ(bodies.compare(), 0u);
    EXPECT_EQ(bodies.closed, 0u);
}

// More than there is room for at first; what closes is as much.
TEST_P(Devices, tell_of_many_changes) {
    Bodies bodies(GetParam());
    Random random(8);
    for (std::uint32_t i = 0; i < 3000; ++i) bodies.add(3, pose_at(random, Vec3{10.0 * i, 0, 0}));
    EXPECT_EQ(bodies.compare(), 0u);
    for (int turn = 0; turn < 2; ++turn) {
        for (BodySlot i = 0; i < 3000; ++i) bodies.move(i, pose_at(random, 14 * random.in_ball()));
        EXPECT_GT(bodies.compare(), 2000u);
        EXPECT_GT(bodies.opened, 2000u);
        for (BodySlot i = 0; i < 3000; ++i) bodies.move(i, pose_at(random, Vec3{10.0 * i, 0, 0}));
        EXPECT_EQ(bodies.compare(), 0u);
        EXPECT_GT(bodies.closed, 2000u);
    }
    EXPECT_EQ(bodies.wholes, 1u);
}

// Two floors between others by their slots, of which the order is sought anew: only where bodies become wide, or are no
// more, the device begins anew.
TEST_P(Devices, tell_what_opened_and_closed_around_wide_bodies) {
    Bodies bodies(GetParam());
    Random random(9);
    const auto on_it = [&] { return pose_at(random, {3 * random.in_ball().x, 1.5 * random.in_ball().y, 0}); };
    for (std::uint32_t i = 0; i < 1500; ++i) bodies.add(i == 300 || i == 900 ? 5 : 1, i == 300 ? Pose{} : on_it());
    bodies.move(900, pose_at(random, {0, 0, 90}));
    bodies.compare();
    const unsigned before = bodies.wholes;
    for (unsigned step = 0; step < 70; ++step) {
        for (std::uint32_t k = 0; k < 30; ++k) {
            const BodySlot slot = random.below(1500);
            if (slot != 300 && slot != 900) bodies.move(slot, on_it());
        }
        EXPECT_GT(bodies.compare(), 1000u);
        EXPECT_LT(bodies.opened, 1000u);
    }
    EXPECT_EQ(bodies.wholes, before);
    bodies.move(900, Pose{});
    EXPECT_GT(bodies.compare(), 2000u);
    bodies.move(300, pose_at(random, {0, 0, 90}));
    bodies.compare();
    for (unsigned step = 0; step < 40; ++step) {
        bodies.move(random.below(300), on_it());
        bodies.compare();
    }
    EXPECT_LE(bodies.wholes, before + 3);
}

// A floor under all, in the first slot or in the last: the launches of a step stay few.
TEST_P(Devices, take_few_launches_and_one_read) {
    for (const bool last : {false, true}) {
        Bodies bodies(GetParam());
        Random random(6);
        const auto on_it = [&] { return Vec3{3 * random.in_ball().x, 1.5 * random.in_ball().y, 0}; };
        if (!last) bodies.add(5, {});
        for (std::uint32_t i = 0; i < 2000; ++i) bodies.add(1, pose_at(random, on_it()));
        if (last) bodies.add(5, {});
        EXPECT_GT(bodies.compare(), 1500u);
        for (int step = 0; step < 3; ++step) {
            for (BodySlot i = 1; i < 2000; ++i) {
                Pose pose = bodies.pose(i);
                pose.translation.z += 1e-4;
                bodies.move(i, pose);
            }
            EXPECT_GT(bodies.compare(), 1500u);
        }
        EXPECT_LE(bodies.work.launches, 9u); // boxes, two for three levels; count, scan, write: pairs, their changes
        EXPECT_EQ(bodies.work.reads, 1u);
    }
}

INSTANTIATE_TEST_SUITE_P(broad_phase, Devices, testing::ValuesIn(devices()), [](const auto& device) {
    std::string name = device.param;
    for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    return name;
});

// Their table would take a gigabyte, and no pair is found.
TEST(device_pairs, so_many_in_one_place_that_filters_keep_apart_are_left_to_the_host) {
    Bodies bodies("cpu");
    for (BodySlot slot = 0; slot < 33'000; ++slot) {
        bodies.add(3, {});
        bodies.filter(slot, {1, 0});
    }
    EXPECT_EQ(bodies.compare(), 0u);
    EXPECT_TRUE(bodies.gave_up());
}

} // namespace
} // namespace raycontact
