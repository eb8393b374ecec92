// SPDX-License-Identifier: Apache-2.0
// Every part that lies inside another body in double is found in float32; few others are.
#include "edges/inside_search.h"

#include "edges/pair_meshes.h"
#include "mesh/disjoint_sets.h"
#include "rays/ray_batch.h"

#include "prepared_shape.h"
#include "reference/meshes.h"
#include "reference/random.h"

#include <raycontact/device.h>

#include <algorithm>
#include <gtest/gtest.h>

namespace raycontact {
namespace {

using namespace reference;

Mesh scaled(Mesh mesh, double by) {
    for (Vec3& v : mesh.vertices) v = by * v;
    return mesh;
}

Mesh turned_inside_out(Mesh mesh) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    return mesh;
}

Mesh joined(const std::vector<Mesh>& meshes) {
    Mesh all;
    for (const Mesh& mesh : meshes) {
        const auto first = static_cast<std::uint32_t>(all.vertices.size());
        all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
        for (const auto& [a, b, c] : mesh.triangles) all.triangles.push_back({first + a, first + b, first + c});
    }
    return all;
}

// Boxes in boxes: a cavity, and a solid in it.
Mesh nested_mesh() {
    return joined({box_mesh({1, 1, 1}), turned_inside_out(box_mesh({0.7, 0.7, 0.7})), box_mesh({0.3, 0.3, 0.3})});
}

Mesh scattered_mesh(Random& random) {
    std::vector<Mesh> parts;
    for (int i = 0; i < 5; ++i) parts.push_back(moved(scaled(tetrahedron_mesh(), 0.15), 1.2 * random.in_ball()));
    return joined(parts);
}

std::vector<Mesh> closed_meshes(Random& random) {
    return {bumpy_octahedron_mesh(8), frame_mesh(),  l_prism_mesh(),
            box_mesh({1, 0.8, 0.6}),  nested_mesh(), scattered_mesh(random)};
}

// With any ray: the crossing that is closest tells.
bool is_inside(const ShapeData& target, const Vec3& p) {
    const MeshHit hit = closest_hit(target, {p, unit({0.4721, -0.3391, 0.8137}), 0, 1e300});
    return hit.face != NONE && hit.from_inside;
}

// By brute force: whether a component of the source lies in the target with all its vertices.
bool has_part_inside(const SourceMesh& pair) {
    if (pair.target.header.closed == 0) return false;
    DisjointSets components;
    components.reset(pair.source.points.size());
    for (const auto& [a, b, c] : pair.source.mesh.triangles) {
        components.join(a, b);
        components.join(a, c);
    }
    std::vector<bool> out(pair.source.points.size());
    for (std::uint32_t v = 0; v < pair.source.points.size(); ++v)
        if (!out[components.of(v)] && !is_inside(pair.target, pair.vertex(v))) out[components.of(v)] = true;
    return std::ranges::any_of(pair.source.component_vertices, [&](std::uint32_t v) { return !out[v]; });
}

// No point of the source that is asked comes near the target or into one of its cavities.
bool is_clearly_apart(const SourceMesh& pair) {
    const ShapeData& target = pair.target;
    return std::ranges::all_of(pair.source.component_vertices, [&](std::uint32_t v) {
        const Vec3 p = pair.vertex(v);
        return !is_inside(target, p) && nearest_face(target, p, 0).distance > 0.05 * target.diagonal
               && closest_hit(target, {p, {1, 0, 0}, 0, 1e300}).face == NONE;
    });
}

/// Pairs of bodies, whose directed pairs are searched.
class Pairs {
public:
    Pairs() : opened_(open_device("cpu", 1)), store_(*opened_.device) {}
    void add(const std::shared_ptr<const Shape>& a, const Pose& pose_a, const std::shared_ptr<const Shape>& b,
             const Pose& pose_b) {
        const auto place = [&](const std::shared_ptr<const Shape>& shape, const Pose& pose) {
            store_.add(shape);
            shapes_.push_back(shape);
            PlacedBody& body = bodies.emplace_back();
            body.shape = shape.get();
            body.pose = pose;
            body.centred = centred_pose(*shape, pose);
        };
        place(a, pose_a);
        place(b, pose_b);
        pairs.emplace_back(bodies.size() - 2, bodies.size() - 1);
    }
    /// The directed pairs found, in slots of which every fourth is empty. Returns how often it was searched.
    int find(std::vector<std::uint32_t>& found) {
        store_.accelerate();
        for (PlacedBody& body : bodies) body.shape_index = store_.index_of(body.shape);
        const Update update{*opened_.device, *opened_.executor, store_, bodies, moved_, open_, {}, {},
                            motion_,         settings_};
        batch_.resize(update.device, 0);
        std::vector<kernels::DirectedPair> placed;
        std::vector<std::uint32_t> directed;
        for (std::uint32_t i = 0; i < pairs.size(); ++i)
            for (int k = 0; k < (i % 4 == 0 ? 2 : 1); ++k)
                for (const std::uint32_t d : {2 * i, 2 * i + 1}) {
                    directed.push_back(k == 0 ? d : NONE);
                    const auto [source, target] = directed_bodies(bodies, pairs, d);
                    place_source(source, target, placed.emplace_back());
                    if (k == 1) placed.back().source = NONE;
                }
        Array<kernels::DirectedPair> device_placed;
        device_placed.write(update.device, placed);
        int searches = 0;
        do {
            ++searches;
            search.find(update, device_placed, batch_.totals, RayBatch::inside_sum);
            const Piece pieces[] = {batch_.totals.piece(batch_.sums), search.piece()};
            update.device.queue().read(pieces);
        } while (!search.take(update.device, batch_.sums[RayBatch::inside_sum]));
        search.mark([&](kernels::uint p) { return directed[p]; }, pairs.size());
        found.clear();
        for (const kernels::uint p : search.found()) found.push_back(directed[p]);
        return searches;
    }

