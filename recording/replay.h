// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/reader.h>

#include <raycontact/scene.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raycontact::recording {

/// A scene that follows a recording: the same bodies, poses and pairs, step by step.
class Follower {
public:
    /// Prepares the shapes, so that a replay repeats: counts of work, and the contacts of methods that follow rays.
    Follower(const Reader& reader, const Settings& settings);

    /// Sets up step i, ascending from 0: bodies come and go, poses, by slot, are set.
    void place(std::uint32_t i, std::span<const Pose> poses);
    Scene& scene() { return scene_; }

private:
    void happen(const BodyEvent& event, std::span<const Pose> poses);

    const Reader& reader_;
    Scene scene_;
    std::size_t next_event_ = 0;
};

/// How often contacts differ from those of every ray cast in full.
struct WrongRays {
    std::uint64_t missed = 0;            ///< a contact of the reference that was not found
    std::uint64_t invented = 0;          ///< a contact that the reference does not have
    std::uint64_t other_triangle = 0;    ///< a contact with another triangle than the reference's
    std::uint64_t rays_compared = 0;     ///< rays the reference cast
    std::uint64_t contacts_compared = 0; ///< contacts the reference found
    std::uint64_t total() const { return missed + invented + other_triangle; }
    double percent() const; ///< of the rays compared (paper section 5.2, figures 9 and 10); NaN where there are none

    /// Of one step; both sorted as Scene gives them.
    void add(std::span<const Contact> found, std::span<const Contact> reference);
    void add(const WrongRays& more);
};

struct ReplayStep : StepStats {
    double step_ms = 0; ///< poses set, contacts found
    WrongRays wrong;    ///< when it was compared
};

struct Replay {
    std::uint64_t pairs_max = 0, rays = 0, contacts = 0;
    double ray_length = 0, penetration_max = 0; ///< metres
    std::vector<ReplayStep> steps;
    std::string hash;
    std::string device_choice;           ///< Scene::device_choice() at the end
    std::optional<WrongRays> wrong_rays; ///< when it was compared
};

struct ReplayOptions {
    Settings settings;
    bool compare = false;                        ///< with method `standard`, in a second scene; its time is not counted
    std::function<void(std::uint32_t)> progress; ///< told how many steps are done
    std::function<bool()> stop;                  ///< asked after each step; true: the replay ends there
};

/// Whether contacts found with `used` are those found with `recorded`, where bodies are expected in the same places:
/// direction, features and limits are the same, and method and thresholds, too, unless both methods find what
/// `standard` finds.
bool find_alike(const Settings& recorded, const Settings& used);
/// Whether they must be in a replay, too, which does not know where bodies were expected.
bool must_agree(const Settings& recorded, const Settings& used);

/// Detection only, over all recorded steps, or up to where it was stopped. Throws InputError for a damaged recording or
/// unusable settings.
Replay replay(Reader& reader, const ReplayOptions& options);

} // namespace raycontact::recording
