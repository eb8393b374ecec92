// SPDX-License-Identifier: Apache-2.0
// Stacks stand in Bullet with one line changed, at least as well as twice Bullet's own boxes drift; and whatever
// overlaps at the end comes apart, by CGAL's exact test, when one body moves by 3 % of its size.
#include <tests/stacks/stack_world.h>
#include <tests/stacks/verdict.h>

// CGAL's headers are not written for these warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <CGAL/Surface_mesh.h>
#pragma GCC diagnostic pop

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace raycontact::scenes {

// How gtest prints a parameter.
void PrintTo(Ground ground, std::ostream* out) {
    *out << to_string(ground);
}

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

/// A body in the world.
struct Placed {
    std::vector<Vec3> vertices;
    const std::vector<std::array<std::uint32_t, 3>>* triangles;
    double size;

    Surface surface(const Vec3& by = {}) const {
        Surface out;
        std::vector<Surface::Vertex_index> ids;
        for (const Vec3& v : vertices) ids.push_back(out.add_vertex({v.x + by.x, v.y + by.y, v.z + by.z}));
        for (const auto& t : *triangles) out.add_face(ids[t[0]], ids[t[1]], ids[t[2]]);
        return out;
    }
    /// Unit normals of the faces.
    void add_normals(std::vector<Vec3>& out) const {
        for (const auto& t : *triangles) {
            const Vec3 &a = vertices[t[0]], &b = vertices[t[1]], &c = vertices[t[2]];
            const Vec3 u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z};
            const Vec3 n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
            const double length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
            out.push_back({n.x / length, n.y / length, n.z / length});
        }
    }
};

std::vector<Placed> placed(const Stack& stack, const std::vector<Pose>& poses) {
    std::vector<Placed> all;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const StackShape& shape = stack.shapes[stack.bodies[i].shape];
        Placed body{{}, &shape.mesh.triangles, shape.size};
        for (const Vec3& v : shape.mesh.vertices) body.vertices.push_back(transform_point(poses[i], v));
        all.push_back(body);
    }
    return all;
}

bool boxes_apart(const Placed& a, const Placed& b) {
    for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
        const auto less = [axis](const Vec3& p, const Vec3& q) { return p.*axis < q.*axis; };
        const auto [a_low, a_high] = std::minmax_element(a.vertices.begin(), a.vertices.end(), less);
        const auto [b_low, b_high] = std::minmax_element(b.vertices.begin(), b.vertices.end(), less);
        if ((*a_high).*axis < (*b_low).*axis || (*b_high).*axis < (*a_low).*axis) return true;
    }
    return false;
}

/// The surfaces meet, or one solid is in the other. Exact.
bool meet(const Surface& a, const Surface& b) {
    return CGAL::Polygon_mesh_processing::do_intersect(a, b, CGAL::parameters::do_overlap_test_of_bounded_sides(true),
                                                       CGAL::parameters::default_values());
}

bool comes_apart(const Placed& a, const Placed& b) {
    const Surface other = b.surface();
    if (!meet(a.surface(), other)) return true;
    std::vector<Vec3> ways{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    b.add_normals(ways);
    std::vector<Vec3> own;
    a.add_normals(own);
    for (const Vec3& n : own) ways.push_back({-n.x, -n.y, -n.z});
    const double by = drift_limit * std::min(a.size, b.size);
    return std::ranges::any_of(ways, [&](const Vec3& n) {
        return !meet(a.surface({by * n.x, by * n.y, by * n.z}), other);
    });
}

std::vector<Pose> after(const Stack& stack, Ground ground, Finder finder, double seconds, const StackSolver& solver) {
    StackWorld world(stack, ground, finder, solver);
    for (int i = 0; i < static_cast<int>(60 * seconds); ++i) world.step();
    return world.poses();
}

void expect_stands(const Stack& stack, Ground ground, double seconds, const StackSolver& solver) {
    // With a slop Bullet's own boxes turn by up to 2.2 degrees.
    const double allowed_turn = solver.slop > 0 ? 1.5 * turn_limit : turn_limit;
    double allowed = drift_limit;
    if (stack.stands && stack.convex())
        allowed = std::max(allowed, 2 * judge(stack, after(stack, ground, Finder::convex, seconds, solver)).drift);
    const std::vector<Pose> poses = after(stack, ground, Finder::edges, seconds, solver);
    const Verdict verdict = judge(stack, poses);
    EXPECT_FALSE(verdict.fell(stack, allowed, allowed_turn))
        << stack.name << ": drift " << verdict.drift << " of " << allowed << ", turned by " << verdict.turn
        << " degrees, sunk by " << verdict.sunk << ", overlap " << verdict.overlap;
    const std::vector<Placed> bodies = placed(stack, poses);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            EXPECT_TRUE(boxes_apart(bodies[i], bodies[k]) || comes_apart(bodies[i], bodies[k]))
                << stack.name << ": " << i << " and " << k;
}

/// Friction along directions that do not follow the sliding: what a slope needs. With Bullet's default, two wedges
/// creep on each other, its own convex hulls most, and a cube that stands on the corner of an open box creeps by 1 % of
/// its size a second (docs/limits.md).
constexpr StackSolver steady{50, 0.002, true};

TEST(StacksApart, ByThreePercentAndNoMore) {
    Stack two = column();
    two.bodies.resize(2);
    for (const double overlap : {-0.01, 0.02, 0.04}) {
        two.bodies[1].pose.translation.z = 1.5 - overlap;
        const std::vector<Placed> bodies = placed(two, {two.bodies[0].pose, two.bodies[1].pose});
        EXPECT_EQ(meet(bodies[0].surface(), bodies[1].surface()), overlap > 0);
        EXPECT_EQ(comes_apart(bodies[0], bodies[1]), overlap < drift_limit);
        EXPECT_EQ(comes_apart(bodies[1], bodies[0]), overlap < drift_limit);
    }
}

class Stacks : public testing::TestWithParam<Ground> {};

TEST_P(Stacks, Stand) {
    for (const Stack& stack : all_stacks())
        expect_stands(stack, GetParam(), 5, stack.name == "wedges" || stack.name == "corner" ? steady : StackSolver{});
}

TEST_P(Stacks, LongStandOnASteadySolver) {
    for (const Stack& stack : all_stacks()) expect_stands(stack, GetParam(), 5, steady);
}

INSTANTIATE_TEST_SUITE_P(On, Stacks, testing::Values(Ground::plane, Ground::slab, Ground::box, Ground::quad),
                         [](const auto& one) { return std::string(to_string(one.param)); });

} // namespace
} // namespace raycontact::scenes
