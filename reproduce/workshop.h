// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>
#include <reproduce/experiment.h>
#include <reproduce/plan.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace raycontact::reproduce {

/// All that decides a simulation.
struct SimulationOptions {
    std::string scene; ///< "avalanche" or "rain"
    std::uint64_t seed = 1;
    SceneSize size;
    Settings settings;
    /// Bullet as it comes: its solver's defaults, and four points a pair of bodies, none kept longer than its contact:
    /// what contact reduction was in 2013. Else the scene's own response.
    bool paper_response = false;
    bool speculative = false; ///< speculative contacts, which the paper has not
};

/// A scene that follows a recording.
struct Follow {
    std::filesystem::path recording;
    Settings settings;
};

/// What all experiments share: how much to run, what is kept, recordings.
class Workshop {
public:
    /// Throws InputError when the folder cannot be made.
    Workshop(const Plan& plan, const std::filesystem::path& cache_folder);

    const Plan& plan() const { return plan_; }
    const Cache& cache() const { return cache_; }
    /// A key with the sizes of the scenes, the program's commit and the machine, so that neither another build nor
    /// another machine finds it.
    Json key(const std::string& what, Json settings) const;
    Json key(const std::string& what, const SimulationOptions& options) const;

    /// By the contacts of a method of the paper, and with the response of its time.
    SimulationOptions driven_by(Method method, const std::string& scene, std::uint64_t seed = 1) const;
    /// The simulation whose poses are the same for every method: by the library's defaults, whose contacts are exact.
    SimulationOptions base(const std::string& scene) const;
    /// Its Part: pairs, contacts; its recording is kept.
    Part base_part(const std::string& scene) const;

    /// The simulation's recording, made where it is missing or not whole.
    std::filesystem::path recording(
        const SimulationOptions& options, const Tick& tick = [](double) {}) const;
    void drop_recording(const SimulationOptions& options) const;
    /// Rough milliseconds of a simulation.
    static double cost(const SimulationOptions& options);

private:
    std::filesystem::path recording_file(const SimulationOptions& options) const;
    Json simulate_recorded(const SimulationOptions& options, const Tick& tick) const;

    Plan plan_;
    Cache cache_;
    Json here_;
};

/// Runs a simulation; writes a recording unless `file` is empty. {"pairs", "contacts", "ray_length",
/// "depth_length": a number a step; "triangles" of the moving bodies, "mesh_source", "hash"}.
Json simulate(const SimulationOptions& options, const std::filesystem::path& file, const Tick& tick);

Json to_json(const Settings& settings);

/// All scenes do step after step in turn, so that a slower spell of the machine meets all alike. `look` sees them after
/// each step, `scenes[k]` following `follow[k]`. The recordings must have the same number of steps.
void side_by_side(const std::vector<Follow>& follow,
                  const std::function<void(std::uint32_t step, std::span<Scene* const> scenes)>& look);

} // namespace raycontact::reproduce
