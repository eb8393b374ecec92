// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include "cli/out_option.h"

#include <clash/coloured.h>
#include <output/out_folder.h>
#include <scenes/models/machined.h>
#include <scenes/models/model.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace raycontact;

std::string obj(const Mesh& mesh) {
    std::string text = "# " + mesh.name + ", metres, z up\n";
    for (const Vec3& v : mesh.vertices) text += fmt::format("v {} {} {}\n", float(v.x), float(v.y), float(v.z));
    for (const auto& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    return text;
}

/// Binary; the normals are left to the reader, as the format allows.
std::string stl(const Mesh& mesh) {
    static_assert(std::endian::native == std::endian::little, "STL is little-endian");
    const auto append = [](std::string& to, const auto& value) {
        to.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    std::string bytes = mesh.name;
    bytes.resize(80, ' ');
    append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
        std::array<float, 12> facet{};
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vec3& v = mesh.vertices[t[corner]];
            facet[3 + 3 * corner] = float(v.x);
            facet[4 + 3 * corner] = float(v.y);
            facet[5 + 3 * corner] = float(v.z);
        }
        append(bytes, facet);
        append(bytes, std::uint16_t{0});
    }
    return bytes;
}

// M12 with a coarse thread of 3 mm, 40 mm long with its head.
const scenes::Thread thread{
    .outer = 0.006, .pitch = 0.003, .length = 0.0364, .nut = 0.009, .across = 0.018, .around = 24};

/// Five turns up the bolt's thread.
Mesh nut_in_place() {
    Mesh nut = scenes::threaded_nut(thread);
    for (Vec3& v : nut.vertices) v.z += 5 * thread.pitch;
    return nut;
}

/// A bolt with two nuts, of which the second is 0.75 mm in the first.
std::string assembly() {
    std::vector<AssemblyPart> parts(3);
    const auto nut = std::make_shared<const Mesh>(nut_in_place());
    parts[0].name = "bolt";
    parts[0].mesh = std::make_shared<const Mesh>(scenes::threaded_bolt(thread));
    parts[1].name = "nut";
    parts[1].mesh = nut;
    parts[2].name = "lock nut";
    parts[2].mesh = nut;
    constexpr double up = 0.00825;
    const double turn = up / thread.pitch; // along its thread: as many turns as pitches
    const double half = 3.14159265358979323846 * turn;
    parts[2].pose = pose_from_quaternion({0, 0, up}, std::cos(half), 0, 0, std::sin(half));
    return clash::coloured_glb(parts, {});
}

struct Sample {
    std::string file, what, bytes;
};

std::vector<Sample> all_samples() {
    const Mesh hare = scenes::stood_up(scenes::scene_model("hare", 2000).mesh);
    const Mesh gear = scenes::scene_model("gear", 1200).mesh;
    const Mesh box = scenes::solid_box({1, 1, 1}), bolt = scenes::threaded_bolt(thread), nut = nut_in_place();
    const auto with_count = [](const std::string& what, const Mesh& mesh) {
        return fmt::format("{}, {} triangles", what, mesh.triangles.size());
    };
    return {{"hare.obj", with_count("a hare, 1 m high", hare), obj(hare)},
            {"gear.stl", with_count("a gear, 1 m wide", gear), stl(gear)},
            {"box.obj", with_count("a box of 1 m", box), obj(box)},
            {"bolt.obj", with_count("a bolt, 40 mm long", bolt), obj(bolt)},
            {"nut.obj", with_count("its nut", nut), obj(nut)},
            {"parts/bolt.stl", "both again", stl(bolt)},
            {"parts/nut.stl", "in place on each other", stl(nut)},
            {"assembly.glb", "the bolt with two nuts that are 0.75 mm in each other", assembly()},
            {"pairs.json", "two poses of hare and gear, for collide --pairs",
             R"([{"a": "hare.obj", "b": "gear.stl",
  "pose_a": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "pose_b": [1,0,0,0.3, 0,1,0,0, 0,0,1,0, 0,0,0,1], "scale_b": 0.5},
 {"a": "hare.obj", "b": "gear.stl", "pose_b": [1,0,0,2, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]
)"}};
}

void write_samples(const std::string& folder, bool json) {
    output::OutFolder out(folder);
    const std::vector<Sample> samples = all_samples();
    for (const Sample& sample : samples) out.write(sample.file, sample.bytes);
    out.keep();
    for (const Sample& sample : samples) {
        const std::string file = out.kept(sample.file).string();
        if (json)
            std::cout << nlohmann::ordered_json{{"file", file}, {"what", sample.what}}.dump(
                -1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
                      << '\n';
        else
            std::cout << file << ": " << sample.what << '\n';
    }
}

} // namespace

void add_samples(CLI::App& app) {
    CLI::App* command = app.add_subcommand("samples", "Write meshes to try the other commands with");
    struct Options {
        std::string out = "samples";
        bool json = false;
    };
    auto options = std::make_shared<Options>();
    add_out(*command, "--out", options->out, "the folder to write them to")->type_name("DIR")->default_str("samples");
    command->add_flag("--json", options->json, "print one JSON object a file and line on stdout");
    command->footer("All of them are closed and made by this program: no licence but its own applies.");
    command->callback([options] { write_samples(options->out, options->json); });
}
