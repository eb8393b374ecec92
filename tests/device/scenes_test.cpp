// SPDX-License-Identifier: Apache-2.0
// One hash of every scene, method and caster, whatever the device; and what a scene may hold little or nothing of.
#include "device/listed_pairs.h"
#include "device/turning.h"
#include "device/work.h"
#include "reference/meshes.h"
#include "reference/random.h"
#include "scenes/models/model.h"

#include "part/part.h"
#include "prepared_shape.h"

#include <raycontact/contact.h>
#include <raycontact/device.h>
#include <raycontact/scene.h>

#include <gtest/gtest.h>

#include <thread>

using namespace raycontact;
using namespace raycontact::reference;
using raycontact::device_test::ListedPairs;
using raycontact::device_test::same;
using raycontact::device_test::tested_device;

namespace {

std::vector<std::shared_ptr<const Shape>> shapes_of(const std::vector<Mesh>& meshes) {
    std::vector<std::shared_ptr<const Shape>> shapes;
    shapes.reserve(meshes.size());
    for (const Mesh& mesh : meshes) shapes.push_back(prepared_shape(mesh));
    return shapes;
}

struct Crowd {
    std::string name;
    std::vector<std::shared_ptr<const Shape>> shapes;
    std::uint32_t bodies = 0;
    double spread = 1, speed = 0.02;
    std::size_t least_contacts = 0;
};

// Boxes, bars, a cone: most of what touches are edges.
const Crowd& coarse_crowd() {
    static const Crowd made = {"coarse",
                               shapes_of({box_mesh({0.5, 0.5, 0.5}), box_mesh({1, 0.1, 0.15}), cone_mesh(),
                                          frame_mesh(), bumpy_octahedron_mesh(10)}),
                               16,
                               1.0,
                               0.02,
                               500};
    return made;
}

const std::vector<Crowd>& crowds() {
    static const std::vector<Crowd> made = {
        {"closed", shapes_of({bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh(), tetrahedron_mesh()}), 16, 1.2,
         0.02, 500},
        {"open", shapes_of({bowl_mesh(8), sheet_mesh(8), open_box_mesh(4)}), 12, 0.8, 0.01, 100},
        {"mixed, slow",
         shapes_of({scenes::scene_model("knot", 302).mesh, scenes::scene_model("gear", 302).mesh, bowl_mesh(8)}), 14,
         0.8, 0.0005, 500},
        {"far apart", shapes_of({tetrahedron_mesh()}), 5, 1e6, 1, 0},
    };
    return made;
}

std::string hash_of(const Crowd& crowd, Method method, Caster caster, const std::string& device,
                    Direction direction = Direction::reprojected, Features features = Features::vertices,
                    bool speculative = false) {
    Settings settings;
    settings.speculative = speculative ? Speculative::on : Speculative::off;
    settings.features = features;
    settings.method = method;
    settings.paper.caster = caster;
    settings.direction = direction;
    settings.execution.devices = device;
    settings.execution.threads = 2;
    Scene scene(settings);
    Random random(2013);
    std::vector<Pose> poses;
    for (std::uint32_t i = 0; i < crowd.bodies; ++i) {
        poses.push_back(random.rotation());
        poses.back().translation = crowd.spread * random.in_ball();
        scene.add(crowd.shapes[i % crowd.shapes.size()], poses.back());
    }
    ContactHash hash(direction, speculative);
    std::size_t contacts = 0, untouched = 0;
    for (std::uint32_t step = 0; step < 5; ++step) {
        hash.add(step, scene.find_contacts());
        contacts += scene.stats().contacts;
        untouched += scene.stats().contacts_speculative;
        for (std::uint32_t body = 0; body < poses.size(); ++body) {
            poses[body].translation = poses[body].translation + crowd.speed * random.in_ball();
            scene.set_pose({body}, poses[body]);
        }
    }
    EXPECT_GE(contacts, crowd.least_contacts) << crowd.name;
    EXPECT_GE(untouched, speculative ? crowd.least_contacts / 200 : 0) << crowd.name;
    return hash.hex();
}

void expect_the_cpus_hash(const std::string& device) {
    for (const Crowd& crowd : crowds())
        for (const Method method : {Method::standard, Method::iterative, Method::predictive, Method::certified})
            for (const Caster caster : {Caster::bvh, Caster::basic})
                EXPECT_EQ(hash_of(crowd, method, caster, device), hash_of(crowd, method, caster, "cpu"))
                    << crowd.name << ", " << to_string(method) << ", " << to_string(caster) << ", " << device;
}

std::vector<std::string> opencl_devices() {
    std::vector<std::string> ids;
    for (const DeviceInfo& info : list_devices())
        if (info.kind == "opencl" && info.usable) ids.push_back(info.id);
    return ids;
}

bool has_parts() {
    try {
        open_device("opencl:0/1", 1);
        return true;
    } catch (const std::exception& error) {
        std::printf("[ no parts ] %s\n", error.what());
        return false;
    }
}

// Host and device take turns in finding pairs, by how many bodies moved: many go back to where they were, when the
// other one saw them.
TEST(scenes, have_one_list_of_pairs_whoever_finds_them) {
    std::vector<std::unique_ptr<Scene>> scenes;
    for (const std::string& device : {std::string("cpu"), tested_device()}) {
        Settings settings;
        settings.execution.devices = device;
        settings.execution.threads = 1;
        scenes.push_back(std::make_unique<Scene>(settings));
    }
    const auto shapes = shapes_of({tetrahedron_mesh(), box_mesh({9, 9, 0.1}), sheet_mesh(2)});
    Random random(18);
    std::vector<Pose> places;
    for (int i = 0; i < 60; ++i) {
        places.push_back(random.rotation());
        places.back().translation = 7 * random.in_ball();
    }
    const auto place = [&] { return places[random.below(60)]; };
    std::vector<BodyId> bodies;
    const auto add = [&] {
        const Pose pose = place();
        const std::size_t shape = random.below(40) == 0 ? 1 + random.below(2) : 0;
        BodyId id;
        for (auto& scene : scenes) id = scene->add(shapes[shape], pose);
        bodies.push_back(id);
    };
    for (int i = 0; i < 400; ++i) add();
    std::size_t others = 0;
    std::vector<Pair> before;
    for (int step = 0; step < 120 && !HasFailure(); ++step) {
        const std::uint32_t kind = random.below(8);
        const std::uint32_t moving = kind == 0 ? 0 : kind < 6 ? 1 + random.below(20) : 100 + random.below(300);
        for (std::uint32_t k = 0; k < moving; ++k) {
            const BodyId id = bodies[random.below(static_cast<std::uint32_t>(bodies.size()))];
            const Pose pose = place();
            for (auto& scene : scenes) scene->set_pose(id, pose);
        }
        if (random.below(4) == 0) {
            const BodyId id = bodies[random.below(static_cast<std::uint32_t>(bodies.size()))];
            const std::uint32_t groups = 1 + random.below(3);
            for (auto& scene : scenes) scene->set_filter(id, groups, 3 - groups / 2);
        }
        for (std::uint32_t k = random.below(6) / 4 * (1 + random.below(9)); k > 0; --k) {
            std::swap(bodies[random.below(static_cast<std::uint32_t>(bodies.size()))], bodies.back());
            for (auto& scene : scenes) scene->remove(bodies.back());
            bodies.pop_back();
        }
        if (random.below(5) == 0) add();
        if (step == 70) // and many slots are no more
            for (; bodies.size() > 150; bodies.pop_back())
                for (auto& scene : scenes) scene->remove(bodies.back());
        const std::uint32_t asked = random.below(12);
        for (auto& scene : scenes) {
            if (asked == 0) scene->closest_point({0, 0, 0}); // a query brings the boxes up to date
            if (asked == 1) scene->find_contacts(std::vector<Pair>{{bodies[0], bodies[1]}});
            if (asked == 2) {
                Settings settings = scene->settings();
                settings.speculative = settings.is_speculative() ? Speculative::off : Speculative::on;
                scene->set_settings(settings);
            }
            scene->find_contacts();
        }
        const std::vector<Pair> expected(scenes[0]->pairs().begin(), scenes[0]->pairs().end());
        EXPECT_TRUE(std::ranges::equal(scenes[1]->pairs(), expected)) << "step " << step;
        EXPECT_GT(expected.size(), 50u);
        others += expected != before ? 1 : 0;
        before = expected;
    }
    EXPECT_GT(others, 90u);
}

// Apart from finding pairs, a step without any asks nothing of a device.
TEST(scenes, find_what_became_of_a_few_pairs_on_the_host) {
    Settings settings;
    settings.execution.devices = tested_device();
    Scene scene(settings);
    const auto shape = Shape::make(tetrahedron_mesh());
    for (std::uint32_t i = 0; i < 320; ++i) scene.add(shape, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {9.0 * i, 0, 0}});
    const auto launches = [&](std::uint32_t moving) {
        for (std::uint32_t i = 0; i < moving; ++i) {
            Pose pose = scene.pose({i});
            pose.translation.y += 0.5;
            scene.set_pose({i}, pose);
        }
        scene.find_contacts();
        return scene.stats().details.work[0].launches;
    };
    EXPECT_GT(launches(0), 0u);
    EXPECT_EQ(launches(0), 0u);
    for (int turn = 0; turn < 2; ++turn) {
        EXPECT_EQ(launches(19), 0u);
        EXPECT_EQ(launches(0), 0u);
        EXPECT_EQ(launches(19), 0u);
        EXPECT_GT(launches(20), 0u);
        EXPECT_GT(launches(320), 0u);
    }
}

