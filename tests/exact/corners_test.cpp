// SPDX-License-Identifier: Apache-2.0
// Depth is a way out: of parts in each other's corners, ridges that cross, and boxes that lie flush on each other. Ways
// are found by trying moves against an exact test, whatever the rule says.
#include "exact/corners.h"
#include "exact/words.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include "scenes/models/trigonometry.h"

#include <raycontact/collide.h>
#include <raycontact/query.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <string>

using namespace raycontact;
using namespace raycontact::exact;
using namespace raycontact::reference;

namespace {

struct Posed {
    std::shared_ptr<const Shape> a, b;
    Pose pose_b;
    explicit Posed(const CornerPair& pair) : a(Shape::make(pair.a)), b(Shape::make(pair.b)), pose_b(pair.pose_b) {}
    bool intersect(const Vec3& moved) const {
        Pose pose = pose_b;
        pose.translation = pose.translation + moved;
        return intersects(*a, {}, *b, pose);
    }
    std::vector<Contact> contacts() const { return collide(*a, {}, *b, pose_b); }
};

Vec3 normal_of(const Contact& c) {
    return {double(c.normal.x), double(c.normal.y), double(c.normal.z)};
}

const Contact* deepest_of(const std::vector<Contact>& contacts) {
    const auto at = std::max_element(contacts.begin(), contacts.end(),
                                     [](const Contact& c, const Contact& d) { return c.depth < d.depth; });
    return at == contacts.end() ? nullptr : &*at;
}

// All around, and as many in the plane of the profiles.
const std::vector<Vec3>& directions() {
    static const std::vector<Vec3> all = [] {
        std::vector<Vec3> list;
        constexpr int count = 200;
        for (int i = 0; i < count; ++i) {
            const double z = 1 - (2 * i + 1.0) / count, level = std::sqrt(1 - z * z);
            const auto [sine, cosine] = scenes::sine_cosine(0.381966 * i);
            list.push_back({level * cosine, level * sine, z});
            const auto flat = scenes::sine_cosine(double(i) / count);
            list.push_back({flat.cosine, flat.sine, 0});
        }
        return list;
    }();
    return all;
}

// Whether b comes apart from a by that move in one of the directions, or along a contact's normal.
bool comes_apart(const Posed& pair, const std::vector<Contact>& contacts, double metres) {
    const auto apart = [&](const Vec3& way) { return !pair.intersect(metres * way); };
    return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& c) { return apart(normal_of(c)); })
           || std::any_of(directions().begin(), directions().end(), apart);
}

// The least move of b after which all contacts are undone, as a solver finds it.
Vec3 asked_by(const std::vector<Contact>& contacts) {
    Vec3 move{};
    std::vector<double> pushes(contacts.size(), 0);
    for (int round = 0; round < 1000; ++round) {
        double most = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const Vec3 n = normal_of(contacts[i]);
            const double before = pushes[i];
            pushes[i] = std::max(0.0, before + double(contacts[i].depth) - dot(n, move));
            move = move + (pushes[i] - before) * n;
            most = std::max(most, std::fabs(pushes[i] - before));
        }
        if (most < 1e-4 * length(move)) break;
    }
    return move;
}

// What is left of the way after b was moved four times as its contacts ask.
double left_after_moves(Posed pair, const std::vector<Contact>& first) {
    std::vector<Contact> contacts = first;
    double left = 0;
    for (int move = 0; move < 4; ++move) {
        const Vec3 asked = asked_by(contacts);
        left = length(asked);
        pair.pose_b.translation = pair.pose_b.translation + (1 + 1e-6 / std::max(left, 1e-9)) * asked;
        if (!pair.intersect({})) return 0;
        contacts = pair.contacts();
        if (contacts.empty()) return 0; // some perturbations deep
    }
    return left;
}

// Each side of a wide bar has a way of its own, and no move undoes both.
bool has_two_ways(std::size_t family) {
    return std::string(corner_families[family]) == "wide bar in a channel";
}

TEST(corners, depth_is_a_way_out) {
    constexpr std::size_t poses = 1000;
    for (std::size_t family = 0; family < std::size(corner_families); ++family) {
        std::size_t met = 0, without = 0, deep = 0, stuck = 0;
        double worst = 0;
        std::string words;
        for (std::size_t i = 0; i < poses; ++i) {
            Random random(1000 * family + 7919 * i + 17);
            const CornerPair made = corner_pair(family, random);
            const Posed pair(made);
            const MeshReport &a = pair.a->report(), &b = pair.b->report();
            ASSERT_TRUE(a.closed && a.outward && !a.self_intersecting) << corner_families[family] << i << to_text(a);
            ASSERT_TRUE(b.closed && b.outward && !b.self_intersecting) << corner_families[family] << i << to_text(b);
            if (!pair.intersect({})) continue;
            ++met;
            const auto contacts = pair.contacts();
            const Contact* deepest = deepest_of(contacts);
            if (!deepest) {
                ++without;
                continue;
            }
            const double depth = double(deepest->depth);
            const bool out = has_two_ways(family) ? depth > 2 * made.way : comes_apart(pair, contacts, 0.49 * depth);
            deep += out;
            worst = std::max(worst, depth / made.way);
            if (out && words.empty()) words = std::to_string(i) + ": " + words_of(*deepest);
            if (!has_two_ways(family)) stuck += left_after_moves(pair, contacts) > 0.1 * made.way;
        }
        std::printf("[ counts   ] %s: %zu poses, %zu without a contact, %zu deeper than twice the way out, %zu still "
                    "in after four moves; at most %.3g of the known way\n",
                    corner_families[family], met, without, deep, stuck, worst);
        std::fflush(stdout);
        EXPECT_GE(met, poses * 4 / 5) << corner_families[family];
        EXPECT_EQ(without, 0u) << corner_families[family];
        EXPECT_EQ(deep, 0u) << corner_families[family] << ' ' << words;
        EXPECT_LE(stuck, poses / 40) << corner_families[family];
    }
}

