// SPDX-License-Identifier: Apache-2.0
#include <scenes/avalanche.h>

#include <scenes/depth_watch.h>
#include <scenes/models/model.h>
#include <scenes/random.h>

#include <raycontact/bullet/mass.h>
#include <raycontact/bullet/mesh_shape.h>
#include <raycontact/error.h>

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace raycontact::scenes {

namespace {

constexpr double dt = 1.0 / 60;
constexpr std::uint32_t last_second = 60; // steps
constexpr double slab_depth = 2;
constexpr std::uint32_t most_bodies = 1u << 20;

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Mesh slab(double half_width) {
    Mesh mesh;
    mesh.name = "ground slab";
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back(
            {i & 1 ? half_width : -half_width, i & 2 ? half_width : -half_width, i & 4 ? 0 : -slab_depth});
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

/// Models stand on y; the scene's up is z.
Mesh stood_up(Mesh mesh) {
    for (Vec3& v : mesh.vertices) v = {v.x, -v.z, v.y};
    return mesh;
}

btTransform start_pose(const Vec3& position, const std::array<double, 4>& tilt) {
    return btTransform(btQuaternion(btScalar(tilt[1]), btScalar(tilt[2]), btScalar(tilt[3]), btScalar(tilt[0])),
                       btVector3(btScalar(position.x), btScalar(position.y), btScalar(position.z)));
}

Pose to_pose(const btTransform& t) {
    Pose pose;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) pose.rotation[3 * i + j] = static_cast<double>(t.getBasis()[i][j]);
    }
    pose.translation = {static_cast<double>(t.getOrigin().x()), static_cast<double>(t.getOrigin().y()),
                        static_cast<double>(t.getOrigin().z())};
    return pose;
}

void check(const AvalancheOptions& o) {
    if (o.bodies < 1 || o.bodies > most_bodies)
        throw InputError("avalanche: " + std::to_string(o.bodies) + " bodies; choose 1 to "
                         + std::to_string(most_bodies));
    if (!(o.density > 0) || !(o.spacing > 0) || !(o.friction >= 0) || o.iterations < 1 || !(o.slop >= 0))
        throw InputError("avalanche: density, spacing and iterations must be positive, friction and slop not negative");
}

} // namespace

struct Avalanche::State {
    explicit State(const AvalancheOptions& o)
        : options(o), dispatcher(&configuration, o.settings, o.manifolds),
          world(&dispatcher, &broadphase, &solver, &configuration), hash(o.settings.direction) {}
    ~State() {
        for (const auto& body : bodies) {
            world.removeRigidBody(body.get());
            dispatcher.remove_body(*body);
        }
    }

    void configure();
    void add_shapes();
    void add_body(bullet::MeshShape& shape, const btTransform& pose, double mass, const btVector3& inertia);
    void keep_frame(std::uint32_t step);
    void measure(StepRow& row);

    AvalancheOptions options;
    btDefaultCollisionConfiguration configuration;
    bullet::CollisionDispatcher dispatcher;
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world;
    std::unique_ptr<bullet::MeshShape> body_shape, ground_shape;
    std::vector<std::unique_ptr<btRigidBody>> bodies; ///< the ground last
    double half_width = 0, top = 0;
    std::uint32_t done = 0;
    ContactHash hash;
    DepthWatch depths{0};
    std::uint64_t contacts = 0, rays = 0, rays_cast = 0, pairs_max = 0;
    double ray_length = 0;
    std::vector<Vec3> before;
    RunLog log;
};

void Avalanche::State::configure() {
    world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    // No sweep of the boxes along the motion: it would only add pairs that rays cannot find contacts in.
    world.getDispatchInfo().m_useContinuous = false;
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_numIterations = options.iterations;
    // Directions fixed by the normal, so that a friction impulse carried over means the same in the next step.
    info.m_solverMode = SOLVER_SIMD | SOLVER_USE_WARMSTARTING | SOLVER_USE_2_FRICTION_DIRECTIONS
                        | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
    info.m_linearSlop = btScalar(options.slop);
    info.m_erp2 = btScalar(options.erp);
    info.m_splitImpulse = 1;
    info.m_splitImpulsePenetrationThreshold = 0;
    // Nobody sleeps, so islands save nothing.
    world.getSimulationIslandManager()->setSplitIslands(false);
}

