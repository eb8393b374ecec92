// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>

#include <mutex>
#include <stdexcept>

namespace raycontact::python {

/// A scene that only one thread of Python enters at a time: a step runs without the GIL, and a scene is not
/// thread-safe. A second thread gets a RuntimeError at once.
class GuardedScene {
public:
    explicit GuardedScene(const Settings& settings) : scene_(settings) {}

    /// The scene, for as long as this lives.
    class Entry {
    public:
        explicit Entry(GuardedScene& guarded) : lock_(guarded.mutex_, std::try_to_lock), scene_(guarded.scene_) {
            if (!lock_)
                throw std::runtime_error(
                    "the scene is in use by another thread; use one scene for each thread, or a lock");
        }
        Scene* operator->() const { return &scene_; }
        Scene& operator*() const { return scene_; }

    private:
        std::unique_lock<std::mutex> lock_;
        Scene& scene_;
    };
    Entry enter() { return Entry(*this); }

private:
    std::mutex mutex_;
    Scene scene_;
};

} // namespace raycontact::python
