// SPDX-License-Identifier: Apache-2.0
// Every edge that crosses a face in double is found in float32, wherever a hair moves the vertices; few others are.
#include "mesh/vector.h"
#include "part/pipeline.h"
#include "shape/shape_data.h"

#include "prepared_shape.h"
#include "property/shapes.h"
#include "reference/meshes.h"

#include <gtest/gtest.h>
#include <set>

namespace raycontact {
namespace {

using namespace reference;

class Pairs {
public:
    explicit Pairs(std::vector<std::shared_ptr<const Shape>> used) : shapes(std::move(used)) {
        opened_ = open_device("cpu", 1);
        store_ = std::make_unique<ShapeStore>(*opened_.device);
        for (const auto& shape : shapes) store_->add(shape);
        settings_.method = Method::standard;
        settings_.features = Features::edges;
    }
    void add(std::size_t a, const Pose& pose_a, std::size_t b, const Pose& pose_b) {
        const auto place = [&](std::size_t shape, const Pose& pose) {
            PlacedBody& body = bodies.emplace_back();
            body.shape = shapes[shape].get();
            body.shape_index = store_->index_of(body.shape);
            body.pose = pose;
            body.centred = centred_pose(*body.shape, pose);
        };
        place(a, pose_a);
        place(b, pose_b);
        pairs.emplace_back(bodies.size() - 2, bodies.size() - 1);
    }
    std::span<const AskedPair> find() {
        const Update update{*opened_.device, *opened_.executor, *store_, bodies, pairs, motion_, settings_};
        pipeline_.begin(update);
        pipeline_.end(update);
        return pipeline_.asked();
    }

    std::vector<std::shared_ptr<const Shape>> shapes;
    std::vector<PlacedBody> bodies;
    std::vector<SlotPair> pairs;

private:
    OpenDevice opened_;
    std::unique_ptr<ShapeStore> store_;
    Settings settings_;
    Motion motion_;
    Pipeline pipeline_;
};

using Found = std::set<std::pair<std::uint32_t, std::uint32_t>>; // edge, face

// By brute force; each vertex is moved by a hair in any direction.
Found crossings(const PlacedBody& source, const PlacedBody& target, Random& random) {
    const ShapeData &from = source.shape->data(), &to = target.shape->data();
    const Pose pose = relative_pose(target.centred, source.centred);
    const double hair = 1e-7 * smaller_size(source, target);
    std::vector<Vec3> own, other;
    for (std::uint32_t v = 0; v < from.points.size(); ++v)
        own.push_back(transform_point(pose, from.point(v)) + hair * random.direction());
    for (std::uint32_t v = 0; v < to.points.size(); ++v) other.push_back(to.point(v) + hair * random.direction());
    Found found;
    for (std::uint32_t t = 0; t < from.mesh.triangles.size(); ++t)
        for (std::uint32_t c = 0; c < 3; ++c) {
            if (from.neighbours[t][c] != NONE && from.neighbours[t][c] < t) continue;
            const Vec3 p = own[from.mesh.triangles[t][c]], q = own[from.mesh.triangles[t][(c + 1) % 3]];
            for (std::uint32_t face = 0; face < to.mesh.triangles.size(); ++face) {
                const auto& [i, j, k] = to.mesh.triangles[face];
                const Vec3 a = other[i], b = other[j], d = other[k], n = cross(b - a, d - a);
                if ((dot(p - a, n) < 0) == (dot(q - a, n) < 0)) continue;
                const Vec3 u = a - p, v = b - p, w = d - p;
                const bool x = dot(q - p, cross(v, w)) < 0, y = dot(q - p, cross(w, u)) < 0;
                if (x == y && y == (dot(q - p, cross(u, v)) < 0)) found.emplace(3 * t + c, face);
            }
        }
    return found;
}

void expect_all_found(Pairs& all, std::size_t least, double most_others) {
    Random random(3);
    std::size_t expected = 0, near = 0;
    for (const AskedPair& asked : all.find())
        for (std::uint32_t side = 0; side < 2; ++side) {
            const auto [source, target] = directed_bodies(all.bodies, all.pairs, 2 * asked.pair + side);
            Found found;
            for (const auto& [edge, face, pair] : asked.near[side])
                EXPECT_TRUE(found.emplace(edge, face).second) << "once";
            near += found.size();
            for (const auto& crossing : crossings(source, target, random)) {
                EXPECT_TRUE(found.contains(crossing)) << asked.pair << ": edge " << crossing.first;
                ++expected;
            }
        }
    EXPECT_GT(expected, least);
    EXPECT_LE(double(near), (1 + most_others) * double(expected));
}

TEST(EdgeRays, FindEveryCrossing) {
    Random random(11);
    std::vector<const Subject*> subjects = pointers(closed_subjects());
    for (const Subject& open : open_subjects()) subjects.push_back(&open);
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const Subject* subject : subjects) {
        subject->shape->prepare();
        shapes.push_back(subject->shape);
    }
    Pairs all(shapes);
    for (int i = 0; i < 140; ++i) {
        const Placement placed = random_placement(subjects, random);
        const auto at = [&](const Subject* subject) {
            return std::size_t(std::ranges::find(subjects, subject) - subjects.begin());
        };
        Pose far = placed.pose_b, far_a = placed.pose_a;
        if (i % 4 == 0)
            for (Pose* pose : {&far, &far_a}) pose->translation = pose->translation + Vec3{10000, 3000, -2000};
        all.add(at(placed.a), far_a, at(placed.b), far);
    }
    expect_all_found(all, 3000, 0.1);
}

// Faces in one plane, edges along edges.
TEST(EdgeRays, FindEveryCrossingOfFlushBodies) {
    Pairs all({prepared_shape(grid_box_mesh(4)), prepared_shape(l_prism_mesh())});
    for (int i = 0; i < 24; ++i) {
        Pose pose;
        pose.translation = {0.25 * (i % 5), 0.25 * (i % 3), i % 4 == 0 ? 1.0 : 0.5};
        all.add(i % 2, {}, 0, pose);
    }
    expect_all_found(all, 500, 40);
}

} // namespace
} // namespace raycontact
