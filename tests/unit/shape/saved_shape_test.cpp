// SPDX-License-Identifier: Apache-2.0
// Shapes as bytes: what is loaded is what was saved, to the bit, and hostile bytes do no harm.
#include <raycontact/collide.h>
#include <raycontact/error.h>
#include <raycontact/primitives.h>
#include <raycontact/query.h>
#include <raycontact/scene.h>

#include "shape/accelerators.h"
#include "state_bytes.h"
#include "unit/mesh/solids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <xxhash.h>

namespace raycontact {
namespace {

using Bytes = std::vector<std::byte>;

Mesh moved(Mesh mesh, const Vec3& by) {
    for (Vec3& v : mesh.vertices) v = v + by;
    return mesh;
}

/// One with hills that no two triangles of have alike.
std::shared_ptr<const Shape> hills(std::uint32_t side) {
    std::vector<double> heights;
    for (std::uint32_t i = 0; i < side; ++i)
        for (std::uint32_t j = 0; j < side; ++j) heights.push_back(0.3 * std::sin(0.7 * i) * std::cos(0.4 * j));
    return make_height_field(heights, {.rows = side, .columns = side, .step_x = 0.1, .step_y = 0.1}, -1);
}

/// A needle that float32 gives an area, or takes one.
Mesh with_slivers() {
    Mesh mesh = test::torus(12, 6, 0.5, 0.2, 0);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& v : {Vec3{2, 0, 0}, Vec3{3, 1e-12, 0}, Vec3{4, 0, 0}, Vec3{2.1, 2.3, 0.1}, Vec3{3.1, 2.4, 0.1},
                          Vec3{4.1, 2.5, 0.1}})
        mesh.vertices.push_back(v);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first + 3, first + 4, first + 5});
    return mesh;
}

PreparedMesh unchecked(const Mesh& mesh) {
    return prepare_mesh(mesh, {.overlaps = Overlaps::leave, .check = Check::topology});
}

struct Kind {
    const char* name;
    std::function<std::shared_ptr<const Shape>()> make;
};
const std::vector<Kind>& kinds() {
    static const Mesh ring = test::torus(24, 12, 0.5, 0.2, 0.1);
    static const std::vector<Kind> all{
        {"box",
         [] {
             return make_box({0.5, 0.4, 0.3});
         }},
        {"ring", [] { return Shape::make(ring); }},
        {"hills", [] { return hills(24); }},
        {"far",
         [] {
             return Shape::make(moved(ring, {1e6 / 3, -7.7, 1.0 / 3}));
         }},
        {"sheet",
         [] {
             Mesh half = ring;
             half.triangles.resize(half.triangles.size() / 2);
             return Shape::make(half);
         }},
        {"shells", [] { return Shape::make(test::shells(3)); }},
        {"slivers", [] { return Shape::make(prepare_mesh(with_slivers(), {.repair = Repair::as_is})); }},
        {"unchecked", [] { return Shape::make(unchecked(ring)); }},
        {"ball", [] { return make_ball(0.4); }},
        {"capsule", [] { return make_capsule(0.2, 0.5); }},
        {"ball of a capsule", [] { return make_capsule(0.4, 0); }},
    };
    return all;
}

template <class T>
void expect_same(std::span<const T> found, std::span<const T> expected, const char* what) {
    ASSERT_EQ(found.size(), expected.size()) << what;
    if (found.empty()) return;
    EXPECT_EQ(std::memcmp(found.data(), expected.data(), found.size_bytes()), 0) << what;
}
template <class T>
void expect_same(const std::vector<T>& found, const std::vector<T>& expected, const char* what) {
    expect_same(std::span<const T>(found), std::span<const T>(expected), what);
}
template <class T>
void expect_same(const T& found, const T& expected, const char* what) {
    EXPECT_EQ(std::memcmp(&found, &expected, sizeof(T)), 0) << what;
}

kernels::ShapeHeader without_places(kernels::ShapeHeader header) {
    for (auto* place :
         {&header.nodes, &header.triangle_blocks, &header.vertex_blocks, &header.clusters, &header.faces,
          &header.face_normals, &header.outside_cells, &header.clearances, &header.normal_cones, &header.components})
        *place = 0;
    return header;
}

void expect_same_tree(const TriangleTree& found, const TriangleTree& expected) {
    expect_same(found.triangle_blocks, expected.triangle_blocks, "triangle blocks");
    expect_same(found.nodes, expected.nodes, "nodes");
}

