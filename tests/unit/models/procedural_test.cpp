// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <raycontact/mass.h>
#include <scenes/models/model.h>
#include <scenes/models/procedural.h>
#include <scenes/models/simplify.h>

#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

using namespace raycontact;
using namespace raycontact::scenes;

namespace {

/// An edge that bends inward: the apex of the triangle across it lies above the triangle's own plane.
bool concave(const Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> apex;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) apex[{t[k], t[(k + 1) % 3]}] = t[(k + 2) % 3];
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &o = mesh.vertices[t[0]], &p = mesh.vertices[t[1]], &q = mesh.vertices[t[2]];
            const Vec3& r = mesh.vertices[apex.at({t[(k + 1) % 3], t[k]})];
            const double a[3] = {p.x - o.x, p.y - o.y, p.z - o.z}, b[3] = {q.x - o.x, q.y - o.y, q.z - o.z},
                         c[3] = {r.x - o.x, r.y - o.y, r.z - o.z};
            const double height = (a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1]
                                  + (a[0] * b[1] - a[1] * b[0]) * c[2];
            if (height > 1e-10) return true;
        }
    return false;
}

void expect_good(const char* kind, std::uint32_t triangles) {
    const Model model = scene_model(kind, triangles);
    SCOPED_TRACE(model.mesh.name);
    EXPECT_EQ(model.mesh.triangles.size(), triangles);
    EXPECT_FALSE(model.stand_in);
    EXPECT_NE(model.source.find(std::to_string(triangles) + " triangles"), std::string::npos);
    const PreparedMesh prepared = prepare_mesh(model.mesh, {.repair = Repair::as_is});
    const MeshReport& report = prepared.report;
    EXPECT_EQ(report.triangles, triangles);
    EXPECT_EQ(report.vertices, model.mesh.vertices.size()) << "two vertices in one place";
    EXPECT_TRUE(sound(report)) << to_text(report);
    EXPECT_GT(report.volume, 0);
    const double extent = std::max({report.box_max.x - report.box_min.x, report.box_max.y - report.box_min.y,
                                    report.box_max.z - report.box_min.z});
    EXPECT_NEAR(extent, 1, 1e-6);
    const Vec3 centre = mass_of(prepared.vertices, prepared.triangles).centre;
    EXPECT_NEAR(std::max({std::fabs(centre.x), std::fabs(centre.y), std::fabs(centre.z)}), 0, 1e-7);
    EXPECT_TRUE(triangles < 60 || concave(model.mesh));
}

struct Kind {
    const char* name;
    std::uint32_t least;
    std::uint64_t hash_902;
};
constexpr Kind kinds[] = {{"sphere", 8, 0xbbbad71726cace4b}, {"torus", 18, 0x95f03ac60333de60},
                          {"gear", 48, 0xc3d962c6ff80ec13},  {"knot", 60, 0x1b3d0333ebf8308a},
                          {"star", 400, 0x26fe6993e586806f}, {"hare", 400, 0x5faad23748663ffd}};

} // namespace

TEST(Procedural, EveryEvenCountFromTheLeast) {
    for (const Kind& kind : kinds)
        for (std::uint32_t triangles = kind.least; triangles <= std::max(320u, kind.least + 100); triangles += 2)
            expect_good(kind.name, triangles);
}

TEST(Procedural, CountsOfThePaperAndLargeOnes) {
    for (const Kind& kind : kinds)
        for (const std::uint32_t triangles : {902u, 1000u, 2130u, 2166u, 3456u, 3458u, 20'000u})
            expect_good(kind.name, triangles);
    expect_good("knot", 200'000);
}

/// Of vertices and triangles, little-endian.
std::uint64_t hash_of_mesh(const Mesh& mesh) {
    std::string bytes;
    for (const Vec3& v : mesh.vertices) bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
    for (const auto& t : mesh.triangles) bytes.append(reinterpret_cast<const char*>(&t), sizeof t);
    return XXH64(bytes.data(), bytes.size(), 0);
}

/// The same bits from every compiler and at every optimisation: what the scenes' own hashes rest on.
TEST(Procedural, GoldenHashes) {
    for (const Kind& kind : kinds) {
        const std::uint64_t hash = hash_of_mesh(scene_model(kind.name, 902).mesh);
        EXPECT_EQ(hash, hash_of_mesh(scene_model(kind.name, 902).mesh));
        EXPECT_EQ(hash, kind.hash_902) << kind.name << " is now 0x" << std::hex << hash;
    }
}

TEST(Procedural, CountsThatCannotBe) {
    for (const Kind& kind : kinds) {
        EXPECT_THROW(scene_model(kind.name, 903), InputError);
        EXPECT_THROW(scene_model(kind.name, kind.least - 2), InputError);
        EXPECT_THROW(scene_model(kind.name, 0), InputError);
        EXPECT_THROW(scene_model(kind.name, 4'000'000'000u), InputError);
    }
    EXPECT_THROW(scene_model("teapot", 902), InputError);
}
