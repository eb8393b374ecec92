// SPDX-License-Identifier: Apache-2.0
#include "round/axis.h"
#include "mesh/vector.h"
#include "round/lines.h"

#include <raycontact/query.h>

#include <algorithm>
#include <cmath>

namespace raycontact {

namespace {

/// Where the axis goes through a facet.
struct Crossing {
    double at = 0; ///< 0 at the first end, 1 at the second
    Vec3 point;
    double slope = 0; ///< how far the whole axis goes along the normal, metres; negative: it enters
    Facet facet;
    bool enters() const { return slope < 0; }
};

/// Sines below which an edge counts as parallel to the axis, or a face as seen from its side.
constexpr double parallel = 1e-4;

class Axis {
public:
    Axis(const Facets& mesh, const Vec3& a, const Vec3& b)
        : mesh_(mesh), a_(a), b_(b), along_(b - a), length_(length(along_)), size_(mesh.size() + length_) {}

    std::vector<Crossing> crossings() const {
        std::vector<Crossing> found;
        each_facet(slack(), [&](const Facet& f) {
            Crossing c;
            c.slope = dot(f.normal, along_);
            if (std::fabs(c.slope) <= 1e-6 * length_) return;
            c.at = dot(f.normal, f.corner[0] - a_) / c.slope;
            if (!(c.at >= 0 && c.at <= 1)) return;
            c.point = a_ + c.at * along_;
            c.facet = f;
            if (holds(c)) found.push_back(c);
        });
        std::stable_sort(found.begin(), found.end(), [](const Crossing& x, const Crossing& y) { return x.at < y.at; });
        // Through an edge or a corner it meets several facets of one surface.
        const auto same = [&](const Crossing& x, const Crossing& y) {
            return x.enters() == y.enters() && (y.at - x.at) * length_ <= 1e-4 * size_;
        };
        found.erase(std::unique(found.begin(), found.end(), same), found.end());
        return found;
    }

    /// Along the normal of a face, until the end that is behind it is out.
    static AxisExit past_face(const Crossing& c) {
        return {c.point, c.facet.normal, (c.enters() ? c.at - 1 : c.at) * c.slope, c.facet};
    }

    AxisExit of_piece(const Crossing& in, const Crossing& out) const {
        AxisExit best = past_face(in);
        const AxisExit other = past_face(out);
        if (other.depth < best.depth) best = other;
        const Vec3 middle = 0.5 * (in.point + out.point);
        each_facet(best.depth, [&](const Facet& f) {
            for (std::size_t k = 0; k < 3; ++k) try_edge(f, k, middle, best);
        });
        return best;
    }

private:
    double slack() const { return 1e-9 * size_; } // of places along the axis, which it meets at a small angle

    template <class Visit>
    void each_facet(double around, Visit&& visit) const {
        const Vec3 more{around, around, around};
        const Vec3 low{std::min(a_.x, b_.x), std::min(a_.y, b_.y), std::min(a_.z, b_.z)};
        const Vec3 high{std::max(a_.x, b_.x), std::max(a_.y, b_.y), std::max(a_.z, b_.z)};
        std::vector<Facet> facets;
        mesh_.near(low - more, high + more, facets);
        for (const Facet& f : facets) visit(f);
    }
    bool holds(const Crossing& c) const {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &p = c.facet.corner[k], edge = c.facet.corner[(k + 1) % 3] - p;
            if (dot(c.facet.normal, cross(edge, c.point - p)) < -slack() * length(edge)) return false;
        }
        return true;
    }

    /// Sideways past an edge, if that is a rim as seen along the axis: no surface of the same part is behind it.
    void try_edge(const Facet& f, std::size_t k, const Vec3& middle, AxisExit& best) const {
        const Shape& shape = *mesh_.shape();
        const Vec3 &p = f.corner[k], edge = f.corner[(k + 1) % 3] - p;
        Vec3 away = cross(along_, edge);
        const double sine = length(away);
        if (sine <= parallel * length_ * length(edge)) return;
        away = (1 / sine) * away;
        const std::uint32_t neighbour = shape.neighbours()[f.triangle][k];
        if (neighbour == Shape::no_triangle) {
            if (dot(f.corner[(k + 2) % 3] - p, away) > 0) away = -away;
        } else {
            const auto& ids = shape.triangles()[neighbour];
            std::array<Vec3, 3> across;
            for (std::size_t i = 0; i < 3; ++i) across[i] = shape.vertices()[ids[i]];
            const Vec3 area = cross(across[1] - across[0], across[2] - across[0]);
            const Vec3 two = (1 / length(area)) * area;
            const double slope1 = dot(f.normal, along_), slope2 = dot(two, along_), flat = parallel * length_;
            if ((slope1 > flat && slope2 > flat) || (slope1 < -flat && slope2 < -flat)) return;
            for (const Vec3& corner : across)
                if (dot(corner - p, f.normal) > slack()) return; // it points inwards
            if (dot(f.normal + two, away) < 0) away = -away;
        }
        const double depth = dot(p - a_, away);
        if (depth < -slack() || depth >= best.depth) return;
        const auto [at, on_edge] = closest_on_lines(a_, along_, p, edge, sine * sine);
        if (at < -parallel || at > 1 + parallel || on_edge < -parallel || on_edge > 1 + parallel) return;
        const Vec3 point = p + on_edge * edge;
        // Not past an edge of another part, with air in between.
        if (shape.has_inside() && !contains(shape, 0.5 * (middle + point))) return;
        best = {point, away, std::max(depth, 0.0), f};
    }

    const Facets& mesh_;
    Vec3 a_, b_, along_;
    double length_;
    double size_; ///< of the coordinates: what rounding grows with
};

} // namespace

void ways_through(const Facets& mesh, const Vec3& a, const Vec3& b, std::vector<AxisExit>& out) {
    out.clear();
    for (const Crossing& c : Axis(mesh, a, b).crossings()) {
        // The normal looks to the side of the second end where the slope is positive.
        const bool second_is_longer = c.at < 0.5;
        const Vec3 normal = (c.slope > 0) == second_is_longer ? c.facet.normal : -c.facet.normal;
        out.push_back({c.point, normal, std::min(c.at, 1 - c.at) * std::fabs(c.slope), c.facet});
    }
}

void ways_out(const Facets& mesh, const Vec3& a, const Vec3& b, const std::array<bool, 2>& known,
              std::vector<AxisExit>& out) {
    out.clear();
    const Axis axis(mesh, a, b);
    int inside = 0; // of how many parts
    const Crossing* entered = nullptr;
    const std::vector<Crossing> crossings = axis.crossings();
    for (const Crossing& c : crossings) {
        if (c.enters()) {
            if (inside++ == 0) entered = &c;
        } else if (inside == 0) {
            if (!known[0]) out.push_back(Axis::past_face(c));
        } else if (--inside == 0) {
            out.push_back(axis.of_piece(*entered, c));
        }
    }
    if (inside > 0 && !known[1]) out.push_back(Axis::past_face(*entered));
}

} // namespace raycontact
