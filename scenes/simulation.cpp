// SPDX-License-Identifier: Apache-2.0
#include <scenes/simulation.h>

#include <raycontact/bullet/mass.h>
#include <raycontact/bullet/recommend.h>
#include <raycontact/error.h>

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace raycontact::scenes {

namespace {

Pose to_pose(const btTransform& t) {
    Pose pose;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) pose.rotation[3 * i + j] = static_cast<double>(t.getBasis()[i][j]);
    }
    pose.translation = {static_cast<double>(t.getOrigin().x()), static_cast<double>(t.getOrigin().y()),
                        static_cast<double>(t.getOrigin().z())};
    return pose;
}

} // namespace

Simulation::Simulation(SceneDescription description)
    : description_(std::move(description)), plane_shape_(btVector3(0, 0, 1), btScalar(0)),
      dispatcher_(&configuration_, description_.settings, description_.response.manifolds),
      world_(&dispatcher_, &broadphase_, &solver_, &configuration_), watch_(description_) {
    const Response& response = description_.response;
    const Vec3& g = description_.gravity;
    world_.setGravity(btVector3(btScalar(g.x), btScalar(g.y), btScalar(g.z)));
    // A sweep of the boxes along the motion adds pairs that have speculative contacts alone.
    const bool speculative = scene().settings().is_speculative();
    world_.getDispatchInfo().m_useContinuous = speculative;
    const double slop = response.slop.value_or((speculative ? 0.001 : 0.005) * response.size);
    if (!response.bullet_defaults)
        bullet::recommend(world_, {.slop = slop, .erp = response.erp, .iterations = response.iterations});
    // Nobody sleeps, so islands save nothing.
    world_.getSimulationIslandManager()->setSplitIslands(false);

    for (const SceneShape& shape : description_.shapes) {
        shape.shape->prepare(description_.settings.execution.threads); // a run repeats, its counts of work, too
        shapes_.push_back(std::make_unique<bullet::MeshShape>(shape.shape, shape.bounds));
    }
    inertias_.resize(shapes_.size());
    if (description_.plane) {
        plane_ = make_body(plane_shape_, btTransform::getIdentity(), {});
        world_.addRigidBody(plane_.get());
    }
    add_bodies_of_step();
}

std::unique_ptr<btRigidBody> Simulation::make_body(btCollisionShape& shape, const btTransform& pose,
                                                   const Inertia& inertia) {
    const Response& response = description_.response;
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
const Simulation::Inertia& Simulation::inertia_of(const BodyStart& start) {
    Inertia& inertia = inertias_[start.shape];
    if (inertia.density == start.density) return inertia;
    inertia = {start.density, 0, btVector3(0, 0, 0)};
    if (start.density == 0) return inertia;
    const bullet::MeshShape& shape = *shapes_[start.shape];
    const MeshReport& report = shape.shape()->report();
    const Vec3 &low = report.box_min, &high = report.box_max;
    const bool flat = !(report.volume > 0) && (low.x == high.x || low.y == high.y || low.z == high.z);
    inertia.mass = btScalar(start.density * bullet::mass_properties(*shape.shape()).volume);
    if (flat || !(inertia.mass > 0) || !std::isfinite(inertia.mass))
        throw InputError(description_.name + ": the mesh " + shape.shape()->name()
                         + " has no volume, so it cannot move; give a closed mesh, or one that is not flat");
    shape.calculateLocalInertia(inertia.mass, inertia.moments);
    return inertia;
}

void Simulation::add_body(const BodyStart& start) {
    auto body = make_body(*shapes_[start.shape], start.pose, inertia_of(start));
    body->setLinearVelocity(start.velocity);
    body->setAngularVelocity(start.spin);
    world_.addRigidBody(body.get());
    dispatcher_.add_body(*body);
    poses_.push_back(to_pose(start.pose));
    watch_.add_body(start, poses_.back());
    bodies_.push_back(std::move(body));
}

void Simulation::add_bodies_of_step() {
    while (bodies_.size() < description_.bodies.size() && description_.bodies[bodies_.size()].step <= steps())
        add_body(description_.bodies[bodies_.size()]);
}

void Simulation::step() {
    add_bodies_of_step();
    const auto start = std::chrono::steady_clock::now();
    world_.stepSimulation(btScalar(description_.dt), 0); // 0: exactly this step, no clock of Bullet's own
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    for (std::size_t i = 0; i < bodies_.size(); ++i) poses_[i] = to_pose(bodies_[i]->getWorldTransform());
    watch_.add_step(took.count(), scene(), poses_);
}

std::uint32_t Simulation::body_count() const {
    return static_cast<std::uint32_t>(std::ranges::count_if(description_.bodies, [&](const BodyStart& body) {
        return body.density > 0 && body.step < description_.steps;
    }));
}

} // namespace raycontact::scenes
