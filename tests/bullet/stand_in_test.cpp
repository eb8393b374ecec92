// SPDX-License-Identifier: Apache-2.0
// The meshes that stand for Bullet's convex shapes: how far they lie from the true surface, both ways.
#include "test_world.h"

#include <convert.h>
#include <scenes/random.h>
#include <stand_in.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace raycontact::test {
namespace {

using Distance = std::function<double(const Vec3&)>; ///< signed, from the true surface

struct Case {
    std::shared_ptr<btCollisionShape> shape;
    Distance distance;
    double tolerance = 1e-3; ///< in parts of its size
};

double length(double x, double y, double z = 0) {
    return std::sqrt(x * x + y * y + z * z);
}

Distance box_distance(double x, double y, double z) {
    return [=](const Vec3& p) {
        const double dx = std::fabs(p.x) - x, dy = std::fabs(p.y) - y, dz = std::fabs(p.z) - z;
        return length(std::max(dx, 0.0), std::max(dy, 0.0), std::max(dz, 0.0)) + std::min(0.0, std::max({dx, dy, dz}));
    };
}

/// Of a solid of revolution about an axis whose half section is a convex polygon: signed distance in the half plane.
Distance turned_distance(int axis, const std::vector<std::array<double, 2>>& section) {
    return [=](const Vec3& p) {
        const double c[3] = {p.x, p.y, p.z};
        const double r = length(c[(axis + 1) % 3], c[(axis + 2) % 3]), z = c[axis];
        double outside = 1e30;
        bool inside = true;
        for (std::size_t i = 0; i + 1 < section.size(); ++i) { // counter-clockwise in (r, z)
            const auto [r0, z0] = section[i];
            const auto [r1, z1] = section[i + 1];
            const double t = std::clamp(((r - r0) * (r1 - r0) + (z - z0) * (z1 - z0))
                                            / (std::pow(r1 - r0, 2) + std::pow(z1 - z0, 2)),
                                        0.0, 1.0);
            outside = std::min(outside, length(r - r0 - t * (r1 - r0), z - z0 - t * (z1 - z0)));
            inside = inside && (r1 - r0) * (z - z0) - (z1 - z0) * (r - r0) >= 0;
        }
        return inside ? -outside : outside;
    };
}

/// Of the hull of up to three balls: it is the union of the balls between them, whose middles and radii are means.
Distance hull_distance(std::vector<std::pair<Vec3, double>> balls) {
    while (balls.size() < 3) balls.push_back(balls.back());
    return [=](const Vec3& p) {
        const auto of = [&](double u, double v) {
            const double w = 1 - u - v;
            const auto mean = [&](double Vec3::*axis) {
                return w * balls[0].first.*axis + u * balls[1].first.*axis + v * balls[2].first.*axis;
            };
            return length(p.x - mean(&Vec3::x), p.y - mean(&Vec3::y), p.z - mean(&Vec3::z)) - w * balls[0].second
                   - u * balls[1].second - v * balls[2].second;
        };
        const auto least = [](double high, auto&& f) { // of a convex function
            double low = 0;
            for (int i = 0; i < 28; ++i) {
                const double third = (high - low) / 3;
                if (f(low + third) < f(high - third))
                    high -= third;
                else
                    low += third;
            }
            return f((low + high) / 2);
        };
        return least(1, [&](double u) { return least(1 - u, [&](double v) { return of(u, v); }); });
    };
}

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    const auto scalar = [](double x) { return btScalar(x); };
    cases.push_back({std::make_shared<btBoxShape>(btVector3(1, 2, scalar(0.3))), box_distance(1, 2, 0.3), 1e-6});
    // Smaller than the default margin.
    cases.push_back({std::make_shared<btBoxShape>(btVector3(scalar(0.01), scalar(0.02), scalar(0.03))),
                     box_distance(0.01, 0.02, 0.03), 1e-6});
    for (int axis = 0; axis < 3; ++axis) {
        const std::vector<std::array<double, 2>> tube{{0, -0.8}, {0.5, -0.8}, {0.5, 0.8}, {0, 0.8}};
        const std::vector<std::array<double, 2>> tip{{0, -0.6}, {0.7, -0.6}, {0, 0.6}};
        btVector3 half(scalar(0.5), scalar(0.5), scalar(0.5));
        half[axis] = scalar(0.8);
        std::shared_ptr<btCollisionShape> cylinder, cone;
        if (axis == 0) {
            cylinder = std::make_shared<btCylinderShapeX>(half);
            cone = std::make_shared<btConeShapeX>(scalar(0.7), scalar(1.2));
        } else if (axis == 1) {
            cylinder = std::make_shared<btCylinderShape>(half);
            cone = std::make_shared<btConeShape>(scalar(0.7), scalar(1.2));
        } else {
            cylinder = std::make_shared<btCylinderShapeZ>(half);
            cone = std::make_shared<btConeShapeZ>(scalar(0.7), scalar(1.2));
        }
        cases.push_back({cylinder, turned_distance(axis, tube)});
        cases.push_back({cone, turned_distance(axis, tip)});
    }
    const btVector3 centres[] = {btVector3(0, 0, 0), btVector3(1, 0, 0), btVector3(scalar(0.2), scalar(0.9), 0)};
    const btScalar radii[] = {scalar(0.5), scalar(0.3), scalar(0.2)};
    cases.push_back({std::make_shared<btMultiSphereShape>(centres, radii, 3),
                     hull_distance({{{0, 0, 0}, 0.5}, {{1, 0, 0}, 0.3}, {{0.2, 0.9, 0}, 0.2}})});
    cases.push_back({std::make_shared<btMultiSphereShape>(centres, radii, 1), hull_distance({{{0, 0, 0}, 0.5}})});
    // A point inside, and one given twice, change nothing.
    auto hull = std::make_shared<btConvexHullShape>();
    for (const btVector3& p : {btVector3(0, 0, 0), btVector3(2, 0, 0), btVector3(0, 1, 0), btVector3(0, 0, 1),
                               btVector3(scalar(0.3), scalar(0.2), scalar(0.2)), btVector3(2, 0, 0)})
        hull->addPoint(p);
    hull->setLocalScaling(btVector3(1, 2, 1));
    cases.push_back({hull,
                     [](const Vec3& p) {
                         return std::max({-p.x, -p.y, -p.z, (p.x / 2 + p.y / 2 + p.z - 1) / std::sqrt(1.5)});
                     },
                     1e-5});
    return cases;
}

