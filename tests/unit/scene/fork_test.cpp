// SPDX-License-Identifier: Apache-2.0
// A child made by fork() has the scene, but none of the threads that its parent made for it.
#include <raycontact/scene.h>

#include "property/shapes.h"
#include "scenes/models/model.h"

#include <gtest/gtest.h>

// ThreadSanitizer does not let such a child make threads.
#if defined(__linux__) && !defined(__SANITIZE_THREAD__)
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace raycontact {
namespace {

/// Enough pairs for several threads.
struct Crowd {
    explicit Crowd(const std::string& devices) {
        Settings settings;
        settings.execution.devices = devices;
        settings.execution.threads = devices == "cpu" ? 2 : 0;
        scene = std::make_unique<Scene>(settings);
        const auto shape = Shape::make(scenes::scene_model("knot", 300).mesh);
        for (int i = 0; i < 300; ++i) scene->add(shape, {.translation = {0.4 * i, 0, 0}});
        for (int step = 0; step < 3; ++step) scene->find_contacts(); // shapes are wanted prepared from the second on
    }
    std::unique_ptr<Scene> scene;
};

bool same(std::span<const Contact> a, std::span<const Contact> b) {
    return std::ranges::equal(a, b, [](const Contact& x, const Contact& y) {
        return x.body_a == y.body_a && x.body_b == y.body_b && x.feature == y.feature && x.depth == y.depth;
    });
}

/// The child's exit status; it is killed after a minute.
template <typename Work>
int in_child(Work&& work) {
    const pid_t child = fork();
    if (child == 0) {
        alarm(60);
        _exit(work());
    }
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

TEST(Fork, AChildStepsItsParentsSceneAndEndsIt) {
    for (const char* devices : {"cpu", "cpu/0,cpu/1"}) {
        Crowd crowd(devices);
        const auto expected = crowd.scene->shared_contacts();
        ASSERT_GT(expected->size(), 0u);
        EXPECT_EQ(in_child([&] {
                      const bool found = same(crowd.scene->find_contacts(), *expected);
                      crowd.scene.reset();
                      return found ? 0 : 1;
                  }),
                  0)
            << devices;
        EXPECT_TRUE(same(crowd.scene->find_contacts(), *expected)) << "the parent goes on";
    }
}

TEST(Fork, AChildMakesScenesOfItsOwn) {
    const Crowd parents("cpu");
    const auto expected = parents.scene->shared_contacts();
    EXPECT_EQ(in_child([&] {
                  const Crowd own("cpu");
                  return same(own.scene->contacts(), *expected) ? 0 : 1;
              }),
              0);
}

TEST(Fork, AChildPreparesAShapeThatItsParentWasPreparing) {
    const auto shape = Shape::make(scenes::scene_model("knot", 20'000).mesh);
    const std::jthread parents([&] { shape->prepare(1); });
    std::this_thread::sleep_for(std::chrono::milliseconds(20)); // it is likely to be at it
    EXPECT_EQ(in_child([&] {
                  shape->prepare(1);
                  return shape->is_prepared() ? 0 : 1;
              }),
              0);
}

} // namespace
} // namespace raycontact
#endif
