// SPDX-License-Identifier: Apache-2.0
// What `raycontact clash` takes: parts of four shapes on a grid, near enough that neighbours reach into each other, all
// of different meshes (each a little longer than the last) or placed over and over; and a plant of pipes that cross as
// they come, with all that is nearer than 10 mm. Seconds.
#include "bench/commands.h"
#include "bench/options.h"

#include <raycontact/clash.h>
#include <scenes/models/model.h>
#include <scenes/peers/clock.h>
#include <scenes/random.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>

namespace raycontact::bench {

namespace {

constexpr const char* kinds[] = {"knot", "gear", "torus", "sphere"};

std::vector<AssemblyPart> assembly(std::size_t count, std::uint32_t triangles, bool different) {
    std::vector<std::shared_ptr<const Mesh>> models;
    for (const char* kind : kinds)
        models.push_back(std::make_shared<const Mesh>(scenes::scene_model(kind, triangles).mesh));
    const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(double(count))));
    std::vector<AssemblyPart> parts(count);
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

/// A pipe along z of `around` faces, closed: four rings of corners.
Mesh pipe(double radius, double bore, double length, std::uint32_t around) {
    Mesh mesh;
    const std::array<std::array<double, 2>, 4> rings{
        {{radius, -length / 2}, {radius, length / 2}, {bore, length / 2}, {bore, -length / 2}}};
    for (const auto& [r, z] : rings)
        for (std::uint32_t i = 0; i < around; ++i) {
            const double angle = 2 * std::numbers::pi * i / around;
            mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), z});
        }
    for (std::uint32_t k = 0; k < 4; ++k)
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t next = (i + 1) % around, from = k * around, to = (k + 1) % 4 * around;
            mesh.triangles.push_back({from + i, from + next, to + next});
            mesh.triangles.push_back({from + i, to + next, to + i});
        }
    return mesh;
}

/// Pipes of 300 shapes and 200 triangles each, along the axes or turned, in a flat box in which most cross another one.
std::vector<AssemblyPart> plant(std::size_t count) {
    scenes::Random random(1);
    const auto between = [&](double low, double high) { return low + (high - low) * 0.5 * (random.symmetric() + 1); };
    std::vector<std::shared_ptr<const Mesh>> shapes;
    for (int i = 0; i < 300; ++i) {
        const double radius = between(0.03, 0.25);
        shapes.push_back(std::make_shared<const Mesh>(pipe(radius, radius * between(0.5, 0.9), between(0.3, 4), 25)));
    }
    const double side = 1.857 * std::cbrt(double(count)); // metres: 40 of 10 000 parts
    const double half = std::sqrt(0.5);
    std::vector<AssemblyPart> parts(count);
    for (std::size_t i = 0; i < count; ++i) {
        parts[i].name = "pipe " + std::to_string(i);
        parts[i].mesh = shapes[random.next() % 300];
        const Vec3 at{between(0, side), between(0, side), between(0, side / 4)};
        const std::uint64_t way = random.next() % 10;
        parts[i].pose = way < 4   ? pose_from_quaternion(at, 1, 0, 0, 0)
                        : way < 7 ? pose_from_quaternion(at, half, half, 0, 0)
                        : way < 9 ? pose_from_quaternion(at, half, 0, half, 0)
                                  : pose_from_quaternion(at, 1, between(-1, 1), between(-1, 1), 0.3);
    }
    return parts;
}

void measure(const char* name, const std::vector<AssemblyPart>& parts, double clearance) {
    std::size_t triangles = 0;
    for (const AssemblyPart& part : parts) triangles += part.mesh->triangles.size();
    ClashOptions options;
    options.clearance = clearance;
    const peers::Times begin = peers::now();
    const ClashReport found = find_clashes(parts, options);
    const peers::Times end = peers::now();
    std::printf("%-10s %6zu parts of %zu triangles in all: %zu pairs, %zu clashes in %.2f s, %.2f s of processors\n",
                name, parts.size(), triangles, found.pairs, found.clashes.size(), 1e-6 * (end.wall - begin.wall),
                1e-6 * (end.cpu - begin.cpu));
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
    add_number(*command, "--parts", size->parts, "of the assembly; the plant has ten times as many", 1u, 10'000'000u);
    add_number(*command, "--triangles", size->triangles, "of each part", 1u, 10'000'000u);
    command->callback([size] {
        measure("the same", assembly(size->parts, size->triangles, false), 0);
        measure("different", assembly(size->parts, size->triangles, true), 0);
        measure("plant", plant(10 * std::size_t{size->parts}), 0.01);
    });
}

} // namespace raycontact::bench
