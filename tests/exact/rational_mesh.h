// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/shape.h>

#include <cstdint>
#include <memory>
#include <optional>

namespace raycontact::exact {

/// A placed mesh in rational numbers: every triangle is asked, and nothing is rounded until the answer.
class RationalMesh {
public:
    /// Of the file's vertices; placed in double, which the identity leaves as they are.
    explicit RationalMesh(const Shape& shape, const Pose& pose = {});
    ~RationalMesh();

    struct Found {
        std::uint32_t triangle; ///< of the nearest ones the lowest, index in the file
        double distance;
        std::uint32_t ties; ///< how many triangles are as near
    };
    /// The first triangle that a ray meets; those seen edge-on do not count. direction: unit to rounding.
    std::optional<Found> raycast(const Vec3& origin, const Vec3& direction) const;
    Found closest(const Vec3& point) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact::exact
