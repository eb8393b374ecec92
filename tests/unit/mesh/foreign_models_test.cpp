// SPDX-License-Identifier: Apache-2.0
// Files of other programs: the hundred of Debian's assimp-testmodels that have one of our endings. Which of them load,
// why the others are refused, and that Assimp finds the same surface in those that load.
#include "mesh/vector.h"
#include "refused_files.h"

#include <raycontact/mesh.h>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace raycontact {
namespace {

const fs::path folder = "/usr/share/assimp/models";

/// Why a file is refused: part of the message.
const RefusedFiles refused = {
    {"OBJ/number_formats.obj", "line 11: coordinate '3.1+e2' is not a number"},
    {"OBJ/point_cloud.obj", "has no triangles"},
    {"OBJ/testline.obj", "has no triangles"},
    {"OBJ/testpoints.obj", "has no triangles"},
    {"OFF/invalid.off", "line 6: a face needs at least 3 vertices"},
    {"PLY/issue623.ply", "line 14: number '7.941797' is not a whole number"}, // its header has lost a line
    {"PLY/points.ply", "has no triangles"},
    {"PLY/pond.0.ply", "announces 70051 records, more than the file holds"}, // 69 bytes are missing
    {"glTF/BoxTextured-glTF-Binary/BoxTextured.glb", "glTF 1.0"},
    {"glTF/BoxTextured-glTF-Embedded/BoxTextured.gltf", "glTF 1.0"},
    {"glTF/BoxTextured-glTF-MaterialsCommon/BoxTextured.gltf", "glTF 1.0"},
    {"glTF/BoxTextured-glTF/BoxTextured.gltf", "glTF 1.0"},
    {"glTF/CesiumMilkTruck/CesiumMilkTruck.gltf", "glTF 1.0"},
    {"glTF/IncorrectVertexArrays/Cube_v1.gltf", "glTF 1.0"},
    {"glTF/TwoBoxes/TwoBoxes.gltf", "glTF 1.0"},
    {"glTF2/BoxTextured-glTF-techniqueWebGL/BoxTextured.gltf", "'KHR_technique_webgl'"},
    {"glTF2/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb", "is not finite"},
    {"glTF2/IncorrectVertexArrays/Cube.gltf", "35 corners, not a multiple of 3"},
    {"glTF2/IndexOutOfRange/AllIndicesOutOfRange.gltf", "vertex index 65535 is not in 0 to 24 - 1"},
    {"glTF2/IndexOutOfRange/IndexOutOfRange.gltf", "vertex index 255 is not in 0 to 24 - 1"},
    {"glTF2/MissingBin/BoxTextured.gltf", "no such file"},
    {"glTF2/RecursiveNodes/RecursiveNodes.gltf", "nodes[0]: is its own ancestor"},
    {"glTF2/SchemaFailures/sceneWrongType.gltf", "no such file"},
    {"glTF2/TestNoRootNode/NoScene.gltf", "scenes[0] does not exist"},
    {"glTF2/TestNoRootNode/SceneWithoutNodes.gltf", "has no triangles"},
    {"glTF2/draco/2CylinderEngine.gltf", "Draco"},
    {"glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_00.gltf", "has no triangles"},
    {"glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_01.gltf", "has no triangles"},
    {"glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_02.gltf", "has no triangles"},
    {"glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_03.gltf", "has no triangles"},
    {"glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_07.gltf", "has no triangles"},
    {"glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_08.gltf", "has no triangles"},
    {"glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_09.gltf", "has no triangles"},
    {"glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_10.gltf", "has no triangles"},
    {"glTF2/wrongTypes/badArray.gltf", "meshes[0].primitives: is no list"},
    {"invalid/OutOfMemory.off", "vertex count 353535235358 does not fit the size of the file"},
    {"invalid/empty.obj", "is empty"},
    {"invalid/empty.off", "is empty"},
    {"invalid/empty.ply", "is empty"},
    {"invalid/malformed.obj", "vertex index 0; OBJ counts from 1"},
    {"invalid/malformed2.obj", "a face needs at least 3 vertices"},
};

/// What Assimp's flattened scenes leave out: how the joints of a skin move its surface.
const std::map<std::string, Vec3> moved_by_joints = {{"glTF2/simple_skin/simple_skin.gltf", {-0.5, 0, 0}}};

std::vector<std::string> files() {
    static const std::set<std::string> endings = {".obj", ".stl", ".ply", ".off", ".glb", ".gltf"};
    std::vector<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        std::string ending = entry.path().extension().string();
        std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
        if (endings.contains(ending)) found.push_back(entry.path().lexically_relative(folder).generic_string());
    }
    std::ranges::sort(found);
    return found;
}

