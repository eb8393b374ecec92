// SPDX-License-Identifier: Apache-2.0
// Check::topology leaves out what grids need; preparing the shape finds it out. A report as JSON.
#include <raycontact/mesh.h>
#include <raycontact/shape.h>

#include "shape/accelerators.h"
#include "tests/unit/mesh/solids.h"

#include <gtest/gtest.h>

namespace raycontact {
namespace {

using namespace test;

std::uint32_t outward_once_prepared(const Mesh& mesh, Check check) {
    const auto shape = Shape::make(prepare_mesh(mesh, {.overlaps = Overlaps::leave, .check = check}));
    EXPECT_EQ(shape->data().header.outward != 0, check == Check::full && shape->report().outward);
    shape->prepare();
    return accelerators_of(*shape)->header.outward;
}

TEST(Check, TopologyIsTheSame) {
    const Mesh mesh = torus(24, 12, 1, 0.3);
    const MeshReport full = prepare_mesh(mesh).report;
    const MeshReport quick = prepare_mesh(mesh, {.overlaps = Overlaps::leave, .check = Check::topology}).report;
    EXPECT_TRUE(full.checked && full.outward);
    EXPECT_FALSE(quick.checked || quick.outward || quick.self_intersecting);
    EXPECT_TRUE(quick.closed && quick.manifold && quick.oriented);
    EXPECT_EQ(quick.volume, full.volume);
    EXPECT_EQ(quick.area, full.area);
    EXPECT_EQ(quick.components, full.components);
}

TEST(Check, PreparingFindsOutWhatIsOutward) {
    EXPECT_EQ(outward_once_prepared(torus(24, 12, 1, 0.3), Check::full), 1u);
    EXPECT_EQ(outward_once_prepared(torus(24, 12, 1, 0.3), Check::topology), 1u);
    // Its own tube is thicker than the way around: it runs into itself.
    EXPECT_EQ(outward_once_prepared(torus(24, 12, 1, 1.4), Check::full), 0u);
    EXPECT_EQ(outward_once_prepared(torus(24, 12, 1, 1.4), Check::topology), 0u);
}

TEST(Check, WindingsAreMendedAllTheSame) {
    Mesh mesh = torus(24, 12, 1, 0.3);
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    std::swap(mesh.triangles[7][1], mesh.triangles[7][2]);
    const PreparedMesh full = prepare_mesh(mesh);
    const PreparedMesh quick = prepare_mesh(mesh, {.check = Check::topology});
    EXPECT_EQ(full.triangles, quick.triangles);
    EXPECT_EQ(full.report.repairs, quick.report.repairs);
    EXPECT_GT(quick.report.volume, 0);
}

// Those of a recording come from its file.
TEST(Check, AReportIsJsonWhateverItsRepairsSay) {
    MeshReport report;
    report.repairs = {"dropped \xff"};
    EXPECT_NE(to_json(report).find("dropped"), std::string::npos);
}

} // namespace
} // namespace raycontact
