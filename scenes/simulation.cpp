// SPDX-License-Identifier: Apache-2.0
#include <scenes/simulation.h>

#include <scenes/run_watch.h>

#include <raycontact/bullet/mass.h>
#include <raycontact/bullet/mesh_shape.h>
#include <raycontact/bullet/recommend.h>
#include <raycontact/error.h>

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

namespace raycontact::scenes {

namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
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

void check(const SceneDescription& d) {
    const auto require = [&](bool fine, const char* what) {
        if (!fine) throw InputError(d.name + ": " + what);
    };
    const Response& r = d.response;
    const auto not_negative = [](double value) { return std::isfinite(value) && value >= 0; };
    const auto share = [](double value) { return value >= 0 && value <= 1; };
    require(std::isfinite(d.dt) && d.dt > 0, "dt must be a positive number of seconds");
    require(std::isfinite(d.gravity.x) && std::isfinite(d.gravity.y) && std::isfinite(d.gravity.z),
            "gravity must be finite");
    require(not_negative(r.friction), "friction must not be negative");
    require(r.iterations >= 1, "iterations must be at least 1");
    require(not_negative(r.slop.value_or(0)), "slop must not be negative");
    require(share(r.erp), "erp must be from 0 to 1");
    require(share(r.linear_damping) && share(r.angular_damping), "damping must be from 0 to 1");
    require(not_negative(d.depth_limit), "the depth limit must not be negative");
    require(!d.bodies.empty(), "there are no bodies; give at least one");
    require(std::all_of(d.bodies.begin(), d.bodies.end(),
                        [&](const BodyStart& body) { return body.shape < d.shapes.size(); }),
            "a body has a shape that the scene lacks");
    require(std::all_of(d.bodies.begin(), d.bodies.end(),
                        [&](const BodyStart& body) { return not_negative(body.density); }),
            "density must not be negative");
    require(std::is_sorted(d.bodies.begin(), d.bodies.end(),
                           [](const BodyStart& a, const BodyStart& b) { return a.step < b.step; }),
            "bodies must be listed in the order in which they come");
}

/// Of the bodies of one shape and density.
struct Inertia {
    double density = -1;
    btScalar mass = 0;
    btVector3 moments{0, 0, 0};
};

} // namespace

struct Simulation::State {
    explicit State(SceneDescription d)
        : description(std::move(d)), dispatcher(&configuration, description.settings, description.response.manifolds),
          world(&dispatcher, &broadphase, &solver, &configuration), watch(description) {}
    ~State() {
        for (const auto& body : bodies) {
            world.removeRigidBody(body.get());
            dispatcher.remove_body(*body);
        }
        if (plane) world.removeRigidBody(plane.get());
    }

    void configure();
    std::unique_ptr<btRigidBody> make_body(btCollisionShape& shape, const btTransform& pose, const Inertia& inertia);
    const Inertia& inertia_of(const BodyStart& start);
    void add_body(const BodyStart& start);
    void add_bodies_of_step();

    SceneDescription description;
    btDefaultCollisionConfiguration configuration;
    bullet::CollisionDispatcher dispatcher;
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world;
    std::vector<std::unique_ptr<bullet::MeshShape>> shapes;
    std::vector<Inertia> inertias; ///< of each shape, for the density last asked for
    std::unique_ptr<btStaticPlaneShape> plane_shape;
    std::unique_ptr<btRigidBody> plane;
    std::vector<std::unique_ptr<btRigidBody>> bodies; ///< that have come, in the description's order
    std::vector<Pose> poses;                          ///< of these, after the last step
    RunWatch watch;
};

void Simulation::State::configure() {
    const Response& response = description.response;
    const Vec3& g = description.gravity;
    world.setGravity(btVector3(btScalar(g.x), btScalar(g.y), btScalar(g.z)));
    // A sweep of the boxes along the motion adds pairs that have speculative contacts alone.
    const bool speculative = dispatcher.scene().settings().is_speculative();
    world.getDispatchInfo().m_useContinuous = speculative;
    const double slop = response.slop.value_or((speculative ? 0.001 : 0.005) * response.size);
    if (!response.bullet_defaults)
        bullet::recommend(world, {.slop = slop, .erp = response.erp, .iterations = response.iterations});
    // Nobody sleeps, so islands save nothing.
    world.getSimulationIslandManager()->setSplitIslands(false);

    for (const SceneShape& shape : description.shapes) {
        shape.shape->prepare(description.settings.execution.threads); // a run repeats, its counts of work, too
        shapes.push_back(std::make_unique<bullet::MeshShape>(shape.shape, shape.bounds));
    }
    inertias.resize(shapes.size());
    if (description.plane) {
        plane_shape = std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
        plane = make_body(*plane_shape, btTransform::getIdentity(), {});
        world.addRigidBody(plane.get());
    }
}