TEST(scenes, have_one_hash_on_another_device) {
    expect_the_cpus_hash(tested_device());
}

// What comes near is found on each device, by the margin and on its way.
TEST(scenes, have_one_hash_with_speculative_contacts) {
    std::vector<Crowd> asked = crowds();
    asked.push_back(coarse_crowd());
    for (const Crowd& crowd : asked)
        for (const Features features : {Features::vertices, Features::edges}) {
            const auto hash = [&](Method method, const std::string& device) {
                return hash_of(crowd, method, Caster::bvh, device, Direction::reprojected, features, true);
            };
            const std::string expected = hash(Method::certified, "cpu");
            for (const std::string& device : {tested_device(), "cpu," + tested_device(), std::string("cpu")})
                EXPECT_EQ(hash(Method::standard, device), expected) << crowd.name << ", " << device;
            EXPECT_EQ(hash(Method::predictive, tested_device()), hash(Method::predictive, "cpu")) << crowd.name;
        }
}

// Weights are placed on the host, whichever device found the contact.
TEST(scenes, have_one_hash_with_weights) {
    for (const std::string& device : {tested_device(), "cpu," + tested_device()})
        for (const Crowd& crowd : crowds()) {
            const auto hash = [&](const std::string& on, Direction direction) {
                return hash_of(crowd, Method::standard, Caster::bvh, on, direction);
            };
            const std::string expected = hash("cpu", Direction::weighted);
            EXPECT_EQ(hash(device, Direction::weighted), expected) << crowd.name << ", " << device;
            EXPECT_EQ(expected == hash("cpu", Direction::ray), crowd.least_contacts == 0) << crowd.name;
        }
}

