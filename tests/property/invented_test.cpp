// SPDX-License-Identifier: Apache-2.0
// No contact is invented, and none is missed, by rays against closed meshes: at random, aimed at edges and vertices,
// grazing silhouettes, and along the axes of boxes. RAYCONTACT_RAYS sets how many; ten million unless told.
#include "prepared_shape.h"
#include "property/ray_sources.h"
#include "property/shapes.h"
#include "reference/margins.h"
#include "reference/meshes.h"
#include "reference/side.h"
#include "reference/vector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

// Every ray is cast, also from vertices that the outside grid would spare: the caster itself is on trial.
Settings every_ray() {
    Settings settings;
    settings.method = Method::standard;
    settings.paper.skip_outside = false;
    return settings;
}

double rays_wanted() {
    const char* text = std::getenv("RAYCONTACT_RAYS");
    return text ? std::max(1e5, std::strtod(text, nullptr)) : 1e7;
}

struct Counts {
    std::uint64_t rays = 0; ///< endless rays against the closed target
    std::uint64_t contacts = 0, invented = 0, missed = 0, near_surface = 0, side_tests = 0;
    std::string first; ///< of the wrong ones, in words
};

// An endless ray from a point of a closed mesh is a contact exactly when the point is inside: no ray needs casting
// to check one, so the check shares nothing with what is checked.
class Judge {
public:
    explicit Judge(const Solid& target) : target_(target), index_(target) {}

    bool in_bounds(const Vec3& p) const {
        return p.x >= target_.box_min.x && p.x <= target_.box_max.x && p.y >= target_.box_min.y
               && p.y <= target_.box_max.y && p.z >= target_.box_min.z && p.z <= target_.box_max.z;
    }

    void judge(const Vec3& p, bool contact, bool endless, Counts& counts) const {
        const SideIndex::Side side = index_.side(p);
        if (contact && side == SideIndex::Side::inside) return;
        if (!contact && (!endless || side == SideIndex::Side::outside)) return;
        if (distance_to_surface(target_, p) < 1e-6 * std::max(1.0, target_.diagonal)) {
            ++counts.near_surface;
            return;
        }
        const bool inside = winding_number(target_, p) > 0.5;
        if (contact == inside) return;
        ++(contact ? counts.invented : counts.missed);
        if (!counts.first.empty()) return;
        char text[200];
        std::snprintf(text, sizeof text, "%s from (%a, %a, %a) of the target's frame, %s", target_.name.c_str(), p.x,
                      p.y, p.z, contact ? "outside but in contact" : "inside but not in contact");
        counts.first = text;
    }

private:
    const Solid& target_;
    SideIndex index_;
};

struct Cloud {
    std::shared_ptr<const Shape> shape;
    std::vector<Vec3> vertices; ///< relative to the target's centre when the poses agree
};

Cloud make_cloud(const Subject& target, Aim aim, std::uint32_t triangles, Random& random) {
    Cloud cloud;
    cloud.shape =
        prepared_shape(prepare_mesh(ray_cloud(target.solid, aim, triangles, random), {.repair = Repair::as_is}));
    cloud.vertices.assign(cloud.shape->vertices().begin(), cloud.shape->vertices().end());
    return cloud;
}

void cast(const Subject& target, Aim aim, double rays, std::uint64_t seed, Counts& counts) {
    constexpr std::uint32_t triangles = 1500;
    Random random(seed);
    const Judge judge(target.solid);
    Scene scene(every_ray());
    const BodyId body = scene.add(target.shape);
    const auto end = counts.rays + static_cast<std::uint64_t>(rays);
    while (counts.rays < end) {
        const Cloud cloud = make_cloud(target, aim, triangles, random);
        const auto exits = cloud.shape->exit_distances();
        const BodyId source = scene.add(cloud.shape);
        const std::vector<Pair> pairs{{body, source}};
        std::vector<char> hit(cloud.vertices.size());
        for (int k = 0; k < 100 && counts.rays < end; ++k) {
            // The target stands where it was aimed at, at random in the world; the cloud is off by about a rounding
            // when aimed, by anything when not. Each pose rounds every ray anew.
            Pose at = random.rotation();
            at.translation = 3 * random.in_ball() - rotate(at, target.solid.centre);
            const Vec3 axis = random.direction(); // one after the other: the order of arguments is the compiler's
            const double angle = 1e-7 * random.uniform();
            const Pose off = aim == Aim::anywhere ? random.rotation() : small_rotation(axis, angle);
            const Vec3 shift = (aim == Aim::anywhere ? 0.1 : 1e-7) * random.in_ball();
            Pose pose = at; // x_target = off * x_cloud + shift, about the target's centre
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j) {
                    pose.rotation[3 * i + j] = 0;
                    for (std::size_t m = 0; m < 3; ++m)
                        pose.rotation[3 * i + j] += at.rotation[3 * i + m] * off.rotation[3 * m + j];
                }
            pose.translation = at.translation + rotate(at, target.solid.centre + shift);
            scene.set_pose(body, at);
            scene.set_pose(source, pose);

            std::fill(hit.begin(), hit.end(), char{0});
            for (const Contact& c : scene.find_contacts(pairs))
                if (c.feature.source == Side::b) hit[c.feature.source_index()] = 1, ++counts.contacts;
            counts.side_tests += scene.stats().details.side_tests;
            const auto index = cloud.shape->vertex_index();
            for (std::size_t v = 0; v < cloud.vertices.size(); ++v) {
                const Vec3 p = rotate(off, cloud.vertices[v]) + shift;
                const bool contact = hit[index[v]] != 0;
                const bool inside_bounds = judge.in_bounds(p);
                counts.rays += inside_bounds;
                if (inside_bounds || contact) judge.judge(p, contact, std::isinf(exits[v]), counts);
            }
        }
        scene.remove(source);
    }
}

