// SPDX-License-Identifier: Apache-2.0
// Ten kilometres from the origin, by pose or by the coordinates of the file, contacts are the same.
#include "property/shapes.h"
#include "reference/compare.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <tuple>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

struct Counts {
    std::uint64_t pairs = 0, same = 0, excused = 0, wrong = 0;
    double worst = 0; ///< metres, normals included
};

// Contacts of one pair near the origin and of the same pair moved by `shift`.
void compare_shifted(const Placement& p, std::span<const Contact> here, std::span<const Contact> there,
                     const Vec3& shift, Counts& counts) {
    ++counts.pairs;
    std::map<std::uint64_t, std::pair<const Contact*, const Contact*>> both;
    for (const Contact& c : here) both[c.key()].first = &c;
    for (const Contact& c : there) both[c.key()].second = &c;
    for (const auto& [key, pair] : both) {
        const auto& [c, d] = pair;
        if (c && d && c->feature == d->feature) {
            double off = length(d->point() - shift - c->point());
            off = std::max(off, length(Vec3(c->normal) - Vec3(d->normal)));
            off = std::max(off, std::fabs(static_cast<double>(c->depth) - static_cast<double>(d->depth)));
            off = std::max(off, std::fabs(static_cast<double>(c->ray_length) - static_cast<double>(d->ray_length)));
            if (off <= 1e-6) {
                ++counts.same;
                counts.worst = std::max(counts.worst, off);
                continue;
            }
        }
        const ContactFeature& feature = (c ? c : d)->feature;
        if (feature.kind != FeatureKind::vertex) { // the margins are those of rays
            ++counts.excused;
            continue;
        }
        const bool of_a = feature.source == Side::a;
        const Solid& source = of_a ? p.a->solid : p.b->solid;
        const Solid& target = of_a ? p.b->solid : p.a->solid;
        const auto at = std::find(source.vertex_index.begin(), source.vertex_index.end(), feature.source_index());
        ASSERT_NE(at, source.vertex_index.end());
        const auto vertex = static_cast<std::uint32_t>(at - source.vertex_index.begin());
        const Margins m = ray_margins(source, of_a ? p.pose_a : p.pose_b, target, of_a ? p.pose_b : p.pose_a, vertex);
        if (m.least() < excuse) {
            ++counts.excused;
            continue;
        }
        ++counts.wrong;
        ADD_FAILURE() << source.name << " vertex " << feature.source_index() << " against " << target.name << ": "
                      << (c ? std::int64_t{c->feature.other_index()} : -1) << " here, "
                      << (d ? std::int64_t{d->feature.other_index()} : -1) << " there; ray lengths "
                      << (c ? c->ray_length : -1) << ", " << (d ? d->ray_length : -1) << "; margin " << m.least()
                      << " (" << m.name_of_least() << ")";
    }
}

void report(const Counts& c) {
    std::printf("[ counts   ] %llu pairs, %llu contacts the same (worst %.2g), %llu excused, %llu wrong\n",
                static_cast<unsigned long long>(c.pairs), static_cast<unsigned long long>(c.same), c.worst,
                static_cast<unsigned long long>(c.excused), static_cast<unsigned long long>(c.wrong));
    EXPECT_EQ(c.wrong, 0u);
    EXPECT_GE(c.same, 5000u);
    EXPECT_LE(c.excused, c.same / 1000);
}

TEST(shift, of_both_poses_by_ten_kilometres) {
    Random random(31);
    Counts counts;
    std::vector<Placement> placements(400);
    for (Placement& p : placements) p = random_placement(pointers(closed_subjects()), random);
    for (const Vec3& shift : {Vec3{10000, 0, 0}, Vec3{-6000, 7000, -4000}}) {
        std::vector<Placement> moved_placements = placements;
        for (Placement& p : moved_placements) {
            p.pose_a.translation = p.pose_a.translation + shift;
            p.pose_b.translation = p.pose_b.translation + shift;
        }
        Scene here;
        Scene there;
        const auto one = by_pair(here.find_contacts(add_all(here, placements)), placements.size());
        const auto two = by_pair(there.find_contacts(add_all(there, moved_placements)), placements.size());
        for (std::size_t i = 0; i < placements.size(); ++i)
            compare_shifted(placements[i], one[i], two[i], shift, counts);
    }
    report(counts);
}

TEST(shift, of_the_coordinates_in_the_file_by_ten_kilometres) {
    const Vec3 shift{10000, -10000, 10000};
    std::vector<Mesh> meshes{bumpy_octahedron_mesh(10), frame_mesh(), l_prism_mesh()};
    for (const char* kind : {"knot", "gear"}) meshes.push_back(model_mesh(kind));
    std::vector<Subject> near;
    std::vector<Subject> far;
    for (const Mesh& mesh : meshes) {
        near.emplace_back(mesh);
        far.emplace_back(moved(mesh, shift));
    }
    Random random(32);
    Counts counts;
    std::vector<Placement> placements;
    std::vector<Placement> far_placements;
    for (int i = 0; i < 400; ++i) {
        Placement p = random_placement(pointers(near), random);
        placements.push_back(p);
        p.a = &far[static_cast<std::size_t>(p.a - near.data())];
        p.b = &far[static_cast<std::size_t>(p.b - near.data())];
        p.pose_a.translation = p.pose_a.translation - rotate(p.pose_a, shift);
        p.pose_b.translation = p.pose_b.translation - rotate(p.pose_b, shift);
        far_placements.push_back(p);
    }
    Scene here;
    Scene there;
    const auto one = by_pair(here.find_contacts(add_all(here, placements)), placements.size());
    const auto two = by_pair(there.find_contacts(add_all(there, far_placements)), placements.size());
    for (std::size_t i = 0; i < placements.size(); ++i) compare_shifted(placements[i], one[i], two[i], {}, counts);
    report(counts);
}

} // namespace
