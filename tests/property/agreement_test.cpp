// SPDX-License-Identifier: Apache-2.0
// Both casters against the brute-force reference, over random overlapping poses.
#include "prepared_shape.h"
#include "property/ray_sources.h"
#include "property/shapes.h"
#include "reference/compare.h"
#include "reference/compare_edges.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <raycontact/collide.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

Settings with(Caster caster, Direction direction = Direction::reprojected, Features features = Features::vertices) {
    Settings settings;
    settings.features = features;
    settings.direction = direction;
    settings.method = Method::standard; // every ray of the rule
    settings.paper.caster = caster;
    return settings;
}

auto key(const Contact& c) {
    return std::tuple(c.body_a, c.body_b, c.key());
}

struct Counts {
    Comparison sum;
    EdgeComparison edges;
    std::uint64_t pairs_touching = 0, swapped = 0, swapped_otherwise = 0, rays_of_library = 0, side_tests = 0;
};

// Swapping a and b changes nothing but the order of the two directions and the sign of the normals. Contacts of edges
// and bodies inside are found in the frame of b, which is smaller by more: they are alike but for rounding, and near a
// tie they may be others.
void expect_flipped(std::span<const Contact> one, std::span<const Contact> two, double size, Counts& counts) {
    std::map<decltype(key({})), const Contact*> flipped;
    for (const Contact& d : two) {
        Contact c = d;
        c.feature.source = d.feature.source == Side::a && d.feature.kind != FeatureKind::edges ? Side::b : Side::a;
        std::swap(c.feature.index_a, c.feature.index_b);
        flipped[key(c)] = &d;
    }
    std::size_t exact = 0;
    for (const Contact& c : one) {
        const auto at = flipped.find(key(c));
        if (c.feature.kind != FeatureKind::vertex) {
            const bool alike = at != flipped.end() && std::fabs(c.depth - at->second->depth) < 1e-6 * size;
            (alike ? counts.swapped : counts.swapped_otherwise) += 1;
            continue;
        }
        ASSERT_NE(at, flipped.end());
        const Contact& d = *at->second;
        ASSERT_EQ(c.feature.other_index(), d.feature.other_index());
        ASSERT_EQ(c.point(), d.point());
        ASSERT_EQ(c.normal, (Vec3f{-d.normal.x, -d.normal.y, -d.normal.z}));
        ASSERT_EQ(c.depth, d.depth);
        ASSERT_EQ(c.ray_length, d.ray_length);
        ASSERT_EQ(c.weight, d.weight);
        ++counts.swapped;
        ++exact;
    }
    ASSERT_EQ(exact, std::count_if(two.begin(), two.end(),
                                   [](const auto& d) { return d.feature.kind == FeatureKind::vertex; }));
}

Placement swapped_placement(const Placement& p) {
    return {p.b, p.a, p.pose_b, p.pose_a};
}

// Without vertices that have no contact by the plain rule.
std::vector<Contact> seen_by_rays(std::span<const Contact> contacts, const Placement& p) {
    CollideOptions options;
    options.features = Features::vertices;
    const auto plain = collide(*p.a->shape, p.pose_a, *p.b->shape, p.pose_b, options);
    std::vector<Contact> seen;
    for (const Contact& c : contacts) {
        const auto same = [&](const Contact& d) { return c.key() == d.key(); };
        if (c.feature.kind != FeatureKind::vertex || std::any_of(plain.begin(), plain.end(), same)) seen.push_back(c);
    }
    return seen;
}

