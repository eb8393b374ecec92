// SPDX-License-Identifier: Apache-2.0
#include <tests/motion/polygon.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace raycontact::scenes {

namespace {

constexpr double gravity = 9.81, pi = std::numbers::pi;
constexpr int iterations = 400; // until nothing changes

/// A corner that may come to the line within the step, from the middle.
struct Corner {
    double x, y, target; ///< m/s: the least speed upwards
    double push = 0, rub = 0;
};

} // namespace

double Polygon::keeps(double speed, double seconds, double hertz) const {
    const double step = 1 / hertz;
    double height = radius * std::cos(pi / sides), turned = 0; // radians, forwards
    double along = speed, up = 0, spin = speed / radius;
    std::vector<Corner> corners;
    const auto corner = [&](int k) {
        const double at = -pi / 2 + (2 * k + 1) * pi / sides - turned;
        return Corner{radius * std::cos(at), radius * std::sin(at), 0};
    };
    for (long i = std::lround(seconds * hertz); i > 0; --i) {
        up -= gravity * step;
        corners.clear();
        for (int k = 0; k < sides; ++k) {
            Corner c = corner(k);
            const double gap = height + c.y;
            if (gap > (std::abs(up) + std::abs(spin) * radius) * step) continue;
            c.target = -std::max(0.0, gap) * hertz;
            corners.push_back(c);
        }
        // A turn forwards gives a corner at (x, y) the velocity spin (y, -x).
        for (int k = 0; k < iterations; ++k)
            for (Corner& c : corners) {
                const double before = c.push, pushed = (c.target - (up - spin * c.x)) / (1 + c.x * c.x / inertia);
                c.push = std::max(0.0, c.push + pushed);
                up += c.push - before;
                spin -= c.x * (c.push - before) / inertia;
                const double rubbed = c.rub, rub = -(along + spin * c.y) / (1 + c.y * c.y / inertia);
                c.rub = std::clamp(c.rub + rub, -friction * c.push, friction * c.push);
                along += c.rub - rubbed;
                spin += c.y * (c.rub - rubbed) / inertia;
            }
        height += up * step;
        turned += spin * step;
        // What goes below is moved up without speed, as split impulses do.
        double lowest = 0;
        for (int k = 0; k < sides; ++k) lowest = std::min(lowest, height + corner(k).y);
        height -= lowest;
    }
    return along / speed;
}

} // namespace raycontact::scenes