void report(const char* what, const Counts& c, double wanted) {
    std::printf("[ counts   ] %s: %llu rays, %llu contacts (%llu rays decided by side), %llu invented, %llu missed, "
                "%llu within 1e-6 of the surface\n",
                what, static_cast<unsigned long long>(c.rays), static_cast<unsigned long long>(c.contacts),
                static_cast<unsigned long long>(c.side_tests), static_cast<unsigned long long>(c.invented),
                static_cast<unsigned long long>(c.missed), static_cast<unsigned long long>(c.near_surface));
    EXPECT_EQ(c.invented, 0u) << c.first;
    EXPECT_EQ(c.missed, 0u) << c.first;
    EXPECT_GE(static_cast<double>(c.rays - c.near_surface), wanted);
    EXPECT_GE(c.contacts, c.rays / 20);
    EXPECT_LE(c.contacts, c.rays - c.rays / 20);
}

void cast_all_targets(Aim aim, const char* what, double rays, std::uint64_t seed) {
    Counts counts;
    std::vector<const Subject*> targets;
    for (const Subject& s : closed_subjects()) targets.push_back(&s);
    for (const Subject* s : targets) cast(*s, aim, rays / static_cast<double>(targets.size()), seed++, counts);
    report(what, counts, rays * 0.99);
}

TEST(invented, at_random) {
    cast_all_targets(Aim::anywhere, "at random", 0.5 * rays_wanted(), 1);
}

TEST(invented, aimed_at_edges_and_vertices) {
    cast_all_targets(Aim::features, "aimed", 0.25 * rays_wanted(), 101);
}

TEST(invented, grazing_silhouettes) {
    cast_all_targets(Aim::silhouettes, "silhouettes", 0.25 * rays_wanted(), 201);
}

// Rays along the axes from points of a dyadic grid: everything is exact, and they run inside faces, along edges and
// through vertices of axis-aligned meshes, and in the planes of every bounding box.
TEST(invented, along_the_axes_of_boxes) {
    const auto source = prepared_shape(prepare_mesh(needle(), {.repair = Repair::as_is}));
    ASSERT_TRUE(std::isinf(source->exit_distances()[0]));
    const std::vector<Pose> rotations = axis_rotations();
    ASSERT_EQ(rotations.size(), 24u);
    Counts counts;
    for (const Mesh& mesh : {grid_box_mesh(8), l_prism_mesh(), frame_mesh()}) {
        const Subject target(mesh);
        const Judge judge(target.solid);
        Scene scene(every_ray());
        const BodyId body = scene.add(target.shape);
        std::vector<Pair> pairs;
        std::vector<Pose> poses;
        const Vec3 size = target.solid.box_max - target.solid.box_min;
        for (int x = 0; x <= 16; ++x)
            for (int y = 0; y <= 16; ++y)
                for (int z = 0; z <= 8; ++z) {
                    Pose pose = rotations[static_cast<std::size_t>(x + 5 * y + 7 * z) % rotations.size()];
                    pose.translation = target.solid.centre + target.solid.box_min
                                       + Vec3{size.x * x / 16, size.y * y / 16, size.z * z / 8};
                    poses.push_back(pose);
                    pairs.emplace_back(body, scene.add(source, pose));
                }
        std::vector<std::array<char, 3>> hit(poses.size());
        for (const Contact& c : scene.find_contacts(pairs))
            if (c.feature.source == Side::b) hit[c.body_b.slot - 1][c.feature.source_index()] = 1, ++counts.contacts;
        counts.side_tests += scene.stats().details.side_tests;
        for (std::size_t i = 0; i < poses.size(); ++i)
            for (std::uint32_t v = 0; v < 3; ++v) {
                const Vec3 p = poses[i].translation + rotate(poses[i], source->vertices()[v]) - target.solid.centre;
                const bool inside_bounds = judge.in_bounds(p);
                counts.rays += inside_bounds;
                if (inside_bounds || hit[i][v]) judge.judge(p, hit[i][v] != 0, true, counts);
            }
    }
    report("along axes", counts, 12000);
}

} // namespace
