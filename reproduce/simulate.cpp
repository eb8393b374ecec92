// SPDX-License-Identifier: Apache-2.0
#include <reproduce/experiments.h>

#include <raycontact/error.h>
#include <recording/writer.h>
#include <report/image.h>
#include <report/render.h>
#include <scenes/avalanche.h>

#include <optional>

namespace raycontact::reproduce {

namespace {

constexpr std::uint64_t small_animation = std::uint64_t{4} << 20; // recordings are kept to be followed, not looked at
constexpr int jpeg_quality = 88;

scenes::AvalancheOptions described(const SimulationOptions& options) {
    if (options.scene != "avalanche") throw InputError("scene " + options.scene + " is not there yet");
    scenes::AvalancheOptions how;
    how.bodies = options.size.bodies;
    how.seed = options.seed;
    how.settings = options.settings;
    how.expected_steps = options.size.steps;
    how.frames = 2;
    if (options.one_manifold) how.manifolds = {btScalar(-1), btScalar(1e9), 0};
    return how;
}

std::unique_ptr<recording::Writer> writer_for(const std::filesystem::path& file, const scenes::RunLog& log,
                                              const SimulationOptions& options) {
    recording::Info info;
    info.scene = log.scene;
    info.seed = options.seed;
    info.bodies = options.size.bodies;
    info.dt = log.dt;
    info.settings = options.settings;
    info.mesh_source = log.mesh_source;
    recording::WriterOptions how;
    how.animation_bytes = small_animation;
    auto writer = std::make_unique<recording::Writer>(file, info, how);
    for (const auto& shape : log.shapes) writer->add_shape(*shape);
    for (const std::uint32_t shape : log.body_shape) writer->add_body(shape);
    return writer;
}

std::string picture(const scenes::RunLog& log, std::uint32_t width) {
    const report::Renderer renderer(log);
    return report::base64(report::encode_jpeg(renderer.render(log.frames.back(), width, width * 9 / 16), jpeg_quality));
}

} // namespace

std::vector<std::string> scene_names() {
    return {"avalanche"};
}

Json simulate(const SimulationOptions& options, const std::filesystem::path& recording, std::uint32_t picture_width,
              const Tick& tick) {
    scenes::Avalanche scene(described(options));
    const scenes::RunLog& log = scene.log();
    std::unique_ptr<recording::Writer> writer;
    if (!recording.empty()) writer = writer_for(recording, log, options);
    Json result{{"pairs", Json::array()},
                {"contacts", Json::array()},
                {"ray_length", Json::array()},
                {"depth_length", Json::array()}};
    for (std::uint32_t i = 0; i < options.size.steps; ++i) {
        scene.step();
        if (writer) writer->step(scene.scene());
        double depth = 0;
        for (const Contact& contact : scene.contacts()) depth += static_cast<double>(contact.depth);
        result["pairs"].push_back(scene.stats().pairs);
        result["contacts"].push_back(scene.stats().contacts);
        result["ray_length"].push_back(scene.stats().ray_length);
        result["depth_length"].push_back(depth);
        tick(Workshop::cost(options) / options.size.steps);
    }
    if (writer) writer->finish(scene.hash());
    std::uint64_t triangles = 0;
    for (std::size_t i = 0; i < log.body_shape.size(); ++i)
        if (log.body_moves[i]) triangles += log.shapes[log.body_shape[i]]->triangles().size();
    result["triangles"] = triangles;
    result["mesh_source"] = log.mesh_source;
    result["hash"] = scene.hash();
    if (picture_width > 0) result["picture"] = picture(log, picture_width);
    return result;
}

} // namespace raycontact::reproduce
