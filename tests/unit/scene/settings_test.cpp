// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>
#include <raycontact/scene.h>

#include "reference/meshes.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace raycontact {
namespace {

void expect_refused(const Settings& settings, const std::string& name) {
    try {
        check_settings(settings);
        ADD_FAILURE() << name << " was taken";
    } catch (const InputError& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with(name)) << error.what();
    }
    EXPECT_THROW(Scene{settings}, InputError);
}

TEST(Settings, ValuesThatAnEnumerationDoesNotHaveAreRefused) {
    Settings settings;
    settings.method = static_cast<Method>(77);
    expect_refused(settings, "method");
    settings = {};
    settings.paper.caster = static_cast<Caster>(9);
    expect_refused(settings, "caster");
    settings = {};
    settings.direction = static_cast<Direction>(-1);
    expect_refused(settings, "direction");
    settings = {};
    settings.features = static_cast<Features>(2);
    expect_refused(settings, "features");
    settings = {};
    settings.execution.schedule = static_cast<Schedule>(3);
    expect_refused(settings, "schedule");
    const auto box = Shape::make(reference::box_mesh({0.5, 0.5, 0.5}));
    EXPECT_THROW(collide(*box, {}, *box, {}, {.direction = static_cast<Direction>(9)}), InputError);
}

/// Each length of the settings by its name.
struct Length {
    const char* name;
    void (*set)(Settings&, double);
};
constexpr Length lengths[] = {
    {"displacement_threshold", [](Settings& s, double x) { s.paper.displacement_threshold = x; }},
    {"culling_distance", [](Settings& s, double x) { s.paper.culling_distance = x; }},
    {"distance_extension", [](Settings& s, double x) { s.paper.distance_extension = x; }},
    {"speculative_margin", [](Settings& s, double x) { s.speculative_margin = x; }}};

TEST(Settings, LengthsThatFloatsCannotSquareAreRefused) {
    for (const auto& [name, set] : lengths)
        for (const double bad : {-1e-300, 1.1e12, 1e30, 1e308, std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::quiet_NaN()}) {
            Settings settings;
            set(settings, bad);
            expect_refused(settings, name);
        }
    for (const double bad : {0.99, 1.1e6, 1e300, std::numeric_limits<double>::infinity()}) {
        Settings settings;
        settings.paper.confidence = bad;
        expect_refused(settings, "confidence");
    }
}

TEST(Settings, TheLargestAndSmallestLengthsFindTheSameContacts) {
    const auto box = Shape::make(reference::box_mesh({0.5, 0.5, 0.5}));
    const auto touching = [&](const Settings& settings) {
        Scene scene(settings);
        scene.add(box);
        const BodyId moved = scene.add(box, {.translation = {0.9, 0.03, 0.02}});
        scene.add(box, {.translation = {40, 0, 0}});
        std::size_t found = 0;
        for (int step = 0; step < 4; ++step) {
            scene.set_pose(moved, {.translation = {0.9 - 0.01 * step, 0.03, 0.02}});
            scene.find_contacts();
            found = scene.stats().contacts;
        }
        return found;
    };
    const std::size_t expected = touching({});
    ASSERT_GT(expected, 0u);
    for (const Method method : {Method::standard, Method::certified, Method::iterative, Method::predictive})
        for (const auto& [name, set] : lengths)
            for (const double length : {0.0, 1e-300, 1e-30, 1e6, 1e12}) {
                Settings settings;
                settings.method = method;
                settings.speculative = Speculative::on;
                settings.paper.confidence = length > 1 ? 1e6 : 1;
                set(settings, length);
                const std::size_t found = touching(settings);
                if (method == Method::standard || method == Method::certified) {
                    EXPECT_EQ(found, expected) << name << " " << length;
                }
            }
}

TEST(Settings, MoreThreadsThanAnyoneNeedsAreRefused) {
    constexpr std::uint32_t too_many = 1025;
    const Mesh mesh = reference::box_mesh({0.5, 0.5, 0.5});
    EXPECT_THROW(prepare_mesh(mesh, {.threads = too_many}), InputError);
    EXPECT_THROW(Shape::make(mesh, too_many), InputError);
    const auto box = Shape::make(mesh);
    EXPECT_THROW(box->prepare(too_many), InputError);
    EXPECT_THROW(collide(*box, {}, *box, {}, {.threads = too_many}), InputError);
    Settings settings;
    settings.execution.threads = too_many;
    EXPECT_THROW(Scene{settings}, InputError);
}

} // namespace
} // namespace raycontact
