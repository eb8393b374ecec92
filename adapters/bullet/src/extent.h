// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

#include <array>
#include <cstddef>
#include <vector>

namespace raycontact::bullet {

/// Points, or boxes, of a mesh that hold the box of the mesh in every direction. Body frame, metres. Many at a time, so
/// that compilers take vector instructions.
class Extent {
public:
    void reserve(std::size_t count) { groups_.reserve((count + width - 1) / width); }
    /// half: of a box; zero for a point.
    void add(const btVector3& centre, const btVector3& half);
    std::size_t size() const { return size_; }
    /// The box of all in the world; there must be one.
    void bounds(const btTransform& transform, btVector3& low, btVector3& high) const;

private:
    static constexpr std::size_t width = 16; ///< loops of eight g++ unrolls before it can take vectors
    using Lanes = std::array<btScalar, width>;
    struct Group {
        std::array<Lanes, 3> centre, half; ///< the first one fills what is left of the last group
    };
    std::vector<Group> groups_;
    std::size_t size_ = 0;
    bool points_ = true; ///< all are points
};

} // namespace raycontact::bullet
