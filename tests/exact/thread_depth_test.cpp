// SPDX-License-Identifier: Apache-2.0
// Direction `refined` in threads: a nut that is shifted by more than its play has its play again once it is moved back,
// and no point moves by more than the shift. So no depth is more than the shift less the play, which is found here by
// trying every vertex on every triangle and every edge on every edge.
#include "exact/assemblies.h"
#include "reference/margins.h"
#include "reference/random.h"
#include "reference/vector.h"

#include <raycontact/collide.h>
#include <raycontact/query.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <set>
#include <utility>
#include <vector>

using namespace raycontact;
using namespace raycontact::exact;
using namespace raycontact::reference;

namespace {

// How far two segments are from each other where that is between their ends; else no less than an end is from either.
double apart(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    const Vec3 u = q - p, v = s - r, w = p - r;
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), across = uu * vv - uv * uv;
    if (!(across > 1e-12 * uu * vv)) return std::numeric_limits<double>::infinity();
    const double along_u = std::clamp((uv * dot(v, w) - vv * dot(u, w)) / across, 0.0, 1.0);
    const double along_v = std::clamp((uu * dot(v, w) - uv * dot(u, w)) / across, 0.0, 1.0);
    return length(p + along_u * u - r - along_v * v);
}

std::set<std::pair<std::uint32_t, std::uint32_t>> edges_of(const Mesh& mesh) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
    return edges;
}

double gap_between(const Mesh& a, const Mesh& b) {
    double gap = std::numeric_limits<double>::infinity();
    for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)})
        for (const Vec3& p : from->vertices)
            for (const auto& [i, j, k] : to->triangles)
                gap = std::min(gap,
                               length(p - closest_on_triangle(p, to->vertices[i], to->vertices[j], to->vertices[k])));
    const auto edges_b = edges_of(b);
    for (const auto& [i, j] : edges_of(a))
        for (const auto& [k, l] : edges_b)
            gap = std::min(gap, apart(a.vertices[i], a.vertices[j], b.vertices[k], b.vertices[l]));
    return gap;
}

struct Fit {
    double clearance; ///< radial
    double beyond;    ///< up to so far beyond the play are nuts shifted
    Vec3 home;        ///< where the nut has play on all sides
};

TEST(thread_depth, is_no_more_than_a_nut_is_shifted_beyond_its_play) {
    const Mesh bolt = bolt_mesh(6);
    const auto bolt_shape = Shape::make(bolt);
    // A pitch up the nut is where it was; the second is there.
    for (const Fit& fit : {Fit{0.02, 0.1, {0, 0, thread_pitch}}, Fit{0.01, 0.1, {}}, Fit{0.04, 0.06, {}}}) {
        const Mesh nut = nut_mesh(2, fit.clearance);
        const auto nut_shape = Shape::make(nut);
        const Pose home{.translation = fit.home};
        ASSERT_FALSE(intersects(*bolt_shape, {}, *nut_shape, home));
        const double play = gap_between(bolt, placed(nut, home));
        ASSERT_GT(play, 0.3 * fit.clearance);
        Random random(43);
        std::size_t contacts = 0, over = 0, deep = 0;
        double worst = 0;
        for (int i = 0; i < 400; ++i) {
            const double beyond = fit.beyond * random.uniform();
            const Pose pose{.translation = fit.home + (play + beyond) * random.direction()};
            std::size_t most_here = 0;
            for (const Contact& c : collide(*bolt_shape, {}, *nut_shape, pose,
                                            {.direction = Direction::refined, .features = Features::vertices})) {
                ++contacts;
                most_here += double(c.depth) > 0.5 * beyond;
                over += double(c.depth) > beyond + 1e-6;
                worst = std::max(worst, double(c.depth) / (beyond + 1e-6));
            }
            deep += most_here > 0;
        }
        std::printf("[ counts   ] clearance %g, play %.6f: %zu contacts in 400 poses, deepest %.3f of its bound\n",
                    fit.clearance, play, contacts, worst);
        EXPECT_EQ(over, 0u);
        EXPECT_GT(contacts, 10000u);
        EXPECT_GT(deep, 100u); // depths are not merely small
    }
}

} // namespace
