// SPDX-License-Identifier: Apache-2.0
// Where two solids press on each other, whatever the division of their faces: contact_patches(), and the contacts of
// direction `weighted`, which are its parts.
#include "reference/meshes.h"
#include "reference/vector.h"
#include "unit/mesh/solids.h"

#include <raycontact/clash.h>
#include <raycontact/collide.h>
#include <raycontact/error.h>
#include <raycontact/query.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

using namespace raycontact;
using reference::box_mesh;

namespace {

constexpr double pi = 3.14159265358979323846;

Vec3 plus(const Vec3& a, double s, const Vec3& b) {
    return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
double size_of(const Vec3& a) {
    return std::sqrt(dot(a, a));
}

/// Each triangle in four, `times` times.
Mesh divided(Mesh mesh, int times) {
    for (int i = 0; i < times; ++i) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        std::vector<std::array<std::uint32_t, 3>> triangles;
        const auto middle = [&](std::uint32_t p, std::uint32_t q) {
            const auto [at, is_new] = middles.try_emplace(std::minmax(p, q), std::uint32_t(mesh.vertices.size()));
            if (is_new) {
                const Vec3 a = mesh.vertices[p], b = mesh.vertices[q];
                mesh.vertices.push_back({0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z)});
            }
            return at->second;
        };
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(triangles);
    }
    return mesh;
}

std::shared_ptr<const Shape> made(const Mesh& mesh) {
    return Shape::make(mesh);
}

Pose turned_about(const Vec3& axis, double angle, const Vec3& at = {}) {
    const double n = size_of(axis), x = axis.x / n, y = axis.y / n, z = axis.z / n, c = std::cos(angle),
                 s = std::sin(angle), d = 1 - c;
    return {{c + x * x * d, x * y * d - z * s, x * z * d + y * s, y * x * d + z * s, c + y * y * d, y * z * d - x * s,
             z * x * d - y * s, z * y * d + x * s, c + z * z * d},
            at};
}

double lowest(const Mesh& mesh, const Pose& pose) {
    double low = 1e300;
    for (const Vec3& v : mesh.vertices) low = std::min(low, transform_point(pose, v).z);
    return low;
}

struct Sums {
    double area = 0, volume = 0;
    Vec3 force{}, centre{}; ///< of volume x normal; of the volume
};
Sums sums_of(const std::vector<ContactPatch>& patches) {
    Sums sums;
    for (const ContactPatch& p : patches) {
        EXPECT_NEAR(size_of(p.normal), 1, 1e-12);
        EXPECT_NEAR(p.depth * p.area, p.volume, 1e-12 * p.volume);
        sums.area += p.area;
        sums.volume += p.volume;
        sums.force = plus(sums.force, p.volume, p.normal);
        sums.centre = plus(sums.centre, p.volume, p.centre);
    }
    const double by = 1 / sums.volume;
    sums.centre = {by * sums.centre.x, by * sums.centre.y, by * sums.centre.z};
    return sums;
}
Sums sums_of(const std::vector<Contact>& contacts) {
    Sums sums;
    for (const Contact& c : contacts) {
        EXPECT_EQ(c.feature.kind, FeatureKind::faces);
        const double volume = double(c.depth) * double(c.weight);
        sums.area += double(c.weight);
        sums.volume += volume;
        sums.force = plus(sums.force, volume, c.normal);
        sums.centre = plus(plus(sums.centre, 0.5 * volume, c.point_a), 0.5 * volume, c.point_b);
    }
    const double by = 1 / sums.volume;
    sums.centre = {by * sums.centre.x, by * sums.centre.y, by * sums.centre.z};
    return sums;
}
std::vector<Contact> weighted(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    return collide(a, pose_a, b, pose_b, {.direction = Direction::weighted});
}

// The contacts of direction `weighted` add up to the patches, of vertices in float32.
void expect_same(const Sums& contacts, const Sums& patches, double size) {
    const double rounding = 1e-5 * patches.volume + 1e-6 * patches.area * size;
    EXPECT_NEAR(contacts.area, patches.area, 1e-5 * patches.area);
    EXPECT_NEAR(contacts.volume, patches.volume, rounding);
    EXPECT_LT(size_of(plus(contacts.force, -1, patches.force)), rounding);
    EXPECT_LT(size_of(plus(contacts.centre, -1, patches.centre)), 1e-5 * size);
}