// Edges are asked on the host, of the vertices that the device found.
TEST(scenes, have_one_hash_with_edges) {
    const auto hash = [](const std::string& on, Method method, Features features) {
        return hash_of(coarse_crowd(), method, Caster::bvh, on, Direction::reprojected, features);
    };
    for (const Method method : {Method::standard, Method::iterative, Method::predictive, Method::certified}) {
        const std::string expected = hash("cpu", method, Features::edges);
        EXPECT_NE(expected, hash("cpu", method, Features::vertices)) << to_string(method);
        for (const std::string& device : {tested_device(), "cpu," + tested_device()})
            EXPECT_EQ(hash(device, method, Features::edges), expected) << to_string(method) << ", " << device;
    }
}

// Small bodies in large ones, in a cavity, and beside them; of one body only a part is inside. A device tells which
// pairs the host asks.
std::vector<Contact> contacts_of_nested(Method method, const std::string& device, bool prepared, bool speculative) {
    const auto joined = [](const Mesh& one, const Mesh& other) {
        Mesh both = one;
        both.vertices.insert(both.vertices.end(), other.vertices.begin(), other.vertices.end());
        const auto first = static_cast<std::uint32_t>(one.vertices.size());
        for (const auto& [a, b, c] : other.triangles) both.triangles.push_back({first + a, first + b, first + c});
        return both;
    };
    Mesh cavity = box_mesh({0.6, 0.6, 0.6});
    for (auto& triangle : cavity.triangles) std::swap(triangle[0], triangle[1]);
    const Mesh small = box_mesh({0.1, 0.05, 0.05});
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const Mesh& mesh : {joined(box_mesh({1, 1, 1}), cavity), grid_box_mesh(8), small,
                             joined(moved(small, {-9, 0, 0}), moved(small, {0.8, 0, 0}))})
        shapes.push_back(prepared ? prepared_shape(mesh) : Shape::make(mesh));
    Settings settings;
    settings.method = method;
    settings.features = Features::edges;
    settings.speculative = speculative ? Speculative::on : Speculative::off;
    settings.execution.devices = device;
    settings.execution.threads = 2;
    Scene scene(settings);
    Random random(41);
    scene.add(shapes[0]);
    Pose beside;
    beside.translation = {1.5, -0.5, -0.5};
    scene.add(shapes[1], beside);
    std::vector<Pose> poses;
    for (std::uint32_t i = 0; i < 40; ++i) {
        poses.push_back(i % 4 == 0 ? Pose{} : random.rotation());
        poses.back().translation =
            i % 4 == 0 ? Vec3{} : Vec3{random.uniform(-1.3, 2.8), random.uniform(-1, 1), random.uniform(-1, 1)};
        scene.add(shapes[i % 4 == 0 ? 3 : 2], poses.back());
    }
    std::vector<Contact> all;
    for (int step = 0; step < 6; ++step) {
        const std::span<const Contact> found = scene.find_contacts();
        all.insert(all.end(), found.begin(), found.end());
        for (std::uint32_t i = 0; i < poses.size(); ++i) {
            poses[i].translation = poses[i].translation + 0.1 * random.in_ball();
            scene.set_pose({i + 2}, poses[i]);
        }
    }
    return all;
}