void Avalanche::State::add_shapes() {
    const Model model = scene_model(options.model, options.triangles);
    const auto shape = Shape::make(stood_up(model.mesh));
    const std::uint32_t side = [&] {
        std::uint32_t n = 1;
        while (static_cast<std::uint64_t>(n) * n * n < options.bodies) ++n;
        return n;
    }();
    half_width = std::max(10.0, 2.5 * options.spacing * side);
    const auto ground = Shape::make(slab(half_width));
    body_shape = std::make_unique<bullet::MeshShape>(shape, options.bounds);
    ground_shape = std::make_unique<bullet::MeshShape>(ground);
    log.shapes = {shape, ground};
    log.mesh_source = model.source;

    // The model's axes, not its principal ones: they have the smaller box, and every ray starts in a box. What Bullet
    // neglects are the products of inertia; the centre of mass is the origin as it must be.
    const double mass = options.density * bullet::mass_properties(*shape).volume;
    btVector3 inertia;
    body_shape->calculateLocalInertia(btScalar(mass), inertia);
    Random random(options.seed);
    const double middle = (side - 1) / 2.0;
    for (std::uint32_t i = 0; i < options.bodies; ++i) {
        const std::uint32_t ix = i % side, iy = (i / side) % side, iz = i / (side * side);
        const double dx = random.symmetric(), dy = random.symmetric();
        const Vec3 position{(ix - middle) * options.spacing + 0.02 * dx, (iy - middle) * options.spacing + 0.02 * dy,
                            0.75 + iz * options.spacing};
        add_body(*body_shape, start_pose(position, random.tilt(0.2)), mass, inertia);
        top = std::max(top, position.z + 1);
    }
    add_body(*ground_shape, btTransform::getIdentity(), 0, btVector3(0, 0, 0));
}

void Avalanche::State::add_body(bullet::MeshShape& shape, const btTransform& pose, double mass,
                                const btVector3& inertia) {
    btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, &shape, inertia);
    info.m_startWorldTransform = pose;
    info.m_friction = btScalar(std::sqrt(options.friction)); // Bullet multiplies the two bodies' coefficients
    info.m_restitution = 0;
    info.m_linearDamping = btScalar(options.linear_damping);
    info.m_angularDamping = btScalar(options.angular_damping);
    auto body = std::make_unique<btRigidBody>(info);
    body->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(body.get());
    dispatcher.add_body(*body);
    log.body_shape.push_back(mass > 0 ? 0 : 1);
    log.body_moves.push_back(mass > 0);
    bodies.push_back(std::move(body));
}

void Avalanche::State::keep_frame(std::uint32_t step) {
    const std::uint32_t steps = std::max(options.expected_steps, 1u), frames = std::max(options.frames, 2u);
    // Evenly over the run, its first and last step included.
    for (std::uint32_t k = 0; k < frames; ++k) {
        if (step != static_cast<std::uint64_t>(steps - 1) * k / (frames - 1)) continue;
        Frame frame;
        frame.step = step;
        for (const auto& body : bodies) frame.poses.push_back(to_pose(body->getWorldTransform()));
        log.frames.push_back(std::move(frame));
        return;
    }
}