template <class Place>
void run(Place place, std::size_t poses, Counts& counts, Features features = Features::vertices) {
    constexpr std::size_t batch = 100;
    for (std::size_t done = 0; done < poses; done += batch) {
        std::vector<Placement> placements;
        for (std::size_t i = 0; i < batch; ++i) placements.push_back(place());
        Direction direction = directions[done / batch % std::size(directions)];
        // With edges its contacts are of faces (unit/query/contact_patches_test.cpp).
        if (features == Features::edges && direction == Direction::weighted) direction = Direction::ray;
        Scene bvh(with(Caster::bvh, direction, features));
        Scene basic(with(Caster::basic, direction, features));
        Scene swapped(with(Caster::bvh, direction, features));
        const auto contacts = bvh.find_contacts(add_all(bvh, placements));
        const auto of_basic = basic.find_contacts(add_all(basic, placements));
        const auto of_swapped = swapped.find_contacts(add_all(swapped, placements, true));
        ASSERT_TRUE(same_bits(contacts, of_basic)) << "the casters differ, poses from " << done;
        ASSERT_EQ(bvh.stats().details.rays, basic.stats().details.rays);
        ASSERT_EQ(bvh.stats().contacts, contacts.size());
        counts.rays_of_library += bvh.stats().details.rays;
        counts.side_tests += bvh.stats().details.side_tests;
        for (std::size_t i = 1; i < contacts.size(); ++i) ASSERT_LT(key(contacts[i - 1]), key(contacts[i]));

        const auto parts = by_pair(contacts, batch);
        const auto swapped_parts = by_pair(of_swapped, batch);
        std::size_t seen = 0;
        for (std::size_t i = 0; i < batch; ++i) {
            const Placement& p = placements[i];
            compare(p.a->solid, p.pose_a, p.b->solid, p.pose_b, parts[i], counts.sum, direction);
            if (features == Features::edges)
                compare_edges(p.a->solid, p.pose_a, p.b->solid, p.pose_b, parts[i], counts.edges, direction);
            // Vertices in the plane of a face, which edges ask again, depend on the order: b is smaller by more.
            const double size = std::max(p.a->solid.diagonal, p.b->solid.diagonal);
            if (features == Features::edges)
                expect_flipped(seen_by_rays(parts[i], p), seen_by_rays(swapped_parts[i], swapped_placement(p)), size,
                               counts);
            else
                expect_flipped(parts[i], swapped_parts[i], size, counts);
            counts.pairs_touching += !parts[i].empty();
            seen += parts[i].size();
        }
        ASSERT_EQ(seen, contacts.size()); // none belongs to a pair that was not asked for
    }
}

void report(const Counts& c) {
    std::printf("[ counts   ] %s\n[ counts   ] %llu pairs with contacts, %llu contacts the same when swapped, library "
                "cast %llu rays, %llu decided by side\n",
                c.sum.summary().c_str(), static_cast<unsigned long long>(c.pairs_touching),
                static_cast<unsigned long long>(c.swapped), static_cast<unsigned long long>(c.rays_of_library),
                static_cast<unsigned long long>(c.side_tests));
    EXPECT_EQ(c.sum.wrong, 0u);
    EXPECT_LT(static_cast<double>(c.sum.excused), 0.001 * static_cast<double>(c.sum.rays));
    EXPECT_GE(c.pairs_touching, c.sum.pairs / 2);
    // The same vertices inside the bounds, rounding apart.
    EXPECT_NEAR(static_cast<double>(c.rays_of_library), static_cast<double>(c.sum.rays),
                0.001 * static_cast<double>(c.sum.rays));
}

TEST(agreement, closed_meshes) {
    const auto subjects = pointers(closed_subjects());
    Random random(20130101);
    Counts counts;
    run([&] { return random_placement(subjects, random); }, 16000, counts);
    report(counts);
    EXPECT_GE(counts.sum.pairs, 16000u);
    EXPECT_GE(counts.sum.agreed, 250000u);
}

TEST(agreement, open_meshes_among_closed_ones) {
    auto subjects = pointers(open_subjects());
    for (const Subject& s : closed_subjects())
        if (s.solid.triangles.size() < 900) subjects.push_back(&s);
    Random random(20130202);
    Counts counts;
    run([&] { return random_placement(subjects, random); }, 4000, counts);
    report(counts);
    EXPECT_GE(counts.sum.pairs, 4000u);
    EXPECT_GE(counts.sum.agreed, 25000u);
}

// Bodies of 1 m half sunk into a slab of 40 m made of twelve triangles, as in the avalanche.
TEST(agreement, small_bodies_in_a_large_slab) {
    const Subject slab(box_mesh({20, 20, 1}));
    Random random(20130303);
    Counts counts;
    const auto place = [&] {
        Placement p;
        p.a = &slab;
        p.b = &closed_subjects()[random.below(static_cast<std::uint32_t>(closed_subjects().size()))];
        p.pose_b = random.rotation();
        const double side = random.below(2) ? 1 : -1; // sunk into the top or into the bottom
        const Vec3 at{random.uniform(-19, 19), random.uniform(-19, 19), side * random.uniform(0.7, 1.3)};
        p.pose_a = random.rotation();
        p.pose_a.translation = 3 * random.in_ball();
        Pose turned = p.pose_a;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                turned.rotation[3 * i + j] = 0;
                for (std::size_t k = 0; k < 3; ++k)
                    turned.rotation[3 * i + j] += p.pose_a.rotation[3 * i + k] * p.pose_b.rotation[3 * k + j];
            }
        turned.translation = p.pose_a.translation + rotate(p.pose_a, at - rotate(p.pose_b, p.b->solid.centre));
        p.pose_b = turned;
        return p;
    };
    run(place, 3000, counts);
    report(counts);
    EXPECT_GE(counts.sum.agreed, 100000u);
}