/// What contacts and queries read.
void expect_same_data(const ShapeData& a, const ShapeData& b) {
    expect_same_tree(a, b);
    expect_same_tree(a.slivers, b.slivers);
    expect_same(a.mesh.vertices, b.mesh.vertices, "rounded vertices");
    expect_same(a.file_vertices, b.file_vertices, "kept vertices");
    expect_same(a.flat, b.flat, "flat");
    expect_same(a.points, b.points, "points");
    expect_same(a.sharp_edges, b.sharp_edges, "sharp edges");
    expect_same(a.hides, b.hides, "hides");
    expect_same(a.perturbations, b.perturbations, "perturbations");
    expect_same(a.component_vertices, b.component_vertices, "component vertices");
    expect_same(a.faces, b.faces, "faces");
    expect_same(a.vertex_blocks, b.vertex_blocks, "vertex blocks");
    expect_same(a.clusters, b.clusters, "clusters");
    expect_same(a.components, b.components, "components");
    expect_same(a.face_normals, b.face_normals, "face normals");
    expect_same(a.clearances, b.clearances, "clearances");
    expect_same(without_places(a.header), without_places(b.header), "header");
    EXPECT_EQ(a.rays_end, b.rays_end);
    for (const auto part :
         {&ShapeData::diagonal, &ShapeData::hides_most, &ShapeData::hides_half, &ShapeData::grain, &ShapeData::reach})
        EXPECT_EQ(a.*part, b.*part);
    ASSERT_EQ(a.core == nullptr, b.core == nullptr);
    if (a.core) expect_same_data(*a.core, *b.core);
}

void expect_same_shape(const Shape& a, const Shape& b) {
    EXPECT_EQ(a.name(), b.name());
    EXPECT_EQ(to_json(a.report()), to_json(b.report()));
    EXPECT_EQ(a.report().repairs, b.report().repairs);
    EXPECT_EQ(a.report().checked, b.report().checked);
    expect_same(a.report().volume, b.report().volume, "volume");
    EXPECT_EQ(a.has_inside(), b.has_inside());
    EXPECT_EQ(a.is_prepared(), b.is_prepared());
    ASSERT_EQ(a.round() == nullptr, b.round() == nullptr);
    if (a.round() != nullptr) expect_same(*a.round(), *b.round(), "round");
    expect_same(a.vertices(), b.vertices(), "vertices");
    expect_same(a.file_vertices(), b.file_vertices(), "file vertices");
    expect_same(a.triangles(), b.triangles(), "triangles");
    expect_same(a.vertex_index(), b.vertex_index(), "vertex index");
    expect_same(a.triangle_index(), b.triangle_index(), "triangle index");
    for (const auto corner : {&Shape::centre, &Shape::box_min, &Shape::box_max})
        expect_same((a.*corner)(), (b.*corner)(), "box");
    EXPECT_EQ(a.radius(), b.radius());
    EXPECT_EQ(a.longest_edge(), b.longest_edge());
    expect_same(a.vertex_normals(), b.vertex_normals(), "normals");
    expect_same(a.vertex_areas(), b.vertex_areas(), "areas");
    expect_same(a.exit_distances(), b.exit_distances(), "exits");
    expect_same(a.neighbours(), b.neighbours(), "neighbours");
    expect_same(a.vertex_triangles(), b.vertex_triangles(), "vertex triangles");
    expect_same_data(a.data(), b.data());
    if (!a.is_prepared() || !b.is_prepared()) return;
    const Accelerators &more = *accelerators_of(a), &expected = *accelerators_of(b);
    expect_same(without_places(more.header), without_places(expected.header), "header of accelerators");
    expect_same(more.normal_cones, expected.normal_cones, "normal cones");
    expect_same(more.outside_cells, expected.outside_cells, "outside cells");
    expect_same(more.clearances, expected.clearances, "clearances");
    expect_same(more.supports.reaches(), expected.supports.reaches(), "supports");
}

TEST(SavedShape, IsTheSameToTheBit) {
    for (const Kind& kind : kinds())
        for (const bool prepared : {false, true}) {
            SCOPED_TRACE(kind.name);
            const auto shape = kind.make();
            if (prepared) shape->prepare();
            const Bytes bytes = shape->save();
            EXPECT_EQ(bytes.capacity(), bytes.size());
            const auto loaded = Shape::load(bytes);
            expect_same_shape(*loaded, *shape);
            EXPECT_EQ(loaded->save(), bytes);
            if (prepared) continue;
            loaded->prepare();
            shape->prepare();
            expect_same_shape(*loaded, *shape);
        }
}

