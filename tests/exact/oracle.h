// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <memory>

namespace raycontact::exact {

/// Which positions of a mesh: those of contacts, float32 about the shape's centre, or those of its file.
enum class Positions { rounded, of_file };

/// A closed mesh of one piece.
class ExactBody {
public:
    explicit ExactBody(const Shape& shape, Positions positions = Positions::rounded);
    ~ExactBody();
    ExactBody(ExactBody&&) noexcept;

    double diagonal() const;

private:
    struct State;
    std::unique_ptr<State> state_;
    friend bool collide(const ExactBody&, const ExactBody&, const Pose&);
    friend bool comes_apart(const ExactBody&, const ExactBody&, const Pose&, double);
    friend bool comes_together(const ExactBody&, const ExactBody&, const Pose&, double);
    friend bool changes(const ExactBody&, const ExactBody&, const Pose&, double, bool);
};

/// The pose of b's frame about its centre in that of a, as the library forms it.
Pose centred_in(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

/// Whether the surfaces have a point in common, or one body is inside the other; by exact predicates on b's positions
/// moved to a's frame, rounded to double. b_in_a: of the frames about the centres.
bool collide(const ExactBody& a, const ExactBody& b, const Pose& b_in_a);

/// Whether colliding bodies come apart, or others come together, when b moves by `metres` in one of some directions:
/// along axes, diagonals, and normals of the faces of both.
bool comes_apart(const ExactBody& a, const ExactBody& b, const Pose& b_in_a, double metres);
bool comes_together(const ExactBody& a, const ExactBody& b, const Pose& b_in_a, double metres);

} // namespace raycontact::exact
