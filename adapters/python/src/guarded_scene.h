// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>

#include <atomic>
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
        explicit Entry(GuardedScene& guarded) : guarded_(guarded) {
            if (guarded_.in_use_.test_and_set())
                throw std::runtime_error(
                    "the scene is in use: by another thread (use one scene for each thread, or a "
                    "lock), by its own pair filter, or a step was under way when this process was forked");
        }
        ~Entry() { guarded_.in_use_.clear(); }
        Entry(const Entry&) = delete;
        Entry& operator=(const Entry&) = delete;
        Scene* operator->() const { return &guarded_.scene_; }
        Scene& operator*() const { return guarded_.scene_; }

    private:
        GuardedScene& guarded_;
    };
    Entry enter() { return Entry(*this); }

private:
    std::atomic_flag in_use_;
    Scene scene_;
};

} // namespace raycontact::python
