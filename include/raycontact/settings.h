// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/execution.h>
#include <raycontact/export.h>
#include <raycontact/paper_options.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace raycontact {

/// What is kept from step to step.
enum class Method {
    standard,   ///< nothing: every ray in full, every step; the reference
    iterative,  ///< a pair that moved little only follows last step's contacts (LGA13; paper section 3)
    predictive, ///< as iterative, and also follows vertices about to touch (paper section 3.1, Algorithm 1)
    certified,  ///< skips what cannot touch yet; the contacts are those of `standard` (docs/internals/certified.md)
};

/// What a contact's normal and depth are made of.
enum class Direction {
    ray,         ///< along the ray itself, depth = |r| (Hermann et al. 2008)
    weighted,    ///< with edges patches, weights are areas; else as ray, weights of vertices (Hermann et al. 2008)
    reprojected, ///< along the normal of the face that was hit, depth = r . n (paper section 3.2, equation 2)
    refined,     ///< to the nearest point of the faces by which the vertex can leave; depth = its distance
};

/// Which features of a mesh can be in contact.
enum class Features {
    vertices, ///< vertices alone: the rule of Hermann et al. 2008 and the paper (section 2.1)
    edges,    ///< vertices and sharp edges: no two closed meshes can intersect unnoticed (docs/internals/edges.md)
};

/// Whether contacts are found before anything touches.
enum class Speculative {
    automatic, ///< as whoever owns the scene has it: a Scene of your own no, a Bullet dispatcher and `raycontact run`
               ///< yes
    off,       ///< no
    on,        ///< yes
};

/// Of the smaller body's box diagonal: how near bodies have speculative contacts that do not hurry.
inline constexpr double speculative_share = 0.0025;

/// What a scene finds; how it does so is `execution`.
struct Settings {
    Method method = Method::certified;            ///< what is kept from step to step
    Direction direction = Direction::reprojected; ///< what normals and depths are made of
    Features features = Features::edges;          ///< what can be in contact

    /// Also finds contacts before anything touches, with depth <= 0: what lies nearer than a margin, and what will
    /// touch on its way to the next step, so that a solver stops bodies at the surface (docs/internals/speculative.md).
    Speculative speculative = Speculative::automatic;
    /// Metres: the margin. Empty: speculative_share of the smaller body's box diagonal.
    std::optional<double> speculative_margin;
    /// `speculative`, and no where it is automatic.
    bool is_speculative() const noexcept { return speculative == Speculative::on; }
    /// Of each pair the contacts that stand for all of them, no more than this (docs/conventions.md, Fewer contacts);
    /// at least the deepest. 0: all contacts. The rest is counted in StepStats.
    std::uint32_t max_contacts_per_pair = 0;
    /// The same for the whole scene: each pair in contact keeps its deepest, if need be beyond the limit.
    std::uint32_t max_contacts = 0;

    Execution execution; ///< devices, threads
    PaperOptions paper;  ///< for methods `iterative` and `predictive`, and for who measures
};

/// Throws InputError naming the setting that makes no sense, and what would. Lengths are at most 1e12 m.
RAYCONTACT_API void check_settings(const Settings& settings);

/// The word of the command line; throws InputError naming what is known.
RAYCONTACT_API Method method_from(std::string_view word);
/// The word of the command line; throws InputError naming what is known.
RAYCONTACT_API Direction direction_from(std::string_view word);
/// The word of the command line; throws InputError naming what is known.
RAYCONTACT_API Features features_from(std::string_view word);
/// The word that method_from() takes for it.
RAYCONTACT_API std::string_view to_string(Method);
/// The word that direction_from() takes for it.
RAYCONTACT_API std::string_view to_string(Direction);
/// The word that features_from() takes for it.
RAYCONTACT_API std::string_view to_string(Features);

} // namespace raycontact