TEST(ContactPatches, OfAPadHalfOverAnEdgeDependOnNoDivision) {
    const Mesh block = box_mesh({0.05, 0.05, 0.01}), pad = box_mesh({0.01, 0.01, 0.0025});
    const Pose low{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, -0.01}}, at{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.05, 0, 0.0024}};
    for (const int n : {0, 2, 4})
        for (const int m : {0, 1, 3, 5}) {
            const auto a = made(divided(block, n)), b = made(divided(pad, m));
            const std::vector<ContactPatch> patches = contact_patches(*a, low, *b, at);
            ASSERT_EQ(patches.size(), 1u) << n << ", " << m;
            EXPECT_NEAR(patches[0].area, 2e-4, 2e-8);
            EXPECT_NEAR(patches[0].volume, 2e-8, 2e-11);
            EXPECT_NEAR(patches[0].centre.x, 0.045, 1e-6);
            EXPECT_NEAR(patches[0].centre.y, 0, 1e-7);
            EXPECT_NEAR(patches[0].normal.y, 0, 1e-6);
            EXPECT_GT(patches[0].normal.z, 0.9999);
            expect_same(sums_of(weighted(*a, low, *b, at)), sums_of(patches), 0.02);
        }
}

/// A pose that a turn moves.
Pose placed(const Pose& turn, const Pose& pose) {
    Pose moved{{}, transform_point(turn, pose.translation)};
    for (std::size_t k = 0; k < 9; ++k)
        for (std::size_t i = 0; i < 3; ++i)
            moved.rotation[k] += turn.rotation[3 * (k / 3) + i] * pose.rotation[3 * i + k % 3];
    return moved;
}

/// Of a flat polygon, by its corners.
Vec3 area_of(const std::vector<Vec3>& corners) {
    Vec3 sum;
    for (std::size_t k = 2; k < corners.size(); ++k)
        sum += 0.5 * cross(corners[k - 1] - corners[0], corners[k] - corners[0]);
    return sum;
}

TEST(ContactPatches, HullOfAPadIsItsOutlineWhateverTheDivision) {
    const Mesh block = box_mesh({0.05, 0.05, 0.01}), pad = box_mesh({0.01, 0.01, 0.0025});
    const Pose low{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, -0.01}}, at{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.05, 0, 0.0024}};
    const Pose turn = turned_about({1, 2, 3}, 0.8, {5, -3, 2});
    for (const int n : {0, 3})
        for (const int m : {0, 2, 5}) {
            const auto a = made(divided(block, n)), b = made(divided(pad, m));
            const auto patches = contact_patches(*a, placed(turn, low), *b, placed(turn, at));
            ASSERT_EQ(patches.size(), 1u);
            const ContactPatch& patch = patches[0];
            EXPECT_GE(patch.hull.size(), 4u);
            EXPECT_LE(patch.hull.size(), 8u) << "corners in a row are left out";
            EXPECT_LT(length(area_of(patch.hull) - patch.area * patch.normal), 1e-7);
            for (const Vec3& corner : patch.hull) EXPECT_NEAR(dot(corner - patch.centre, patch.normal), 0, 1e-12);
            for (const double x : {0.04, 0.05})
                for (const double y : {-0.01, 0.01}) {
                    double nearest = 1;
                    for (const Vec3& c : patch.hull) // seen along the normal, which an overhang tilts
                        nearest = std::min(nearest, length(cross(c - transform_point(turn, {x, y, 0}), patch.normal)));
                    EXPECT_LT(nearest, 1e-5) << x << ' ' << y;
                }
            const Vec3 about{0.3, 0.2, 0.1};
            const std::vector<Wrench> basis = wrench_basis(patch, about);
            ASSERT_EQ(basis.size(), patch.hull.size());
            for (std::size_t i = 0; i < basis.size(); ++i) {
                EXPECT_EQ(basis[i].force, patch.normal);
                EXPECT_LT(length(basis[i].torque - cross(patch.hull[i] - about, patch.normal)), 1e-15);
            }
        }
}

