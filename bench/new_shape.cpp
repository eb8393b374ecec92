// SPDX-License-Identifier: Apache-2.0
// What it takes to begin with a new mesh: Bullet's own btBvhTriangleMeshShape, a raycontact::Shape, how much longer
// than the next the dispatch takes that meets it, in a world that runs and in one that begins with it, one query of two
// copies, the same with their files read, and what is made beside later steps.
// Milliseconds, medians, by turns.
// With --saving: what a shape takes to be made, prepared, saved and loaded.
// With --floor or --sheet: a static mesh of about N triangles that has been in a running world for a while meets its
// first body: how long that step takes, with --ahead after add_body(), and the memory.
#include "bench/commands.h"
#include "bench/options.h"

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/bullet/mesh_shape.h>
#include <raycontact/collide.h>
#include <scenes/models/model.h>
#include <scenes/peers/clock.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace raycontact::bench {

namespace {

template <class Work>
double milliseconds_of(Work&& work) {
    const double begin = peers::now().wall;
    work();
    return 1e-3 * (peers::now().wall - begin);
}

/// A mesh as Bullet takes it.
struct BulletMesh {
    std::vector<float> vertices;
    std::vector<int> indices;
    btTriangleIndexVertexArray array;

    explicit BulletMesh(const Mesh& mesh) {
        for (const Vec3& v : mesh.vertices)
            for (const double c : {v.x, v.y, v.z}) vertices.push_back(static_cast<float>(c));
        for (const auto& triangle : mesh.triangles)
            for (const std::uint32_t corner : triangle) indices.push_back(static_cast<int>(corner));
        btIndexedMesh part;
        part.m_numTriangles = static_cast<int>(mesh.triangles.size());
        part.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(indices.data());
        part.m_triangleIndexStride = 3 * sizeof(int);
        part.m_numVertices = static_cast<int>(mesh.vertices.size());
        part.m_vertexBase = reinterpret_cast<const unsigned char*>(vertices.data());
        part.m_vertexStride = 3 * sizeof(float);
        part.m_vertexType = PHY_FLOAT;
        array.addIndexedMesh(part, PHY_INTEGER);
    }
};

/// A world of Bullet's and pairs of one of its own mesh shapes, two objects a little in each other.
class World {
public:
    /// Adds a pair, far from the others.
    void add(btBvhTriangleMeshShape& shape, double size) {
        const std::size_t pairs = m_objects.size() / 2;
        for (int i = 0; i < 2; ++i) {
            btCollisionObject& object = *m_objects.emplace_back(std::make_unique<btCollisionObject>());
            object.setCollisionShape(&shape);
            object.setCollisionFlags(0);
            object.getWorldTransform().setOrigin(
                btVector3(btScalar(0.8 * size * i), btScalar(10 * size) * btScalar(pairs), 0));
            m_world.addCollisionObject(&object);
        }
    }
    ~World() {
        for (const auto& object : m_objects) m_world.removeCollisionObject(object.get());
    }
    World() = default;
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    void prepare() { m_dispatcher.prepare(); }

