// SPDX-License-Identifier: Apache-2.0
#include "query/hull_exit.h"

#include "interruption.h"

#include <algorithm>
#include <array>

namespace raycontact {

namespace {

Vec3 farthest_of(std::span<const Vec3> points, const Vec3& way) {
    const Vec3* best = points.data();
    double most = dot(*best, way);
    for (const Vec3& point : points) {
        const double along = dot(point, way);
        if (along <= most) continue;
        most = along;
        best = &point;
    }
    return *best;
}

/// A direction, and the point that reaches farthest along it.
struct Support {
    Vec3 way, point;
    double reach() const { return dot(way, point); }
};

/// Directions between three. None has less reach than `least`: that of any point between the supports is no less
/// between directions than at the worst of them, where that is not negative. Points between two are enough: they keep
/// long hulls, whose ends are far from each other, from being looked at direction by direction.
struct Triangle {
    std::array<Support, 3> corner;
    double least = 0;

    explicit Triangle(const std::array<Support, 3>& corners) : corner(corners) {
        std::array<std::array<double, 3>, 3> reach; // of a point along a way
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k) reach[i][k] = dot(corner[i].point, corner[k].way);
        for (std::size_t i = 0; i < 3; ++i) look_between(reach[i], reach[(i + 1) % 3]);
    }
    static bool later(const Triangle& p, const Triangle& q) { return p.least > q.least; }

private:
    // The worst of three lines is best at an end, or where two of them cross.
    void look_between(const std::array<double, 3>& p, const std::array<double, 3>& q) {
        const auto look = [&](double t) {
            if (!(t >= 0 && t <= 1)) return;
            double worst = p[0] + t * (q[0] - p[0]);
            for (std::size_t k = 1; k < 3; ++k) worst = std::min(worst, p[k] + t * (q[k] - p[k]));
            least = std::max(least, worst);
        };
        look(0);
        look(1);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            const double apart = p[next] - p[k], closing = apart - (q[next] - q[k]);
            if (closing != 0) look(apart / closing);
        }
    }
};

} // namespace

Vec3 HullExits::farthest(const Vec3& way) const {
    return farthest_of(a_, way) - farthest_of(b_, Vec3{} - way) + radius_ * way;
}

// Branch and bound over directions, from the eight of an octahedron's faces.
HullExit HullExits::shortest(double share, double size) const {
    const auto support = [&](const Vec3& way) { return Support{way, farthest(way)}; };
    HullExit best{{1, 0, 0}, along({1, 0, 0})};
    const auto try_way = [&](const Support& at) {
        if (at.reach() < best.metres) best = {at.way, at.reach()};
    };
    std::vector<Triangle> waiting;
    const auto add = [&](const Support& p, const Support& q, const Support& r) {
        waiting.emplace_back(std::array{p, q, r});
        std::ranges::push_heap(waiting, Triangle::later);
    };
    std::array<Support, 6> axes;
    for (std::size_t k = 0; k < 6; ++k) {
        const double sign = k < 3 ? 1 : -1;
        axes[k] = support({k % 3 == 0 ? sign : 0, k % 3 == 1 ? sign : 0, k % 3 == 2 ? sign : 0});
        try_way(axes[k]);
    }
    for (const std::size_t x : {0, 3})
        for (const std::size_t y : {1, 4})
            for (const std::size_t z : {2, 5}) add(axes[x], axes[y], axes[z]);
    const InterruptionCheck check;
    while (best.metres - waiting.front().least > share * best.metres + 1e-9 * size) {
        check();
        std::ranges::pop_heap(waiting, Triangle::later);
        const Triangle open = waiting.back();
        waiting.pop_back();
        std::array<Support, 3> middle;
        for (std::size_t k = 0; k < 3; ++k) {
            middle[k] = support(unit(open.corner[k].way + open.corner[(k + 1) % 3].way));
            try_way(middle[k]);
        }
        for (std::size_t k = 0; k < 3; ++k) add(open.corner[k], middle[k], middle[(k + 2) % 3]);
        add(middle[0], middle[1], middle[2]);
    }
    return best;
}

} // namespace raycontact