TEST(scenes, have_the_cpus_bodies_inside_others) {
    for (const bool prepared : {true, false})
        for (const bool speculative : {false, true}) {
            const auto contacts = [&](Method method, const std::string& device) {
                return contacts_of_nested(method, device, prepared, speculative);
            };
            const std::vector<Contact> expected = contacts(Method::certified, "cpu");
            EXPECT_GT(
                std::ranges::count(expected, FeatureKind::inside, [](const Contact& c) { return c.feature.kind; }), 50);
            for (const std::string& device : {tested_device(), "cpu," + tested_device(), std::string("cpu")})
                EXPECT_TRUE(same(contacts(Method::standard, device), expected)) << device;
            EXPECT_TRUE(same(contacts(Method::predictive, tested_device()), contacts(Method::predictive, "cpu")));
        }
}

// Two devices, or parts of one: each with its own scene, at the same time, and both for one scene.
void expect_side_by_side(const std::string& one, const std::string& other) {
    const Crowd& crowd = crowds().front();
    const std::string expected = hash_of(crowd, Method::standard, Caster::bvh, "cpu");
    std::string a, b;
    std::thread thread([&] { a = hash_of(crowd, Method::standard, Caster::bvh, one); });
    b = hash_of(crowd, Method::standard, Caster::bvh, other);
    thread.join();
    EXPECT_EQ(a, expected) << one;
    EXPECT_EQ(b, expected) << other;
    expect_the_cpus_hash(one + "," + other);
}

TEST(scenes, have_one_hash_on_two_devices) {
    const std::vector<std::string> devices = opencl_devices();
    if (devices.size() < 2) GTEST_SKIP() << "one OpenCL device; POCL_DEVICES=\"pthread pthread\" makes two";
    expect_side_by_side(devices[0], devices[1]);
}

TEST(scenes, have_one_hash_on_parts_of_a_device) {
    if (!has_parts()) GTEST_SKIP() << "the driver does not divide the device";
    expect_side_by_side("opencl:0/0", "opencl:0/1");
}

