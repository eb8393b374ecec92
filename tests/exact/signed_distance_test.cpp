// SPDX-License-Identifier: Apache-2.0
// Signed distances against CGAL: its tree tells how far the surface is, its rays tell the side.
#include "exact/assemblies.h"
#include "exact/random_solids.h"
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <raycontact/query.h>

// CGAL's headers are not written for these warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#pragma GCC diagnostic pop

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace raycontact::exact {
namespace {

using namespace reference;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Surface>>>;

Kernel::Point_3 point_of(const Vec3& v) {
    return {v.x, v.y, v.z};
}

/// A placed solid as CGAL has it, with the triangles that span holes.
class CgalSolid {
public:
    CgalSolid(const Shape& shape, const Pose& pose) : shape_(shape) {
        for (const Vec3& v : shape.file_vertices()) surface_.add_vertex(point_of(transform_point(pose, v)));
        for (const auto& [a, b, c] : shape.triangles()) {
            const auto at = [](std::uint32_t i) { return Surface::Vertex_index(i); };
            EXPECT_NE(surface_.add_face(at(a), at(b), at(c)), Surface::null_face());
        }
        tree_.insert(faces(surface_).begin(), faces(surface_).end(), surface_);
        tree_.accelerate_distance_queries();
    }

    double distance(const Vec3& point) const { return std::sqrt(tree_.squared_distance(point_of(point))); }
    bool contains(const Vec3& point) const {
        return CGAL::Side_of_triangle_mesh<Surface, Kernel>(tree_)(point_of(point)) != CGAL::ON_UNBOUNDED_SIDE;
    }
    /// From a triangle of the file, or the nearest piece of it.
    double distance(std::uint32_t triangle, const Vec3& point) const {
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t t = 0; t < shape_.triangles().size(); ++t) {
            if (shape_.triangle_index()[t] != triangle) continue;
            const auto& [a, b, c] = shape_.triangles()[t];
            const auto at = [&](std::uint32_t i) { return surface_.point(Surface::Vertex_index(i)); };
            const double square = CGAL::squared_distance(point_of(point), Kernel::Triangle_3(at(a), at(b), at(c)));
            nearest = std::min(nearest, std::sqrt(square));
        }
        return nearest;
    }

private:
    const Shape& shape_;
    Surface surface_;
    Tree tree_;
};

/// Of the body frame: corners, points of edges and faces, others beside them, anywhere in the box, and far away.
std::vector<Vec3> points_about(const Shape& shape, std::size_t count, Random& random) {
    const double size = length(shape.box_max() - shape.box_min());
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        const auto& t = shape.triangles()[random.below(static_cast<std::uint32_t>(shape.triangles().size()))];
        const Vec3 a = shape.file_vertices()[t[0]], b = shape.file_vertices()[t[1]], c = shape.file_vertices()[t[2]];
        const double u = i % 2 == 0 ? 0 : random.uniform(), v = i % 4 < 2 ? 0 : random.uniform();
        Vec3 point = a + u * (b - a) + v * (1 - u) * (c - a);
        if (i % 8 >= 4) point = point + std::pow(10, random.uniform(-13, -1)) * size * random.direction();
        if (i % 16 == 3) point = shape.centre() + 0.6 * size * random.in_ball();
        if (i % 32 == 31) point = point + 100 * size * random.direction();
        points.push_back(point);
    }
    return points;
}

/// Tells how many points are inside.
std::size_t compare(const Mesh& mesh, std::size_t count, Random& random) {
    const auto shape = Shape::make(mesh);
    EXPECT_TRUE(shape->has_inside() && verdict_of(shape->report()).good) << verdict_of(shape->report()).text;
    const double size = length(shape->box_max() - shape->box_min()), tiny = 1e-12 * size;
    Pose pose = random.rotation();
    pose.translation = 3 * size * random.in_ball();
    std::vector<Vec3> points = points_about(*shape, count, random);
    for (Vec3& p : points) p = transform_point(pose, p);
    const std::vector<SignedDistance> found = signed_distance(*shape, pose, points);
    const CgalSolid solid(*shape, pose);
    std::size_t inside = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const SignedDistance& d = found[i];
        const double far = solid.distance(points[i]);
        EXPECT_NEAR(std::fabs(d.distance), far, tiny) << i;
        EXPECT_NEAR(length(points[i] - d.point), far, tiny) << i;
        EXPECT_LT(solid.distance(d.triangle, d.point), tiny) << i;
        EXPECT_NEAR(length(d.gradient), 1, 1e-12) << i;
        if (far <= tiny) continue;
        const bool is_inside = solid.contains(points[i]);
        EXPECT_EQ(d.distance < 0, is_inside) << i;
        const Vec3 away = (is_inside ? -1 : 1) * unit(points[i] - d.point);
        EXPECT_LT(length(d.gradient - away), 1e-13 * size / far + 1e-13) << i;
        inside += is_inside;
    }
    return inside;
}

TEST(ExactSignedDistance, OfSolidsIsThatOfCgal) {
    Random random(51);
    std::vector<Mesh> meshes{l_prism_mesh(), frame_mesh(), bumpy_octahedron_mesh(6), cone_mesh(), grid_box_mesh(4)};
    for (const Mesh& mesh : {tray_mesh(), pipe_mesh(24, 1, 0.9, 3), bolt_mesh(3), nut_mesh(2, 0.01)})
        meshes.push_back(mesh);
    meshes.push_back(moved(frame_mesh(), {20, -30, 10}));
    for (const char* kind : {"knot", "gear", "torus", "sphere"}) meshes.push_back(model_mesh(kind));
    for (int i = 0; i < 60; ++i) meshes.push_back(i % 6 == 0 ? fine_solid(random) : coarse_solid(random));
    std::size_t inside = 0;
    for (const Mesh& mesh : meshes) {
        SCOPED_TRACE(mesh.name);
        inside += compare(mesh, 400, random);
    }
    EXPECT_GT(inside, 4000u);
}

// Triangles of our own are on the surface, and so are pieces of those that were cut.
TEST(ExactSignedDistance, OfSpannedHolesAndUnitedPartsIsThatOfCgal) {
    Random random(52);
    for (const char* kind : {"knot", "gear", "torus", "sphere"}) {
        Mesh holed = model_mesh(kind);
        for (int i = 0; i < 5; ++i)
            holed.triangles.erase(holed.triangles.begin() + 40 * i, holed.triangles.begin() + 40 * i + 2);
        EXPECT_GE(Shape::make(holed)->report().holes, 2u) << kind;
        EXPECT_GT(compare(holed, 1000, random), 50u) << kind;

        // A bar through it.
        Mesh united = model_mesh(kind);
        const double size = Shape::make(united)->radius();
        const Mesh bar = placed(box_mesh({0.3 * size, 0.2 * size, 1.2 * size}), random.rotation());
        const auto first = static_cast<std::uint32_t>(united.vertices.size());
        united.vertices.insert(united.vertices.end(), bar.vertices.begin(), bar.vertices.end());
        for (const auto& [a, b, c] : bar.triangles) united.triangles.push_back({a + first, b + first, c + first});
        EXPECT_NE(to_text(Shape::make(united)->report()).find("united"), std::string::npos) << kind;
        EXPECT_GT(compare(united, 1000, random), 50u) << kind;
    }
}

} // namespace
} // namespace raycontact::exact
