// SPDX-License-Identifier: Apache-2.0
// fuzz_seeds FOLDER: writes a sound input or two for each target whose inputs are not texts. What else the corpora
// hold, fuzzers found, or hands wrote as other programs do.
#include "fuzz/recording_input.h"
#include "tests/recording/sample.h"
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/solids.h"

#include <recording/layout.h>
#include <recording/shape_codec.h>
#include <recording/step_codec.h>

#include <cstdio>
#include <fstream>

using namespace raycontact;

namespace {

std::filesystem::path root;

void write(const std::string& name, const std::string& bytes) {
    const auto file = root / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
}

void append(std::string& input, std::uint8_t type, std::uint32_t first, std::uint32_t count,
            const recording::Bytes& payload) {
    test::put(input, type);
    test::put(input, first);
    test::put(input, count);
    test::put(input, static_cast<std::uint16_t>(payload.size()));
    input.append(payload.begin(), payload.end());
}

/// Two small meshes that touch, a body more that comes and goes, some steps.
std::string blocks(Method method) {
    using namespace raycontact::recording;
    std::string input(1, '\1');
    Info info;
    info.scene = "seed";
    info.bodies = 2;
    info.settings.method = method;
    info.settings.features = Features::vertices;
    append(input, 0, 0, 0, encode_info(info));
    const PreparedMesh mesh = prepare_mesh(test::box());
    append(input, 1, 0, 0, encode_mesh(mesh));
    append(input, 2, 0, 0,
           encode_events(std::array{BodyEvent{0, BodyEvent::comes, 0, 0}, BodyEvent{0, BodyEvent::comes, 1, 0},
                                    BodyEvent{1, BodyEvent::comes, 2, 0}, BodyEvent{2, BodyEvent::goes, 2, 0}}));
    StepEncoder encoder;
    std::vector<Pose> poses(3);
    poses[1].translation = {0.5, 0.25, 0.125};
    poses[2].translation = {0, 0, 0.9};
    encoder.add(std::vector<std::uint32_t>{0, 1}, poses, std::vector<NumberPair>{{0, 1}});
    poses[1].translation.x = 0.75;
    encoder.add(std::vector<std::uint32_t>{0, 1, 2}, poses, std::vector<NumberPair>{{0, 1}, {0, 2}});
    encoder.add(std::vector<std::uint32_t>{0, 1}, poses, std::vector<NumberPair>{});
    append(input, 3, 0, 3, encoder.take());
    append(input, 4, 0, 0, encode_end(3, "0123456789abcdef"));
    return input;
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
        return 2;
    }
    root = argv[1];
    const Mesh mesh = test::box();
    write("obj/sound", test::as_obj(mesh));
    // An L, a square with a bridge to its hole, a corner on a side: polygons that are no fans.
    const std::string places = "v 0 0 0\nv 6 0 0\nv 6 2 0\nv 2 2 0\nv 2 6 0\nv 0 6 0\nv 1 1 1\nv 1 3 0\n";
    write("obj/polygons", places + "f 1 2 3 4 5 6\nf 4 1 2 3 5 6 1 4 8\nf -8 -5 -2 -1 9\nf 1 4 6 2\nv 3 0 0\n");
    std::string wide = "\xff\xfe";
    for (const char c : "# \xe9\n" + places + "f 1 2 3 4 5 6\nf 1 2 7\n") wide += {c, '\0'};
    write("obj/utf16", wide);
    write("off/polygons", "OFF\n6 2 0\n0 0 0\n6 0 0\n6 2 0\n2 2 0\n2 6 0\n0 6 0\n6 0 1 2 3 4 5\n5 0 1 1 3 5 255 0 0\n");
    write("ply/polygons",
          "ply\rcomment faces first\rformat ascii 1.0 { as described }\rmade by hand\relement face 2\r"
          "property list uchar int vertex_index\relement vertex 6\rproperty float x\rproperty float y\r"
          "property float z\rend_header\r6 0 1 2 3 4 5 { an L }\r4 5 3 1 0\r0 0 0\r6 0 0\r6 2 0\r2 2 0\r"
          "2 6 0\r0 6 0\r");
    write("off/sound", test::as_off(mesh));
    write("stl/ascii", test::as_ascii_stl(mesh));
    write("stl/binary", test::as_binary_stl(mesh));
    write("ply/ascii", test::as_ascii_ply(mesh));
    write("ply/little", test::as_binary_ply(mesh, false));
    write("ply/big", test::as_binary_ply(mesh, true));
    write("gltf/binary", test::as_glb(mesh));
    write("gltf/draco", R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"]})");
    write("gltf/version_1", R"({"asset":{"version":"1.0"},"scene":"s","scenes":{"s":{"nodes":[]}},"meshes":{}})");
    // m.bin is the target's: a torus
    write("gltf/with_buffer", test::gltf_json(test::torus(6, 4, 1, 0.3), R"([{"mesh":0,"scale":[1,2,1]}])", "m.bin"));
    write("recording/certified", blocks(Method::certified));
    write("recording/predictive", blocks(Method::predictive));
    const TemporaryFile file;
    record(make_sample(2), file.path(), true);
    const std::vector<unsigned char> bytes = bytes_of(file.path());
    std::string whole(1, '\0');
    whole.append(bytes.begin(), bytes.end());
    write("recording/whole", whole);
}