void report_edges(const Counts& c) {
    std::printf("[ counts   ] %s\n[ counts   ] %s\n[ counts   ] %llu contacts the same when swapped, %llu not\n",
                c.sum.summary().c_str(), c.edges.summary().c_str(), static_cast<unsigned long long>(c.swapped),
                static_cast<unsigned long long>(c.swapped_otherwise));
    EXPECT_EQ(c.sum.wrong, 0u);
    EXPECT_EQ(c.edges.wrong, 0u);
    EXPECT_LT(static_cast<double>(c.edges.pairs_excused), 0.002 * static_cast<double>(c.edges.pairs));
    EXPECT_LT(static_cast<double>(c.edges.excused), 0.002 * static_cast<double>(c.edges.contacts));
    EXPECT_LT(static_cast<double>(c.swapped_otherwise), 0.02 * static_cast<double>(c.edges.contacts));
}

const std::vector<Subject>& coarse_subjects() {
    static const std::vector<Subject> subjects = [] {
        std::vector<Subject> list;
        for (const Mesh& mesh :
             {box_mesh({0.5, 0.5, 0.5}), box_mesh({1, 0.1, 0.15}), box_mesh({0.6, 0.6, 0.05}), tetrahedron_mesh(),
              cone_mesh(), l_prism_mesh(), frame_mesh(), bumpy_octahedron_mesh(2)})
            list.emplace_back(mesh);
        return list;
    }();
    return subjects;
}

TEST(agreement, edges_of_coarse_meshes) {
    Random random(20130701);
    Counts counts;
    run([&] { return random_placement(pointers(coarse_subjects()), random); }, 30000, counts, Features::edges);
    report_edges(counts);
    EXPECT_GE(counts.edges.agreed, 35000u);
}

TEST(agreement, edges_of_coarse_and_fine_meshes) {
    auto subjects = pointers(coarse_subjects());
    for (const Subject& subject : closed_subjects()) subjects.push_back(&subject);
    Random random(20130702);
    Counts counts;
    run([&] { return random_placement(subjects, random); }, 2000, counts, Features::edges);
    report_edges(counts);
    EXPECT_GE(counts.edges.agreed, 1500u);
}

// Small ones anywhere within large ones.
TEST(agreement, bodies_inside_others) {
    std::vector<Subject> small;
    for (Mesh mesh : {box_mesh({0.5, 0.5, 0.5}), box_mesh({1, 0.1, 0.15}), tetrahedron_mesh(), model_mesh("knot")}) {
        for (Vec3& v : mesh.vertices) v = 0.1 * v;
        small.emplace_back(mesh);
    }
    Random random(20130703);
    Counts counts;
    const auto place = [&] {
        Placement p = random_placement(pointers(coarse_subjects()), random);
        p.b = &small[random.below(4)];
        p.pose_b.translation = p.pose_a.translation + rotate(p.pose_a, p.a->solid.centre)
                               + 0.4 * p.a->solid.diagonal * random.in_ball() - rotate(p.pose_b, p.b->solid.centre);
        if (random.below(2)) {
            std::swap(p.a, p.b);
            std::swap(p.pose_a, p.pose_b);
        }
        return p;
    };
    run(place, 2000, counts, Features::edges);
    report_edges(counts);
    EXPECT_GE(counts.edges.inside, 100u);
}

// An open body's edges can lie in a closed one, and pass its edges; nothing lies in the open one.
TEST(agreement, edges_of_open_meshes) {
    auto subjects = pointers(open_subjects());
    for (const Subject& subject : coarse_subjects()) subjects.push_back(&subject);
    Random random(20130704);
    Counts counts;
    run([&] { return random_placement(subjects, random); }, 2000, counts, Features::edges);
    report_edges(counts);
    EXPECT_GE(counts.edges.agreed, 1000u);
}

// Of two open meshes what is behind either counts as in it.
TEST(agreement, edges_of_two_open_meshes) {
    const auto subjects = pointers(open_subjects());
    Random random(20130705);
    Counts counts;
    run([&] { return random_placement(subjects, random); }, 2000, counts, Features::edges);
    report_edges(counts);
    EXPECT_GE(counts.edges.agreed, 2000u);
}

