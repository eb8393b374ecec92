// SPDX-License-Identifier: Apache-2.0
#include <tests/motion/courses.h>

#include <tests/stacks/verdict.h>

#include "mesh/vector.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raycontact::scenes {

namespace {

constexpr double gravity = 9.81;
constexpr double degrees = 180 / std::numbers::pi;

Vec3 of(const btVector3& v) {
    return {double(v.x()), double(v.y()), double(v.z())};
}

Vec3 level(const Vec3& v) {
    return {v.x, v.y, 0};
}

double turn_of(const Pose& from, const Pose& to) {
    return degrees * angle_of(relative_pose(from, to));
}

Figure figure(const char* name, const std::string& unit, const Worst& worst, double scale, double most) {
    return {.name = name,
            .unit = unit + " (body " + std::to_string(worst.body) + ")",
            .value = scale * worst.value,
            .most = scale * most};
}

/// Of a number that each body has, the one farthest from what is right.
Worst farthest(const std::vector<double>& values, const std::vector<std::size_t>& bodies, double right) {
    if (values.empty()) return {std::nan(""), 0};
    Worst worst{right, bodies[0]};
    for (std::size_t k = 0; k < values.size(); ++k)
        if (!(std::abs(values[k] - right) <= std::abs(worst.value - right))) worst = {values[k], bodies[k]};
    return worst;
}

Figure about(const char* name, const std::string& unit, const Worst& worst, double least, double most) {
    Figure out = figure(name, unit, worst, 1, most);
    out.least = least;
    return out;
}

} // namespace

void Launched::begin(StackWorld& world) {
    const std::size_t bodies = world.poses().size();
    for (std::size_t i = 0; i < bodies; ++i)
        if (world.body(i).getInvMass() > 0) movers_.push_back(i);
    for (const std::size_t a : movers_)
        for (const std::size_t b : movers_)
            if (a != b) world.body(a).setIgnoreCollisionCheck(&world.body(b), true);
    launches_.resize(movers_.size());
}

void Launched::before_step(StackWorld& world, double dt) {
    dt_ = dt;
    if (gone_ || time_ + dt / 2 < rest_) return;
    gone_ = true;
    for (std::size_t k = 0; k < movers_.size(); ++k) {
        first_.push_back(world.pose(movers_[k]));
        world.body(movers_[k]).setLinearVelocity(to_bullet(launches_[k].velocity));
        world.body(movers_[k]).setAngularVelocity(to_bullet(launches_[k].spin));
    }
    start(world);
}

void Launched::after_step(const StackWorld& world, double time) {
    time_ = time;
    if (gone_) watch(world, time - rest_);
}

std::vector<Figure> Launched::figures() const {
    if (!gone_) return {{.name = "was let go after", .unit = "s", .value = std::nan("")}};
    return measured();
}

Slide::Slide(std::vector<Launch> launches, double braking, const SlideBounds& bounds, const Vec3& ground)
    : Launched(std::move(launches), 0.5), braking_(braking), bounds_(bounds), ground_(ground) {}

void Slide::begin(StackWorld& world) {
    Launched::begin(world);
    if (length(ground_) == 0) return;
    const std::size_t bodies = world.poses().size();
    for (std::size_t i = 0; i < bodies; ++i) {
        btRigidBody& body = world.body(i);
        if (body.getInvMass() > 0) continue;
        body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
        body.setActivationState(DISABLE_DEACTIVATION);
    }
}

void Slide::before_step(StackWorld& world, double dt) {
    Launched::before_step(world, dt);
    if (length(ground_) == 0 || first_.empty()) return;
    const std::size_t bodies = world.poses().size();
    for (std::size_t i = 0; i < bodies; ++i) {
        btRigidBody& body = world.body(i);
        if (body.getInvMass() > 0) continue;
        btTransform next = body.getWorldTransform();
        next.setOrigin(next.getOrigin() + btScalar(dt) * to_bullet(ground_));
        body.setWorldTransform(next);
    }
}

void Slide::start(const StackWorld&) {
    for (const Launch& launch : launches_) speeds_.push_back(length(launch.velocity - ground_));
    ways_.assign(launches_.size(), 0);
}

void Slide::watch(const StackWorld& world, double since) {
    along_.clear();
    for (std::size_t k = 0; k < movers_.size(); ++k) {
        const std::size_t body = movers_[k];
        const Vec3 relative = launches_[k].velocity - ground_;
        // As a solver without error goes, step by step.
        speeds_[k] = std::max(0.0, speeds_[k] - braking_ * dt_);
        ways_[k] += speeds_[k] * dt_;
        const Vec3 right = since * ground_ + ways_[k] * unit(relative);
        const double way = length(right);
        const Pose pose = world.pose(body);
        const Vec3 went = pose.translation - first_[k].translation;
        along_.push_back(dot(went, right) / (way * way));
        const double beside = length(level(went - along_.back() * right));
        beside_.most(beside / way, body);
        const Vec3 velocity = of(world.body(body).getLinearVelocity());
        const double first = std::max(length(launches_[k].velocity), length(ground_));
        if (braking_ == 0) {
            slower_.most(1 - length(level(velocity)) / first, body);
            faster_.most(length(level(velocity)) / first - 1, body);
        }
        up_.most(std::abs(velocity.z) / first, body);
        height_.most(std::abs(went.z), body);
        turn_.most(turn_of(first_[k], pose), body);
    }
}

