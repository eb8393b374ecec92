// SPDX-License-Identifier: Apache-2.0
#include <raycontact/collide.h>
#include <raycontact/scene.h>

#include "reference/meshes.h"

#include <gtest/gtest.h>

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

TEST(Settings, MoreThreadsThanAnyoneNeedsAreRefused) {
    constexpr std::uint32_t too_many = 1025;
    const Mesh mesh = reference::box_mesh({0.5, 0.5, 0.5});
    EXPECT_THROW(prepare_mesh(mesh, Repair::allowed, Nesting::as_wound, Check::full, too_many), InputError);
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