double size_of(const Mesh& mesh) {
    Vec3 low = mesh.vertices[0], high = low;
    for (const Vec3& v : mesh.vertices) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

// Points all over the mesh are near the true surface.
TEST(StandIn, LiesNearTheTrueSurface) {
    for (const Case& c : all_cases()) {
        const Mesh mesh = bullet::stand_in(*c.shape);
        ASSERT_FALSE(mesh.triangles.empty()) << c.shape->getName();
        const double size = size_of(mesh);
        double most = 0;
        const auto measure = [&](const Vec3& p) { most = std::max(most, std::fabs(c.distance(p))); };
        for (const auto& t : mesh.triangles) {
            const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &d = mesh.vertices[t[2]];
            for (int i = 0; i <= 3; ++i)
                for (int k = 0; i + k <= 3; ++k) {
                    const double u = i / 3.0, v = k / 3.0, w = 1 - u - v;
                    measure({w * a.x + u * b.x + v * d.x, w * a.y + u * b.y + v * d.y, w * a.z + u * b.z + v * d.z});
                }
        }
        EXPECT_LT(most / size, c.tolerance) << c.shape->getName();
        const auto shape = Shape::make(mesh);
        EXPECT_TRUE(shape->report().closed) << c.shape->getName();
        EXPECT_GT(shape->report().volume, 0) << c.shape->getName();
        RecordProperty(c.shape->getName(), std::to_string(most / size));
    }
}

// The other way: a line from the middle through every true surface point meets the mesh at that distance.
TEST(StandIn, IsNearEverywhere) {
    scenes::Random random(11);
    for (const Case& c : all_cases()) {
        const Mesh mesh = bullet::stand_in(*c.shape);
        const double size = size_of(mesh);
        Vec3 middle{};
        for (const Vec3& v : mesh.vertices) {
            const double n = double(mesh.vertices.size());
            middle = {middle.x + v.x / n, middle.y + v.y / n, middle.z + v.z / n};
        }
        for (int i = 0; i < 200; ++i) {
            const Vec3 to{random.symmetric(), random.symmetric(), random.symmetric()};
            double near = 0, far = 4 * size / length(to.x, to.y, to.z);
            const auto at = [&](double t) {
                return Vec3{middle.x + t * to.x, middle.y + t * to.y, middle.z + t * to.z};
            };
            for (int k = 0; k < 30; ++k) (c.distance(at((near + far) / 2)) < 0 ? near : far) = (near + far) / 2;
            const Vec3 p = at(near); // on the true surface
            double above = -1e30;    // its height over the mesh's highest plane: outside, at most its distance
            double below = 1e30;
            for (const auto& t : mesh.triangles) {
                const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &d = mesh.vertices[t[2]];
                const Vec3 u{b.x - a.x, b.y - a.y, b.z - a.z}, v{d.x - a.x, d.y - a.y, d.z - a.z};
                const Vec3 n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
                const double h = ((p.x - a.x) * n.x + (p.y - a.y) * n.y + (p.z - a.z) * n.z) / length(n.x, n.y, n.z);
                above = std::max(above, h);
                below = std::min(below, std::fabs(h));
            }
            EXPECT_LT(above, c.tolerance * size) << c.shape->getName();
            EXPECT_LT(below, c.tolerance * size) << c.shape->getName();
        }
    }
}

TEST(StandIn, IsMadeOnce) {
    bullet::ShapeCache cache(1);
    const btBoxShape a(btVector3(1, 2, 3)), b(btVector3(1, 2, 3)), other(btVector3(1, 2, 4));
    EXPECT_EQ(cache.get(a).shape, cache.get(b).shape);
    EXPECT_NE(cache.get(a).shape, cache.get(other).shape);
    btBoxShape thin(btVector3(1, 2, 3));
    thin.setMargin(btScalar(0.2)); // counted inwards: the same surface
    EXPECT_EQ(cache.get(a).shape->box_max(), cache.get(thin).shape->box_max());
    const btCylinderShape upright(btVector3(1, 2, 1));
    const btCylinderShapeZ lying(btVector3(1, 2, 1));
    EXPECT_NE(cache.get(upright).shape, cache.get(lying).shape);
}

TEST(StandIn, FlatHullHasNone) {
    btConvexHullShape flat;
    EXPECT_TRUE(bullet::stand_in(flat).triangles.empty());
    for (int i = 0; i < 5; ++i) flat.addPoint(btVector3(btScalar(i), btScalar(i * i), 0));
    EXPECT_TRUE(bullet::stand_in(flat).triangles.empty());
    bullet::ShapeCache cache(1);
    EXPECT_EQ(cache.get(flat).shape, nullptr);
}

} // namespace
} // namespace raycontact::test