std::vector<Figure> Slide::measured() const {
    std::vector<Figure> all{about("went", "of its way", farthest(along_, movers_, 1), 1 - bounds_.way, 1 + bounds_.way),
                            figure("beside it by", "of it", beside_, 1, bounds_.way)};
    if (braking_ == 0) {
        all.push_back(figure("slower by", "of its speed", slower_, 1, bounds_.speed));
        all.push_back(figure("faster by", "of its speed", faster_, 1, bounds_.speed));
    }
    all.push_back(figure("up or down at", "of its speed", up_, 1, bounds_.speed));
    all.push_back(figure("up or down by", "mm", height_, 1000, bounds_.height));
    all.push_back(figure("turned by", "degrees", turn_, 1, bounds_.turn));
    return all;
}

Coast::Coast(std::vector<Launch> launches, double lowest, double loses)
    : Launched(std::move(launches), 0), lowest_(lowest), loses_(loses) {}

void Coast::watch(const StackWorld& world, double) {
    const bool is_first = velocity_.empty();
    for (std::size_t k = 0; k < movers_.size(); ++k) {
        const btRigidBody& body = world.body(movers_[k]);
        const Vec3 velocity = of(body.getLinearVelocity());
        const Vec3 spin = of(body.getWorldTransform().getBasis().transpose() * body.getAngularVelocity());
        const double height = world.pose(movers_[k]).translation.z - lowest_;
        if (is_first) {
            velocity_.push_back(velocity);
            spin_.push_back(spin);
            height_.push_back(height);
            continue;
        }
        // Bullet's positions and velocities are half a step apart, so those about a position have a mean.
        const Vec3 v = 0.5 * (velocity_[k] + velocity), w = 0.5 * (spin_[k] + spin);
        const Vec3 inertia = double(body.getInvMass()) * of(body.getLocalInertia());
        const double turning = inertia.x * w.x * w.x + inertia.y * w.y * w.y + inertia.z * w.z * w.z;
        const double energy = (dot(v, v) + turning) / 2 + gravity * height_[k];
        velocity_[k] = velocity;
        spin_[k] = spin;
        height_[k] = height;
        if (first_energy_.size() <= k) {
            first_energy_.push_back(energy);
            energy_.push_back(energy);
        }
        energy_[k] = energy / first_energy_[k];
        gained_.most(energy_[k] - 1, movers_[k]);
    }
}

std::vector<Figure> Coast::measured() const {
    return {about("has at the end", "of its energy", farthest(energy_, movers_, 1), 1 - loses_, 1.005),
            figure("gains at most", "of its energy", gained_, 1, 0.005)};
}

Halt::Halt(std::vector<Launch> launches, double reach, double past)
    : Launched(std::move(launches), 0.5), reach_(reach), past_(past) {
    beyond_.value = -1;
}

void Halt::watch(const StackWorld& world, double) {
    for (const std::size_t body : movers_) beyond_.most(world.pose(body).translation.x + reach_, body);
    speed_ = {};
    for (const std::size_t body : movers_) speed_.most(double(world.body(body).getLinearVelocity().x()), body);
}

std::vector<Figure> Halt::measured() const {
    Figure beyond = figure("went beyond it by", "mm", beyond_, 1000, past_);
    beyond.least = -1000 * past_; // it came there
    return {beyond, figure("goes on at", "m/s", speed_, 1, 0.05)};
}

Roll::Roll(std::vector<Launch> launches, double radius, int sides, double play)
    : Launched(std::move(launches), 0.5), wheel_{sides, radius, 0, 0.5}, play_(play) {}

void Roll::start(const StackWorld& world) {
    const btRigidBody& body = world.body(movers_[0]);
    wheel_.inertia = double(body.getLocalInertia().y() * body.getInvMass());
}

void Roll::watch(const StackWorld& world, double since) {
    step_ = since - std::exchange(since_, since);
    ways_.clear();
    speeds_.clear();
    for (std::size_t k = 0; k < movers_.size(); ++k) {
        const std::size_t body = movers_[k];
        const Pose pose = world.pose(body);
        const Vec3 went = pose.translation - first_[k].translation;
        const double first = launches_[k].velocity.x, speed = double(world.body(body).getLinearVelocity().x());
        ways_.push_back(went.x);
        speeds_.push_back(speed / first);
        faster_.most(speed / first - 1, body);
        up_.most(went.z, body);
        beside_.most(std::abs(went.y), body);
        const Vec3 axis = rotated(relative_pose(first_[k], pose).rotation, {0, 1, 0});
        lean_.most(degrees * std::acos(std::min(1.0, axis.y)), body);
    }
}

