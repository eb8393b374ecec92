// SPDX-License-Identifier: Apache-2.0
#include <scenes/rain.h>

#include <raycontact/error.h>
#include <scenes/models/simplify.h>
#include <scenes/simulation.h>

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

namespace raycontact::scenes {
namespace {

RainOptions without_package() {
    RainOptions o;
    o.model = "sphere"; // procedural: no package needed
    return o;
}

TEST(Rain, IsThePapersScene) {
    const SceneDescription scene = rain(without_package());
    EXPECT_EQ(scene.steps * scene.dt, 50);
    std::map<std::uint64_t, std::uint32_t> bodies_of; // by triangles
    std::uint64_t triangles = 0;
    for (const BodyStart& body : scene.bodies) {
        if (body.density == 0) continue;
        const std::uint64_t count = scene.shapes[body.shape].shape->triangles().size();
        ++bodies_of[count];
        triangles += count;
    }
    EXPECT_EQ(bodies_of, (std::map<std::uint64_t, std::uint32_t>{{902, 125}, {2130, 125}, {3456, 125}, {3458, 125}}));
    EXPECT_EQ(triangles, 1'243'250u); // "approximately 1.2 million"
}

TEST(Rain, FourSoundShapesOfOneMetre) {
    const SceneDescription scene = rain(without_package());
    ASSERT_EQ(scene.shapes.size(), 5u); // with the slab
    std::set<double> volumes;
    for (const BodyStart& body : scene.bodies) {
        if (body.density == 0) continue;
        const Shape& shape = *scene.shapes[body.shape].shape;
        const MeshReport& report = shape.report();
        EXPECT_TRUE(sound(report)) << shape.name();
        EXPECT_LT(report.volume, 0.7 * (report.box_max.x - report.box_min.x) * (report.box_max.y - report.box_min.y)
                                     * (report.box_max.z - report.box_min.z));
        const double extent = std::max({report.box_max.x - report.box_min.x, report.box_max.y - report.box_min.y,
                                        report.box_max.z - report.box_min.z});
        EXPECT_NEAR(extent, 1, 1e-6) << shape.name();
        volumes.insert(report.volume);
        if (volumes.size() == 4) break;
    }
    EXPECT_EQ(volumes.size(), 4u) << "one shape at several resolutions";
}

TEST(Rain, TenASecondFromACircle) {
    constexpr double radius = 2.5, height = 7;
    const SceneDescription scene = rain(without_package());
    std::vector<BodyStart> moving;
    for (const BodyStart& body : scene.bodies)
        if (body.density > 0) moving.push_back(body);
    ASSERT_EQ(moving.size(), 500u);
    double least_x = 0, least_y = 0;
    for (std::size_t k = 0; k < moving.size(); ++k) {
        EXPECT_EQ(moving[k].step, 6 * k);
        EXPECT_EQ(moving[k].shape, moving[k % 4].shape);
        const btVector3& p = moving[k].pose.getOrigin();
        EXPECT_NEAR(std::hypot(double(p.x()), double(p.y())), radius, 1e-5);
        EXPECT_NEAR(double(p.z()), height, 1e-5);
        least_x = std::min(least_x, double(p.x()));
        least_y = std::min(least_y, double(p.y()));
        if (k > 0) { // the last one is out of the way
            EXPECT_GT((p - moving[k - 1].pose.getOrigin()).length(), btScalar(1.1));
        }
    }
    EXPECT_NEAR(least_x, -radius, 0.1); // all the way round
    EXPECT_NEAR(least_y, -radius, 0.1);
}

TEST(Rain, BodiesComeAsTheyAreDue) {
    RainOptions o = without_package();
    o.steps = 100;
    Simulation scene(rain(o));
    EXPECT_EQ(scene.body_count(), 17u); // in steps 0, 6, ... 96
    for (std::uint32_t step = 0; step < 100; ++step) {
        scene.step();
        ASSERT_EQ(scene.scene().body_count(), 2 + step / 6); // with the ground
    }
    EXPECT_FALSE(scene.contacts().empty()); // the first has landed
    EXPECT_EQ(scene.health().below_ground, 0u);
    EXPECT_EQ(scene.health().flown_off, 0u);
    const RunLog& log = scene.log();
    ASSERT_EQ(log.frames.size(), 8u);
    EXPECT_EQ(log.frames.front().poses.size(), 2u);
    EXPECT_EQ(log.frames.back().poses.size(), 18u);
    EXPECT_EQ(log.body_shape.size(), 18u);
}

TEST(Rain, SameSeedSameHash) {
    RainOptions o = without_package();
    o.steps = 150;
    const auto hash_of = [](const RainOptions& options) {
        Simulation scene(rain(options));
        std::uint64_t contacts = 0;
        for (std::uint32_t i = 0; i < options.steps; ++i) {
            scene.step();
            contacts += scene.stats().contacts;
        }
        EXPECT_GT(contacts, 300u);
        return scene.hash();
    };
    o.settings.execution.threads = 1;
    const std::string hash = hash_of(o);
    for (const std::uint32_t threads : {1u, 2u, 5u}) {
        o.settings.execution.threads = threads;
        EXPECT_EQ(hash_of(o), hash) << threads;
    }
    o.settings.method = Method::standard;
    o.settings.paper.caster = Caster::basic;
    EXPECT_EQ(hash_of(o), hash);
    o.seed = 2;
    EXPECT_NE(hash_of(o), hash);
}

TEST(Rain, RefusesAModelThatIsNotKnown) {
    RainOptions o = without_package();
    o.model = "teapot";
    EXPECT_THROW(rain(o), InputError);
}

} // namespace
} // namespace raycontact::scenes
