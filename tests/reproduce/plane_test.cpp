// SPDX-License-Identifier: Apache-2.0
#include <reproduce/plane_test.h>

#include <scenes/models/procedural.h>

#include <gtest/gtest.h>

namespace raycontact::reproduce {
namespace {

PlaneTest of(const Mesh& mesh) {
    return {Shape::make(mesh), 40, 5, 0.1};
}

TEST(PlaneTest, ReprojectedForcesStandOnThePlane) {
    for (const Mesh& mesh : {scenes::round_sphere(136), scenes::bumpy_sphere(902), scenes::knot(902)}) {
        const Deviation found = plane_deviation(of(mesh), Direction::reprojected);
        EXPECT_GT(found.cases, 100u) << mesh.name;
        EXPECT_LT(found.percent, 1e-4) << mesh.name;
    }
}

TEST(PlaneTest, RaysDeviateMoreOnAnIrregularShape) {
    const double sphere = plane_deviation(of(scenes::round_sphere(136)), Direction::ray).percent;
    const double bumpy = plane_deviation(of(scenes::bumpy_sphere(902)), Direction::ray).percent;
    EXPECT_GT(sphere, 0.1);
    EXPECT_GT(bumpy, sphere);
}

TEST(PlaneTest, WeightsCountAndTheSameCallGivesTheSame) {
    const PlaneTest test = of(scenes::bumpy_sphere(902));
    const Deviation ray = plane_deviation(test, Direction::ray), weighted = plane_deviation(test, Direction::weighted);
    EXPECT_EQ(ray.cases, weighted.cases);
    EXPECT_NE(ray.percent, weighted.percent);
    EXPECT_EQ(plane_deviation(test, Direction::weighted).percent, weighted.percent);
}

TEST(PlaneTest, TheRoundSphereHasThePapersVertices) {
    EXPECT_EQ(scenes::round_sphere(136).vertices.size(), 70u);
    EXPECT_EQ(scenes::bumpy_sphere(2166).vertices.size(), 1085u);
}

} // namespace
} // namespace raycontact::reproduce
