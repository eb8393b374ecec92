// SPDX-License-Identifier: Apache-2.0
// A recording is an ordinary .glb to loaders that know nothing of us, finished or not.
#include "sample.h"

#include <tiny_gltf.h>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

using namespace raycontact;
using namespace raycontact::recording;

namespace {

tinygltf::Model load(const std::filesystem::path& file) {
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error, warning;
    EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, file.string())) << error;
    EXPECT_EQ(error, "");
    EXPECT_EQ(warning, "");
    return model;
}

std::vector<float> floats_of(const tinygltf::Model& model, int accessor_index) {
    const auto& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
    const auto& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
    const auto& data = model.buffers.at(0).data;
    std::vector<float> floats(
        accessor.count
        * static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type))));
    const std::size_t at = view.byteOffset + accessor.byteOffset;
    EXPECT_LE(accessor.byteOffset + floats.size() * 4, view.byteLength);
    if (at + floats.size() * 4 > data.size()) throw std::out_of_range("accessor");
    std::memcpy(floats.data(), data.data() + at, floats.size() * 4);
    return floats;
}

/// Rotates by x, y, z, w.
Vec3 rotated(const float* q, const Vec3& v) {
    const double x = double(q[0]), y = double(q[1]), z = double(q[2]), w = double(q[3]);
    const Vec3 t{2 * (y * v.z - z * v.y), 2 * (z * v.x - x * v.z), 2 * (x * v.y - y * v.x)};
    return {v.x + w * t.x + y * t.z - z * t.y, v.y + w * t.y + z * t.x - x * t.z, v.z + w * t.z + x * t.y - y * t.x};
}

double distance(const Vec3& p, const Vec3& q) {
    return std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z));
}

} // namespace

