// SPDX-License-Identifier: Apache-2.0
#include "cli/record.h"

#include <fmt/format.h>

#include <iostream>
#include <stdexcept>
#include <utility>

using namespace raycontact;

RunRecorder::RunRecorder(std::optional<output::OutFile> file, const scenes::Simulation& scene)
    : file_(std::move(file)) {
    if (!file_) return;
    const scenes::RunLog& log = scene.log();
    const RecorderOptions options{log.scene, log.dt, log.seed, log.mesh_source, scene.body_count()};
    recorder_.emplace(file_->part(), scene.scene(), options);
}

RunRecorder::~RunRecorder() {
    if (recorder_ && recorder_->steps() > 0) file_->leave();
}

void RunRecorder::give_up(const std::string& why) {
    error_ = why + "; the steps until then are in " + file_->part().string();
    if (recorder_->steps() > 0) file_->leave();
    recorder_.reset();
}

void RunRecorder::step() {
    if (!recorder_) return;
    try {
        recorder_->record();
    } catch (const std::runtime_error& error) {
        give_up(error.what());
        std::cerr << "the run goes on without its recording: " << error_ << '\n';
    }
}

void RunRecorder::finish(bool cut_short) {
    if (!recorder_) return;
    try {
        recorder_->finish();
        const auto kept = file_->keep(cut_short && file_->is_there());
        std::cerr << fmt::format("recording: {}, {:.1f} MB; writing took {:.2f} ms a step and {:.2f} s at the end\n",
                                 kept.string(), static_cast<double>(recorder_->bytes()) / 1e6,
                                 1000 * recorder_->seconds() / recorder_->steps(), recorder_->finish_seconds());
        recorder_.reset();
    } catch (const std::runtime_error& error) {
        give_up(error.what());
    }
}