TEST(corners, knives_and_wedges_come_apart) {
    for (const double half_angle : {1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0, 30.0, 45.0, 60.0, 75.0, 85.0}) {
        double least = 2, most = 0;
        for (std::size_t i = 0; i < 80; ++i) {
            Random random(77 + i);
            const double turn = random.uniform(0.03, 0.47);
            const double overlap = (half_angle < 50 ? 5e-3 : 2e-3) * std::pow(0.02, random.uniform());
            const Posed pair(crossed_ridges(half_angle, turn, overlap, random));
            const auto contacts = pair.contacts();
            const Contact* deepest = deepest_of(contacts);
            ASSERT_NE(deepest, nullptr) << half_angle << ' ' << i;
            // Both are moved inward, together by four perturbations.
            const double size =
                std::min(length(pair.a->box_max() - pair.a->box_min()), length(pair.b->box_max() - pair.b->box_min()));
            const double depth = double(deepest->depth), rounding = 5e-7 * size;
            least = std::min(least, (depth + rounding) / overlap);
            most = std::max(most, (depth - rounding) / overlap);
            EXPECT_FALSE(pair.intersect((depth + rounding) * normal_of(*deepest)))
                << half_angle << ' ' << i << ' ' << words_of(*deepest);
        }
        std::printf("[ counts   ] ridges of half an angle of %g degrees: deepest from %.4g to %.4g of the overlap\n",
                    half_angle, least, most);
        EXPECT_GE(least, 0.999);
        EXPECT_LE(most, 1.001);
    }
}

using Point = std::array<double, 2>;

double hull_area(std::vector<Point> points) {
    std::sort(points.begin(), points.end());
    std::vector<Point> hull;
    const auto turns = [](const Point& o, const Point& p, const Point& q) {
        return (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
    };
    for (int side = 0; side < 2; ++side) {
        const std::size_t first = hull.size();
        for (const Point& p : points) {
            while (hull.size() >= first + 2 && turns(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    double area = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Point &p = hull[i], &q = hull[(i + 1) % hull.size()];
        area += (p[0] * q[1] - q[0] * p[1]) / 2;
    }
    return area;
}

// Pads, crates and bricks: their contacts hold all of the patch, whatever rounding does.
TEST(corners, boxes_flush_on_each_other_touch_all_over) {
    for (const char* kind : {"pads", "bricks along x", "bricks along y", "pads but for rounding"}) {
        double least = 1;
        std::size_t most = 0;
        for (std::uint64_t i = 0; i < 500; ++i) {
            Random random(50 + i);
            const std::string name = kind;
            const Vec3 half{random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.05, 0.5)};
            const double overlap = 1e-4 * std::pow(30, random.uniform());
            Vec3 shift{};
            if (name == "bricks along x") shift.x = random.uniform(-1.8, 1.8) * half.x;
            if (name == "bricks along y") shift.y = random.uniform(-1.8, 1.8) * half.y;
            if (name == "pads but for rounding") shift = 1e-8 * random.in_ball();
            Pose below, above;
            if (i % 2 != 0) below = random.rotation(), below.translation = 3 * random.in_ball();
            above.rotation = below.rotation;
            above.translation = below.translation + rotate(below, {shift.x, shift.y, 2 * half.z - overlap});
            const auto box = Shape::make(box_mesh(half));
            const auto contacts = i % 4 < 2 ? collide(*box, below, *box, above) : collide(*box, above, *box, below);
            most = std::max(most, contacts.size());
            std::vector<Point> points;
            for (const Contact& c : contacts) {
                const Vec3 n = rotate_back(below, normal_of(c));
                EXPECT_LE(double(c.depth), 2 * overlap) << kind << ' ' << i << ' ' << words_of(c);
                if (std::fabs(n.z) < 0.99 || double(c.depth) < overlap / 2) continue;
                const Vec3 at = rotate_back(below, c.point() - below.translation);
                points.push_back({at.x, at.y});
            }
            ASSERT_GE(points.size(), 3u) << kind << ' ' << i;
            const double area = (2 * half.x - std::fabs(shift.x)) * (2 * half.y - std::fabs(shift.y));
            least = std::min(least, hull_area(points) / area);
        }
        std::printf("[ counts   ] %s: the hull of contacts is at least %.4g of the patch, at most %zu contacts\n", kind,
                    least, most);
        EXPECT_GE(least, 0.99) << kind;
        EXPECT_LE(most, 8u) << kind;
    }
}

} // namespace