std::unique_ptr<btRigidBody> Simulation::State::make_body(btCollisionShape& shape, const btTransform& pose,
                                                          const Inertia& inertia) {
    const Response& response = description.response;
    btRigidBody::btRigidBodyConstructionInfo info(inertia.mass, nullptr, &shape, inertia.moments);
    info.m_startWorldTransform = pose;
    info.m_friction = btScalar(std::sqrt(response.friction)); // Bullet multiplies the two bodies' coefficients
    info.m_restitution = 0;
    info.m_linearDamping = btScalar(response.linear_damping);
    info.m_angularDamping = btScalar(response.angular_damping);
    auto body = std::make_unique<btRigidBody>(info);
    body->setActivationState(DISABLE_DEACTIVATION);
    return body;
}

// About the shape's axes, not its principal ones: models have the smaller box along them, and every ray starts in a
// box. What Bullet neglects are the products of inertia.
const Inertia& Simulation::State::inertia_of(const BodyStart& start) {
    Inertia& inertia = inertias[start.shape];
    if (inertia.density == start.density) return inertia;
    inertia = {start.density, 0, btVector3(0, 0, 0)};
    if (start.density == 0) return inertia;
    const bullet::MeshShape& shape = *shapes[start.shape];
    const MeshReport& report = shape.shape()->report();
    const Vec3 &low = report.box_min, &high = report.box_max;
    const bool flat = !(report.volume > 0) && (low.x == high.x || low.y == high.y || low.z == high.z);
    inertia.mass = btScalar(start.density * bullet::mass_properties(*shape.shape()).volume);
    if (flat || !(inertia.mass > 0) || !std::isfinite(inertia.mass))
        throw InputError(description.name + ": the mesh " + shape.shape()->name()
                         + " has no volume, so it cannot move; give a closed mesh, or one that is not flat");
    shape.calculateLocalInertia(inertia.mass, inertia.moments);
    return inertia;
}

void Simulation::State::add_body(const BodyStart& start) {
    auto body = make_body(*shapes[start.shape], start.pose, inertia_of(start));
    body->setLinearVelocity(start.velocity);
    body->setAngularVelocity(start.spin);
    world.addRigidBody(body.get());
    dispatcher.add_body(*body);
    poses.push_back(to_pose(start.pose));
    watch.add_body(start, poses.back());
    bodies.push_back(std::move(body));
}

void Simulation::State::add_bodies_of_step() {
    while (bodies.size() < description.bodies.size() && description.bodies[bodies.size()].step <= watch.steps())
        add_body(description.bodies[bodies.size()]);
}

Simulation::Simulation(SceneDescription description) {
    check(description);
    state_ = std::make_unique<State>(std::move(description));
    state_->configure();
    state_->add_bodies_of_step();
}

Simulation::~Simulation() = default;

void Simulation::step() {
    State& s = *state_;
    s.add_bodies_of_step();
    const auto start = Clock::now();
    s.world.stepSimulation(btScalar(s.description.dt), 0); // 0: exactly this step, no clock of Bullet's own
    const double ms = ms_since(start);
    for (std::size_t i = 0; i < s.bodies.size(); ++i) s.poses[i] = to_pose(s.bodies[i]->getWorldTransform());
    s.watch.add_step(ms, s.dispatcher.scene(), s.poses);
}

const SceneDescription& Simulation::description() const {
    return state_->description;
}
std::uint32_t Simulation::steps() const {
    return state_->watch.steps();
}
std::span<const Contact> Simulation::contacts() const {
    return state_->dispatcher.scene().contacts();
}
const StepStats& Simulation::stats() const {
    return state_->dispatcher.scene().stats();
}
const Scene& Simulation::scene() const {
    return state_->dispatcher.scene();
}
Pose Simulation::pose(std::uint32_t body) const {
    return state_->poses.at(body);
}
std::uint32_t Simulation::body_count() const {
    const SceneDescription& d = state_->description;
    return static_cast<std::uint32_t>(std::count_if(d.bodies.begin(), d.bodies.end(), [&](const BodyStart& body) {
        return body.density > 0 && body.step < d.steps;
    }));
}
Health Simulation::health() const {
    return state_->watch.health();
}
std::string Simulation::hash() const {
    return state_->watch.hash();
}
std::uint64_t Simulation::contacts_total() const {
    return state_->watch.contacts();
}
std::uint64_t Simulation::rays_total() const {
    return state_->watch.rays();
}
double Simulation::ray_length_total() const {
    return state_->watch.ray_length();
}
std::uint64_t Simulation::pairs_max() const {
    return state_->watch.pairs_max();
}
const RunLog& Simulation::log() const {
    return state_->watch.log();
}

} // namespace raycontact::scenes
