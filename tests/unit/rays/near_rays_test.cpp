// SPDX-License-Identifier: Apache-2.0
// Every edge that crosses a face in double is found in float32, wherever a perturbation moves the vertices; few others
// are.
#include "mesh/vector.h"
#include "part/pipeline.h"
#include "shape/mesh_rays.h"
#include "shape/shape_data.h"

#include "device/listed_pairs.h"
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
        moved_.forget();
        place(a, pose_a);
        place(b, pose_b);
        pairs.emplace_back(bodies.size() - 2, bodies.size() - 1);
    }
    /// By their places in `pairs`.
    std::vector<AskedPair> find() {
        const Part::Pairs listed = listed_.next(pairs);
        const Update update{*opened_.device, *opened_.executor, *store_,      bodies,  moved_,
                            listed.open,     listed.asked,      listed.slots, motion_, settings_};
        pipeline_.begin(update);
        const Update found = pipeline_.end(update);
        found_.assign(found.pairs.begin(), found.pairs.end());
        listed_.step_done();
        std::vector<AskedPair> asked(pipeline_.asked().begin(), pipeline_.asked().end());
        for (AskedPair& one : asked)
            one.pair = static_cast<std::uint32_t>(std::ranges::find(pairs, found_[one.pair]) - pairs.begin());
        return asked;
    }
    /// After find(): whether edges alone tell of the pair.
    bool without_contact(std::uint32_t i) const {
        const auto at = static_cast<std::size_t>(std::ranges::find(found_, pairs[i]) - found_.begin());
        return at >= found_.size() || pipeline_.contacts().first(2 * at) == pipeline_.contacts().first(2 * at + 2);
    }
    /// By directed pair what comes within `more` of its target; with `ahead`, as NearRays::clear() needs it. Parts of
    /// the smaller body's size. Returns these, metres.
    std::vector<float> cast(double more, double ahead, RayBatch& batch, NearRays& rays) {
        const Part::Pairs asked = listed_.next(pairs);
        const Update update{*opened_.device, *opened_.executor, *store_,     bodies,  moved_,
                            asked.open,      asked.asked,       asked.slots, motion_, settings_};
        batch.resize(update.device, 0);
        Array<kernels::DirectedPair> placed;
        Array<float> margins, beyond;
        placed.resize(update.device, 2 * pairs.size());
        margins.resize(update.device, 2 * pairs.size());
        beyond.resize(update.device, 2 * pairs.size());
        for (std::uint32_t d = 0; d < 2 * pairs.size(); ++d) {
            const auto [source, target] = directed_bodies(bodies, pairs, d);
            place_source(source, target, placed.in_place()[d]);
            margins.in_place()[d] = static_cast<float>(more * smaller_size(source, target));
            beyond.in_place()[d] = static_cast<float>(ahead * smaller_size(source, target));
        }
        do {
            rays.cast(update, placed, {}, {margins, beyond, {}}, batch);
            const Piece pieces[] = {batch.totals.piece(batch.sums), rays.found().piece()};
            update.device.queue().read(pieces);
        } while (!rays.had_room(update.device, batch));
        const std::span<const float> asked_for = ahead > 0 ? beyond.in_place() : margins.in_place();
        return {asked_for.begin(), asked_for.end()};
    }
    /// By pair: how far its bodies can move, either against the other, before an edge crosses that is not found now.
    std::vector<double> clear(double ahead, RayBatch& batch, NearRays& rays) {
        const std::vector<float> beyond = cast(0, ahead, batch, rays);
        std::vector<double> clear;
        for (std::uint32_t i = 0; i < pairs.size(); ++i) {
            const auto& [a, b] = pairs[i];
            const auto of = [&](std::uint32_t d, std::uint32_t target) {
                return rays.clear(d, beyond[d], bodies[target].shape->data().header.tolerance);
            };
            clear.push_back(std::min(of(2 * i, b), of(2 * i + 1, a)));
        }
        return clear;
    }

    std::vector<std::shared_ptr<const Shape>> shapes;
    std::vector<PlacedBody> bodies;
    std::vector<SlotPair> pairs;

private:
    OpenDevice opened_;
    std::unique_ptr<ShapeStore> store_;
    Settings settings_;
    SlotChanges moved_;
    device_test::ListedPairs listed_;
    std::vector<SlotPair> found_; ///< the pairs of the answers
    Motion motion_;
    Pipeline pipeline_;
};

using Found = std::set<std::pair<std::uint32_t, std::uint32_t>>; // edge, face

// By brute force; each vertex is moved by a perturbation in any direction.
Found crossings(const PlacedBody& source, const PlacedBody& target, Random& random) {
    const ShapeData &from = source.shape->data(), &to = target.shape->data();
    const Pose pose = relative_pose(target.centred, source.centred);
    const double perturbation = 1e-7 * smaller_size(source, target);
    std::vector<Vec3> own, other;
    for (std::uint32_t v = 0; v < from.points.size(); ++v)
        own.push_back(transform_point(pose, from.point(v)) + perturbation * random.direction());
    for (std::uint32_t v = 0; v < to.points.size(); ++v)
        other.push_back(to.point(v) + perturbation * random.direction());
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
    // Of a pair without contact that is not asked none was found.
    std::vector<AskedPair> pairs = all.find();
    for (std::uint32_t i = 0; i < all.pairs.size(); ++i)
        if (all.without_contact(i) && std::ranges::find(pairs, i, &AskedPair::pair) == pairs.end())
            pairs.push_back({i, false, {}});
    for (const AskedPair& asked : pairs)
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

std::vector<const Subject*> closed_and_open() {
    std::vector<const Subject*> subjects = pointers(closed_subjects());
    for (const Subject& open : open_subjects()) subjects.push_back(&open);
    return subjects;
}

std::vector<std::shared_ptr<const Shape>> shapes_of(const std::vector<const Subject*>& subjects) {
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const Subject* subject : subjects) {
        subject->shape->prepare();
        shapes.push_back(subject->shape);
    }
    return shapes;
}

