// SPDX-License-Identifier: Apache-2.0
#include "exact/oracle.h"

#include "reference/vector.h"

// CGAL's headers are not written for these warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace raycontact::exact {

using namespace reference;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Triangle>::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
using Surface = CGAL::Surface_mesh<Point>;
using SideOf = CGAL::Side_of_triangle_mesh<Surface, Kernel>;

Point point(const Vec3& p) {
    return {p.x, p.y, p.z};
}

struct Side {
    Surface surface;
    std::unique_ptr<SideOf> of;
};

std::unique_ptr<Side> side_of(const std::vector<Vec3>& vertices,
                              std::span<const std::array<std::uint32_t, 3>> triangles) {
    auto side = std::make_unique<Side>();
    std::vector<Surface::Vertex_index> index;
    index.reserve(vertices.size());
    for (const Vec3& v : vertices) index.push_back(side->surface.add_vertex(point(v)));
    for (const auto& t : triangles) side->surface.add_face(index[t[0]], index[t[1]], index[t[2]]);
    if (side->surface.number_of_faces() != triangles.size() || !CGAL::is_closed(side->surface))
        throw std::logic_error("a mesh of the exact test is not closed and manifold");
    side->of = std::make_unique<SideOf>(side->surface);
    return side;
}

} // namespace

struct ExactBody::State {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Triangle> faces;
    std::unique_ptr<Tree> tree;
    mutable std::unique_ptr<Side> side; ///< made when first asked
    CGAL::Bbox_3 box;
    double diagonal = 0;
};

ExactBody::ExactBody(const Shape& shape, Positions positions) : state_(std::make_unique<State>()) {
    State& s = *state_;
    if (!shape.report().closed || shape.report().components != 1)
        throw std::logic_error("a mesh of the exact test is not closed and of one piece");
    const bool of_file = positions == Positions::of_file;
    for (const Vec3& v : of_file ? shape.file_vertices() : shape.vertices()) {
        const Vec3 d = v - shape.centre();
        // Of float32 about the centre the addition is undone without a loss.
        s.vertices.push_back(of_file ? d : Vec3{double(float(d.x)), double(float(d.y)), double(float(d.z))});
    }
    s.triangles.assign(shape.triangles().begin(), shape.triangles().end());
    for (const auto& t : s.triangles)
        s.faces.emplace_back(point(s.vertices[t[0]]), point(s.vertices[t[1]]), point(s.vertices[t[2]]));
    s.tree = std::make_unique<Tree>(s.faces.cbegin(), s.faces.cend());
    s.tree->build();
    s.box = s.tree->bbox();
    s.diagonal = length({s.box.xmax() - s.box.xmin(), s.box.ymax() - s.box.ymin(), s.box.zmax() - s.box.zmin()});
}
ExactBody::~ExactBody() = default;
ExactBody::ExactBody(ExactBody&&) noexcept = default;

double ExactBody::diagonal() const {
    return state_->diagonal;
}

Pose centred_in(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) {
    const Pose of_a{pose_a.rotation, transform_point(pose_a, a.centre())};
    const Pose of_b{pose_b.rotation, transform_point(pose_b, b.centre())};
    return relative_pose(of_a, of_b);
}

bool collide(const ExactBody& first, const ExactBody& second, const Pose& b_in_a) {
    const ExactBody::State &a = *first.state_, &b = *second.state_;
    std::vector<Vec3> placed;
    placed.reserve(b.vertices.size());
    CGAL::Bbox_3 box;
    for (const Vec3& v : b.vertices) {
        placed.push_back(rotate(b_in_a, v) + b_in_a.translation);
        box += point(placed.back()).bbox();
    }
    if (!CGAL::do_overlap(box, a.box)) return false;
    for (const auto& t : b.triangles) {
        const Triangle face(point(placed[t[0]]), point(placed[t[1]]), point(placed[t[2]]));
        if (CGAL::do_overlap(face.bbox(), a.box) && a.tree->do_intersect(face)) return true;
    }
    // Surfaces apart: one vertex tells for the whole body.
    if (CGAL::do_overlap(point(placed[0]).bbox(), a.box)) {
        if (!a.side) a.side = side_of(a.vertices, a.triangles);
        if ((*a.side->of)(point(placed[0])) == CGAL::ON_BOUNDED_SIDE) return true;
    }
    if (!CGAL::do_overlap(point(a.vertices[0]).bbox(), box)) return false;
    return (*side_of(placed, b.triangles)->of)(point(a.vertices[0])) == CGAL::ON_BOUNDED_SIDE;
}

bool changes(const ExactBody& a, const ExactBody& b, const Pose& b_in_a, double metres, bool to) {
    std::vector<Vec3> ways;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (x != 0 || y != 0 || z != 0) ways.push_back(unit({1.0 * x, 1.0 * y, 1.0 * z}));
    const auto add = [&](const ExactBody::State& s, const Pose& pose) {
        for (const auto& t : s.triangles) {
            const Vec3 n = unit(cross(s.vertices[t[1]] - s.vertices[t[0]], s.vertices[t[2]] - s.vertices[t[0]]));
            ways.push_back(rotate(pose, n));
            ways.push_back(rotate(pose, -n));
        }
    };
    add(*a.state_, {});
    add(*b.state_, b_in_a);
    return std::any_of(ways.begin(), ways.end(), [&](const Vec3& way) {
        Pose moved = b_in_a;
        moved.translation = moved.translation + metres * way;
        return collide(a, b, moved) == to;
    });
}

bool comes_apart(const ExactBody& a, const ExactBody& b, const Pose& b_in_a, double metres) {
    return changes(a, b, b_in_a, metres, false);
}

bool comes_together(const ExactBody& a, const ExactBody& b, const Pose& b_in_a, double metres) {
    return changes(a, b, b_in_a, metres, true);
}

} // namespace raycontact::exact
