// SPDX-License-Identifier: Apache-2.0
// Meshes that never were files: the bytes of one, or arrays.
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/solids.h"

#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <gtest/gtest.h>

#include <limits>

using namespace raycontact;
using namespace raycontact::test;

namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

std::string base64(const std::string& bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

template <class Load>
std::string error_of(Load&& load) {
    try {
        load();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

struct Sample {
    MeshFormat format;
    const char* ending;
    std::string bytes;
};

std::vector<Sample> samples() {
    const Mesh mesh = torus(7, 5, 1.1, 0.3);
    const std::string embedded =
        gltf_json(mesh, R"([{"mesh":0}])", "data:application/octet-stream;base64," + base64(gltf_buffer(mesh)));
    return {{MeshFormat::obj, ".obj", as_obj(mesh)},        {MeshFormat::stl, ".stl", as_ascii_stl(mesh)},
            {MeshFormat::stl, ".stl", as_binary_stl(mesh)}, {MeshFormat::ply, ".ply", as_ascii_ply(mesh)},
            {MeshFormat::ply, ".ply", as_binary_ply(mesh)}, {MeshFormat::off, ".off", as_off(mesh)},
            {MeshFormat::gltf, ".gltf", embedded},          {MeshFormat::glb, ".glb", as_glb(mesh)}};
}

TEST(FromMemory, IsWhatTheFileIs) {
    const TempFolder folder;
    for (const Sample& sample : samples()) {
        const auto path = folder.write(std::string("m") + sample.ending, sample.bytes);
        const Mesh expected = load_mesh(path), mesh = load_mesh(bytes_of(sample.bytes), sample.format, "m.x");
        EXPECT_EQ(mesh.vertices, expected.vertices) << sample.ending;
        EXPECT_EQ(mesh.triangles, expected.triangles) << sample.ending;
        EXPECT_EQ(mesh.name, "m.x");
        EXPECT_FALSE(mesh.triangles.empty());
    }
}

TEST(FromMemory, ErrorsAreThoseOfTheFile) {
    const TempFolder folder;
    for (const Sample& sample : samples()) {
        for (const std::size_t kept : {std::size_t{1}, sample.bytes.size() / 2, sample.bytes.size() - 3}) {
            const std::string damaged = sample.bytes.substr(0, kept);
            const auto path = folder.write(std::string("m") + sample.ending, damaged);
            const std::string expected = error_of([&] { return load_mesh(path); });
            const std::string found =
                error_of([&] { return load_mesh(bytes_of(damaged), sample.format, path.string()); });
            EXPECT_EQ(found, expected) << sample.ending;
        }
    }
    EXPECT_EQ(error_of([] { return load_mesh({}, MeshFormat::obj, "part"); }),
              "part: is empty; give the bytes of a whole file");
    EXPECT_EQ(error_of([] { return load_mesh(bytes_of("x"), static_cast<MeshFormat>(99)); }),
              "mesh: unknown format; take one of MeshFormat");
}

TEST(FromMemory, BuffersBesideTheFileAreNotThere) {
    const std::string json = gltf_json(box(), R"([{"mesh":0}])", "m.bin");
    const std::string error = error_of([&] { return load_mesh(bytes_of(json), MeshFormat::gltf, "part"); });
    EXPECT_TRUE(error.starts_with("part: buffers[0].uri: names the file 'm.bin', and bytes in memory have none beside "
                                  "them"))
        << error;
}

TEST(FromArrays, FloatAndDouble) {
    const std::vector<double> doubles{0, 0, 0, 0.1, 0, 0, 0, 0.7, 0};
    const std::vector<float> floats(doubles.begin(), doubles.end());
    const std::vector<std::uint32_t> corners{0, 1, 2};
    const Mesh exact = make_mesh(doubles, corners, "arrays"), rounded = make_mesh(floats, corners);
    EXPECT_EQ(exact.name, "arrays");
    EXPECT_EQ(exact.vertices[1].x, 0.1);
    EXPECT_EQ(rounded.vertices[1].x, double(0.1f));
    EXPECT_EQ(exact.triangles, rounded.triangles);
    EXPECT_EQ(exact.triangles.size(), 1u);
}

TEST(FromArrays, BadOnesAreRefused) {
    const std::vector<double> points{0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::vector<std::uint32_t> one{0, 1, 2};
    const auto refused = [](std::vector<double> coordinates, std::vector<std::uint32_t> corners) {
        return error_of([&] { return make_mesh(coordinates, corners, "arrays"); });
    };
    EXPECT_EQ(refused({0, 0, 0, 1}, one), "arrays: 4 coordinates, not a multiple of 3; give three of each");
    EXPECT_EQ(refused(points, {0, 1}), "arrays: 2 corners, not a multiple of 3; give three of each");
    EXPECT_EQ(refused(points, {}), "arrays: has no triangles; export a triangle mesh");
    EXPECT_EQ(refused(points, {0, 1, 3}), "arrays: triangle 0: vertex index 3 is not in 0 to 3 - 1");
    EXPECT_EQ(refused({0, 0, 0, 1, 0, 0, 0, std::numeric_limits<double>::infinity(), 0}, one),
              "arrays: vertex 2 (counted from 0) is not finite");
}

} // namespace
