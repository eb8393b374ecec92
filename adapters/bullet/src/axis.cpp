// SPDX-License-Identifier: Apache-2.0
#include <axis.h>
#include <vectors.h>

#include <raycontact/collide.h>

#include <algorithm>
#include <tuple>

namespace raycontact::bullet {

namespace {

/// Where the axis goes through a triangle.
struct Crossing {
    btScalar at{}; ///< 0 at the first end, 1 at the second
    btVector3 point, normal;
    btScalar slope{}; ///< how far the whole axis goes along the normal, metres; negative: it enters
    std::uint32_t triangle = 0;
    bool enters() const { return slope < 0; }
};

/// Sines below which an edge counts as parallel to the axis, or a face as seen from its side.
constexpr btScalar parallel = btScalar(1e-4);

class Axis {
public:
    Axis(const Converted& mesh, const btVector3& a, const btVector3& b)
        : mesh_(mesh), a_(a), b_(b), along_(b - a), length_(along_.length()),
          size_(btScalar(mesh.shape->radius()) + length_) {}

    std::vector<Crossing> crossings() const {
        std::vector<Crossing> found;
        each_triangle(slack(), [&](std::uint32_t t) {
            Crossing c;
            c.normal = face_normal(t);
            c.slope = c.normal.dot(along_);
            if (btFabs(c.slope) <= btScalar(1e-6) * length_) return;
            c.at = c.normal.dot(corner(t, 0) - a_) / c.slope;
            if (!(c.at >= 0 && c.at <= 1)) return;
            c.point = a_ + along_ * c.at;
            c.triangle = t;
            if (holds(t, c)) found.push_back(c);
        });
        std::sort(found.begin(), found.end(), [](const Crossing& x, const Crossing& y) {
            return std::tie(x.at, x.triangle) < std::tie(y.at, y.triangle);
        });
        // Through an edge or a corner it meets several triangles of one surface.
        const auto same = [&](const Crossing& x, const Crossing& y) {
            return x.enters() == y.enters() && (y.at - x.at) * length_ <= btScalar(1e-4) * size_;
        };
        found.erase(std::unique(found.begin(), found.end(), same), found.end());
        return found;
    }

    /// Along the normal of a face, until the end that is behind it is out.
    static WayOut past_face(const Crossing& c) {
        return {c.point, c.normal, (c.enters() ? c.at - 1 : c.at) * c.slope, c.triangle};
    }

    WayOut of_piece(const Crossing& in, const Crossing& out) const {
        WayOut best = past_face(in);
        const WayOut other = past_face(out);
        if (other.depth < best.depth) best = other;
        const btVector3 middle = (in.point + out.point) / 2;
        each_triangle(best.depth, [&](std::uint32_t t) {
            for (int k = 0; k < 3; ++k) try_edge(t, k, middle, best);
        });
        return best;
    }

private:
    btScalar slack() const { return btScalar(2e-6) * size_; } // of float coordinates, with a margin

    const btVector3& corner(std::uint32_t t, int k) const { return mesh_.in_bullet->corner(t, k); }
    btVector3 face_normal(std::uint32_t t) const { return mesh_.in_bullet->face_normal(t); }
    template <class Visit>
    void each_triangle(btScalar around, Visit&& visit) const {
        btVector3 low = a_, high = a_;
        low.setMin(b_);
        high.setMax(b_);
        const btVector3 more(around, around, around);
        for (const std::uint32_t t : mesh_.in_bullet->overlapping(low - more, high + more)) visit(t);
    }
    bool holds(std::uint32_t t, const Crossing& c) const {
        for (int k = 0; k < 3; ++k) {
            const btVector3 edge = corner(t, k + 1) - corner(t, k);
            if (c.normal.dot(edge.cross(c.point - corner(t, k))) < -slack() * edge.length()) return false;
        }
        return true;
    }
    /// The corner of a neighbour that is not on the edge.
    const btVector3& far_corner(std::uint32_t t, int k, std::uint32_t neighbour) const {
        const auto& ids = mesh_.in_bullet->triangle(t);
        int far = 0;
        for (const std::uint32_t id : mesh_.in_bullet->triangle(neighbour)) {
            if (id != ids[static_cast<std::size_t>(k)] && id != ids[static_cast<std::size_t>((k + 1) % 3)]) break;
            ++far;
        }
        return corner(neighbour, far);
    }

    /// Sideways past an edge, if that is a rim as seen along the axis: no surface of the same part is behind it.
    void try_edge(std::uint32_t t, int k, const btVector3& middle, WayOut& best) const {
        const btVector3 &p = corner(t, k), edge = corner(t, k + 1) - p;
        btVector3 away = along_.cross(edge);
        const btScalar sine = away.length();
        if (sine <= parallel * length_ * edge.length()) return;
        away /= sine;
        const std::uint32_t neighbour = mesh_.shape->neighbours()[t][static_cast<std::size_t>(k)];
        if (neighbour == Shape::no_triangle) {
            if ((corner(t, k + 2) - p).dot(away) > 0) away = -away;
        } else {
            const btVector3 one = face_normal(t), two = face_normal(neighbour);
            const btScalar slope1 = one.dot(along_), slope2 = two.dot(along_), flat = parallel * length_;
            if ((slope1 > flat && slope2 > flat) || (slope1 < -flat && slope2 < -flat)) return;
            if ((far_corner(t, k, neighbour) - p).dot(one) > slack()) return; // it points inwards
            if ((one + two).dot(away) < 0) away = -away;
        }
        const btScalar depth = (p - a_).dot(away);
        if (depth < -slack() || depth >= best.depth) return;
        const auto [at, on_edge] = closest_on_lines(a_, along_, p, edge, sine * sine);
        if (at < -parallel || at > 1 + parallel || on_edge < -parallel || on_edge > 1 + parallel) return;
        const btVector3 point = p + edge * on_edge;
        // Not past an edge of another part, with air in between.
        if (mesh_.shape->has_inside() && !contains(*mesh_.shape, to_vec((middle + point) / 2))) return;
        best = {point, away, btMax(depth, btScalar(0)), t};
    }

    const Converted& mesh_;
    btVector3 a_, b_, along_;
    btScalar length_;
    btScalar size_; ///< of the coordinates: what rounding grows with
};

} // namespace

void ways_through(const Converted& mesh, const btVector3& a, const btVector3& b, std::vector<WayOut>& out) {
    out.clear();
    for (const Crossing& c : Axis(mesh, a, b).crossings()) {
        // The normal looks to the side of the second end where the slope is positive.
        const bool second_is_longer = c.at < btScalar(0.5);
        const btVector3 normal = (c.slope > 0) == second_is_longer ? c.normal : -c.normal;
        out.push_back({c.point, normal, btMin(c.at, 1 - c.at) * btFabs(c.slope), c.triangle});
    }
}

void ways_out(const Converted& mesh, const btVector3& a, const btVector3& b, const std::array<bool, 2>& known,
              std::vector<WayOut>& out) {
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

} // namespace raycontact::bullet
