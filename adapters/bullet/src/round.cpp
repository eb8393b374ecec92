// SPDX-License-Identifier: Apache-2.0
#include <axis.h>
#include <round.h>
#include <vectors.h>

#include <raycontact/collide.h>

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btMultiSphereShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace raycontact::bullet {

namespace {

/// The point of a triangle that is nearest to another point.
struct Nearest {
    btVector3 point;
    btScalar away2{}; ///< squared distance
    unsigned on = 7;  ///< the corners that span what it lies on: bits 0 to 2
};

Nearest nearest(const btVector3& a, const btVector3& b, const btVector3& c, const btVector3& p) {
    btVoronoiSimplexSolver solver; // its functions are no static ones
    btSubSimplexClosestResult found;
    solver.closestPtPointTriangle(p, a, b, c, found);
    const btVector3& q = found.m_closestPointOnSimplex;
    const btUsageBitfield& used = found.m_usedVertices;
    const int on = used.usedVertexA | used.usedVertexB << 1 | used.usedVertexC << 2;
    return {q, (q - p).length2(), static_cast<unsigned>(on)};
}

/// Normals by which two faces count as one.
constexpr btScalar flat = btScalar(1 - 1e-6);
/// Squared lengths, in squared reaches, that count as equal.
constexpr btScalar hair2 = btScalar(1e-7);

struct Found {
    btVector3 point, normal;
    btScalar away{}; ///< of the centre; negative inside
    std::uint32_t triangle = 0;
};

/// The triangles near a ball or capsule. Mesh frame.
class Neighbourhood {
public:
    Neighbourhood(const Converted& mesh, const btVector3& a, const btVector3& b, btScalar limit, bool two_sided)
        : mesh_(mesh), limit2_(limit * limit), two_sided_(two_sided) {
        btVector3 low = a, high = a;
        low.setMin(b);
        high.setMax(b);
        const btVector3 around(limit, limit, limit);
        triangles_ = mesh.in_bullet->overlapping(low - around, high + around);
        fans_.clear();
        for (const std::uint32_t t : triangles_)
            for (const std::uint32_t v : mesh.in_bullet->triangle(t)) fans_.emplace_back(v, t);
        std::sort(fans_.begin(), fans_.end());
    }

    void of_end(const btVector3& centre, std::vector<Found>& out) const;
    void of_side(const btVector3& a, const btVector3& b, std::vector<Found>& out) const;

private:
    const btVector3& corner(std::uint32_t t, int k) const { return mesh_.in_bullet->corner(t, k); }
    btVector3 face_normal(std::uint32_t t) const { return mesh_.in_bullet->face_normal(t); }
    Nearest nearest_on(std::uint32_t t, const btVector3& p) const {
        return nearest(corner(t, 0), corner(t, 1), corner(t, 2), p);
    }
    /// Calls visit(triangle) for those around a triangle's corner or edge (`on`, bits as Nearest::on), itself included.
    template <class Visit>
    void around(std::uint32_t t, unsigned on, Visit&& visit) const {
        const auto& ids = mesh_.in_bullet->triangle(t);
        std::size_t first = 0;
        while (!(on >> first & 1)) ++first;
        const auto begin = std::lower_bound(fans_.begin(), fans_.end(), std::pair{ids[first], std::uint32_t{0}});
        for (auto i = begin; i != fans_.end() && i->first == ids[first]; ++i) {
            const auto& other = mesh_.in_bullet->triangle(i->second);
            bool holds = true;
            for (std::size_t k = 0; k < 3; ++k)
                holds = holds && (!(on >> k & 1) || std::find(other.begin(), other.end(), ids[k]) != other.end());
            if (holds) visit(i->second);
        }
    }
    /// Whether no triangle around comes nearer to p than at this place.
    bool is_least(std::uint32_t t, unsigned on, const btVector3& p, btScalar away2) const {
        bool least = true;
        around(t, on,
               [&](std::uint32_t other) { least = least && nearest_on(other, p).away2 >= away2 - hair2 * limit2_; });
        return least;
    }
    /// Out of the mesh at a corner or edge; any length. Decides what is inside (Baerentzen and Aanaes 2005).
    btVector3 outwards(std::uint32_t t, unsigned on) const {
        if (on == 7) return face_normal(t);
        if ((on & (on - 1)) == 0) {
            const std::size_t k = on == 1 ? 0 : on == 2 ? 1 : 2;
            const Vec3& n = mesh_.shape->vertex_normals()[mesh_.in_bullet->triangle(t)[k]];
            return to_bullet(n);
        }
        btVector3 sum(0, 0, 0);
        around(t, on, [&](std::uint32_t other) { sum += face_normal(other); });
        return sum;
    }
    bool is_flat(std::uint32_t t, unsigned on) const {
        const btVector3 normal = face_normal(t);
        bool same = true;
        int count = 0;
        around(t, on, [&](std::uint32_t other) {
            ++count;
            same = same && face_normal(other).dot(normal) > flat;
        });
        return same && count > 1;
    }
    void add(std::vector<Found>& out, const Found& found) const {
        const bool known = std::any_of(out.begin(), out.end(), [&](const Found& f) {
            return (f.point - found.point).length2() < 10 * hair2 * limit2_ && f.away * found.away > 0;
        });
        if (!known) out.push_back(found);
    }
    Found make(std::uint32_t t, unsigned on, const btVector3& p, const btVector3& centre, btScalar away2) const {
        Found found;
        found.point = p;
        found.triangle = t;
        const btVector3 out = outwards(t, on);
        const btScalar away = btSqrt(away2);
        const bool inside = !two_sided_ && out.dot(centre - p) < 0;
        found.away = inside ? -away : away;
        // On the surface itself the line from it to the centre has no direction.
        if (away2 <= hair2 * limit2_)
            found.normal = face_normal(t);
        else
            found.normal = (inside ? p - centre : centre - p) / away;
        return found;
    }

    const Converted& mesh_;
    btScalar limit2_;
    bool two_sided_;                       ///< it has no inside
    std::vector<std::uint32_t> triangles_; ///< ascending
    /// Corners, and triangles there; kept from call to call for its memory.
    static thread_local std::vector<std::pair<std::uint32_t, std::uint32_t>> fans_;
};

thread_local std::vector<std::pair<std::uint32_t, std::uint32_t>> Neighbourhood::fans_;

void Neighbourhood::of_end(const btVector3& centre, std::vector<Found>& out) const {
    out.clear();
    std::size_t top = 0;
    for (const std::uint32_t t : triangles_) {
        const Nearest n = nearest_on(t, centre);
        if (n.away2 >= limit2_ || (n.on != 7 && !is_least(t, n.on, centre, n.away2))) continue;
        add(out, make(t, n.on, n.point, centre, n.away2));
    }
    if (out.empty()) return;
    for (std::size_t i = 1; i < out.size(); ++i)
        if (btFabs(out[i].away) < btFabs(out[top].away)) top = i;
    if (out[top].away < 0)
        out = {out[top]};
    else // faces seen from behind belong to the far side of something thin
        std::erase_if(out, [](const Found& f) { return f.away < 0; });
}

void Neighbourhood::of_side(const btVector3& a, const btVector3& b, std::vector<Found>& out) const {
    out.clear();
    const btVector3 along = b - a;
    const btScalar length2 = along.length2();
    const auto consider = [&](std::uint32_t t, unsigned on, const btVector3& p, btScalar at) {
        if (!(at > 0 && at < 1)) return; // the ends see it
        const btVector3 centre = a + along * at;
        const btScalar away2 = (p - centre).length2();
        if (away2 >= limit2_ || is_flat(t, on) || !is_least(t, on, centre, away2)) return;
        const Found found = make(t, on, p, centre, away2);
        if (found.away > 0) add(out, found);
    };
    for (const std::uint32_t t : triangles_) {
        for (int k = 0; k < 3; ++k) {
            const btVector3 &p = corner(t, k), &q = corner(t, (k + 1) % 3);
            const unsigned corner_bit = 1u << k, edge_bits = corner_bit | 1u << (k + 1) % 3;
            consider(t, corner_bit, p, (p - a).dot(along) / length2);
            const btVector3 edge = q - p;
            const btScalar e2 = edge.length2(), mixed = along.dot(edge);
            const btScalar square = length2 * e2 - mixed * mixed;
            if (square <= btScalar(1e-6) * length2 * e2) continue; // parallel: corners and ends see it
            const auto [at, on_edge] = closest_on_lines(a, along, p, edge, square);
            if (on_edge > 0 && on_edge < 1) consider(t, edge_bits, p + edge * on_edge, at);
        }
    }
}

/// An end so deep inside that no surface is in its reach: the nearest exit, found by growing steps.
void deep_end(const Converted& mesh, const btVector3& centre, btScalar limit, std::vector<Found>& out) {
    if (!contains(*mesh.shape, to_vec(centre))) return;
    const btScalar size = btScalar(mesh.shape->radius()), most = 4 * size + limit;
    limit = btMax(limit, btScalar(1e-3) * size); // a radius of 0 would not grow
    while (out.empty() && limit < most) {
        limit *= 2;
        Neighbourhood(mesh, centre, centre, limit, false).of_end(centre, out);
    }
    std::erase_if(out, [](const Found& f) { return f.away > 0; });
}

/// What neither ends nor sides see: an axis inside the mesh between them.
void add_axis(const Converted& mesh, const btVector3& a, const btVector3& b,
              const std::array<std::vector<Found>*, 2>& ends, bool two_sided, std::vector<Found>& out) {
    static thread_local std::vector<WayOut> ways;
    if (two_sided) {
        ways_through(mesh, a, b, ways);
        // The end that is on the other side would be pushed there.
        const auto against = [&](const Found& f) {
            return std::ranges::any_of(ways, [&](const WayOut& way) { return way.normal.dot(f.normal) < 0; });
        };
        for (std::vector<Found>* found : {ends[0], ends[1], &out}) std::erase_if(*found, against);
        for (const WayOut& way : ways) out.push_back({way.point, way.normal, -way.depth, way.triangle});
        return;
    }
    std::array<bool, 2> known{};
    for (std::size_t k = 0; k < 2; ++k)
        known[k] = mesh.shape->has_inside()
                   || std::any_of(ends[k]->begin(), ends[k]->end(), [](const Found& f) { return f.away < 0; });
    ways_out(mesh, a, b, known, ways);
    for (const WayOut& way : ways) out.push_back({way.point, way.normal, -way.depth, way.triangle});
}

} // namespace

Round round_of(const btCollisionShape& shape) {
    Round round;
    round.ends[0].setZero();
    round.ends[1].setZero();
    if (shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE) {
        round.radius = static_cast<const btSphereShape&>(shape).getRadius();
        return round;
    }
    if (shape.getShapeType() == MULTI_SPHERE_SHAPE_PROXYTYPE) {
        const auto& balls = static_cast<const btMultiSphereShape&>(shape);
        const btScalar scaling = balls.getLocalScaling().x();
        round.balls = balls.getSphereCount();
        round.radius = balls.getSphereRadius(0) * scaling;
        round.ends[0] = balls.getSpherePosition(0) * scaling;
        round.ends[1] = balls.getSpherePosition(round.balls - 1) * scaling;
        return round;
    }
    const auto& capsule = static_cast<const btCapsuleShape&>(shape);
    round.radius = capsule.getRadius();
    if (capsule.getHalfHeight() > 0) {
        round.balls = 2;
        round.ends[0][capsule.getUpAxis()] = -capsule.getHalfHeight();
        round.ends[1][capsule.getUpAxis()] = capsule.getHalfHeight();
    }
    return round;
}

void round_contacts(const Converted& mesh, const btTransform& mesh_pose, const Round& round,
                    const btTransform& round_pose, btScalar reach, std::vector<RoundContact>& out) {
    out.clear();
    const btTransform to_mesh = mesh_pose.inverseTimes(round_pose);
    const btVector3 a = to_mesh(round.ends[0]), b = to_mesh(round.ends[1]);
    const btScalar limit = round.radius + reach;
    const bool two_sided = round.two_sided && !mesh.shape->has_inside();
    static thread_local std::vector<Found> found;
    const auto give = [&](int part, const std::vector<Found>& all) {
        int number = 0;
        for (const Found& f : all)
            out.push_back({part + 3 * number++, mesh_pose(f.point), mesh_pose.getBasis() * f.normal,
                           f.away - round.radius, f.triangle});
    };
    static thread_local std::vector<Found> first, second;
    {
        const Neighbourhood neighbourhood(mesh, a, b, limit, two_sided);
        neighbourhood.of_end(a, first);
        second.clear();
        found.clear();
        if (round.balls > 1) {
            neighbourhood.of_end(b, second);
            neighbourhood.of_side(a, b, found);
        }
    }
    if (first.empty() && !two_sided) deep_end(mesh, a, limit, first);
    if (second.empty() && round.balls > 1 && !two_sided) deep_end(mesh, b, limit, second);
    if (round.balls > 1) add_axis(mesh, a, b, {&first, &second}, two_sided, found);
    give(0, first);
    give(1, second);
    give(2, found);
}

namespace {

/// How the ends of a round go in a step, in the mesh's frame.
struct Way {
    btVector3 from[2], by[2];
};

constexpr int most_steps = 64;
constexpr btScalar glancing = btScalar(0.1); // sine
constexpr int coming = 1 << 20;              // apart from the places that are near now

// Goes on by the distance of what is nearest ahead, until that is next to nothing.
std::optional<RoundContact> touch_on(const Converted& mesh, Round round, const Way& way) {
    const btScalar touching = btScalar(0.01) * round.radius;
    const btScalar length = btSqrt(btMax(way.by[0].length2(), way.by[1].length2()));
    static thread_local std::vector<RoundContact> places;
    btScalar part = 0;
    for (int i = 0; i < most_steps && part < 1; ++i) {
        for (int e = 0; e < 2; ++e) round.ends[e] = way.from[e] + part * way.by[e];
        round_contacts(mesh, btTransform::getIdentity(), round, btTransform::getIdentity(), (1 - part) * length,
                       places);
        const RoundContact* nearest = nullptr;
        for (const RoundContact& c : places) {
            const btScalar towards = -btMin(c.normal.dot(way.by[0]), c.normal.dot(way.by[1]));
            if (towards > glancing * length && (nearest == nullptr || c.distance < nearest->distance)) nearest = &c;
        }
        if (nearest == nullptr) return std::nullopt;
        if (nearest->distance <= touching) {
            if (i == 0) return std::nullopt; // it touches already
            // The place of the axis that comes there, and what is below it now: a push there does not turn a ball.
            const btVector3 axis = round.ends[1] - round.ends[0];
            const btScalar along =
                round.balls == 1
                    ? 0
                    : btClamped(axis.dot(nearest->point - round.ends[0]) / axis.length2(), btScalar(0), btScalar(1));
            const btVector3 centre = way.from[0] + along * (way.from[1] - way.from[0]);
            RoundContact touch = *nearest;
            const btScalar height = touch.normal.dot(centre - touch.point);
            touch.point = centre - height * touch.normal;
            touch.distance = btMax(height - round.radius, btScalar(0));
            return touch;
        }
        part += nearest->distance / length;
    }
    return std::nullopt;
}

} // namespace

void first_touches(const Converted& mesh, const btTransform& mesh_pose, const btTransform& mesh_next,
                   const Round& round, const btTransform& round_pose, const btTransform& round_next,
                   std::vector<RoundContact>& out) {
    const btTransform now = mesh_pose.inverseTimes(round_pose), then = mesh_next.inverseTimes(round_next);
    Way way;
    for (int e = 0; e < 2; ++e) {
        way.from[e] = now(round.ends[e]);
        way.by[e] = then(round.ends[e]) - way.from[e];
    }
    const auto add = [&](const Round& part, const Way& its_way, int number) {
        auto touch = touch_on(mesh, part, its_way);
        if (!touch) return;
        touch->place += coming * number;
        touch->point = mesh_pose(touch->point);
        touch->normal = mesh_pose.getBasis() * touch->normal;
        out.push_back(*touch);
    };
    add(round, way, 1);
    if (round.balls == 1) return;
    // What lies flat is stopped at both ends.
    for (int e = 0; e < 2; ++e) {
        const Round end{
            .ends = {round.ends[e], round.ends[e]}, .balls = 1, .radius = round.radius, .two_sided = round.two_sided};
        add(end, {.from = {way.from[e], way.from[e]}, .by = {way.by[e], way.by[e]}}, 2 + e);
    }
}

} // namespace raycontact::bullet