TEST(scenes, have_one_hash_on_the_cpu_and_another_device) {
    expect_the_cpus_hash("cpu," + tested_device());
}

// Pairs that go from the CPU to another device and back have the contacts that they would have had.
TEST(parts, of_different_devices_hand_pairs_over) {
    const Crowd& crowd = crowds()[2];
    for (const Method method : {Method::standard, Method::iterative, Method::predictive}) {
        Settings settings;
        settings.method = method;
        Part whole(open_device("cpu", 1)), on_cpu(open_device("cpu", 1)), elsewhere(open_device(tested_device(), 1));
        std::vector<PlacedBody> bodies(crowd.bodies);
        std::vector<SlotPair> pairs;
        for (Part* part : {&whole, &on_cpu, &elsewhere})
            for (const auto& shape : crowd.shapes) part->shapes().add(shape);
        Random random(3);
        for (BodySlot i = 0; i < crowd.bodies; ++i) {
            bodies[i].shape = crowd.shapes[i % crowd.shapes.size()].get();
            bodies[i].shape_index = whole.shapes().index_of(bodies[i].shape);
            bodies[i].pose = random.rotation();
            bodies[i].pose.translation = crowd.spread * random.in_ball();
            bodies[i].centred = centred_pose(*bodies[i].shape, bodies[i].pose);
            for (BodySlot j = i + 1; j < crowd.bodies; ++j) pairs.emplace_back(i, j);
        }
        SlotChanges moved;
        ListedPairs all_pairs, cpu_pairs, their_pairs;
        std::vector<bool> is_elsewhere(pairs.size());
        std::size_t contacts = 0;
        for (int step = 0; step < 12; ++step) {
            std::vector<SlotPair> go, come, stay, away;
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                if (step > 0 && random.below(5) == 0) {
                    (is_elsewhere[i] ? come : go).push_back(pairs[i]);
                    is_elsewhere[i] = !is_elsewhere[i];
                }
                (is_elsewhere[i] ? away : stay).push_back(pairs[i]);
            }
            const PairList from_cpu = cpu_pairs.of(go), from_elsewhere = their_pairs.of(come);
            const auto going = on_cpu.export_state(bodies, from_cpu),
                       arriving = elsewhere.export_state(bodies, from_elsewhere);
            const Part::Pairs next_here = cpu_pairs.next(stay), next_there = their_pairs.next(away);
            elsewhere.import_state(bodies, their_pairs.of(from_cpu.pairs), going);
            on_cpu.import_state(bodies, cpu_pairs.of(from_elsewhere.pairs), arriving);
            for (PlacedBody& body : bodies) {
                body.pose.translation = body.pose.translation + crowd.speed * random.in_ball();
                body.centred = centred_pose(*body.shape, body.pose);
            }
            moved.forget(); // every body may have moved
            whole.begin(bodies, moved, all_pairs.next(pairs), settings);
            on_cpu.begin(bodies, moved, next_here, settings);
            elsewhere.begin(bodies, moved, next_there, settings);
            std::vector<Contact> expected, here, there;
            whole.end(expected);
            on_cpu.end(here);
            elsewhere.end(there);
            for (ListedPairs* list : {&all_pairs, &cpu_pairs, &their_pairs}) list->step_done();
            contacts += there.size();
            here.insert(here.end(), there.begin(), there.end());
            std::ranges::stable_sort(here, {}, [](const Contact& c) { return pair_of(c); });
            ASSERT_TRUE(same(here, expected)) << to_string(method) << ", step " << step;
        }
        EXPECT_GT(contacts, 100u);
    }
}

// Devices "auto": all pairs go to and fro.
TEST(scenes, have_the_cpus_contacts_on_a_device_that_is_tried) {
    for (const Method method : {Method::standard, Method::certified, Method::iterative, Method::predictive})
        for (const Features features : {Features::vertices, Features::edges})
            for (const bool speculative : {false, true})
                device_test::expect_the_cpus_contacts(
                    device_test::automatic(method, features, speculative),
                    [] { return std::optional(open_device(tested_device(), 1)); }, 1);
}