std::string hash_of(const std::vector<std::shared_ptr<const Shape>>& shapes, Method method) {
    Settings settings;
    settings.method = method;
    Scene scene(settings);
    std::vector<BodyId> bodies;
    std::vector<Vec3> places;
    std::mt19937 random(7);
    for (int i = 0; i < 3; ++i)
        for (const auto& shape : shapes) {
            const auto number = [&] { return double(random()) / 4294967296.0 - 0.5; };
            places.push_back(Vec3{number(), number(), number()} - shape->centre());
            bodies.push_back(scene.add(shape, {.translation = places.back()}));
        }
    ContactHash hash(scene.settings().direction, true);
    std::size_t found = 0;
    for (std::uint32_t step = 0; step < 6; ++step) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const double angle = 0.03 * step * double(i % 5), c = std::cos(angle), s = std::sin(angle);
            scene.set_pose(bodies[i], {{c, -s, 0, s, c, 0, 0, 0, 1}, places[i] + Vec3{0, 0, 0.01 * step}});
        }
        found += scene.find_contacts().size();
        hash.add(step, scene.contacts());
    }
    EXPECT_GT(found, 100u);
    return hash.hex();
}

TEST(SavedShape, HasTheSameContacts) {
    for (const bool prepared : {false, true}) {
        std::vector<std::shared_ptr<const Shape>> shapes, loaded;
        for (const Kind& kind : kinds()) {
            if (std::string(kind.name) == "far") continue; // its vertices turn too far
            shapes.push_back(kind.make());
            if (prepared) shapes.back()->prepare();
            loaded.push_back(Shape::load(shapes.back()->save()));
        }
        for (const Method method : {Method::standard, Method::certified, Method::iterative, Method::predictive})
            EXPECT_EQ(hash_of(loaded, method), hash_of(shapes, method));
    }
}

