// SPDX-License-Identifier: Apache-2.0
// The meshes of CGAL's demos, 154 files of Debian's libcgal-demo: which load, why the others are refused, that CGAL
// reads the same, and that random pairs of the solids among them intersect where an exact test says so.
#include "exact/oracle.h"
#include "reference/random.h"
#include "reference/vector.h"
#include "refused_files.h"
#include "temporary_folder.h"

#include <raycontact/collide.h>
#include <raycontact/mesh.h>
#include <raycontact/query.h>
#include <raycontact/shape.h>

// CGAL's headers are not written for these warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/polygon_soup_io.h>
#pragma GCC diagnostic pop

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace fs = std::filesystem;
using namespace raycontact;
using namespace raycontact::exact;
using namespace raycontact::reference;

namespace {

const fs::path archive = "/usr/share/doc/libcgal-dev/data.tar.gz";

/// Why a file is refused: part of the message.
const RefusedFiles refused = {
    {"meshes/b9.ply", "has no triangles"},
    {"meshes/prim.off", "line 24: more lines than the 7 faces of the header"}, // it has eight
    {"points_3/b9_training.ply", "has no triangles"},
    {"points_3/ball.ply", "has no triangles"},
    {"points_3/building.ply", "has no triangles"},
    {"points_3/circles.ply", "has no triangles"},
    {"points_3/colors.ply", "has no triangles"},
    {"points_3/example.ply", "has no triangles"},
    {"points_3/hippo1.ply", "has no triangles"},
    {"points_3/hippo2.ply", "has no triangles"},
    {"points_3/kitten.off", "has no triangles"},
    {"points_3/oni.ply", "has no triangles"},
    {"points_3/spheres.ply", "has no triangles"},
};

class GeometryLibrary : public ::testing::Test {
protected:
    static void SetUpTestSuite() {
        if (!fs::exists(archive)) return;
        unpacked = std::make_unique<TemporaryFolder>();
        const std::string command = "tar -xzf " + archive.string() + " -C " + unpacked->path().string();
        ASSERT_EQ(std::system(command.c_str()), 0) << command;
    }
    static void TearDownTestSuite() { unpacked.reset(); }
    void SetUp() override {
        if (!unpacked) GTEST_SKIP() << "the Debian package libcgal-demo is not installed: no " << archive;
    }

    static fs::path folder() { return unpacked->path() / "data"; }
    static std::vector<std::string> files() {
        static const std::set<std::string> endings = {".obj", ".stl", ".ply", ".off", ".glb", ".gltf", ".3mf"};
        std::vector<std::string> found;
        for (const auto& entry : fs::recursive_directory_iterator(folder()))
            if (endings.contains(entry.path().extension().string()))
                found.push_back(entry.path().lexically_relative(folder()).generic_string());
        std::ranges::sort(found);
        return found;
    }