// What lies under the floor, and where surfaces cross, has the same least and greatest places as the hulls have.
TEST(ContactPatches, HullsOfARingReachAsFarAsTheRing) {
    const auto floor = made(box_mesh({3, 3, 0.5}));
    const Mesh ring = test::torus(24, 12, 1, 0.3, 0);
    const auto body = made(ring);
    const Pose under{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, -0.5}};
    for (const double tilt : {0.0, 0.02}) {
        Pose pose = turned_about({1, 0.3, 0}, tilt, {0.1, 0.2, 0});
        pose.translation.z = -0.06 - lowest(ring, pose);
        std::vector<Vec3> points;
        for (const auto& t : ring.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3 p = transform_point(pose, ring.vertices[t[k]]),
                           q = transform_point(pose, ring.vertices[t[(k + 1) % 3]]);
                if (p.z < 0) points.push_back(p);
                if ((p.z < 0) != (q.z < 0)) points.push_back(p + (p.z / (p.z - q.z)) * (q - p));
            }
        const std::vector<ContactPatch> patches = contact_patches(*floor, under, *body, pose);
        ASSERT_FALSE(patches.empty());
        for (int i = 0; i < 32; ++i) {
            const Vec3 way{std::cos(2 * pi * i / 32), std::sin(2 * pi * i / 32), 0};
            double most = -1e9, told = -1e9;
            for (const Vec3& p : points) most = std::max(most, dot(way, p));
            for (const ContactPatch& patch : patches)
                for (const Vec3& corner : patch.hull) told = std::max(told, dot(way, corner));
            EXPECT_NEAR(told, most, 1e-4) << tilt << ", " << i;
        }
        for (const ContactPatch& patch : patches) EXPECT_GE(length(area_of(patch.hull)), patch.area * (1 - 1e-6));
    }
}

// Bodies that are pressed into a flat floor are pushed straight up by what lies in it, and feel nothing along it.
TEST(ContactPatches, OnAFlatFloorPushStraightUp) {
    std::mt19937 random(65);
    const auto unit = [&] { return double(random()) / 4294967296.0; };
    const std::array bodies{box_mesh({0.1, 0.1, 0.1}), box_mesh({0.3, 0.05, 0.02}), test::torus(24, 12, 0.2, 0.07, 0),
                            divided(box_mesh({0.1, 0.2, 0.1}), 3), reference::bumpy_octahedron_mesh(6)};
    for (const int n : {0, 3}) {
        const auto floor = made(divided(box_mesh({2, 2, 0.5}), n));
        const Pose under{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, -0.5}};
        for (const Mesh& mesh : bodies) {
            const auto body = made(mesh);
            for (int i = 0; i < 20; ++i) {
                Pose pose = turned_about({unit() - 0.5, unit() - 0.5, unit() - 0.5}, 6 * unit());
                const double depth = 0.001 + 0.03 * unit();
                pose.translation = {unit() - 0.5, unit() - 0.5, -lowest(mesh, pose) - depth};
                const std::vector<ContactPatch> patches = contact_patches(*floor, under, *body, pose);
                ASSERT_GE(patches.size(), 1u);
                const Sums sums = sums_of(patches);
                const double volume = overlap_volume(*floor, under, *body, pose);
                EXPECT_LE(sums.volume, (1 + 1e-5) * volume); // what overhangs does not count
                EXPECT_GE(sums.volume, 0.9 * volume);
                EXPECT_LT(std::hypot(sums.force.x, sums.force.y), 1e-9 * volume);
                expect_same(sums_of(weighted(*floor, under, *body, pose)), sums, 0.1);
            }
        }
    }
}

// Of two that are exchanged the patches are the same, their normals reversed. What they share is all counted where
// nothing overhangs.
TEST(ContactPatches, OfConvexBodiesCountAllThatTheyShare) {
    std::mt19937 random(1965);
    const auto unit = [&] { return double(random()) / 4294967296.0; };
    const std::array bodies{box_mesh({0.1, 0.12, 0.2}), reference::cone_mesh(), reference::tetrahedron_mesh(),
                            divided(box_mesh({0.3, 0.2, 0.1}), 2)};
    int pressed = 0;
    for (int i = 0; i < 400; ++i) {
        const auto a = made(bodies[random() % 4]), b = made(bodies[random() % 4]);
        const Pose pose_a = turned_about({unit() - 0.5, unit() - 0.5, unit() - 0.5}, 6 * unit());
        Pose pose_b = turned_about({unit() - 0.5, unit() - 0.5, unit() - 0.5}, 6 * unit());
        // Along a random way until they hardly meet.
        const Vec3 way = {unit() - 0.5, unit() - 0.5, unit() - 0.5};
        double apart = 4, meet = 0;
        for (int k = 0; k < 40; ++k) {
            const double s = 0.5 * (apart + meet);
            pose_b.translation = plus({}, s / size_of(way), way);
            (intersects(*a, pose_a, *b, pose_b) ? meet : apart) = s;
        }
        pose_b.translation = plus({}, (meet - 0.02 * unit()) / size_of(way), way);
        const std::vector<ContactPatch> patches = contact_patches(*a, pose_a, *b, pose_b);
        if (patches.empty()) continue;
        ++pressed;
        const Sums sums = sums_of(patches), back = sums_of(contact_patches(*b, pose_b, *a, pose_a));
        EXPECT_EQ(patches.size(), 1u);
        const double volume = overlap_volume(*a, pose_a, *b, pose_b);
        EXPECT_LE(sums.volume, (1 + 1e-5) * volume) << i;
        EXPECT_GE(sums.volume, 0.8 * volume) << i;
        const double rounding = 1e-4 * sums.volume + 1e-6 * sums.area; // where the surfaces cross, it is to 1e-7
        EXPECT_NEAR(back.volume, sums.volume, rounding) << i;
        EXPECT_LT(size_of(plus(sums.force, 1, back.force)), rounding);
    }
    EXPECT_GT(pressed, 380);
}

