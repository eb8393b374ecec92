// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"

#include <raycontact/mesh.h>
#include <raycontact/shape.h>

#include <memory>
#include <vector>

namespace raycontact::reference {

// Crowds of meshes that touch, part and touch again, for methods that keep something from step to step.

/// What a crowd is made of.
enum class Kind {
    concave,  ///< closed, outward, without crossings
    cavities, ///< the same, with closed hollows and thin shells
    open,     ///< bowls, sheets, a lone triangle; among closed meshes
    crossing, ///< self-intersecting, inside out, or wound inconsistently
    slivers,  ///< flattened and stretched meshes, needles, fans of narrow triangles
    slab,     ///< one slab of 42 x 42 x 2 and twelve triangles, and concave meshes of size 1 on it
    sizes,    ///< concave meshes from a hundredth to ten times the usual size
    coarse    ///< boxes, bars, plates, cones and the like, and a few finer meshes
};
inline constexpr Kind kinds[] = {Kind::concave, Kind::cavities, Kind::open,  Kind::crossing,
                                 Kind::slivers, Kind::slab,     Kind::sizes, Kind::coarse};
const char* name_of(Kind kind);

/// Meshes of about 1 m times `scale`; made once. The first of a slab's crowd is the slab.
const std::vector<std::shared_ptr<const Shape>>& crowd_shapes(Kind kind, double scale);

/// How a body goes about.
enum class Course {
    drift,    ///< slowly, turning slowly, and back
    jitter,   ///< about one place, by anything from a rounding to a thousandth of its size
    spin,     ///< in place, always the same way
    creep,    ///< at a pace and a way that change now and then, about the fastest at which normal-cone balls are asked
    approach, ///< into its place and out again
    tumble,   ///< by a large part of its size and any angle, every step
    still,    ///< not a bit
    teleport, ///< nearly still, and now and then elsewhere
    sheared,  ///< jitter of a rotation that is one only to 9e-5
    mixed     ///< each body another of these
};
inline constexpr Course courses[] = {Course::drift,    Course::jitter, Course::spin,  Course::creep,
                                     Course::approach, Course::tumble, Course::still, Course::teleport,
                                     Course::sheared,  Course::mixed};
const char* name_of(Course course);

/// A body's poses, one a step.
class Mover {
public:
    /// home: the pose at which it touches its neighbours; size: of the body, metres.
    Mover(Course course, const Pose& home, double size, Random& random);
    Pose next(Random& random);

private:
    Course course_;
    Pose home_, pose_;
    double size_;
    Vec3 way_, axis_;     ///< unit
    double speed_, rate_; ///< metres and radians a step
    int period_, step_ = 0;
};

/// As a physics engine in float32 would hand it over: a rotation only to 1e-7.
Pose rounded_to_float(Pose pose);
/// The rotation times a symmetric matrix that pose checks still accept (1e-4).
Pose sheared(Pose pose, Random& random);
/// First `inner`, then `outer`.
Pose composed(const Pose& outer, const Pose& inner);

/// Places for bodies of these shapes, in order: each beside a vertex of an earlier one, so that many just touch.
std::vector<Pose> touching_poses(const std::vector<std::shared_ptr<const Shape>>& shapes, double tightness,
                                 Random& random);

} // namespace raycontact::reference