    double dispatch() {
        const double time = milliseconds_of([&] { m_world.performDiscreteCollisionDetection(); });
        if (2 * m_dispatcher.stats().mesh_pairs != m_objects.size())
            throw std::runtime_error("the two meshes were not tested");
        return time;
    }

private:
    btDefaultCollisionConfiguration m_configuration;
    bullet::CollisionDispatcher m_dispatcher{&m_configuration};
    btDbvtBroadphase m_broadphase;
    btCollisionWorld m_world{&m_dispatcher, &m_broadphase, &m_configuration};
    std::vector<std::unique_ptr<btCollisionObject>> m_objects;
};

/// How much longer the dispatch takes that meets a new shape, and makes it, than the next. `old`: a shape that the
/// world has been with for some steps, or null for a world that begins with the new one.
double wait_for(btBvhTriangleMeshShape& shape, btBvhTriangleMeshShape* old, double size) {
    World world;
    if (old) {
        world.add(*old, 1);
        world.dispatch();
        world.prepare(); // or its accelerators are made beside the dispatch that is timed
        for (int i = 0; i < 3; ++i) world.dispatch();
    }
    world.add(shape, size);
    const double first = world.dispatch();
    return first - world.dispatch();
}

void write_obj(const Mesh& mesh, const std::filesystem::path& file) {
    std::ofstream out(file);
    out.precision(9);
    for (const Vec3& v : mesh.vertices) out << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
    for (const auto& [a, b, c] : mesh.triangles) out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
    if (!out.flush()) throw std::runtime_error(file.string() + " cannot be written");
}

void measure(std::uint32_t triangles, int rounds) {
    const Mesh mesh = scenes::scene_model("sphere", triangles).mesh;
    BulletMesh bullet(mesh), other(scenes::scene_model("torus", 200).mesh);
    btBvhTriangleMeshShape old(&other.array, true);
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("raycontact-bench-" + std::to_string(triangles) + ".obj");
    write_obj(mesh, file);
    std::vector<double> own, make, wait, begin, prepare, query, read;
    for (int i = 0; i < rounds; ++i) {
        std::unique_ptr<btBvhTriangleMeshShape> shape;
        own.push_back(milliseconds_of([&] { shape = std::make_unique<btBvhTriangleMeshShape>(&bullet.array, true); }));
        std::shared_ptr<const Shape> made;
        make.push_back(milliseconds_of([&] { made = Shape::make(mesh); }));
        const double size = made->box_max().x - made->box_min().x;
        begin.push_back(wait_for(*shape, nullptr, size));
        wait.push_back(wait_for(*shape, &old, size));
        const auto ask = [&](const Mesh& one, const Mesh& two) {
            const auto a = Shape::make(one), b = Shape::make(two);
            if (collide(*a, {}, *b, {.translation = {0.8 * size, 0, 0}}, {.threads = 0}).empty())
                throw std::runtime_error("the two meshes have no contact");
        };
        query.push_back(milliseconds_of([&] { ask(mesh, mesh); }));
        read.push_back(milliseconds_of([&] { ask(load_mesh(file), load_mesh(file)); }));
        prepare.push_back(milliseconds_of([&] { made->prepare(); }));
    }
    std::filesystem::remove(file);
    std::printf("%9zu  %10.2f  %10.2f %5.2f  %9.2f %5.2f  %9.2f %5.2f  %10.2f  %10.2f  %10.2f\n", mesh.triangles.size(),
                median(own), median(make), median(make) / median(own), median(wait), median(wait) / median(own),
                median(begin), median(begin) / median(own), median(query), median(read), median(prepare));
    std::fflush(stdout);
}

/// Bytes that the system has given this process, now and at most; 0 where it does not tell.
double resident(const char* which) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
        if (double kilobytes = 0; word == which && status >> kilobytes) return 1024 * kilobytes;
    return 0;
}
void forget_peak() {
    std::ofstream("/proc/self/clear_refs") << 5;
}

/// A square of hills, open, of about so many triangles.
Mesh sheet(std::uint32_t triangles) {
    Mesh mesh;
    const auto side = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0));
    for (std::uint32_t i = 0; i <= side; ++i)
        for (std::uint32_t j = 0; j <= side; ++j)
            mesh.vertices.push_back(
                {20.0 * i / side - 10, 20.0 * j / side - 10, 0.1 * std::sin(0.05 * i) * std::sin(0.05 * j)});
    for (std::uint32_t i = 0; i < side; ++i)
        for (std::uint32_t j = 0; j < side; ++j) {
            const std::uint32_t a = i * (side + 1) + j, b = a + side + 1;
            mesh.triangles.push_back({a, b, a + 1});
            mesh.triangles.push_back({a + 1, b, b + 1});
        }
    return mesh;
}

/// A small ball of triangles falls on the middle of a static mesh of Bullet's.
void measure_floor(const Mesh& given, bool ahead) {
    BulletMesh mesh(given);
    const auto size = double(given.triangles.size());
    double before = resident("VmRSS:");
    btBvhTriangleMeshShape floor_shape(&mesh.array, true);
    std::printf("%.0f triangles; of Bullet's own tree: %.0f bytes a triangle kept\n", size,
                (resident("VmRSS:") - before) / size);
    double high = 0;
    for (const Vec3& v : given.vertices) high = std::max(high, v.z);

    btDefaultCollisionConfiguration configuration;
    bullet::CollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    btRigidBody floor(0, nullptr, &floor_shape);
    bullet::MeshShape small(Shape::make(scenes::scene_model("sphere", 200).mesh));
    btRigidBody body(1, nullptr, &small, btVector3(1, 1, 1));
    before = resident("VmRSS:");
    forget_peak();
    world.addRigidBody(&floor);
    if (ahead) std::printf("add_body()  %8.1f ms\n", milliseconds_of([&] { dispatcher.add_body(floor); }));
    for (int i = 0; i < 60; ++i) world.stepSimulation(btScalar(1.0 / 60), 0);
    body.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, btScalar(high))));
    world.addRigidBody(&body);
    for (int i = 0; i < 3; ++i) {
        const double time = milliseconds_of([&] { world.stepSimulation(btScalar(1.0 / 60), 0); });
        std::printf("step %d      %8.1f ms, %llu shapes made, %llu contacts\n", i, time,
                    static_cast<unsigned long long>(dispatcher.stats().shapes_made),
                    static_cast<unsigned long long>(dispatcher.stats().contacts));
        if (i == 0)
            std::printf("            %.0f bytes a triangle at most, %.0f kept\n", (resident("VmHWM:") - before) / size,
                        (resident("VmRSS:") - before) / size);
    }
    if (ahead) dispatcher.remove_body(floor);
    world.removeRigidBody(&body);
    world.removeRigidBody(&floor);
}

