// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/library_mode.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace raycontact {

/// What is kept from step to step.
enum class Method {
    standard,   ///< nothing: every ray in full, every step; the reference
    iterative,  ///< a pair that moved little only follows last step's contacts (LGA13; paper section 3)
    predictive, ///< as iterative, and also follows vertices about to touch (paper section 3.1, Algorithm 1)
    certified,  ///< skips what cannot touch yet; the contacts are those of `standard` (docs/certified.md)
};

/// How a ray meets a mesh. Both give the same bits.
enum class Caster {
    basic, ///< every triangle (paper section 5.1, "basic traversal")
    bvh,   ///< stackless bounding volume hierarchy (paper section 5.1)
};

/// What a contact's normal and depth are made of.
enum class Direction {
    ray,         ///< along the ray itself, depth = |r| (Hermann et al. 2008)
    weighted,    ///< as ray, and each contact has its vertex's area as weight (after Hermann et al. 2008)
    reprojected, ///< along the normal of the face that was hit, depth = r . n (paper section 3.2, equation 2)
    refined,     ///< to the nearest point of the faces by which the vertex can leave; depth = its distance
};

/// Which features of a mesh can be in contact.
enum class Features {
    vertices, ///< vertices alone: the rule of Hermann et al. 2008 and the paper (section 2.1)
    edges,    ///< vertices and sharp edges: no two closed meshes can intersect unnoticed (docs/edges.md)
};

/// Which of several devices a pair is on.
enum class Schedule {
    balanced, ///< where it came first, unless devices are loaded unevenly for several steps: then pairs move
    sticky,   ///< where it came first, as long as it is open (paper section 4)
    counted,  ///< as balanced, but what a unit of load costs is set, not measured, so that a run repeats exactly
};

/// Of the smaller body's box diagonal: how near bodies have speculative contacts that do not hurry.
inline constexpr double speculative_share = 0.0025;

struct Settings {
    Method method = Method::certified;
    Caster caster = Caster::bvh;
    Direction direction = Direction::reprojected;
    Features features = Features::edges;

    /// Metres a pair may move before it is looked at in full again (paper section 3). Empty: chosen for each pair from
    /// its size and speed, with `iterative` and `predictive` also from the counted cost of either kind of step, and
    /// chosen again as it moves; `predictive` then casts pairs that are too fast for it in full in each step
    /// (docs/design.md). With `certified` no contact depends on it.
    std::optional<double> displacement_threshold;
    /// How far a predictive ray goes, in displacement thresholds; at least 1 (paper equation 1).
    double confidence = 2;
    /// The same in metres; replaces confidence x displacement threshold.
    std::optional<double> culling_distance;
    /// Metres by which `predictive` widens the bounds whose vertices it looks at (paper section 3.1); not below a
    /// displacement threshold that is given, too. Empty: the culling distance.
    std::optional<double> distance_extension;
    /// Triangles a ray may visit when it is followed from step to step (maxIt of Algorithm 1); 1 to 4096.
    std::uint32_t max_iterations = 16;
    /// If a walk of `predictive` ends nowhere, its ray is cast in full (counted in StepStats); off, it is given up.
    bool cast_lost_walks = true;

    /// No ray is cast for a vertex that a grid of the mesh knows to be outside, or too far off to be predicted, and no
    /// pair is looked at in full while nothing is near (docs/design.md). Off, `standard`, `iterative` and `predictive`
    /// cast every ray of the paper's rule, with `iterative` and `predictive` whenever a pair has moved by its
    /// threshold, on which their contacts depend; those of `standard` do not. `certified` does not look at it.
    bool skip_outside = true;
    /// Also finds contacts before anything touches, with depth <= 0: what lies nearer than a margin, and what will
    /// touch on its way to the next step, so that a solver stops bodies at the surface (docs/speculative.md). Empty: as
    /// whoever owns the scene has it; a Scene of your own: no; a Bullet CollisionDispatcher and `raycontact run`: yes.
    std::optional<bool> speculative;
    /// Metres: the margin. Empty: speculative_share of the smaller body's box diagonal.
    std::optional<double> speculative_margin;
    bool is_speculative() const { return speculative.value_or(false); }
    /// Of each pair the contacts that stand for all of them, no more than this (docs/reduction.md); at least the
    /// deepest. 0: all contacts. The rest is counted in StepStats.
    std::uint32_t max_contacts_per_pair = 0;
    /// The same for the whole scene: each pair in contact keeps its deepest, if need be beyond the limit.
    std::uint32_t max_contacts = 0;
    /// "auto" (a GPU where one is expected to be faster, else the CPU), "all" (every GPU, or the CPU where there is
    /// none), or ids of list_devices(), separated by commas: the pairs are shared out among them. "cpu/k", and "ID/k"
    /// where the driver divides the device, is its k-th core alone.
    std::string devices = "auto";
    Schedule schedule = Schedule::balanced; ///< no result depends on it
    /// Accept a device that rounds differently: its contacts may differ from those of all other devices.
    bool inexact = false;
    std::uint32_t threads = 0; ///< of the host; 0: one per core. No count changes a bit of the result
};

/// Throws InputError naming the setting that makes no sense, and what would.
void check_settings(const Settings& settings);

/// The words of the command line; throw InputError naming what is known.
Method method_from(std::string_view word);
Caster caster_from(std::string_view word);
Direction direction_from(std::string_view word);
Features features_from(std::string_view word);
Schedule schedule_from(std::string_view word);
std::string_view to_string(Method);
std::string_view to_string(Caster);
std::string_view to_string(Direction);
std::string_view to_string(Features);
std::string_view to_string(Schedule);

} // namespace raycontact