/// What does not depend on how vertices are shared or polygons cut.
struct Surface {
    double area = 0;
    Vec3 low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};

    void add(const Vec3& a, const Vec3& b, const Vec3& c) {
        area += 0.5 * length(cross(b - a, c - a));
        low = least(low, least(a, least(b, c)));
        high = most(high, most(a, most(b, c)));
    }
};

Surface surface_of(const Mesh& mesh) {
    Surface surface;
    for (const auto& [a, b, c] : mesh.triangles) surface.add(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    return surface;
}

/// Without an area where Assimp refuses the file.
Surface surface_by_assimp(const std::string& file) {
    Assimp::Importer importer;
    const aiScene* scene =
        importer.ReadFile((folder / file).string(), aiProcess_Triangulate | aiProcess_PreTransformVertices);
    Surface surface;
    for (unsigned i = 0; scene && i < scene->mNumMeshes; ++i) {
        const aiMesh& mesh = *scene->mMeshes[i];
        const auto at = [&](unsigned v) { return Vec3{mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z}; };
        for (unsigned t = 0; t < mesh.mNumFaces; ++t)
            if (const aiFace& face = mesh.mFaces[t]; face.mNumIndices == 3)
                surface.add(at(face.mIndices[0]), at(face.mIndices[1]), at(face.mIndices[2]));
    }
    return surface;
}

class ForeignModels : public ::testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(folder)) GTEST_SKIP() << "the Debian package assimp-testmodels is not installed";
    }
};

TEST_F(ForeignModels, FiftyNineOfAHundredLoadAndTheOthersAreRefusedForWhatTheyAre) {
    expect_all_load_but(refused, folder, files(), 59);
}

TEST_F(ForeignModels, AssimpFindsTheSameSurface) {
    std::size_t compared = 0;
    for (const std::string& file : files()) {
        if (refused.contains(file)) continue;
        SCOPED_TRACE(file);
        const Surface theirs = surface_by_assimp(file), ours = surface_of(load_mesh(folder / file));
        if (theirs.area == 0) {
            std::printf("[ counts   ] Assimp refuses %s\n", file.c_str());
            continue;
        }
        ++compared;
        const double size = length(ours.high - ours.low);
        EXPECT_NEAR(theirs.area, ours.area, 1e-4 * ours.area); // theirs are floats
        const auto joints = moved_by_joints.find(file);
        const Vec3 moved = joints == moved_by_joints.end() ? Vec3{} : joints->second;
        EXPECT_LT(length(theirs.low + moved - ours.low), 1e-5 * size);
        EXPECT_LT(length(theirs.high + moved - ours.high), 1e-5 * size);
    }
    EXPECT_EQ(compared, 52u);
}

#ifdef RAYCONTACT_3MF
TEST_F(ForeignModels, Assimps3mfIsItsBoxInMillimetres) {
    const Surface theirs = surface_by_assimp("3MF/box.3mf"), ours = surface_of(load_mesh(folder / "3MF/box.3mf"));
    EXPECT_NEAR(theirs.area * 1e-6, ours.area, 1e-9 * ours.area);
    EXPECT_LT(length(0.001 * theirs.high - ours.high), 1e-9);
}
#endif

} // namespace
} // namespace raycontact
