// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/machined.h>
#include <scenes/quantile.h>
#include <tests/holds/parts.h>
#include <tests/holds/scenes.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raycontact::scenes {

namespace {

constexpr double length_of_peg = 0.06, depth_of_hole = 0.05;

class InItsHole : public Course {
public:
    void after_step(const StackWorld& world, double) override { at_ = world.pose(1).translation; }
    int passed(const std::vector<Pose>& poses) const override {
        return poses[1].translation.z < -depth_of_hole + length_of_peg / 2 - 0.005;
    }
    std::vector<Figure> figures() const override {
        const double above = at_.z - (length_of_peg / 2 - depth_of_hole);
        return {{.name = "from the bottom", .unit = "mm", .value = 1000 * above, .least = -0.1, .most = 0.1}};
    }

private:
    Vec3 at_;
};

Hold peg_in_a_hole() {
    Hold hold;
    hold.name = "peg in a hole with 0.1 mm of play";
    hold.means = "it slides down to the bottom and stands there at rest";
    constexpr std::uint32_t around = 48;
    Mesh pin = peg(0.01, length_of_peg, 0.001, around),
         block = block_with_hole(0.01005, 0.03, depth_of_hole, 0.01, around);
    const Vec3 pin_centre = centre(pin), block_centre = centre(block);
    hold.stack = {hold.name, {shape_of(std::move(block), false), shape_of(std::move(pin), true)}, {}};
    hold.stack.bodies.push_back({0, {.translation = block_centre}, true});
    // Its end is in the hole by 5 mm.
    hold.stack.bodies.push_back({1, at(0, 0, length_of_peg + pin_centre.z - 0.005)});
    for (StackBody& body : hold.stack.bodies) {
        body.density = 7800;
        body.friction = 0.4;
    }
    hold.size = length_of_peg;
    hold.slop = 1e-5;
    hold.deepest = 0.001;
    hold.ground = Ground::none;
    hold.seconds = 5;
    hold.course = [] { return std::make_unique<InItsHole>(); };
    return hold;
}

constexpr double nut_begins = 0.04;

/// What a nut without friction does on a thread: it falls along it, and turns.
class OnItsThread : public Course {
public:
    OnItsThread(const Thread& thread, bool held) : thread_(thread), held_(held) {}
    void begin(StackWorld& world) override {
        last_ = world.pose(1);
        start_ = last_.translation.z;
        const btRigidBody& nut = world.body(1);
        const btVector3 inertia = nut.getLocalInertia() * nut.getInvMass();
        turning_ = {double(inertia.x()), double(inertia.y()), double(inertia.z())};
        gravity_ = -double(world.world().getGravity().z());
    }
    void after_step(const StackWorld& world, double time) override {
        const Pose now = world.pose(1), moved = relative_pose(last_, now);
        turns_ += std::atan2(moved.rotation[3], moved.rotation[0]) / (2 * std::numbers::pi);
        last_ = now;
        fell_ = start_ - now.translation.z;
        if (fell_ > nut_begins - 0.004) return; // it comes to the head
        time_ = time;
        off_ = std::max(off_, std::abs(fell_ + turns_ * thread_.pitch));
        const btRigidBody& nut = world.body(1);
        const btVector3 spin = nut.getWorldTransform().getBasis().transpose() * nut.getAngularVelocity();
        const double moving = (double(nut.getLinearVelocity().length2()) + turning_.x * double(spin.x() * spin.x())
                               + turning_.y * double(spin.y() * spin.y()) + turning_.z * double(spin.z() * spin.z()))
                              / 2;
        speeds_.push_back(double(nut.getLinearVelocity().length()));
        gained_ = std::max(gained_, moving / gravity_ - fell_);
        way_ = fell_;
    }
    int passed(const std::vector<Pose>& poses) const override {
        const Vec3& p = poses[1].translation;
        return off_ > thread_.pitch / 2 || std::sqrt(p.x * p.x + p.y * p.y) > 0.005;
    }
    std::vector<Figure> figures() const override {
        std::vector<Figure> all{
            {.name = "off the thread by", .unit = "mm", .value = 1000 * off_, .most = 0.2},
            {.name = "gains energy of", .unit = "mm of height", .value = 1000 * gained_, .most = 0.2},
            {.name = "median speed", .unit = "m/s", .value = quantile(speeds_, 0.5), .most = 0.1}};
        if (held_) {
            all.push_back({.name = "went down by", .unit = "mm", .value = 1000 * fell_, .most = 0.1});
        } else {
            const double lead = thread_.pitch / (2 * std::numbers::pi);
            const double free = gravity_ / (1 + turning_.z / (lead * lead)) * time_ * time_ / 2;
            all.push_back(
                {.name = "went down by", .unit = "of the free way", .value = way_ / free, .least = 0.02, .most = 1.05});
        }
        return all;
    }

private:
    Thread thread_;
    bool held_;
    Pose last_;
    Vec3 turning_; ///< inertia over mass, m^2
    double start_ = 0, gravity_ = 9.81, turns_ = 0, fell_ = 0, time_ = 0, off_ = 0, gained_ = 0, way_ = 0;
    std::vector<double> speeds_;
};

Hold nut_on_a_bolt(double friction, double hertz) {
    const Thread thread;
    const bool held = friction > 0;
    Hold hold;
    char name[80];
    std::snprintf(name, sizeof name, "nut M20, friction %g, %g Hz", friction, hertz);
    hold.name = name;
    hold.means = held ? "it stays where it is" : "it turns down its thread by its own weight, and gains no energy";
    Mesh bolt = threaded_bolt(thread), nut = threaded_nut(thread);
    const Vec3 bolt_centre = centre(bolt), nut_centre = centre(nut);
    hold.stack = {name, {shape_of(std::move(bolt), false), shape_of(std::move(nut), false)}, {}};
    hold.stack.bodies.push_back({0, {.translation = bolt_centre}, true});
    hold.stack.bodies.push_back({1, at(nut_centre.x, nut_centre.y, nut_centre.z + nut_begins)});
    for (StackBody& body : hold.stack.bodies) body.density = 7800;
    hold.stack.bodies[0].friction = 1;
    hold.stack.bodies[1].friction = friction;
    hold.size = 0.03;
    hold.slop = 1e-5;
    hold.deepest = 0.003;
    hold.hertz = hertz;
    hold.seconds = held ? 3 : 2;
    if (!held) hold.rest = std::nullopt;
    hold.sample = static_cast<int>(hertz / 20);
    hold.ground = Ground::none;
    hold.course = [=] { return std::make_unique<OnItsThread>(thread, held); };
    return hold;
}

} // namespace

std::vector<Hold> fits() {
    std::vector<Hold> all{peg_in_a_hole()};
    for (const double hertz : {60.0, 120.0, 240.0, 500.0, 1000.0, 2000.0})
        for (const double friction : {0.0, 0.05}) all.push_back(nut_on_a_bolt(friction, hertz));
    return all;
}

} // namespace raycontact::scenes
