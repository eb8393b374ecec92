// SPDX-License-Identifier: Apache-2.0
#include <reproduce/experiments.h>
#include <reproduce/pair_lengths.h>

#include <recording/writer.h>
#include <scenes/avalanche.h>
#include <scenes/rain.h>
#include <scenes/simulation.h>

#include <cstddef>
#include <optional>

namespace raycontact::reproduce {

namespace {

constexpr std::uint64_t small_animation = std::uint64_t{4} << 20; // recordings are kept to be followed, not looked at

/// Bullet as it comes: its solver's defaults, the friction of two bodies of 0.5 each, at most four points a pair, none
/// kept longer than its contact.
scenes::Response paper_response() {
    scenes::Response response;
    response.manifolds = {btScalar(-1), btScalar(1e9), 0};
    response.friction = 0.25;
    response.bullet_defaults = true;
    return response;
}

scenes::SceneDescription described(const SimulationOptions& options) {
    scenes::SceneOptions how;
    how.bodies = options.size.bodies;
    how.steps = options.size.steps;
    how.seed = options.seed;
    how.settings = options.settings;
    how.settings.speculative = options.speculative ? Speculative::on : Speculative::off;
    if (options.paper_response) how.response = paper_response();
    return options.scene == "rain" ? scenes::rain(how) : scenes::avalanche(how);
}

} // namespace

std::vector<std::string> scene_names() {
    return {"avalanche", "rain"};
}

Json simulate(const SimulationOptions& options, const std::filesystem::path& file, const Tick& tick) {
    scenes::Simulation scene(described(options));
    const scenes::RunLog& log = scene.log();
    std::optional<recording::Writer> writer;
    std::size_t recorded = 0; // bodies
    if (!file.empty()) {
        const recording::Info info{log.scene,      log.seed, scene.body_count(), log.dt, scene.description().settings,
                                   log.mesh_source};
        writer.emplace(file, info, recording::WriterOptions{.animation_bytes = small_animation});
        for (const auto& shape : log.shapes) writer->add_shape(*shape);
    }
    Json result{{"pairs", Json::array()},
                {"contacts", Json::array()},
                {"ray_length", Json::array()},
                {"depth_length", Json::array()}};
    PairLengths pairs;
    for (std::uint32_t i = 0; i < options.size.steps; ++i) {
        scene.step();
        pairs.add(scene.contacts());
        if (writer) {
            for (; recorded < log.body_shape.size(); ++recorded) writer->add_body(log.body_shape[recorded]);
            writer->step(scene.scene());
        }
        double depth = 0;
        for (const Contact& contact : scene.contacts())
            if (!contact.is_speculative()) depth += static_cast<double>(contact.depth);
        result["pairs"].push_back(scene.stats().pairs);
        result["contacts"].push_back(scene.stats().contacts);
        result["ray_length"].push_back(scene.stats().details.ray_length);
        result["depth_length"].push_back(depth);
        tick(1.0 / options.size.steps);
    }
    if (writer) writer->finish(scene.hash());
    std::uint64_t triangles = 0;
    for (std::size_t i = 0; i < log.body_shape.size(); ++i)
        if (log.body_moves[i]) triangles += log.shapes[log.body_shape[i]]->triangles().size();
    result["triangles"] = triangles;
    result["longest_pair_ray"] = pairs.longest_ray();
    result["longest_pair_depth"] = pairs.longest_depth();
    result["mesh_source"] = log.mesh_source;
    result["hash"] = scene.hash();
    return result;
}

} // namespace raycontact::reproduce
