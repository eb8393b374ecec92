// SPDX-License-Identifier: Apache-2.0
// What Scene tells of predictions and of devices agrees with what it counts, on one device and on two.
#include "property/crowds.h"

#include <raycontact/error.h>
#include <raycontact/scene.h>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <tuple>

namespace raycontact::reference {
namespace {

template <class T>
auto key_of(const T& c) {
    return std::tuple(c.body_a, c.body_b, c.feature.source, c.feature.source_index());
}

double distance(const Vec3& a, const Vec3& b) {
    return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

// A crowd that drifts.
struct Drifting {
    Drifting(const std::string& devices, Method method) : scene(settings_of(devices, method)) {
        std::vector<std::shared_ptr<const Shape>> shapes;
        for (int i = 0; i < 3; ++i)
            for (const auto& shape : crowd_shapes(Kind::concave, 1)) shapes.push_back(shape);
        const std::vector<Pose> homes = touching_poses(shapes, 0.9, random);
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            movers.emplace_back(Course::drift, homes[i], 1.0, random);
            bodies.push_back(scene.add(shapes[i], homes[i]));
        }
    }
    static Settings settings_of(const std::string& devices, Method method) {
        Settings settings;
        settings.features = Features::vertices;
        settings.method = method;
        settings.execution.devices = devices;
        return settings;
    }
    void step() {
        for (std::size_t i = 0; i < bodies.size(); ++i) scene.set_pose(bodies[i], movers[i].next(random));
        scene.find_contacts();
    }

    Scene scene;
    Random random{7};
    std::vector<Mover> movers;
    std::vector<BodyId> bodies;
};

// Returns all predictions, step by step.
std::vector<std::vector<Prediction>> predictions_of(const std::string& devices, Method method, std::uint64_t& counted) {
    Drifting crowd(devices, method);
    Scene& scene = crowd.scene;
    std::vector<std::vector<Prediction>> found;
    for (int step = 0; step < 20; ++step) {
        crowd.step();
        found.push_back(scene.predictions());
        EXPECT_EQ(found.back().size(), scene.stats().details.predictions) << "step " << step;
        counted += scene.stats().details.predictions;
        for (const Prediction& p : found.back()) {
            EXPECT_FALSE(std::ranges::binary_search(scene.contacts(), key_of(p), {}, key_of<Contact>));
            const BodyId source = p.feature.source == Side::a ? p.body_a : p.body_b;
            EXPECT_LT(distance(p.point, scene.pose(source).translation), 1e-9 + scene.shape(source).radius());
        }
        for (std::size_t i = 0; i < scene.pairs().size(); ++i)
            EXPECT_LT(scene.device_of_pair(i), scene.stats().details.work.size());
        EXPECT_THROW(static_cast<void>(scene.device_of_pair(scene.pairs().size())), InputError);
    }
    return found;
}

bool same(const Prediction& p, const Prediction& q) {
    return key_of(p) == key_of(q) && p.feature.other_index() == q.feature.other_index()
           && distance(p.point, q.point) == 0 && distance(p.ahead, q.ahead) == 0;
}

// Without the grids, and with a threshold that every motion exceeds: the paper's rays, all of them, in every step.
TEST(EveryRay, IsCastIfNoneIsKnownToBeOutside) {
    for (const Method method : {Method::iterative, Method::predictive})
        for (const Caster caster : {Caster::basic, Caster::bvh}) {
            Settings settings;
            settings.features = Features::vertices;
            settings.method = method;
            settings.paper.caster = caster;
            settings.paper.displacement_threshold = 0;
            settings.paper.culling_distance = settings.paper.distance_extension = 0.05;
            settings.paper.skip_outside = false;
            Scene scene(settings);
            settings.method = Method::standard;
            Scene standard(settings);
            std::vector<std::shared_ptr<const Shape>> shapes = crowd_shapes(Kind::concave, 1);
            Random random(11);
            const std::vector<Pose> homes = touching_poses(shapes, 0.9, random);
            std::vector<Mover> movers;
            for (std::size_t i = 0; i < shapes.size(); ++i) {
                movers.emplace_back(Course::drift, homes[i], 1.0, random);
                scene.add(shapes[i], homes[i]);
                standard.add(shapes[i], homes[i]);
            }
            std::uint64_t rays = 0;
            for (int step = 0; step < 10; ++step) {
                for (std::size_t i = 0; i < shapes.size(); ++i) {
                    const Pose pose = movers[i].next(random);
                    scene.set_pose({static_cast<std::uint32_t>(i)}, pose);
                    standard.set_pose({static_cast<std::uint32_t>(i)}, pose);
                }
                scene.find_contacts();
                standard.find_contacts();
                EXPECT_EQ(scene.stats().details.rays_cast, scene.stats().details.rays)
                    << to_string(method) << " step " << step;
                EXPECT_TRUE(
                    std::ranges::equal(scene.contacts(), standard.contacts(), {}, key_of<Contact>, key_of<Contact>));
                if (method == Method::iterative) {
                    EXPECT_EQ(scene.stats().details.rays, standard.stats().details.rays);
                } else {
                    EXPECT_GT(scene.stats().details.rays, standard.stats().details.rays);
                }
                rays += scene.stats().details.rays_cast;
            }
            EXPECT_GT(rays, 50u);
        }
}

TEST(Predictions, AreThoseThatAreCounted) {
    std::uint64_t counted = 0;
    predictions_of("cpu", Method::predictive, counted);
    EXPECT_GT(counted, 50u);
}

// Those of its pairs are gone, whatever the device.
TEST(Predictions, LeaveOutABodyThatIsRemoved) {
    std::size_t counts[2] = {};
    for (const bool two : {false, true}) {
        Drifting crowd(two ? "cpu/0,cpu/1" : "cpu", Method::predictive);
        std::vector<Prediction> before;
        while (before.empty()) {
            crowd.step();
            before = crowd.scene.predictions();
        }
        const BodyId body = before.front().body_a;
        crowd.scene.remove(body);
        std::erase_if(before, [&](const Prediction& p) { return p.body_a == body || p.body_b == body; });
        const std::vector<Prediction> left = crowd.scene.predictions();
        EXPECT_TRUE(std::ranges::equal(left, before, {}, key_of<Prediction>, key_of<Prediction>));
        counts[two ? 1 : 0] = left.size();
    }
    EXPECT_EQ(counts[0], counts[1]);
}

TEST(Predictions, AreTheSameOnTwoDevices) {
    std::uint64_t counted = 0;
    const auto one = predictions_of("cpu", Method::predictive, counted);
    const auto two = predictions_of("cpu/0,cpu/1", Method::predictive, counted);
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(std::ranges::equal(one[i], two[i], same)) << "step " << i;
}

TEST(Predictions, OtherMethodsHaveNone) {
    for (const Method method : {Method::standard, Method::iterative, Method::certified}) {
        std::uint64_t counted = 0;
        for (const auto& step : predictions_of("cpu", method, counted)) EXPECT_TRUE(step.empty()) << to_string(method);
    }
}

} // namespace
} // namespace raycontact::reference