/// What lies over a polygon that its first corner sees the whole of, counter-clockwise.
Mesh prism(const std::vector<std::array<double, 2>>& polygon, double half) {
    Mesh mesh;
    const auto n = static_cast<std::uint32_t>(polygon.size());
    for (const double z : {-half, half})
        for (const auto& [x, y] : polygon) mesh.vertices.push_back({x, y, z});
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t next = (i + 1) % n;
        if (i > 0 && next > 0) {
            mesh.triangles.push_back({0, next, i});
            mesh.triangles.push_back({n, n + i, n + next});
        }
        mesh.triangles.push_back({i, next, n + next});
        mesh.triangles.push_back({i, n + next, n + i});
    }
    return mesh;
}
std::vector<std::array<double, 2>> regular(int n, double radius) {
    std::vector<std::array<double, 2>> corners;
    for (int i = 0; i < n; ++i)
        corners.push_back({radius * std::cos(2 * pi * i / n), radius * std::sin(2 * pi * i / n)});
    return corners;
}
Mesh tube(int n, double inner, double outer, double half) {
    Mesh mesh;
    for (const double z : {-half, half})
        for (const double radius : {inner, outer})
            for (const auto& [x, y] : regular(n, radius)) mesh.vertices.push_back({x, y, z});
    const auto corner = [&](int ring, int i) { return static_cast<std::uint32_t>(ring * n + i % n); };
    const auto quad = [&](int p, int q, int i) { // from ring p to ring q
        mesh.triangles.push_back({corner(p, i), corner(p, i + 1), corner(q, i + 1)});
        mesh.triangles.push_back({corner(p, i), corner(q, i + 1), corner(q, i)});
    };
    for (int i = 0; i < n; ++i) {
        quad(1, 3, i); // outside
        quad(2, 0, i); // inside
        quad(3, 2, i); // top
        quad(0, 1, i); // bottom
    }
    return mesh;
}

// In a corner the floor and the wall press each by its own depth, also where one of them hardly touches.
TEST(ContactPatches, InACornerAreThoseOfFloorAndWall) {
    const Mesh corner = prism({{0, 0}, {0, 2}, {-1, 2}, {-1, -1}, {2, -1}, {2, 0}}, 1);
    for (const int n : {0, 2})
        for (const double wall : {1e-5, 1e-3, 1e-2})
            for (const double askew : {0.0, 1e-4}) {
                const double floor = 1e-3;
                const auto a = made(divided(corner, n)), b = made(divided(box_mesh({0.25, 0.25, 0.25}), 2 - n));
                Pose pose = turned_about({0, 0, 1}, askew, {0.25 - wall, 0.25 - floor, 0});
                const std::vector<ContactPatch> patches = contact_patches(*a, {}, *b, pose);
                ASSERT_EQ(patches.size(), 2u) << wall;
                const bool floor_first = patches[0].normal.y > 0.5;
                const ContactPatch &down = patches[floor_first ? 0 : 1], &side = patches[floor_first ? 1 : 0];
                EXPECT_NEAR(down.normal.y, 1, 1e-9);
                EXPECT_NEAR(side.normal.x, 1, 1e-9);
                if (askew != 0) continue;
                EXPECT_NEAR(down.area, 0.5 * (0.5 - wall), 1e-6);
                EXPECT_NEAR(down.depth, floor, 1e-6 * floor);
                EXPECT_NEAR(side.area, 0.5 * (0.5 - floor), 1e-6);
                EXPECT_NEAR(side.depth, wall, 1e-6 * wall);
                expect_same(sums_of(weighted(*a, {}, *b, pose)), sums_of(patches), 0.5);
            }
}

