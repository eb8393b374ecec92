// SPDX-License-Identifier: Apache-2.0
#include "cli/record.h"

#include <raycontact/recorder.h>

#include <fmt/format.h>

#include <iostream>

using namespace raycontact;

struct RunRecorder::State {
    std::string file;
    Recorder recorder;
};

RunRecorder::RunRecorder(const std::string& file, const scenes::Simulation& scene) {
    if (file.empty()) return;
    const scenes::RunLog& log = scene.log();
    const RecorderOptions options{log.scene, log.dt, log.seed, log.mesh_source, scene.body_count()};
    state_ = std::make_unique<State>(State{file, Recorder(file, scene.scene(), options)});
}

RunRecorder::~RunRecorder() = default;

void RunRecorder::step() {
    if (state_) state_->recorder.step();
}

void RunRecorder::finish() {
    if (!state_) return;
    Recorder& recorder = state_->recorder;
    recorder.finish();
    std::cerr << fmt::format("recording: {}, {:.1f} MB; writing took {:.2f} ms a step and {:.2f} s at the end\n",
                             state_->file, static_cast<double>(recorder.bytes()) / 1e6,
                             1000 * recorder.seconds() / recorder.steps(), recorder.finish_seconds());
}