    static inline std::unique_ptr<TemporaryFolder> unpacked;
};

TEST_F(GeometryLibrary, AHundredAndFortyOneOf154LoadAndTheOthersAreRefusedForWhatTheyAre) {
    expect_all_load_but(refused, folder(), files(), 141);
}

TEST_F(GeometryLibrary, CgalReadsTheSame) {
    using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
    std::size_t compared = 0;
    for (const std::string& file : files()) {
        if (refused.contains(file)) continue;
        SCOPED_TRACE(file);
        std::vector<Point> points;
        std::vector<std::vector<std::size_t>> polygons;
        ASSERT_TRUE(CGAL::IO::read_polygon_soup((folder() / file).string(), points, polygons));
        const Mesh mesh = load_mesh(folder() / file);
        std::size_t triangles = 0;
        for (const auto& polygon : polygons) triangles += polygon.size() - 2;
        EXPECT_EQ(mesh.triangles.size(), triangles);
        // CGAL joins the equal corners of an STL.
        std::set<Point> theirs(points.begin(), points.end()), ours;
        for (const Vec3& v : mesh.vertices) ours.emplace(v.x, v.y, v.z);
        EXPECT_EQ(theirs, ours);
        ++compared;
    }
    EXPECT_EQ(compared, 141u);
}

struct Body {
    std::shared_ptr<const Shape> shape;
    ExactBody rounded, of_file;
    explicit Body(std::shared_ptr<const Shape> made)
        : shape(std::move(made)), rounded(*shape), of_file(*shape, Positions::of_file) {}
};

/// As long as `size`, its box's diagonal.
void scale_to(Mesh& mesh, double size) {
    Vec3 low = mesh.vertices[0], high = low;
    for (const Vec3& v : mesh.vertices) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    const double by = size / length(high - low);
    for (Vec3& v : mesh.vertices) v = by * v;
}

std::optional<Body> body_of(const fs::path& file, std::size_t most_triangles, double size) {
    Mesh mesh = load_mesh(file);
    if (mesh.triangles.size() > most_triangles) return std::nullopt;
    scale_to(mesh, size);
    auto shape = Shape::make(mesh);
    const MeshReport& report = shape->report();
    if (!verdict_of(report).good || !report.manifold || report.components != 1) return std::nullopt;
    return std::make_optional<Body>(std::move(shape));
}

// RAYCONTACT_PAIRS, as of exact_test, also takes the large meshes.
TEST_F(GeometryLibrary, PairsOfItsSolidsIntersectAsAnExactTestSays) {
    const char* asked = std::getenv("RAYCONTACT_PAIRS");
    const std::size_t wanted = asked ? std::strtoul(asked, nullptr, 10) : 600;
    std::vector<Body> bodies;
    std::size_t number = 0;
    for (const std::string& file : files()) {
        if (refused.contains(file)) continue;
        // Every other one is small, so that one lies in another at times.
        if (auto body = body_of(folder() / file, asked ? 100000 : 6000, number % 2 == 0 ? 1 : 0.25)) {
            bodies.push_back(std::move(*body));
            ++number;
        }
    }
    std::size_t intersecting = 0, missed = 0, invented = 0, without = 0, beside = 0, excused = 0;
    std::string first;
    for (std::size_t i = 0; i < wanted; ++i) {
        Random random(4000037 + i);
        const auto any = [&]() -> const Body& {
            return bodies[random.below(static_cast<std::uint32_t>(bodies.size()))];
        };
        const Body &a = any(), &b = any();
        Pose pose_a = random.rotation(), pose_b = random.rotation();
        const Vec3 middle = 5 * random.in_ball();
        const Vec3 offset = (0.4 * (a.of_file.diagonal() + b.of_file.diagonal())) * random.in_ball();
        pose_a.translation = middle - rotate(pose_a, a.shape->centre());
        pose_b.translation = middle + offset - rotate(pose_b, b.shape->centre());
        const Pose relative = centred_in(*a.shape, pose_a, *b.shape, pose_b);
        const bool truth = collide(a.of_file, b.of_file, relative);
        intersecting += truth;
        for (const bool found :
             {intersects(*a.shape, pose_a, *b.shape, pose_b), intersects(*b.shape, pose_b, *a.shape, pose_a)}) {
            missed += truth && !found;
            invented += !truth && found;
            if (truth != found && first.empty())
                first = "pair " + std::to_string(i) + ": " + a.shape->name() + ", " + b.shape->name();
        }
        const bool has_contacts = !raycontact::collide(*a.shape, pose_a, *b.shape, pose_b).empty();
        const bool rounded = collide(a.rounded, b.rounded, relative);
        if (rounded == has_contacts) continue;
        if (rounded ? comes_apart(a.rounded, b.rounded, relative, 1e-6)
                    : comes_together(a.rounded, b.rounded, relative, 1e-6))
            ++excused;
        else
            ++(rounded ? without : beside);
    }
    std::printf("[ counts   ] %zu solids of CGAL: of %zu pairs %zu intersect; %zu missed, %zu invented; %zu without a "
                "contact, %zu with one beside it, %zu excused\n",
                bodies.size(), wanted, intersecting, missed, invented, without, beside, excused);
    EXPECT_EQ(missed + invented, 0u) << first;
    EXPECT_EQ(without + beside, 0u);
    EXPECT_GE(bodies.size(), 60u);
    EXPECT_GE(intersecting, wanted / 3);
    EXPECT_LE(intersecting, wanted * 2 / 3);
}

} // namespace
