// SPDX-License-Identifier: Apache-2.0
#include "cli/record.h"

#include <recording/writer.h>

#include <fmt/format.h>

#include <iostream>

using namespace raycontact;

struct Recorder::State {
    State(const std::string& f, const scenes::Simulation& s, const recording::Info& info)
        : file(f), scene(s), writer(f, info) {}

    std::string file;
    const scenes::Simulation& scene;
    std::size_t bodies = 0; ///< recorded so far
    recording::Writer writer;
};

Recorder::Recorder(const std::string& file, const scenes::Simulation& scene) {
    if (file.empty()) return;
    const scenes::RunLog& log = scene.log();
    recording::Info info;
    info.scene = log.scene;
    info.seed = log.seed;
    info.bodies = scene.body_count();
    info.dt = log.dt;
    info.settings = scene.description().settings;
    info.mesh_source = log.mesh_source;
    state_ = std::make_unique<State>(file, scene, info);
    for (const auto& shape : log.shapes) state_->writer.add_shape(*shape);
}

Recorder::~Recorder() = default;

void Recorder::step() {
    if (!state_) return;
    const auto& shapes = state_->scene.log().body_shape;
    for (; state_->bodies < shapes.size(); ++state_->bodies) state_->writer.add_body(shapes[state_->bodies]);
    state_->writer.step(state_->scene.scene());
}

void Recorder::finish() {
    if (!state_) return;
    recording::Writer& writer = state_->writer;
    writer.finish(state_->scene.hash());
    std::cerr << fmt::format("recording: {}, {:.1f} MB; writing took {:.2f} ms a step and {:.2f} s at the end\n",
                             state_->file, static_cast<double>(writer.bytes()) / 1e6,
                             1000 * writer.seconds() / writer.steps(), writer.finish_seconds());
}