TEST(Viewer, AnimationHasTheRecordedPoses) {
    const Sample sample = make_sample(31);
    const TemporaryFile file;
    record(sample, file.path(), true);
    const tinygltf::Model model = load(file.path());
    ASSERT_EQ(model.nodes.size(), 1 + sample.bodies.size());
    EXPECT_EQ(model.nodes[0].children.size(), sample.bodies.size());
    ASSERT_EQ(model.animations.size(), 1u);
    const tinygltf::Animation& animation = model.animations[0];
    std::size_t moving = 0, coming_or_going = 0;
    for (const tinygltf::AnimationChannel& channel : animation.channels) {
        const auto& sampler = animation.samplers.at(static_cast<std::size_t>(channel.sampler));
        const auto body = static_cast<std::size_t>(channel.target_node) - 1;
        ASSERT_LT(body, sample.bodies.size());
        EXPECT_NE(body, 0u) << "it does not move";
        const std::vector<float> times = floats_of(model, sampler.input), values = floats_of(model, sampler.output);
        ASSERT_EQ(times.size(), 31u);
        for (std::uint32_t i = 0; i < 31; ++i) {
            EXPECT_FLOAT_EQ(times[i], static_cast<float>(i / 240.0));
            const Pose& pose = sample.poses[i][body];
            const bool alive = sample.bodies[body].alive(i);
            if (channel.target_path == "translation") {
                ASSERT_EQ(values.size(), 3 * 31u);
                if (!alive) continue;
                EXPECT_EQ(values[3 * i], static_cast<float>(pose.translation.x));
                EXPECT_EQ(values[3 * i + 1], static_cast<float>(pose.translation.y));
                EXPECT_EQ(values[3 * i + 2], static_cast<float>(pose.translation.z));
            } else if (channel.target_path == "rotation") {
                ASSERT_EQ(values.size(), 4 * 31u);
                if (!alive) continue;
                const Pose turn{pose.rotation, {}};
                for (const Vec3& v : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
                    EXPECT_LT(distance(rotated(&values[4 * i], v), transform_point(turn, v)), 1e-6);
                if (i == 0 || !sample.bodies[body].alive(i - 1)) continue;
                float along = 0; // neighbours on one half sphere
                for (std::size_t k = 0; k < 4; ++k) along += values[4 * i + k] * values[4 * i - 4 + k];
                EXPECT_GT(along, 0.9f);
            } else {
                ASSERT_EQ(channel.target_path, "scale");
                ASSERT_EQ(values.size(), 3 * 31u);
                EXPECT_EQ(sampler.interpolation, "STEP");
                for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(values[3 * i + k], alive ? 1.f : 0.f);
            }
        }
        moving += channel.target_path == "translation";
        coming_or_going += channel.target_path == "scale";
    }
    EXPECT_EQ(moving, 6u);
    EXPECT_EQ(coming_or_going, 3u);
}

TEST(Viewer, MeshesAreTheShapes) {
    const Sample sample = make_sample(3);
    const TemporaryFile file;
    record(sample, file.path(), true);
    const tinygltf::Model model = load(file.path());
    for (std::uint32_t id = 0; id < sample.bodies.size(); ++id) {
        if (sample.bodies[id].first_step >= 3) continue;
        const Shape& shape = *sample.shapes[sample.bodies[id].shape];
        const auto& mesh = model.meshes.at(static_cast<std::size_t>(model.nodes[id + 1].mesh));
        const auto& primitive = mesh.primitives.at(0);
        const std::vector<float> positions = floats_of(model, primitive.attributes.at("POSITION"));
        ASSERT_EQ(positions.size(), 3 * shape.vertices().size());
        for (std::size_t v = 0; v < shape.vertices().size(); ++v) {
            EXPECT_EQ(positions[3 * v], static_cast<float>(shape.vertices()[v].x));
            EXPECT_EQ(positions[3 * v + 1], static_cast<float>(shape.vertices()[v].y));
            EXPECT_EQ(positions[3 * v + 2], static_cast<float>(shape.vertices()[v].z));
        }
        EXPECT_EQ(model.accessors[static_cast<std::size_t>(primitive.indices)].count, 3 * shape.triangles().size());
    }
}

TEST(Viewer, AnUnfinishedOneIsAStillPicture) {
    const Sample sample = make_sample(11);
    const TemporaryFile file;
    Writer writer(file.path(), sample.info, {4, 1e9, 1u << 20});
    Feeder feeder(sample, writer);
    while (feeder.steps() < 11) {
        feeder.step();
        const tinygltf::Model model = load(file.path());
        EXPECT_EQ(model.animations.size(), 0u);
        ASSERT_EQ(model.nodes.size(), 1u + 5u); // those that are there from the start
        const Vec3& start = sample.poses[0][3].translation;
        EXPECT_EQ(model.nodes[4].translation, (std::vector<double>{start.x, start.y, start.z}));
    }
}

TEST(Viewer, TheAnimationKeepsToItsSize) {
    const Sample sample = make_sample(200);
    const TemporaryFile file;
    record(sample, file.path(), true, {16, 1e9, 8000});
    const tinygltf::Model model = load(file.path());
    const auto& accessor = model.accessors.at(static_cast<std::size_t>(model.animations.at(0).samplers.at(0).input));
    EXPECT_LT(accessor.count, 40u);
    EXPECT_GT(accessor.count, 10u);
    EXPECT_FLOAT_EQ(static_cast<float>(accessor.maxValues.at(0)), static_cast<float>(199 / 240.0));
    Reader reader(file.path());
    EXPECT_EQ(difference(sample, reader, 200), "");
}

TEST(Viewer, AssimpReadsIt) {
    const Sample sample = make_sample(25);
    for (const bool finish : {false, true}) {
        const TemporaryFile file;
        record(sample, file.path(), finish);
        const std::vector<unsigned char> bytes = bytes_of(file.path());
        Assimp::Importer importer;
        const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, "glb");
        ASSERT_NE(scene, nullptr) << importer.GetErrorString();
        EXPECT_GE(scene->mNumMeshes, sample.shapes.size());
        ASSERT_EQ(scene->mNumAnimations, finish ? 1u : 0u);
        if (!finish) continue;
        const aiAnimation& animation = *scene->mAnimations[0];
        ASSERT_EQ(animation.mNumChannels, 6u);
        for (unsigned i = 0; i < animation.mNumChannels; ++i) {
            const aiNodeAnim& channel = *animation.mChannels[i];
            ASSERT_EQ(channel.mNumPositionKeys, 25u);
            ASSERT_EQ(channel.mNumRotationKeys, 25u);
            const std::string name = channel.mNodeName.C_Str();
            const auto body = static_cast<std::size_t>(std::stoi(name.substr(name.find(' ') + 1)));
            if (!sample.bodies[body].alive(10)) continue;
            const auto& value = channel.mPositionKeys[10].mValue;
            EXPECT_EQ(value.x, static_cast<float>(sample.poses[10][body].translation.x));
            EXPECT_EQ(value.y, static_cast<float>(sample.poses[10][body].translation.y));
        }
    }
}
