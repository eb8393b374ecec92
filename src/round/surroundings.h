// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "round/round_contacts.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace raycontact {

/// Where a ball or capsule is nearest to an obstacle. Frame of the obstacle, metres.
struct Spot {
    std::size_t obstacle = 0;
    int part = 0;               ///< 0, 1: of that end; 2: of what is between them
    double at = 0;              ///< the place on the axis, 0 at the first end, 1 at the second
    Vec3 point{};               ///< on the surface
    Vec3 normal{};              ///< unit, out of the obstacle, or towards the side where the round is
    double away = 0;            ///< of the axis; negative: inside
    bool flat = false;          ///< the normal is that of a face
    std::uint32_t triangle = 0; ///< index of the file
    std::array<int, 2> name{-1, -1};
};

/// An obstacle as a round sees it in one step.
struct Site {
    const Obstacle* obstacle;
    Pose pose;                 ///< of the obstacle
    std::vector<Facet> facets; ///< near the way; of many in the order of their boxes along an axis
    std::size_t sorted_along = 0;
    double widest = 0;   ///< of their boxes along that axis; infinite: they are few, and not sorted
    Vec3 start[2];       ///< the ends of the axis now; frame of the obstacle
    Vec3 from[2], by[2]; ///< a straight piece of their way
};

/// How many ends count: those of a ball are one.
inline int balls_of(const Round& round) {
    return round.from == round.to ? 1 : 2;
}

/// A ball or capsule and all obstacles about it: one surface.
class Surroundings {
public:
    /// reach: how far from its surface spots may be asked for. next: the end of the way; none: it has no way.
    Surroundings(const Round& round, const Pose& pose, const std::optional<Pose>& next,
                 std::span<const Obstacle> obstacles, double reach);

    const Round& round() const { return round_; }
    std::span<const Site> sites() const { return sites_; }
    /// Local minima of the distance at a part of the piece, 0 to 1, of at most `limit` from the axis; by obstacle.
    void spots(double part, double limit, std::vector<Spot>& out) const;
    /// Whether a point of an obstacle, not within a face, is such a minimum.
    bool is_least(std::size_t obstacle, const Vec3& point, double at, double part) const;
    /// How far the axis goes there on this piece. Frame of the obstacle.
    Vec3 way(std::size_t obstacle, double at) const;
    /// Takes from the rest of the way what leads into any of these.
    void deflect(std::span<const Spot> spots);
    /// Goes on to a part of the piece.
    void advance(double part);

private:
    void deflect(const Spot& spot);
    /// A facet, and how near it is to a point or the axis.
    struct Entry {
        double away2;
        std::size_t site;
        const Facet* facet;
        Nearest nearest;
    };
    std::optional<Entry> nearest_facet(std::size_t site, const Vec3& p, double from, std::vector<Facet>& found) const;
    Vec3 axis(std::size_t site, double at, double part) const;
    Vec3 seen_from(std::size_t other, std::size_t site, const Vec3& point, double at, double part) const;
    /// Metres within which a facet is beside a point of the obstacle.
    double beside(std::size_t site) const;
    bool is_step(const Spot& spot, std::span<const Spot> spots, double part) const;
    std::array<bool, 2> goes_on(const Spot& spot, double part, double slope) const;
    bool is_nearer_there(const Spot& spot, double part, double than2) const;
    void finish(const Site& site, const Facet& facet, unsigned on, const Vec3& centre, Spot& spot) const;
    void of_end(int end, double part, double limit, std::vector<std::vector<Spot>>& out) const;
    void of_side(double part, double limit, std::vector<std::vector<Spot>>& out) const;
    void of_axis(std::size_t site, double part, std::vector<Spot>& first, std::vector<Spot>& second,
                 std::vector<Spot>& side) const;

    Round round_;
    std::vector<Site> sites_;
    double margin_ = 0; ///< of all obstacles the widest
};

} // namespace raycontact
