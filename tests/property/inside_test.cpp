// SPDX-License-Identifier: Apache-2.0
// Every contact's vertex is inside the other mesh, by CGAL with exact predicates.
#include "property/shapes.h"
#include "reference/margins.h"
#include "reference/vector.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <gtest/gtest.h>

#include <cstdio>
#include <map>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using SideOf = CGAL::Side_of_triangle_mesh<Surface, Kernel>;

struct Oracle {
    Surface surface;
    std::unique_ptr<SideOf> side;
};

Kernel::Point_3 point(const Vec3& p) {
    return {p.x, p.y, p.z};
}

std::unique_ptr<Oracle> make_oracle(const Solid& solid) {
    auto oracle = std::make_unique<Oracle>();
    std::vector<Surface::Vertex_index> vertices;
    for (const Vec3& v : solid.vertices) vertices.push_back(oracle->surface.add_vertex(point(v)));
    for (const auto& t : solid.triangles) oracle->surface.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
    if (oracle->surface.number_of_faces() != solid.triangles.size() || !CGAL::is_closed(oracle->surface)) return {};
    oracle->side = std::make_unique<SideOf>(oracle->surface);
    return oracle;
}

// A point of the world in the frame of b or a, about its centre.
Vec3 in_frame(const Placement& p, bool of_b, const Vec3& at) {
    const Pose& pose = of_b ? p.pose_b : p.pose_a;
    return rotate_back(pose, at - pose.translation) - (of_b ? p.b : p.a)->solid.centre;
}

TEST(inside, every_contact_by_exact_predicates) {
    std::map<const Solid*, std::unique_ptr<Oracle>> oracles;
    for (const Subject& s : closed_subjects()) {
        oracles[&s.solid] = make_oracle(s.solid);
        ASSERT_TRUE(oracles[&s.solid]) << s.solid.name;
    }
    Random random(41);
    std::uint64_t inside = 0;
    std::uint64_t near = 0, past = 0;
    std::vector<Placement> placements(1000);
    for (Placement& p : placements) p = random_placement(pointers(closed_subjects()), random);
    Scene scene;
    const auto parts = by_pair(scene.find_contacts(add_all(scene, placements)), placements.size());
    for (std::size_t i = 0; i < placements.size(); ++i)
        for (const Contact& c : parts[i]) {
            const Placement& p = placements[i];
            const bool of_a = c.feature.source == Side::a;
            const Solid& target = of_a ? p.b->solid : p.a->solid;
            const Vec3 local = in_frame(p, of_a, c.point());
            const auto is_inside = [&](const Solid& solid, const Vec3& at) {
                return (*oracles.at(&solid)->side)(point(at)) == CGAL::ON_BOUNDED_SIDE;
            };
            // Of edges, one or the other is inside, or a's surface where an edge of b has come out.
            const bool edges = c.feature.kind == FeatureKind::edges;
            if (is_inside(target, local) || (edges && is_inside(p.a->solid, in_frame(p, false, c.point_b)))) {
                ++inside;
            } else if (edges && distance_to_surface(target, local) <= c.depth) {
                EXPECT_LT(distance_to_surface(p.a->solid, in_frame(p, false, c.point())), 1e-6 * p.a->solid.diagonal);
                ++past;
            } else if (distance_to_surface(target, local) < 1e-6 * std::max(1.0, target.diagonal)) {
                ++near;
            } else {
                ADD_FAILURE() << "pair " << i << ": vertex " << c.feature.source_index() << " of body "
                              << (of_a ? "a" : "b") << " is outside " << target.name << " by "
                              << distance_to_surface(target, local) << " m, ray " << c.ray_length << " m to triangle "
                              << c.feature.other_index();
            }
        }
    std::printf("[ counts   ] %zu pairs, %llu contacts inside, %llu within 1e-6 of the surface, %llu edges past it\n",
                placements.size(), static_cast<unsigned long long>(inside), static_cast<unsigned long long>(near),
                static_cast<unsigned long long>(past));
    EXPECT_GE(inside, 20000u);
    EXPECT_LE(near, inside / 1000);
    EXPECT_LE(past, inside / 1000);
}

} // namespace
