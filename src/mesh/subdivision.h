// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/adjacency.h"
#include "mesh/exact_point.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace raycontact {

/// A triangle cut along segments that lie in it.
class Subdivision {
public:
    using Segment = std::pair<std::uint32_t, std::uint32_t>;

    /// corners: of the triangle, which has an area; numbers of points of the table.
    /// work: what may still be done, a step of a loop each; it falls to 0 and stays there.
    Subdivision(PointTable& points, const Triangle& corners, std::size_t& work);

    void add(std::uint32_t point) { points_.push_back(point); }
    void add(const Segment& segment);

    /// The points that lie on the triangle's edge from corner k to the next one.
    std::vector<std::uint32_t> on_edge(std::size_t k) const;
    /// Adds the points where segments cross each other.
    void cross_segments();
    /// The pieces, which wind as the triangle does, and have no point of it but as corners; some, if it is too much
    /// work. Corner k of a piece, or else its edge from there on, is that of the triangle where the piece has it or a
    /// part of it.
    std::vector<Triangle> cut();

private:
    using Edge = std::pair<std::uint32_t, std::uint32_t>; ///< of points, along a piece

    int turn(std::uint32_t p, std::uint32_t q, std::uint32_t r) const;
    bool lies_between(std::uint32_t point, const Segment& ends) const;
    bool cross(const Segment& s, const Segment& t) const;
    void set(std::uint32_t piece, const Triangle& corners);
    void insert(std::uint32_t point);
    void recover(const Segment& segment);
    void turn_as_whole(Triangle& piece) const;
    void spend(std::size_t steps) const { work_ -= std::min(work_, steps); }

    PointTable& table_;
    std::size_t& work_;
    Triangle corners_;
    std::size_t drop_;
    int way_; ///< turns of the triangle, seen along the axis
    std::vector<std::uint32_t> points_;
    std::vector<Segment> segments_;
    std::vector<Triangle> pieces_;
    std::map<Edge, std::uint32_t> edges_; ///< the piece on the left
};

} // namespace raycontact
