// SPDX-License-Identifier: Apache-2.0
// Prints the bits of every contact of a few scenes, by every method, caster and direction, and records one scene into
// the file named. What it prints and writes must be the same on every system.
#include "reference/meshes.h"

#include <raycontact/contact.h>
#include <raycontact/recorder.h>
#include <raycontact/scene.h>

#include <bit>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

constexpr std::uint32_t steps = 6;

std::vector<std::shared_ptr<const Shape>> make_shapes() {
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const Mesh& mesh : {bumpy_octahedron_mesh(8), frame_mesh(), l_prism_mesh(), tetrahedron_mesh(), bowl_mesh(8)})
        shapes.push_back(Shape::make(mesh));
    return shapes;
}

// Bodies that drift into each other; after each step it calls done(step).
template <typename Done>
void run(Scene& scene, const std::vector<std::shared_ptr<const Shape>>& shapes, Done&& done) {
    Random random(2013);
    std::vector<BodyId> bodies;
    std::vector<Pose> poses;
    for (std::uint32_t i = 0; i < 16; ++i) {
        Pose pose = random.rotation();
        const Vec3 at = random.in_ball();
        pose.translation = {1.3 * at.x, 1.3 * at.y, 1.3 * at.z};
        bodies.push_back(scene.add(shapes[i % shapes.size()], pose));
        poses.push_back(pose);
    }
    for (std::uint32_t step = 0; step < steps; ++step) {
        scene.find_contacts();
        done(step);
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const Vec3 by = random.in_ball();
            Vec3& at = poses[i].translation;
            at = {at.x + 0.02 * by.x, at.y + 0.02 * by.y, at.z + 0.02 * by.z};
            scene.set_pose(bodies[i], poses[i]);
        }
    }
}

void print(const Contact& contact) {
    std::printf("%u %u %016llx %u", contact.body_a.slot, contact.body_b.slot,
                static_cast<unsigned long long>(contact.key()), contact.feature.other_index());
    for (const double number : {contact.point().x, contact.point().y, contact.point().z})
        std::printf(" %016llx", static_cast<unsigned long long>(std::bit_cast<std::uint64_t>(number)));
    for (const float number :
         {contact.normal.x, contact.normal.y, contact.normal.z, contact.depth, contact.ray_length, contact.weight})
        std::printf(" %08x", std::bit_cast<std::uint32_t>(number));
    std::printf("\n");
}

void print_scenes(const std::vector<std::shared_ptr<const Shape>>& shapes) {
    for (const Method method : {Method::standard, Method::certified, Method::iterative, Method::predictive})
        for (const Caster caster : {Caster::bvh, Caster::basic})
            for (const Direction direction : {Direction::reprojected, Direction::ray, Direction::weighted})
                for (const Features features : {Features::vertices, Features::edges})
                    for (const std::uint32_t threads : {1u, 3u}) {
                        Settings settings;
                        settings.method = method;
                        settings.paper.caster = caster;
                        settings.direction = direction;
                        settings.features = features;
                        settings.execution.devices = "cpu";
                        settings.execution.threads = threads;
                        Scene scene(settings);
                        ContactHash hash(direction);
                        std::size_t contacts = 0;
                        run(scene, shapes, [&](std::uint32_t step) {
                            hash.add(step, scene.contacts());
                            contacts += scene.contacts().size();
                            if (caster == Caster::bvh && threads == 3)
                                for (const Contact& contact : scene.contacts()) print(contact);
                        });
                        std::printf("%s, %s, %s, %s, %u threads: %zu contacts, hash %s\n",
                                    std::string(to_string(method)).c_str(), std::string(to_string(caster)).c_str(),
                                    std::string(to_string(direction)).c_str(), std::string(to_string(features)).c_str(),
                                    threads, contacts, hash.hex().c_str());
                    }
}

// A mesh file with Windows' line ends, under a name that is not ASCII.
void print_mesh_file(const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / u8"K\u00f6rper.obj";
    std::ofstream(path, std::ios::binary) << "v 0 0 1e-400\r\nv 1 0 0\r\nv 0 1 0\r\nv 0 0 1.5\r\n"
                                             "f 1 3 2\r\nf 1 2 4\r\nf 2 3 4\r\nf 3 1 4\r\n";
    const Mesh mesh = load_mesh(path);
    std::printf("mesh file: %zu vertices, %zu triangles\n", mesh.vertices.size(), mesh.triangles.size());
    std::filesystem::remove(path);
}

void record(const std::filesystem::path& file, const std::vector<std::shared_ptr<const Shape>>& shapes) {
    Scene scene;
    RecorderOptions options;
    options.dt = 0.01;
    Recorder recorder(file, scene, options);
    run(scene, shapes, [&](std::uint32_t) { recorder.record(); });
    recorder.finish();
    std::printf("recording: %u steps, hash %s\n", recorder.steps(), recorder.hash().c_str());
}

} // namespace

int main(int count, char** arguments) {
    if (count != 2) return 2;
    const std::filesystem::path file = arguments[1];
    try {
        const auto shapes = make_shapes();
        print_scenes(shapes);
        print_mesh_file(file.parent_path());
        record(file, shapes);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