// What is pressed into a hole all around is pushed nowhere; moved to one side, back from there.
TEST(ContactPatches, AroundAPegCancelOut) {
    for (const int n : {4, 6, 12, 48}) {
        const double play = -1e-3;
        const auto hole = made(tube(n, 0.1, 0.2, 0.1)), peg = made(prism(regular(n, 0.1 - play), 0.3));
        const std::vector<ContactPatch> patches = contact_patches(*hole, {}, *peg, {});
        EXPECT_GE(patches.size(), 4u);
        const Sums sums = sums_of(patches);
        const double ring = 0.5 * n * std::sin(2 * pi / n) * (0.101 * 0.101 - 0.1 * 0.1) * 0.2;
        EXPECT_NEAR(sums.volume, ring, 0.02 * ring);
        EXPECT_LT(size_of(sums.force), 1e-6 * sums.volume) << n;
        expect_same(sums_of(weighted(*hole, {}, *peg, {})), sums, 0.1);
        const Pose aside{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {4e-4, 3e-4, 0}};
        const Sums pushed = sums_of(contact_patches(*hole, {}, *peg, aside));
        EXPECT_LT(pushed.force.x, -0.1 * sums.volume);
        EXPECT_NEAR(pushed.force.y / pushed.force.x, 0.75, 0.05);
        EXPECT_LT(std::fabs(pushed.force.z), 1e-9 * sums.volume);
    }
}

// Four feet on one floor are four patches, though the floor is two triangles.
TEST(ContactPatches, AreAsManyAsFeet) {
    Mesh table = prism({{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}, 0.05);
    for (const double x : {-0.4, 0.4})
        for (const double y : {-0.4, 0.4}) test::append_box(table, {x - 0.05, y - 0.05, -0.5}, {x + 0.05, y + 0.05, 0});
    const auto floor = made(box_mesh({2, 2, 0.5})), body = made(table);
    const Pose under{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, -0.5}}, over{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0.499}};
    const std::vector<ContactPatch> patches = contact_patches(*floor, under, *body, over);
    ASSERT_EQ(patches.size(), 4u);
    for (const ContactPatch& p : patches) {
        EXPECT_NEAR(p.area, 0.01, 1e-6);
        EXPECT_NEAR(p.depth, 1e-3, 1e-7);
        EXPECT_NEAR(std::fabs(p.centre.x), 0.4, 1e-6);
        EXPECT_NEAR(p.normal.z, 1, 1e-12);
    }
}

// Two ridges that cross push each other apart across both.
TEST(ContactPatches, OfCrossedRidgesHaveOneNormal) {
    const Mesh bar = box_mesh({1, 0.1, 0.1});
    for (const double turn : {0.3, 1.0, pi / 2})
        for (const double roll : {pi / 4, 0.5}) {
            const Pose below = turned_about({1, 0, 0}, roll);
            const double reach = -lowest(bar, below);
            const Pose flat = turned_about({0, 0, 1}, turn);
            Pose above = turned_about({1, 0, 0}, -roll);
            for (auto* p : {&above.rotation}) {
                const auto& r = flat.rotation;
                std::array<double, 9> product{};
                for (std::size_t i = 0; i < 3; ++i)
                    for (std::size_t j = 0; j < 3; ++j)
                        for (std::size_t k = 0; k < 3; ++k) product[3 * i + j] += r[3 * i + k] * (*p)[3 * k + j];
                *p = product;
            }
            above.translation = {0, 0, 2 * reach - 0.002};
            const auto shape = made(bar);
            const std::vector<ContactPatch> patches = contact_patches(*shape, below, *shape, above);
            ASSERT_EQ(patches.size(), 1u);
            EXPECT_NEAR(patches[0].normal.z, 1, 1e-6) << turn << ", " << roll;
        }
}

TEST(ContactPatches, NeedAnInside) {
    const auto box = made(box_mesh({1, 1, 1})), sheet = made(reference::sheet_mesh(4));
    EXPECT_THROW(contact_patches(*box, {}, *sheet, {}), InputError);
    EXPECT_THROW(contact_patches(*sheet, {}, *box, {}), InputError);
    EXPECT_TRUE(contact_patches(*box, {}, *box, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 3}}).empty());
}

// Where a rod pierces a plate no face stands over another: the contacts of edges stay.
TEST(ContactPatches, OfWhatIsPiercedAreNone) {
    const auto plate = made(box_mesh({1, 1, 0.01})), rod = made(box_mesh({0.05, 0.05, 1}));
    EXPECT_TRUE(contact_patches(*plate, {}, *rod, turned_about({1, 2, 0}, 0.1)).empty());
    const std::vector<Contact> contacts = weighted(*plate, {}, *rod, turned_about({1, 2, 0}, 0.1));
    ASSERT_FALSE(contacts.empty());
    for (const Contact& c : contacts) EXPECT_NE(c.feature.kind, FeatureKind::faces);
}

} // namespace
