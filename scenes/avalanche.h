// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/bullet/mesh_shape.h>
#include <raycontact/contact.h>
#include <raycontact/scene.h>
#include <scenes/run_log.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace raycontact::scenes {

/// The paper's first scene (section 5.1): concave meshes in a cubic grid fall onto the ground and pile up.
/// Right-handed, z up, metres, seconds, gravity 9.81 m/s^2 along -z; the ground is a closed slab whose top is z = 0.
/// Every contact, the ground's included, is RayContact's; Bullet does the broad phase and the response (sequential
/// impulses), with deactivation off, one substep of 1/60 s a step.
struct AvalancheOptions {
    std::uint32_t bodies = 512;    ///< grid of ceil(cbrt(bodies)) a side, filled from below
    std::uint64_t seed = 1;        ///< of the small offsets and tilts
    std::string model = "bunny";   ///< see scene_model
    std::uint32_t triangles = 902; ///< of each body; its largest extent is 1 m
    double spacing = 1.05;         ///< of the grid, metres
    double density = 1000;         ///< kg/m^3
    double friction = 0.6;
    Settings settings; ///< of RayContact
    bullet::ManifoldSettings manifolds;
    int iterations = 20;                         ///< of the solver
    bullet::Bounds bounds = bullet::Bounds::box; ///< what the broad phase sees; the paper's pair counts go with boxes
    double slop = 0.005; ///< metres a contact may stay deep: rays see only what penetrates, so bodies rest there
    double erp = 0.3;    ///< part of the remaining depth undone a step, by positions and not by speed
    double linear_damping = 0, angular_damping = 0; ///< part of the speed lost in a second
    std::uint32_t expected_steps = 600;             ///< the frames kept for pictures are spread over these
    std::uint32_t frames = 8;
};

/// How well the pile behaves; over the whole run unless said otherwise.
struct AvalancheHealth {
    double penetration_max = 0;               ///< deepest contact, metres
    double depth_limit = 0;                   ///< 2 % of a body's largest extent, metres
    std::uint64_t deep_contacts = 0;          ///< contacts deeper than the limit, summed over the steps
    std::uint32_t deep_steps_longest = 0;     ///< most steps in a row that one contact (same key) was deeper
    std::uint32_t deep_steps_last_second = 0; ///< the same, of runs that reach into the last second
    double median_speed_last_second = 0;      ///< median over bodies, the largest of the last second's steps, m/s
    std::uint32_t below_ground = 0;           ///< bodies whose centre is under z = 0 now
    std::uint32_t flown_off = 0;              ///< bodies off the slab or above the highest starting point now
};

class Avalanche {
public:
    /// Throws InputError for options out of range or settings this machine cannot use.
    explicit Avalanche(const AvalancheOptions& options);
    ~Avalanche();
    Avalanche(const Avalanche&) = delete;
    Avalanche& operator=(const Avalanche&) = delete;

    /// One step of 1/60 s.
    void step();

    std::uint32_t steps() const;               ///< done so far
    std::span<const Contact> contacts() const; ///< of the last step; body ids count from 0, the ground is the last
    const StepStats& stats() const;            ///< of the last step
    const Scene& scene() const;                ///< poses and pairs of the last step, as contacts() came from them
    const bullet::DispatcherStats& manifold_stats() const;
    Pose pose(std::uint32_t body) const; ///< body frame: the model's, z up, at the centre of mass
    std::uint32_t body_count() const;    ///< without the ground
    AvalancheHealth health() const;
    std::string hash() const; ///< ContactHash of all steps so far
    std::uint64_t contacts_total() const;
    std::uint64_t rays_total() const;
    std::uint64_t rays_cast_total() const; ///< of these, cast; of the rest it is known how they end
    double ray_length_total() const;
    std::uint64_t pairs_max() const;
    /// Everything a report needs but the summary.
    const RunLog& log() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact::scenes