// ---- little or nothing

class Nothing : public testing::TestWithParam<Method> {
protected:
    static Settings settings(const std::string& device) {
        Settings settings;
        settings.method = GetParam();
        settings.execution.devices = device;
        return settings;
    }
};

TEST_P(Nothing, is_no_contact) {
    Scene scene(settings(tested_device()));
    EXPECT_EQ(scene.find_contacts().size(), 0u) << "no body";
    const auto shape = prepared_shape(tetrahedron_mesh());
    Pose far;
    far.translation = {100, 0, 0};
    scene.add(shape);
    EXPECT_EQ(scene.find_contacts().size(), 0u) << "one body";
    const BodyId other = scene.add(shape, far);
    EXPECT_EQ(scene.find_contacts().size(), 0u) << "no pair";
    const Pair pair{BodyId{0}, other};
    EXPECT_EQ(scene.find_contacts({&pair, 1}).size(), 0u) << "a pair out of reach";
    EXPECT_EQ(scene.find_contacts({&pair, 1}).size(), 0u) << "again";
    scene.set_pose(other, Pose{});
    const std::size_t touching = scene.find_contacts({&pair, 1}).size();
    scene.set_pose(other, far);
    EXPECT_EQ(scene.find_contacts({&pair, 1}).size(), 0u) << "gone, after " << touching;
    scene.remove(other);
    EXPECT_EQ(scene.find_contacts().size(), 0u);
}

// Their arrays of the grids that know an outside are empty.
TEST_P(Nothing, is_known_of_the_outside_of_open_meshes) {
    std::string hashes[2];
    for (int i = 0; i < 2; ++i) {
        Scene scene(settings(i == 0 ? "cpu" : tested_device()));
        const auto sheet = prepared_shape(sheet_mesh(6));
        Random random(5);
        for (int k = 0; k < 6; ++k) {
            Pose pose = random.rotation();
            pose.translation = 0.3 * random.in_ball();
            scene.add(sheet, pose);
        }
        ContactHash hash;
        for (std::uint32_t step = 0; step < 3; ++step) hash.add(step, scene.find_contacts());
        EXPECT_GT(scene.contacts().size(), 0u);
        hashes[i] = hash.hex();
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

// What speeds up steps reaches the device's arrays between two steps, in the middle of a scene.
TEST(Prepared, in_the_middle_of_a_scene) {
    for (const Method method : {Method::standard, Method::certified}) {
        std::string hashes[3];
        for (int i = 0; i < 3; ++i) {
            std::vector<std::shared_ptr<const Shape>> shapes;
            for (const Mesh& mesh : {bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh()})
                shapes.push_back(i == 0 ? prepared_shape(mesh) : Shape::make(mesh));
            Settings settings;
            settings.method = method;
            settings.execution.devices = i == 2 ? "cpu," + tested_device() : i == 1 ? tested_device() : "cpu";
            Scene scene(settings);
            Random random(8);
            std::vector<Pose> poses;
            for (std::uint32_t k = 0; k < 10; ++k) {
                poses.push_back(random.rotation());
                poses.back().translation = random.in_ball();
                scene.add(shapes[k % 3], poses.back());
            }
            ContactHash hash;
            for (std::uint32_t step = 0; step < 12; ++step) {
                if (step == 4) shapes[0]->prepare();
                if (step == 8) scene.prepare();
                for (std::uint32_t k = 0; k < 10; ++k) {
                    poses[k].translation = poses[k].translation + 0.01 * random.in_ball();
                    scene.set_pose({k}, poses[k]);
                }
                hash.add(step, scene.find_contacts());
            }
            EXPECT_GT(scene.contacts().size(), 20u);
            hashes[i] = hash.hex();
        }
        EXPECT_EQ(hashes[0], hashes[1]) << to_string(method);
        EXPECT_EQ(hashes[0], hashes[2]) << to_string(method);
    }
}

INSTANTIATE_TEST_SUITE_P(methods, Nothing,
                         testing::Values(Method::standard, Method::iterative, Method::predictive, Method::certified),
                         [](const auto& method) { return std::string(to_string(method.param)); });

} // namespace