void Avalanche::State::measure(StepRow& row) {
    const StepStats& s = dispatcher.scene().stats();
    static_cast<StepStats&>(row) = s;
    const auto found = dispatcher.scene().contacts();
    hash.add(row.step, found);
    depths.add(row.step, found);
    contacts += found.size();
    rays += s.rays;
    rays_cast += s.rays_cast;
    ray_length += s.ray_length;
    pairs_max = std::max(pairs_max, s.pairs);
    for (const Contact& c : found) row.penetration_max = std::max(row.penetration_max, static_cast<double>(c.depth));

    // From positions: what the eye sees, with the corrections that Bullet keeps out of its velocities.
    std::vector<double> speeds;
    for (std::size_t i = 0; i + 1 < bodies.size(); ++i) {
        const Vec3 now = to_pose(bodies[i]->getWorldTransform()).translation;
        const Vec3 d{now.x - before[i].x, now.y - before[i].y, now.z - before[i].z};
        speeds.push_back(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) / dt);
        before[i] = now;
    }
    const auto half = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
    std::nth_element(speeds.begin(), half, speeds.end());
    row.median_speed = *half;
}

Avalanche::Avalanche(const AvalancheOptions& options) {
    check(options);
    state_ = std::make_unique<State>(options);
    State& s = *state_;
    s.configure();
    s.add_shapes();
    s.depths = DepthWatch(0.02); // bodies are 1 m
    s.log.scene = "avalanche";
    s.log.seed = options.seed;
    s.log.dt = dt;
    for (std::size_t i = 0; i + 1 < s.bodies.size(); ++i)
        s.before.push_back(to_pose(s.bodies[i]->getWorldTransform()).translation);
}

Avalanche::~Avalanche() = default;

void Avalanche::step() {
    State& s = *state_;
    StepRow row;
    row.step = s.done;
    const auto start = Clock::now();
    s.world.stepSimulation(btScalar(dt), 0); // 0: exactly this step, no clock of Bullet's own
    row.step_ms = ms_since(start);
    s.measure(row);
    s.log.rows.push_back(row);
    s.keep_frame(s.done);
    ++s.done;
}

std::uint32_t Avalanche::steps() const {
    return state_->done;
}
std::span<const Contact> Avalanche::contacts() const {
    return state_->dispatcher.scene().contacts();
}
const StepStats& Avalanche::stats() const {
    return state_->dispatcher.scene().stats();
}
const Scene& Avalanche::scene() const {
    return state_->dispatcher.scene();
}
const bullet::DispatcherStats& Avalanche::manifold_stats() const {
    return state_->dispatcher.stats();
}
Pose Avalanche::pose(std::uint32_t body) const {
    return to_pose(state_->bodies.at(body)->getWorldTransform());
}
std::uint32_t Avalanche::body_count() const {
    return state_->options.bodies;
}
std::string Avalanche::hash() const {
    return state_->hash.hex();
}
std::uint64_t Avalanche::contacts_total() const {
    return state_->contacts;
}
std::uint64_t Avalanche::rays_total() const {
    return state_->rays;
}

std::uint64_t Avalanche::rays_cast_total() const {
    return state_->rays_cast;
}
double Avalanche::ray_length_total() const {
    return state_->ray_length;
}
std::uint64_t Avalanche::pairs_max() const {
    return state_->pairs_max;
}
const RunLog& Avalanche::log() const {
    return state_->log;
}

AvalancheHealth Avalanche::health() const {
    const State& s = *state_;
    AvalancheHealth h;
    const std::uint32_t late = s.done > last_second ? s.done - last_second : 0;
    for (const StepRow& row : s.log.rows) {
        h.penetration_max = std::max(h.penetration_max, row.penetration_max);
        if (row.step >= late) h.median_speed_last_second = std::max(h.median_speed_last_second, row.median_speed);
    }
    h.depth_limit = s.depths.limit();
    h.deep_contacts = s.depths.contacts();
    h.deep_steps_longest = s.depths.longest();
    h.deep_steps_last_second = s.depths.longest_since(late);
    for (std::uint32_t i = 0; i < s.options.bodies; ++i) {
        const Vec3 p = pose(i).translation;
        if (p.z < 0) ++h.below_ground;
        if (std::fabs(p.x) > s.half_width || std::fabs(p.y) > s.half_width || p.z > s.top) ++h.flown_off;
    }
    return h;
}

} // namespace raycontact::scenes