// Needles through one point: there a ray meets more leaves and triangles than a group of rays has room for, and of two
// thousand needles more leaves are near it than are listed.
Mesh needles_mesh(std::uint32_t count, Random& random) {
    const Mesh needle = tetrahedron_mesh();
    Mesh mesh;
    for (std::uint32_t n = 0; n < count; ++n) {
        const Pose turn = random.rotation();
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const Vec3& v : needle.vertices)
            mesh.vertices.push_back(transform_point(turn, {v.x, 0.05 * v.y, 0.05 * v.z}));
        for (const auto& t : needle.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return mesh;
}

TEST(agreement, many_leaves_in_one_place) {
    Random random(20130606);
    Mesh small = bumpy_octahedron_mesh(6);
    for (Vec3& v : small.vertices) v = 0.1 * v;
    const auto body = prepared_shape(small);
    for (const std::uint32_t count : {400u, 2000u}) {
        const auto needles = prepared_shape(needles_mesh(count, random));
        std::uint64_t contacts = 0;
        for (int i = 0; i < 50; ++i) {
            const Pose pose = random.rotation();
            Vec3 at = 0.1 * random.in_ball();
            std::vector<Contact> of[2];
            for (const Caster caster : {Caster::bvh, Caster::basic}) {
                Scene scene(with(caster));
                scene.add(needles);
                scene.set_pose(scene.add(body), {pose.rotation, at});
                const auto found = scene.find_contacts();
                of[caster == Caster::basic].assign(found.begin(), found.end());
            }
            ASSERT_TRUE(same_bits(of[0], of[1])) << "the casters differ, pose " << i;
            contacts += of[0].size();
        }
        EXPECT_GT(contacts, 1500u);
    }
}

// The same meshes a thousand times smaller and larger: nothing may hang on a length in metres.
TEST(agreement, at_other_scales) {
    for (const double scale : {1e-3, 1e3}) {
        std::vector<Subject> subjects;
        for (Mesh mesh : {model_mesh("knot"), model_mesh("torus"), bumpy_octahedron_mesh(8), l_prism_mesh()}) {
            for (Vec3& v : mesh.vertices) v = scale * v;
            subjects.emplace_back(mesh);
        }
        Random random(20130404);
        Counts counts;
        run([&] { return random_placement(pointers(subjects), random); }, 1000, counts);
        report(counts);
        EXPECT_GE(counts.sum.agreed, 15000u);
        Counts edges;
        run([&] { return random_placement(pointers(subjects), random); }, 200, edges, Features::edges);
        report_edges(edges);
        EXPECT_GE(edges.edges.agreed, 60u); // fine meshes: mostly vertices
    }
}

// Axis-aligned meshes on a grid: faces coincide, rays run in planes, along edges and through vertices. Most of them
// are excused here; the casters and the swap still have to agree bit for bit, and a clear ray has to be right.
TEST(agreement, exact_coincidences) {
    std::vector<Subject> subjects;
    for (const Mesh& mesh : {grid_box_mesh(4), l_prism_mesh(), frame_mesh(), box_mesh({0.5, 0.5, 0.5})})
        subjects.emplace_back(mesh);
    const std::vector<Pose> rotations = axis_rotations();
    Random random(20130505);
    Counts counts;
    const auto place = [&] {
        Placement p;
        p.a = &subjects[random.below(4)];
        p.b = &subjects[random.below(4)];
        p.pose_a = rotations[random.below(24)];
        p.pose_b = rotations[random.below(24)];
        const auto step = [&] { return (random.below(9) - 4.0) / 8; };
        p.pose_b.translation = {step(), step(), step()};
        return p;
    };
    run(place, 3000, counts);
    std::printf("[ counts   ] %s\n", counts.sum.summary().c_str());
    EXPECT_EQ(counts.sum.wrong, 0u);
    EXPECT_GE(counts.swapped, 2000u);
    EXPECT_GE(counts.sum.rays, 20000u);
    Counts edges;
    run(place, 3000, edges, Features::edges);
    std::printf("[ counts   ] %s\n", edges.edges.summary().c_str());
    EXPECT_LT(edges.edges.wrong, edges.edges.contacts / 100); // rays along edges, hits next to nothing away
    EXPECT_GE(edges.edges.contacts, 2000u);
}

} // namespace
