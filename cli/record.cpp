// SPDX-License-Identifier: Apache-2.0
#include "cli/record.h"

#include <raycontact/recorder.h>

#include <fmt/format.h>

#include <iostream>
#include <stdexcept>
#include <utility>

using namespace raycontact;

struct RunRecorder::State {
    output::OutFile file;
    Recorder recorder;
    bool kept = false;
    State(output::OutFile f, const scenes::Simulation& scene, const RecorderOptions& options)
        : file(std::move(f)), recorder(file.part(), scene.scene(), options) {}
    ~State() {
        if (!kept && recorder.steps() > 0) file.leave();
    }
};

RunRecorder::RunRecorder(std::optional<output::OutFile> file, const scenes::Simulation& scene) {
    if (!file) return;
    const scenes::RunLog& log = scene.log();
    const RecorderOptions options{log.scene, log.dt, log.seed, log.mesh_source, scene.body_count()};
    state_ = std::make_unique<State>(std::move(*file), scene, options);
}

RunRecorder::~RunRecorder() = default;

void RunRecorder::give_up(const std::string& why) {
    error_ = why + "; the steps until then are in " + state_->file.part().string();
    state_.reset();
}

void RunRecorder::step() {
    if (!state_) return;
    try {
        state_->recorder.record();
    } catch (const std::runtime_error& error) {
        give_up(error.what());
        std::cerr << "the run goes on without its recording: " << error_ << '\n';
    }
}

void RunRecorder::finish(bool cut_short) {
    if (!state_) return;
    Recorder& recorder = state_->recorder;
    try {
        recorder.finish();
        const auto kept = state_->file.keep(cut_short && state_->file.is_there());
        state_->kept = true;
        std::cerr << fmt::format("recording: {}, {:.1f} MB; writing took {:.2f} ms a step and {:.2f} s at the end\n",
                                 kept.string(), static_cast<double>(recorder.bytes()) / 1e6,
                                 1000 * recorder.seconds() / recorder.steps(), recorder.finish_seconds());
    } catch (const std::runtime_error& error) {
        give_up(error.what());
    }
}
