// SPDX-License-Identifier: Apache-2.0
// Regions of a mesh are what brute force finds.
#include "reference/random.h"
#include "reference/vector.h"

#include <raycontact/query.h>
#include <scenes/models/procedural.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace raycontact {
namespace {

using namespace reference;

class Regions : public testing::TestWithParam<double> {
protected:
    static std::shared_ptr<const Shape> make(double far) {
        Mesh mesh = scenes::bumpy_torus(2000);
        for (Vec3& v : mesh.vertices) v = v + Vec3{far, -far, far};
        return Shape::make(mesh);
    }
    std::shared_ptr<const Shape> shape_ = make(GetParam());
    Random random_{7};
    Vec3 some_point() { return shape_->centre() + 1.5 * random_.in_ball(); }
};

TEST_P(Regions, TrianglesInABox) {
    std::vector<std::uint32_t> found{7}; // is replaced
    std::size_t total = 0;
    for (int k = 0; k < 200; ++k) {
        const Vec3 p = some_point(), q = some_point();
        const Vec3 low{std::min(p.x, q.x), std::min(p.y, q.y), std::min(p.z, q.z)};
        const Vec3 high{std::max(p.x, q.x), std::max(p.y, q.y), std::max(p.z, q.z)};
        triangles_in_box(*shape_, low, high, found);
        std::vector<std::uint32_t> expected;
        for (std::uint32_t t = 0; t < shape_->triangles().size(); ++t) {
            const auto reaches = [&](double Vec3::*axis) {
                double least = 1e300, most = -1e300;
                for (const std::uint32_t v : shape_->triangles()[t]) {
                    least = std::min(least, shape_->vertices()[v].*axis);
                    most = std::max(most, shape_->vertices()[v].*axis);
                }
                return least <= high.*axis && low.*axis <= most;
            };
            if (reaches(&Vec3::x) && reaches(&Vec3::y) && reaches(&Vec3::z)) expected.push_back(t);
        }
        EXPECT_EQ(found, expected);
        total += found.size();
    }
    EXPECT_GT(total, 1000u);
}

TEST_P(Regions, VerticesBelowAPlane) {
    std::vector<std::uint32_t> found;
    std::size_t total = 0;
    for (int k = 0; k < 200; ++k) {
        const Vec3 normal = random_.uniform(0.1, 10) * random_.direction();
        const double offset = dot(normal, some_point());
        vertices_below(*shape_, normal, offset, found);
        std::vector<std::uint32_t> expected;
        for (std::uint32_t v = 0; v < shape_->vertices().size(); ++v)
            if (dot(normal, shape_->vertices()[v]) < offset) expected.push_back(v);
        EXPECT_EQ(found, expected);
        total += found.size();
    }
    EXPECT_GT(total, 10000u);
}

TEST_P(Regions, BoxesThatCoverTheMesh) {
    for (const std::size_t most : {std::size_t{1}, std::size_t{20}, std::size_t{1000}}) {
        const std::vector<AxisBox> boxes = covering_boxes(*shape_, most);
        ASSERT_GE(boxes.size(), 1u);
        EXPECT_LE(boxes.size(), most);
        const double slack = 1e-6 * shape_->radius();
        for (const Vec3& v : shape_->vertices())
            EXPECT_TRUE(std::ranges::any_of(boxes, [&](const AxisBox& box) {
                return box.low.x - slack <= v.x && v.x <= box.high.x + slack && box.low.y - slack <= v.y
                       && v.y <= box.high.y + slack && box.low.z - slack <= v.z && v.z <= box.high.z + slack;
            }));
    }
}

TEST_P(Regions, WhatIsNotANumberIsNowhere) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::uint32_t> found{7};
    triangles_in_box(*shape_, {nan, nan, nan}, {nan, nan, nan}, found);
    EXPECT_TRUE(found.empty());
    vertices_below(*shape_, {0, 0, nan}, 0, found);
    EXPECT_TRUE(found.empty());
}

INSTANTIATE_TEST_SUITE_P(At, Regions, testing::Values(0.0, 1e4),
                         [](const auto& one) { return std::string(one.param == 0 ? "TheOrigin" : "TenKilometres"); });

} // namespace
} // namespace raycontact