void measure_all(int rounds) {
    std::printf("triangles  Bullet BVH  Shape::make       a world waits    a new one waits  two, a query  files read  "
                "prepare()  "
                "(ms)\n");
    for (const std::uint32_t triangles : {200u, 902u, 4000u, 20000u, 82000u, 327680u}) measure(triangles, rounds);
}

/// What preparing takes, one thread: as it was before parts were united, of a closed mesh, and with a hole for each
/// hundred triangles.
void measure_preparing(int rounds) {
    std::printf("triangles   closed, not united, topology   closed   open, holes left   open, holes spanned   (ms)\n");
    for (const std::uint32_t triangles : {10'000u, 250'000u}) {
        const Mesh closed = scenes::scene_model("knot", triangles).mesh;
        Mesh open = closed;
        open.triangles.clear();
        for (std::size_t t = 0; t < closed.triangles.size(); ++t)
            if (t % 100 != 50) open.triangles.push_back(closed.triangles[t]);
        const auto ms = [&](const Mesh& mesh, const PrepareOptions& options) {
            std::vector<double> times;
            for (int round = 0; round < rounds; ++round) {
                const double begin = peers::now().cpu;
                static_cast<void>(prepare_mesh(mesh, options));
                times.push_back(1e-3 * (peers::now().cpu - begin));
            }
            return peers::median(times);
        };
        std::printf("%9zu %30.1f %8.1f %18.1f %21.1f\n", closed.triangles.size(),
                    ms(closed, {.overlaps = Overlaps::leave, .check = Check::topology, .threads = 1}),
                    ms(closed, {.threads = 1}), ms(open, {.holes = Holes::none, .threads = 1}),
                    ms(open, {.threads = 1}));
    }
}

/// A prepared shape that was saved, beside one that is made of its mesh.
void measure_saving(int rounds) {
    std::printf("triangles  Shape::make   save()   load()      bytes  prepare()   save()   load()      bytes   (ms)\n");
    for (const char* kind : {"sphere", "knot"})
        for (const std::uint32_t triangles : {20'000u, 300'000u}) {
            const Mesh mesh = scenes::scene_model(kind, triangles).mesh;
            std::vector<double> make, prepare, save, load, save_all, load_all;
            std::vector<std::byte> plain, bytes;
            for (int i = 0; i < rounds; ++i) {
                std::shared_ptr<const Shape> shape;
                make.push_back(milliseconds_of([&] { shape = Shape::make(mesh); }));
                save.push_back(milliseconds_of([&] { plain = shape->save(); }));
                load.push_back(milliseconds_of([&] { Shape::load(plain); }));
                prepare.push_back(milliseconds_of([&] { shape->prepare(); }));
                save_all.push_back(milliseconds_of([&] { bytes = shape->save(); }));
                load_all.push_back(milliseconds_of([&] { Shape::load(bytes); }));
            }
            std::printf("%9zu  %11.1f %8.1f %8.1f %10zu %10.1f %8.1f %8.1f %10zu   %s\n", mesh.triangles.size(),
                        median(make), median(save), median(load), plain.size(), median(prepare), median(save_all),
                        median(load_all), bytes.size(), kind);
            std::fflush(stdout);
        }
}

} // namespace

void add_new_shape(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "new-shape", "What it takes to begin with a new mesh: Bullet's tree, a shape, the first dispatch, a query");
    struct Options {
        int rounds = 5;
        std::optional<std::uint32_t> floor, sheet;
        bool ahead = false, preparing = false, saving = false;
    };
    auto o = std::make_shared<Options>();
    add_number(*command, "--rounds", o->rounds, "by turns; figures are medians", 1, 1000);
    CLI::Option* floor =
        add_number(*command, "--floor", o->floor, "instead, a static ball of about N triangles meets its first body",
                   1u, 10'000'000u);
    add_number(*command, "--sheet", o->sheet, "the same for open ground", 1u, 10'000'000u)->excludes(floor);
    command->add_flag("--preparing", o->preparing, "instead, prepare_mesh() of closed meshes and of some with holes")
        ->excludes(floor);
    command->add_flag("--saving", o->saving, "instead, what a shape takes to be made, prepared, saved and loaded")
        ->excludes(floor);
    command->add_flag("--ahead", o->ahead, "with --floor or --sheet: after add_body()");
    command->callback([o] {
        if (o->saving)
            measure_saving(o->rounds);
        else if (o->preparing)
            measure_preparing(o->rounds);
        else if (o->sheet)
            measure_floor(sheet(*o->sheet), o->ahead);
        else if (o->floor)
            measure_floor(scenes::scene_model("sphere", *o->floor).mesh, o->ahead);
        else
            measure_all(o->rounds);
    });
}

} // namespace raycontact::bench
