// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/crossings.h"

#include <span>
#include <vector>

namespace raycontact {

/// A curve in which the surfaces of a pair cross, from crossing to crossing.
struct Loop {
    std::uint32_t first, count; ///< in Loops::order()
    std::uint32_t first_segment, segment_count;
    bool closed; ///< the last crossing is followed by the first
    Vec3 area;   ///< vector area, m^2; points the way in which a leaves b
};

/// Two crossings that follow each other on a loop: between them two triangles cross.
struct LoopSegment {
    std::uint32_t loop;
    std::uint32_t from, to;             ///< crossings
    std::array<std::uint32_t, 2> faces; ///< of a, of b
    std::array<Vec3, 2> normals;        ///< of these, outward
};

/// Joins the crossings of a pair to loops. Keeps nothing but memory from one pair to the next.
class Loops {
public:
    void find(const PairMeshes& pair, std::span<const Crossing> crossings);
    std::span<const Loop> loops() const { return loops_; }
    /// Crossings, loop by loop.
    std::span<const std::uint32_t> order() const { return order_; }
    /// Loop by loop, in order.
    std::span<const LoopSegment> segments() const { return segments_; }
    std::span<const LoopSegment> segments_of(const Loop& loop) const {
        return segments().subspan(loop.first_segment, loop.segment_count);
    }

private:
    static constexpr std::uint32_t nowhere = 0xffffffffu;
    /// A crossing lies on one triangle of the one body and two of the other, so on two pairs of triangles.
    struct Links {
        std::array<std::uint64_t, 2> faces; ///< of a in the upper half, of b in the lower; none: at a border
        std::array<std::uint32_t, 2> next{nowhere, nowhere};
    };
    void link(const PairMeshes& pair, std::span<const Crossing> crossings);
    void walk(std::span<const Crossing> crossings, std::uint32_t begin);
    void measure(const PairMeshes& pair, std::span<const Crossing> crossings, Loop& loop);

    std::vector<Links> links_; ///< by crossing
    std::vector<std::pair<std::uint64_t, std::uint32_t>> by_faces_;
    std::vector<Loop> loops_;
    std::vector<std::uint32_t> order_;
    std::vector<LoopSegment> segments_;
    std::vector<bool> seen_;
};

} // namespace raycontact