std::vector<Figure> Roll::measured() const {
    const double corner = std::numbers::pi / wheel_.sides, side = 2 * wheel_.radius * std::sin(corner);
    // A polygon that goes over a corner: what it has about the next corner stays (McGeer 1990, a rimless wheel). Steps
    // as long as that takes lose more.
    const double arm = wheel_.radius * wheel_.radius;
    const double kept = (wheel_.inertia + arm * std::cos(2 * corner)) / (wheel_.inertia + arm);
    double slowest = 1e9, explained = 0, fastest = 0, slowest_launch = 1e9;
    std::size_t worst = 0;
    for (std::size_t k = 0; k < ways_.size(); ++k) {
        const double right = std::min(std::pow(kept, std::ceil(ways_[k] / side)),
                                      wheel_.keeps(launches_[k].velocity.x, since_, 1 / step_));
        if (speeds_[k] / right < slowest) {
            slowest = speeds_[k] / right;
            explained = right;
            worst = k;
        }
        fastest = std::max(fastest, launches_[k].velocity.x);
        slowest_launch = std::min(slowest_launch, launches_[k].velocity.x);
    }
    // It is thrown up from a corner, at most at the speed at which the next one comes down.
    const double leap = fastest * std::sin(corner);
    const double up = leap * leap / (2 * gravity) + wheel_.radius * (1 - std::cos(corner)) + 1e-3;
    const Worst end{speeds_[worst], movers_[worst]};
    // Over a face its middle is lower than over a corner, and so faster.
    const double faster = 0.01 + gravity * wheel_.radius * (1 - std::cos(corner)) / (slowest_launch * slowest_launch);
    return {about("rolls on at", "of its speed", end, 0.95 * explained, 1 + faster),
            figure("faster by", "of its speed", faster_, 1, faster), figure("up by", "mm", up_, 1000, up),
            figure("beside by", "mm", beside_, 1000, play_), figure("leans by", "degrees", lean_, 1, 3)};
}

Fall::Fall(std::vector<double> drops, double restitution)
    : Launched(std::vector<Launch>(drops.size()), 0), drops_(std::move(drops)), restitution_(restitution),
      highest_(drops_.size(), -1e9), phase_(drops_.size(), 0) {}

void Fall::begin(StackWorld& world) {
    Launched::begin(world);
    const std::size_t bodies = world.poses().size();
    for (std::size_t i = 0; i < bodies; ++i) {
        btRigidBody& body = world.body(i);
        body.setRestitution(body.getInvMass() > 0 ? btScalar(restitution_) : 1); // of two the product
    }
}

void Fall::watch(const StackWorld& world, double) {
    for (std::size_t k = 0; k < movers_.size(); ++k) {
        const Pose pose = world.pose(movers_[k]);
        const double up = double(world.body(movers_[k]).getLinearVelocity().z());
        if (phase_[k] == 0 && up > 0) phase_[k] = 1;
        if (phase_[k] != 1) continue;
        highest_[k] = std::max(highest_[k], pose.translation.z);
        turn_.most(turn_of(first_[k], pose), movers_[k]);
        if (up < 0) phase_[k] = 2;
    }
}

std::vector<Figure> Fall::measured() const {
    std::vector<double> rose;
    for (std::size_t k = 0; k < highest_.size(); ++k) {
        const double ground = first_[k].translation.z - drops_[k];
        rose.push_back((highest_[k] - ground) / (restitution_ * restitution_ * drops_[k]));
    }
    return {about("bounced to", "of the right height", farthest(rose, movers_, 1), 0.9, 1.1),
            figure("turned by", "degrees", turn_, 1, 5)};
}

ToAndFro::ToAndFro(std::vector<Launch> launches, double room) : Launched(std::move(launches), 0), room_(room) {}

void ToAndFro::begin(StackWorld& world) {
    Launched::begin(world);
    const std::size_t bodies = world.poses().size();
    for (std::size_t i = 0; i < bodies; ++i) world.body(i).setRestitution(1);
    bounces_.assign(movers_.size(), 0);
    sign_.assign(movers_.size(), 1);
}

void ToAndFro::watch(const StackWorld& world, double since) {
    seconds_ = since;
    speeds_.clear();
    for (std::size_t k = 0; k < movers_.size(); ++k) {
        const Vec3 velocity = of(world.body(movers_[k]).getLinearVelocity());
        speeds_.push_back(length(velocity) / length(launches_[k].velocity));
        if (sign_[k] * velocity.x < 0) {
            sign_[k] = -sign_[k];
            ++bounces_[k];
        }
        const Vec3 went = world.pose(movers_[k]).translation - first_[k].translation;
        beside_.most(std::sqrt(went.y * went.y + went.z * went.z), movers_[k]);
    }
}

std::vector<Figure> ToAndFro::measured() const {
    const double right = seconds_ * launches_[0].velocity.x / room_;
    return {about("keeps", "of its speed", farthest(speeds_, movers_, 1), 0.9, 1.1),
            about("bounced", "times", farthest(bounces_, movers_, right), 0.9 * right - 1, 1.1 * right + 1),
            figure("beside by", "mm", beside_, 1000, 0.01)};
}

} // namespace raycontact::scenes
