// SPDX-License-Identifier: Apache-2.0
// Penalty forces of direction `weighted` with vertices alone: sums over the contacts of a body that is pressed into a
// plane (paper section 5.4, after Hermann et al. 2008). Those of faces: unit/query/contact_patches_test.cpp.
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

constexpr double pi = 3.14159265358979323846;

/// Moves the vertices of a star-shaped mesh over its surface's directions, so that they lie up to sixteen times as
/// dense on one side as on the other; `radius` tells how far out the surface is in each direction.
template <class Radius>
Mesh uneven(Mesh mesh, Radius radius) {
    for (Vec3& v : mesh.vertices) {
        const Vec3 direction = unit(unit(v) + Vec3{0.6, 0, 0});
        v = radius(direction) * direction;
    }
    return mesh;
}

Mesh uneven_sphere_mesh() {
    return uneven(bumpy_octahedron_mesh(28), [](const Vec3&) { return 1.0; });
}

/// The surface of bumpy_octahedron_mesh, but for its lesser bumps.
Mesh uneven_bumpy_mesh() {
    return uneven(bumpy_octahedron_mesh(12), [](const Vec3& d) {
        return 0.85 - 0.2 * (d.x * d.x * d.x * d.x + d.y * d.y * d.y * d.y) + 0.5 * d.x * d.y * d.z;
    });
}

struct Force {
    double normal = 0, tangential = 0;
    double deviation() const { return tangential / normal; }
};

/// Of a plane on a body that reaches `depth` into it, for a stiffness of 1: the sum of weight x depth x normal.
class Plane {
public:
    Plane(const Mesh& body, Direction direction) : body_(Shape::make(body)), scene_(settings(direction)) {
        scene_.add(Shape::make(box_mesh({10, 10, 10}))); // its top is at 10
        id_ = scene_.add(body_);
    }

    Force push(Pose pose, double depth) {
        double lowest = 1e9;
        for (const Vec3& v : body_->vertices()) lowest = std::min(lowest, rotate(pose, v).z);
        pose.translation = {0, 0, 10 - lowest - depth};
        scene_.set_pose(id_, pose);
        Vec3 sum{};
        for (const Contact& c : scene_.find_contacts()) {
            const double size = double(c.weight) * double(c.depth);
            sum = sum + size * Vec3{double(c.normal.x), double(c.normal.y), double(c.normal.z)};
        }
        return {sum.z, std::hypot(sum.x, sum.y)};
    }

private:
    static Settings settings(Direction direction) {
        Settings settings;
        settings.direction = direction;
        settings.features = Features::vertices;
        settings.execution.threads = 1;
        return settings;
    }

    std::shared_ptr<const Shape> body_;
    Scene scene_;
    BodyId id_;
};

// A pressure of depth x stiffness on a sphere of radius R that reaches h into a plane adds up to pi R h^2 across the
// plane and to nothing along it. Weights are areas, so their sum is that integral, wherever the vertices lie.
TEST(weighted, forces_on_a_sphere_are_the_integral_of_the_pressure) {
    Plane weighted(uneven_sphere_mesh(), Direction::weighted), plain(uneven_sphere_mesh(), Direction::ray);
    Random random(2008);
    double worst = 0, worst_deviation = 0, least = 1e9, most = 0, plain_deviation = 0;
    int runs = 0;
    for (int i = 0; i < 60; ++i) {
        const Pose pose = random.rotation();
        for (const double depth : {0.25, 0.35, 0.45}) {
            const double expected = pi * depth * depth;
            const Force force = weighted.push(pose, depth), unweighted = plain.push(pose, depth);
            worst = std::max(worst, std::fabs(force.normal / expected - 1));
            worst_deviation = std::max(worst_deviation, force.deviation());
            least = std::min(least, unweighted.normal / expected);
            most = std::max(most, unweighted.normal / expected);
            plain_deviation += unweighted.deviation();
            ++runs;
        }
    }
    plain_deviation /= runs;
    std::printf("[ counts   ] %d forces: off by at most %.2f %%, deviation at most %.2f %%; without weights between "
                "%.0f and %.0f times the integral, mean deviation %.1f %%\n",
                runs, 100 * worst, 100 * worst_deviation, least, most, 100 * plain_deviation);
    EXPECT_LT(worst, 0.05);
    EXPECT_LT(worst_deviation, 0.03);
    EXPECT_GT(most, 5 * least);
    EXPECT_GT(plain_deviation, 0.1);
}

// The paper's Table 1 has a ratio of 0.67 to 0.76; it does not give its meshes.
TEST(weighted, forces_on_a_bumpy_mesh_deviate_less) {
    Plane weighted(uneven_bumpy_mesh(), Direction::weighted), plain(uneven_bumpy_mesh(), Direction::ray),
        reprojected(uneven_bumpy_mesh(), Direction::reprojected);
    Random random(2013);
    double with = 0, without = 0, worst_reprojected = 0;
    int runs = 0;
    for (int i = 0; i < 100; ++i) {
        const Pose pose = random.rotation();
        for (const double depth : {0.05, 0.1, 0.15, 0.2}) {
            with += weighted.push(pose, depth).deviation();
            without += plain.push(pose, depth).deviation();
            worst_reprojected = std::max(worst_reprojected, reprojected.push(pose, depth).deviation());
            ++runs;
        }
    }
    std::printf("[ counts   ] %d forces: mean deviation %.1f %% with weights, %.1f %% without\n", runs,
                100 * with / runs, 100 * without / runs);
    EXPECT_LT(with, 0.9 * without);
    EXPECT_LT(worst_reprojected, 1e-6);
}

// Nothing but the weight and the hash tells `weighted` from `ray`.
TEST(weighted, contacts_are_those_of_ray) {
    const auto subjects = pointers(closed_subjects());
    Random random(20080101);
    std::vector<Placement> placements;
    placements.reserve(200);
    for (int i = 0; i < 200; ++i) placements.push_back(random_placement(subjects, random));
    Settings settings;
    settings.features = Features::vertices;
    settings.direction = Direction::ray;
    Scene ray(settings);
    settings.direction = Direction::weighted;
    Scene weighted(settings);
    const auto expected = ray.find_contacts(add_all(ray, placements));
    const auto found = weighted.find_contacts(add_all(weighted, placements));
    ASSERT_GT(expected.size(), 1500u);
    std::vector<Contact> unweighted(found.begin(), found.end());
    for (Contact& c : unweighted) {
        EXPECT_GT(c.weight, 0);
        c.weight = 1;
    }
    EXPECT_TRUE(same_bits(unweighted, expected));
    EXPECT_FALSE(same_bits(found, expected));
    EXPECT_EQ(ray.stats().details.ray_length, weighted.stats().details.ray_length);
}

} // namespace