void expect_refused(std::span<const std::byte> bytes, const char* why) {
    try {
        Shape::load(bytes);
        ADD_FAILURE() << why;
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
}

/// As if they had been written so.
void sign(Bytes& bytes) {
    constexpr std::size_t word = sizeof(std::uint64_t);
    std::uint64_t mark = 0;
    std::memcpy(&mark, bytes.data(), word);
    const std::uint64_t sum = XXH64(bytes.data(), bytes.size() - word, mark);
    std::memcpy(bytes.data() + bytes.size() - word, &sum, word);
}

TEST(SavedShape, RefusesOtherBytes) {
    const Bytes bytes = Shape::make(test::torus(12, 6, 0.5, 0.2, 0))->save();
    expect_refused({}, "no shape of this version");
    for (const std::size_t size : {std::size_t{1}, std::size_t{8}, std::size_t{15}})
        expect_refused(std::span(bytes).first(size), "no shape of this version");
    for (const std::size_t size : {std::size_t{16}, std::size_t{17}, bytes.size() / 2, bytes.size() - 1})
        expect_refused(std::span(bytes).first(size), "damaged");
    for (std::size_t i = 8; i < bytes.size(); i += 97) {
        Bytes damaged = bytes;
        damaged[i] ^= std::byte{4};
        expect_refused(damaged, "damaged");
    }
    Bytes longer = bytes;
    longer.push_back({});
    expect_refused(longer, "damaged");
    sign(longer);
    expect_refused(longer, "damaged");
    Bytes other = bytes;
    std::reverse(other.begin(), other.begin() + 8);
    expect_refused(other, "another order of bytes");
    other = bytes;
    other[16] = std::byte{'9'}; // the first letter of the version
    sign(other);
    expect_refused(other, "of version 9");
    expect_refused(Scene().save_state(), "no shape of this version");
}

/// All that could read beyond an array of a shape that is not what it says.
void use(const std::shared_ptr<const Shape>& shape, bool prepare) {
    static const auto other = Shape::make(test::torus(12, 6, 0.5, 0.2, 0));
    if (prepare) shape->prepare(1);
    const Vec3 middle = shape->centre();
    const Pose near{.translation = {middle.x + 0.3, middle.y, middle.z + 0.05}};
    static_cast<void>(raycast(*shape, {}, middle + Vec3{3, 0.1, 0.2}, {-1, 0, 0}));
    static_cast<void>(closest_point(*shape, {}, middle + Vec3{0.4, 0.3, 0.2}));
    static_cast<void>(intersects(*shape, {}, *other, near));
    static_cast<void>(distance(*shape, {}, *other, near));
    for (const Method method : {Method::certified, Method::predictive}) {
        Settings settings;
        settings.method = method;
        settings.execution.threads = 1;
        Scene scene(settings);
        scene.add(shape);
        const BodyId body = scene.add(other, near);
        for (int step = 0; step < 3; ++step) {
            scene.set_pose(body, {.translation = near.translation + 0.02 * step * Vec3{1, 0.3, 0.1}});
            scene.find_contacts();
        }
    }
    EXPECT_EQ(Shape::load(shape->save())->vertices().size(), shape->vertices().size());
}

// The checksum is right: whoever forges bytes writes one.
TEST(SavedShape, DoesNoHarmWhateverTheBytes) {
    std::mt19937 random(3);
    int refused = 0, used = 0;
    for (const bool prepared : {false, true}) {
        const auto shape = Shape::make(test::torus(12, 6, 0.5, 0.2, 0));
        if (prepared) shape->prepare();
        const Bytes bytes = shape->save();
        const std::size_t words = bytes.size() / 4;
        for (int i = 0; i < 600; ++i) {
            Bytes forged = bytes;
            const int changes = i % 3 == 0 ? 4 : 1;
            for (int k = 0; k < changes; ++k) {
                const std::size_t at = random() % forged.size();
                static constexpr std::uint32_t odd[] = {0,           1,           2,           71,
                                                        0x7fffffffu, 0x80000000u, 0x80000001u, 0xffffffffu,
                                                        0x7fc00000u, 0x7f800000u, 0x3f800000u};
                const std::size_t word = random() % words;
                if (i % 2 == 0)
                    forged[at] = std::byte(random());
                else
                    std::memcpy(forged.data() + 4 * word, &odd[random() % std::size(odd)], 4);
            }
            if (i % 50 == 7) forged.resize(forged.size() - random() % 500);
            if (i % 50 == 8) forged.insert(forged.end() - 8, 1 + random() % 500, std::byte(random()));
            if (forged.size() < 16) continue;
            sign(forged);
            std::shared_ptr<const Shape> loaded;
            try {
                loaded = Shape::load(forged);
            } catch (const InputError&) {
                ++refused;
                continue;
            }
            ++used;
            use(loaded, i % 100 == 0);
        }
    }
    EXPECT_GT(refused, 200);
    EXPECT_GT(used, 200);
}

// Two entries of a list change places: each is still in range.
TEST(SavedShape, AnOrderThatIsNoneIsRefused) {
    const auto shape = Shape::make(test::torus(24, 12, 0.5, 0.2, 0));
    const Bytes bytes = shape->save();
    const ShapeData& data = shape->data();
    const auto find = [&](std::span<const std::uint32_t> list) {
        const auto own = std::as_bytes(list);
        const auto at = std::ranges::search(bytes, own);
        EXPECT_FALSE(at.empty());
        return static_cast<std::size_t>(at.begin() - bytes.begin());
    };
    const auto changed = [&](std::size_t at, std::uint32_t to) {
        Bytes forged = bytes;
        std::memcpy(forged.data() + at, &to, 4);
        sign(forged);
        expect_refused(forged, "damaged");
    };
    const auto& block = data.triangle_blocks[0].triangle;
    const std::size_t triangles = find(block);
    changed(triangles, block[1]);
    changed(triangles, NONE);
    changed(triangles, 576);
    const auto& node = data.nodes[0].child;
    const std::size_t children = find(node);
    ASSERT_GT(data.nodes.size(), 2u);
    for (const std::uint32_t child : {0u, 2u, 500u, LEAF, LEAF | 5000u, NONE}) changed(children, child);
    const auto& vertices = data.vertex_blocks[0].vertex;
    changed(find(vertices), vertices[1]);
    changed(find(vertices), 5000);
    const auto& edges = data.vertex_blocks[data.header.edges.block_first].vertex;
    changed(find(edges), edges[1]);
    changed(find(edges), 50000);
}

} // namespace
} // namespace raycontact
