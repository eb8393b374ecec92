// SPDX-License-Identifier: Apache-2.0
#include <reproduce/workshop.h>

#include <raycontact/device.h>
#include <raycontact/error.h>
#include <recording/reader.h>
#include <recording/replay.h>
#include <report/machine.h>

#include <fmt/format.h>

#include <stdexcept>

namespace raycontact::reproduce {

namespace {

/// Finished: it has the run's hash.
bool is_whole(const std::filesystem::path& file) {
    if (!std::filesystem::exists(file)) return false;
    try {
        return recording::Reader(file).hash().has_value();
    } catch (const InputError&) {
        return false;
    }
}

std::string name_of(const char* what, const SimulationOptions& options) {
    return fmt::format("{}-{}-{}-seed{}", what, options.scene, to_string(options.settings.method), options.seed);
}

} // namespace

Workshop::Workshop(const Plan& plan, const std::filesystem::path& cache_folder) : plan_(plan), cache_(cache_folder) {
    const report::Machine machine = report::this_machine();
    here_ = {{"commit", machine.commit}, {"compiler", machine.compiler}, {"cpu", machine.cpu}};
    auto devices = Json::array();
    for (const DeviceInfo& device : list_devices())
        if (device.usable) devices.push_back(device.id + " " + device.name);
    here_["devices"] = devices;
    here_["cores"] = machine.cores;
}

Json Workshop::key(const std::string& what, Json settings) const {
    const SceneSize &avalanche = plan_.avalanche, &rain = plan_.rain;
    return {{"what", what},
            {"settings", std::move(settings)},
            {"sizes", {avalanche.bodies, avalanche.steps, rain.bodies, rain.steps}},
            {"made_by", here_}};
}

Json Workshop::key(const std::string& what, const SimulationOptions& o) const {
    return key(what, Json{{"scene", o.scene},
                          {"seed", o.seed},
                          {"bodies", o.size.bodies},
                          {"steps", o.size.steps},
                          {"paper_response", o.paper_response},
                          {"speculative", o.speculative},
                          {"settings", to_json(o.settings)}});
}

SimulationOptions Workshop::driven_by(Method method, const std::string& scene, std::uint64_t seed) const {
    return {scene, seed, plan_.size(scene), as_in_the_paper(method, plan_.constants), true};
}

SimulationOptions Workshop::base(const std::string& scene) const {
    return {scene, 1, plan_.size(scene), by_default(Method::certified)};
}

Part Workshop::base_part(const std::string& scene) const {
    const SimulationOptions options = base(scene);
    return {"scene-" + scene, key("scene", options), cost(options),
            [this, options](const Tick& tick) { return simulate_recorded(options, tick); }};
}

std::filesystem::path Workshop::recording_file(const SimulationOptions& options) const {
    return cache_.file(name_of("recording", options), key("recording", options), ".glb");
}

Json Workshop::simulate_recorded(const SimulationOptions& options, const Tick& tick) const {
    const std::filesystem::path file = recording_file(options);
    const std::filesystem::path draft = std::filesystem::path(file).replace_extension(".part.glb");
    Json result = simulate(options, draft, tick);
    std::filesystem::rename(draft, file);
    return result;
}

std::filesystem::path Workshop::recording(const SimulationOptions& options, const Tick& tick) const {
    std::filesystem::path file = recording_file(options);
    if (!is_whole(file)) simulate_recorded(options, tick);
    return file;
}

void Workshop::drop_recording(const SimulationOptions& options) const {
    std::error_code ignored; // only space is lost
    std::filesystem::remove(recording_file(options), ignored);
}

double Workshop::cost(const SimulationOptions& options) {
    const double pairs_at_end = 15.0 * options.size.bodies * (options.scene == "rain" ? 0.7 : 1);
    return options.size.steps * (1 + 1.2e-3 * pairs_at_end);
}

Json to_json(const Settings& s) {
    const auto length = [](const std::optional<double>& metres) { return metres ? Json(*metres) : Json("auto"); };
    return {{"method", to_string(s.method)},
            {"caster", to_string(s.paper.caster)},
            {"direction", to_string(s.direction)},
            {"features", to_string(s.features)},
            {"displacement_threshold", length(s.paper.displacement_threshold)},
            {"confidence", s.paper.confidence},
            {"culling_distance", length(s.paper.culling_distance)},
            {"distance_extension", length(s.paper.distance_extension)},
            {"max_iterations", s.paper.max_iterations},
            {"cast_lost_walks", s.paper.cast_lost_walks},
            {"skip_outside", s.paper.skip_outside},
            {"devices", s.execution.devices},
            {"schedule", to_string(s.execution.schedule)},
            {"threads", s.execution.threads}};
}

void side_by_side(const std::vector<Follow>& follow,
                  const std::function<void(std::uint32_t, std::span<Scene* const>)>& look) {
    struct Follower {
        explicit Follower(const Follow& f) : reader(f.recording), follower(reader, f.settings) {}
        recording::Reader reader;
        recording::Follower follower;
    };
    std::vector<std::unique_ptr<Follower>> all;
    std::vector<Scene*> scenes;
    for (const Follow& one : follow) {
        all.push_back(std::make_unique<Follower>(one));
        scenes.push_back(&all.back()->follower.scene());
        if (all.back()->reader.steps() != all.front()->reader.steps())
            throw std::logic_error("recordings that are compared differ in their steps; report this");
    }
    std::vector<Pose> poses;
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < all.front()->reader.steps(); ++i) {
        for (const auto& one : all) {
            one->reader.read_step(i, poses, pairs);
            one->follower.place(i, poses);
            one->follower.scene().find_contacts(pairs);
        }
        look(i, scenes);
    }
}

} // namespace raycontact::reproduce
