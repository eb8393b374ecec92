// SPDX-License-Identifier: Apache-2.0
#include "world_recorder.h"

#include <raycontact/error.h>
#ifdef RAYCONTACT_RECORDING
#include <raycontact/recorder.h>
#endif

namespace raycontact::bullet {

#ifdef RAYCONTACT_RECORDING

struct WorldRecorder::State {
    Recorder recorder;
};

WorldRecorder::WorldRecorder(const std::filesystem::path& file, const Scene& scene, const RecorderOptions* options)
    : state_(std::make_unique<State>(State{Recorder(file, scene, options ? *options : RecorderOptions{})})) {}
void WorldRecorder::step() {
    state_->recorder.record();
}
void WorldRecorder::finish() {
    state_->recorder.finish();
}

#else

struct WorldRecorder::State {};

WorldRecorder::WorldRecorder(const std::filesystem::path& file, const Scene&, const RecorderOptions*) {
    throw InputError(file.string()
                     + ": this RayContact was built without recordings; configure it with "
                       "-DRAYCONTACT_RECORDING=ON");
}
void WorldRecorder::step() {}
void WorldRecorder::finish() {}

#endif

WorldRecorder::~WorldRecorder() = default;

} // namespace raycontact::bullet