    std::vector<PlacedBody> bodies;
    std::vector<SlotPair> pairs;
    InsideSearch search;

private:
    std::vector<std::shared_ptr<const Shape>> shapes_;
    OpenDevice opened_;
    ShapeStore store_;
    Settings settings_;
    SlotChanges moved_;
    PairSlots open_;
    Motion motion_;
    RayBatch batch_;
};

struct Counts {
    std::size_t inside = 0, apart = 0, apart_found = 0;
};

Counts compare(Pairs& all) {
    std::vector<std::uint32_t> found;
    all.find(found);
    EXPECT_TRUE(std::ranges::is_sorted(found));
    Counts counts;
    for (std::uint32_t d = 0; d < 2 * all.pairs.size(); ++d) {
        const auto [source, target] = directed_bodies(all.bodies, all.pairs, d);
        const SourceMesh pair(source, target);
        const bool is_found = std::ranges::binary_search(found, d);
        if (has_part_inside(pair)) {
            ++counts.inside;
            EXPECT_TRUE(is_found) << d;
        } else if (is_clearly_apart(pair)) {
            ++counts.apart;
            counts.apart_found += is_found;
        }
        EXPECT_TRUE(!is_found || all.search.has(d / 2)) << d;
        EXPECT_TRUE(!is_found || target.shape->has_inside()) << d;
    }
    return counts;
}

// Bodies of all sizes within each other and around each other, here and far from the origin.
Counts compare_at_random(bool prepared) {
    Random random(31);
    std::vector<std::shared_ptr<const Shape>> targets, sources;
    for (const Mesh& mesh : closed_meshes(random)) {
        targets.push_back(prepared ? prepared_shape(mesh) : Shape::make(mesh));
        for (const double size : {1e-3, 0.05, 0.2, 1.0, 300.0})
            sources.push_back(prepared && size < 100 ? prepared_shape(scaled(mesh, size))
                                                     : Shape::make(scaled(mesh, size)));
    }
    targets.push_back(Shape::make(bowl_mesh(6)));
    sources.push_back(Shape::make(scaled(sheet_mesh(4), 0.1)));
    Pairs all;
    for (int i = 0; i < 3000; ++i) {
        const auto& target = targets[random.below(std::uint32_t(targets.size()))];
        const auto& source = sources[random.below(std::uint32_t(sources.size()))];
        Pose at = random.rotation(), from = random.rotation();
        const double reach = i % 3 == 0 ? 0.5 : i % 3 == 1 ? 1.3 : 2 + source->radius();
        from.translation = reach * random.in_ball();
        if (i % 5 == 0)
            for (Pose* pose : {&at, &from}) pose->translation = pose->translation + Vec3{10000, 3000, -2000};
        if (i % 2 == 0)
            all.add(target, at, source, from);
        else
            all.add(source, from, target, at);
    }
    return compare(all);
}

TEST(InsideSearch, FindsEveryPartInside) {
    const Counts counts = compare_at_random(true);
    EXPECT_GT(counts.inside, 300u);
    EXPECT_GT(counts.apart, 1000u);
    EXPECT_LT(double(counts.apart_found), 0.02 * double(counts.apart));
}

// The bounds alone tell.
TEST(InsideSearch, FindsEveryPartInsideWithoutGrids) {
    const Counts counts = compare_at_random(false);
    EXPECT_GT(counts.inside, 300u);
    EXPECT_LT(double(counts.apart_found), 0.1 * double(counts.apart));
}

// By a millionth of the size and less from the surface, and through it.
TEST(InsideSearch, FindsPartsThatTouchFromWithin) {
    Random random(32);
    const auto outer = prepared_shape(box_mesh({1, 1, 1})), inner = prepared_shape(box_mesh({0.25, 0.25, 0.25}));
    const auto pair =
        prepared_shape(joined({box_mesh({0.25, 0.25, 0.25}), moved(box_mesh({0.1, 0.1, 0.1}), {9, 0, 0})}));
    Pairs all;
    for (int i = 0; i < 600; ++i) {
        const double gap = random.uniform(-1, 1) * (i % 3 == 0 ? 1e-8 : i % 3 == 1 ? 1e-7 : 1e-6);
        Pose at = random.rotation(), from = at;
        const Vec3 corner{i % 2 == 0 ? 0.75 - gap : -0.75 + gap, 0.75 - gap, random.uniform(-0.7, 0.7)};
        at.translation = 100 * random.in_ball();
        from.translation = transform_point(at, corner);
        all.add(outer, at, i % 4 < 2 ? inner : pair, from);
    }
    EXPECT_GT(compare(all).inside, 200u);
}

// A crowd whose boxes overlap, none inside another: the host has next to nothing to ask.
TEST(InsideSearch, FindsFewInACrowdOfEquals) {
    Random random(33);
    const auto shape = prepared_shape(bumpy_octahedron_mesh(8));
    Pairs all;
    for (int i = 0; i < 1000; ++i) {
        Pose at = random.rotation(), from = random.rotation();
        from.translation = random.uniform(1.0, 2.0) * random.direction();
        all.add(shape, at, shape, from);
    }
    std::vector<std::uint32_t> found;
    all.find(found);
    EXPECT_LT(found.size(), 20u);
}

TEST(InsideSearch, MakesRoomAndSearchesAgain) {
    const auto outer = prepared_shape(box_mesh({1, 1, 1}));
    const auto small = prepared_shape(scaled(tetrahedron_mesh(), 0.1));
    Pairs all;
    for (int i = 0; i < 2000; ++i) all.add(outer, {}, small, {});
    std::vector<std::uint32_t> found;
    EXPECT_EQ(all.find(found), 2);
    ASSERT_EQ(found.size(), 2000u);
    for (std::uint32_t i = 0; i < 2000; ++i) EXPECT_EQ(found[i], 2 * i + 1);
    EXPECT_EQ(all.find(found), 1);
    EXPECT_EQ(found.size(), 2000u);
}

} // namespace
} // namespace raycontact