std::size_t place_of(const Subject* subject, const std::vector<const Subject*>& subjects) {
    return std::size_t(std::ranges::find(subjects, subject) - subjects.begin());
}

TEST(NearRays, FindEveryCrossing) {
    Random random(11);
    const std::vector<const Subject*> subjects = closed_and_open();
    Pairs all(shapes_of(subjects));
    for (int i = 0; i < 140; ++i) {
        const Placement placed = random_placement(subjects, random);
        Pose far = placed.pose_b, far_a = placed.pose_a;
        if (i % 4 == 0)
            for (Pose* pose : {&far, &far_a}) pose->translation = pose->translation + Vec3{10000, 3000, -2000};
        all.add(place_of(placed.a, subjects), far_a, place_of(placed.b, subjects), far);
    }
    expect_all_found(all, 3000, 0.1);
}

// Bodies apart, and moved by nearly as much as is clear: nothing crosses that was not found before.
TEST(NearRays, WhatIsClearStaysApart) {
    Random random(12);
    const std::vector<const Subject*> subjects = pointers(closed_subjects());
    Pairs all(shapes_of(subjects));
    for (int i = 0; i < 120; ++i) {
        const Placement placed = random_placement(subjects, random);
        Pose away = placed.pose_b;
        const double size = std::min(placed.a->shape->data().diagonal, placed.b->shape->data().diagonal);
        away.translation = away.translation + (0.7 * size) * random.direction();
        all.add(place_of(placed.a, subjects), placed.pose_a, place_of(placed.b, subjects), away);
    }
    RayBatch batch;
    NearRays rays(BlockSearch::Sources::edges);
    const std::vector<double> clear = all.clear(0.3, batch, rays);
    std::vector<std::array<Found, 2>> found(all.pairs.size());
    for (const auto& [edge, face, pair] : rays.found().values()) found[pair / 2][pair % 2].emplace(edge, face);
    std::size_t moved = 0, touched = 0;
    for (std::size_t i = 0; i < all.pairs.size(); ++i) {
        if (!(clear[i] > 0)) continue;
        const auto [a, b] = all.pairs[i];
        const double way = std::min(clear[i], 2.0 * all.bodies[b].shape->data().diagonal);
        moved += way > 0.01 * all.bodies[b].shape->data().diagonal;
        for (int k = 0; k < 8; ++k) {
            const Vec3 step =
                k == 0 ? all.bodies[a].centred.translation - all.bodies[b].centred.translation : random.direction();
            PlacedBody to = all.bodies[b];
            to.centred.translation = to.centred.translation + (0.99 * way / length(step)) * step;
            for (std::size_t side = 0; side < 2; ++side)
                for (const auto& crossing :
                     side == 0 ? crossings(all.bodies[a], to, random) : crossings(to, all.bodies[a], random))
                    EXPECT_TRUE(found[i][side].contains(crossing)) << i << ": clear " << clear[i];
            to.centred.translation = to.centred.translation + (4 * way / length(step)) * step;
            touched += k == 0 && !crossings(all.bodies[a], to, random).empty();
        }
    }
    EXPECT_GT(moved, 20u);
    EXPECT_GT(touched, 4u) << "a few times as far, some cross";
}

// Vertices that rest, and the faces within a margin: all that a brute force in double finds, and few others.
TEST(NearRays, FindEveryFaceNearAVertex) {
    Random random(13);
    const std::vector<const Subject*> subjects = closed_and_open();
    Pairs all(shapes_of(subjects));
    for (int i = 0; i < 100; ++i) {
        const Placement placed = random_placement(subjects, random);
        all.add(place_of(placed.a, subjects), placed.pose_a, place_of(placed.b, subjects), placed.pose_b);
    }
    RayBatch batch;
    NearRays rays(BlockSearch::Sources::points);
    const std::vector<float> margins = all.cast(0.02, 0, batch, rays);
    std::vector<Found> found(margins.size());
    for (const auto& [vertex, face, pair] : rays.found().values())
        EXPECT_TRUE(found[pair].emplace(vertex, face).second) << "once";
    std::size_t expected = 0, near = 0;
    for (std::uint32_t d = 0; d < found.size(); ++d) {
        near += found[d].size();
        const auto [source, target] = directed_bodies(all.bodies, all.pairs, d);
        const ShapeData &from = source.shape->data(), &to = target.shape->data();
        const Pose pose = relative_pose(target.centred, source.centred);
        for (std::uint32_t v = 0; v < from.points.size(); ++v) {
            if (from.vertex_triangle[v] == Shape::no_triangle) continue;
            const Vec3 p = transform_point(pose, from.point(v));
            for (std::uint32_t face = 0; face < to.mesh.triangles.size(); ++face) {
                const NearestPoint nearest = nearest_of(p, to.corner(face, 0), to.corner(face, 1), to.corner(face, 2));
                if (length(p - nearest.point) > double(margins[d])) continue;
                EXPECT_TRUE(found[d].contains({v, face})) << "pair " << d << ": vertex " << v << ", face " << face;
                ++expected;
            }
        }
    }
    EXPECT_GT(expected, 3000u);
    EXPECT_LE(double(near), 2.5 * double(expected));
}

// Faces in one plane, edges along edges.
TEST(NearRays, FindEveryCrossingOfFlushBodies) {
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
