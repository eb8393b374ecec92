// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/contact.h>
#include <raycontact/scene.h>
#include <scenes/description.h>
#include <scenes/health.h>
#include <scenes/run_log.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace raycontact::scenes {

/// A scene that runs: every contact between meshes is RayContact's; Bullet does the broad phase and the response
/// (sequential impulses), with deactivation off. The same description gives the same numbers, times apart.
class Simulation {
public:
    /// Throws InputError for a description that makes no sense or settings this machine cannot use.
    explicit Simulation(SceneDescription description);
    ~Simulation();
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    /// One step of SceneDescription::dt, with the bodies that come in it. Throws InputError for a body without a mass.
    void step();

    const SceneDescription& description() const;
    std::uint32_t steps() const;               ///< done so far
    std::span<const Contact> contacts() const; ///< of the last step; a body's slot is its place in the description
    const StepStats& stats() const;            ///< of the last step
    const Scene& scene() const;                ///< poses and pairs of the last step, as contacts() came from them
    Pose pose(std::uint32_t body) const;       ///< of a body that has come, by its place in the description
    std::uint32_t body_count() const;          ///< of bodies that move and come within the planned steps
    Health health() const;
    std::string hash() const; ///< ContactHash of all steps so far
    std::uint64_t contacts_total() const;
    std::uint64_t rays_total() const;
    double ray_length_total() const;
    std::uint64_t pairs_max() const;
    /// Everything a report needs but the summary.
    const RunLog& log() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact::scenes
