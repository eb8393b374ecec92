// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>

#include <filesystem>
#include <memory>

namespace raycontact {
struct RecorderOptions;
}

namespace raycontact::bullet {

/// A Recorder where raycontact::recording is built; elsewhere one cannot be made.
class WorldRecorder {
public:
    /// options null: its own. Throws InputError as Recorder does, and where recordings are not built.
    WorldRecorder(const std::filesystem::path& file, const Scene& scene, const RecorderOptions* options);
    ~WorldRecorder();
    WorldRecorder(const WorldRecorder&) = delete;
    WorldRecorder& operator=(const WorldRecorder&) = delete;

    void step();
    void finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact::bullet
