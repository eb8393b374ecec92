// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/library_mode.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace raycontact {

/// How a ray meets a mesh. Both give the same bits.
enum class Caster {
    basic, ///< every triangle (paper section 5.1, "basic traversal")
    bvh,   ///< stackless bounding volume hierarchy (paper section 5.1)
};

/// The constants of Lehericey, Gouranton and Arnaldi 2013, for methods `iterative` and `predictive` and for who
/// measures. No contact of `certified`, the default, depends on any of them.
struct PaperOptions {
    Caster caster = Caster::bvh; ///< no bit of a contact depends on it
    /// Metres a pair may move before it is tested in full again (paper section 3). Empty: chosen for each pair from
    /// its size and speed, with `iterative` and `predictive` also from the counted cost of either kind of step, and
    /// chosen again as it moves; `predictive` then casts pairs that are too fast for it in full in each step
    /// (docs/internals/paper-map.md).
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
    /// If a walk of `predictive` ends nowhere, its ray is cast in full (counted in StepDetails); off, it is given up.
    bool cast_lost_walks = true;
    /// No ray is cast for a vertex that a grid of the mesh knows to be outside, or too far off to be predicted, and no
    /// pair is tested in full while nothing is near (docs/internals/paper-map.md). Off, `standard`, `iterative` and
    /// `predictive` cast every ray of the paper's rule, with `iterative` and `predictive` whenever a pair has moved by
    /// its threshold, on which their contacts depend; those of `standard` do not. `certified` does not look at it.
    bool skip_outside = true;
    friend bool operator==(const PaperOptions&, const PaperOptions&) = default;
};

/// The word of the command line; throws InputError naming what is known.
RAYCONTACT_API Caster caster_from(std::string_view word);
/// The word that caster_from() takes for it.
RAYCONTACT_API std::string_view to_string(Caster);

} // namespace raycontact
