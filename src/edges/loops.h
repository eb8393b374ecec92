// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/crossings.h"

#include <span>
#include <vector>

namespace raycontact {

/// A curve in which the surfaces of a pair cross, from crossing to crossing.
struct Loop {
    std::uint32_t first, count;                 ///< crossings
    std::uint32_t first_segment, segment_count; ///< one less than crossings if it is not closed
    Vec3 area;                                  ///< vector area, m^2; points the way in which a leaves b
    bool runs_back;                             ///< against the way in which `area` is run
    bool is_closed() const { return segment_count == count; }
};

/// From a crossing to the next one of its loop: there two triangles cross.
struct LoopSegment {
    std::uint32_t from, to;             ///< crossings
    std::array<std::uint32_t, 2> faces; ///< of a and b
    std::array<Vec3, 2> normals;        ///< theirs, outward
};

/// Follows the loops of a pair from triangle to triangle. Keeps nothing but memory from one pair to the next.
class Loops {
public:
    void clear();
    /// Follows the loop through a crossing, unless it is there already.
    void follow(const PairMeshes& pair, const Crossing& seed);
    std::span<const Loop> loops() const { return loops_; }
    /// Loop by loop, in the order in which they follow each other.
    std::span<const Crossing> crossings() const { return crossings_; }
    std::span<const LoopSegment> segments() const { return segments_; }

private:
    /// The triangles between a crossing and the next one.
    struct Step {
        Crossing next;
        std::array<std::uint32_t, 2> faces;
        std::array<Vec3, 2> normals;
    };
    bool walk(const PairMeshes& pair, const Crossing& seed, bool onward);
    void keep(const Crossing& seed, bool closed);
    void measure(Loop& loop) const;
    bool is_known(const Crossing& c) const;
    void remember(std::uint32_t number);

    std::vector<Crossing> crossings_;
    std::vector<Loop> loops_;
    std::vector<LoopSegment> segments_;
    std::array<std::vector<Step>, 2> steps_;    ///< from the seed: back, onward
    std::array<PlacedFace, 2> faces_;           ///< of a, of b
    std::array<std::uint32_t, 2> normal_faces_; ///< whose normals_ are known
    std::array<Vec3, 2> normals_;
    std::vector<std::uint32_t> table_; ///< numbers of crossings by their hash, NONE: free
};

} // namespace raycontact
