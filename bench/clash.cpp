// SPDX-License-Identifier: Apache-2.0
// What `raycontact clash` takes: parts of four shapes on a grid, near enough that neighbours reach into each other, all
// of different meshes (each a little longer than the last) or placed over and over. Seconds.
#include "bench/commands.h"
#include "bench/options.h"

#include <clash/search.h>
#include <scenes/models/model.h>
#include <scenes/peers/clock.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

namespace raycontact::bench {

namespace {

constexpr const char* kinds[] = {"knot", "gear", "torus", "sphere"};

std::vector<clash::Part> assembly(std::size_t count, std::uint32_t triangles, bool different) {
    std::vector<std::shared_ptr<const Mesh>> models;
    for (const char* kind : kinds)
        models.push_back(std::make_shared<const Mesh>(scenes::scene_model(kind, triangles).mesh));
    const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(double(count))));
    std::vector<clash::Part> parts(count);
    for (std::size_t i = 0; i < count; ++i) {
        parts[i].name = "part " + std::to_string(i);
        parts[i].mesh = models[i % models.size()];
        if (different) {
            auto own = std::make_shared<Mesh>(*parts[i].mesh);
            for (Vec3& v : own->vertices) v.x *= 1 + 1e-4 * double(i);
            parts[i].mesh = std::move(own);
        }
        constexpr double spacing = 0.93; // metres; the shapes are about one across
        const std::size_t column = i % side, row = i / side % side, layer = i / side / side;
        parts[i].pose.translation = {spacing * double(column), spacing * double(row), spacing * double(layer)};
    }
    return parts;
}

void measure(std::size_t count, std::uint32_t triangles, bool different) {
    std::vector<clash::Part> parts = assembly(count, triangles, different);
    const double begin = peers::now().wall;
    const auto pairs = clash::touching_boxes(parts);
    clash::make_shapes(
        parts, pairs, 0, [](std::size_t, std::size_t) {}, [] { return false; });
    const double made = peers::now().wall;
    const auto clashes = clash::find_clashes(parts, pairs, {});
    const double end = peers::now().wall;
    std::printf(
        "%-10s %6zu parts of %u triangles: %zu pairs, %zu clashes; shapes %.2f s, clashes %.2f s, together %.2f s\n",
        different ? "different" : "the same", count, triangles, pairs.size(), clashes.size(), 1e-6 * (made - begin),
        1e-6 * (end - made), 1e-6 * (end - begin));
    std::fflush(stdout);
}

} // namespace

void add_clash(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("clash", "What a clash search takes: parts that are all different, or placed over and over");
    struct Size {
        std::uint32_t parts = 1000, triangles = 10000;
    };
    auto size = std::make_shared<Size>();
    add_number(*command, "--parts", size->parts, "of the assembly", 1u, 10'000'000u);
    add_number(*command, "--triangles", size->triangles, "of each part", 1u, 10'000'000u);
    command->callback([size] {
        for (const bool different : {false, true}) measure(size->parts, size->triangles, different);
    });
}

} // namespace raycontact::bench
