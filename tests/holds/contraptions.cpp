// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/model.h>
#include <tests/holds/parts.h>
#include <tests/holds/scenes.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace raycontact::scenes {

namespace {

/// A hand in virtual reality: springs draw a body to a place behind a wall, and to the way it was held.
class Hand : public Course {
public:
    explicit Hand(double reach, double hertz) : reach_(reach), last_second_(static_cast<std::size_t>(hertz)) {}
    void before_step(StackWorld& world, double) override {
        constexpr double stiff = 400, damped = 30; // 1/s^2, 1/s, for each kilogram
        btRigidBody& body = world.body(1);
        const btScalar mass = 1 / body.getInvMass();
        const btVector3 way = btVector3(btScalar(reach_), 0, 1) - body.getWorldTransform().getOrigin();
        body.applyCentralForce(mass * (btScalar(stiff) * way - btScalar(damped) * body.getLinearVelocity()));
        const btQuaternion turn = body.getWorldTransform().getRotation();
        const btScalar sign = turn.w() < 0 ? btScalar(-1) : btScalar(1);
        const btVector3 back = -2 * sign * btVector3(turn.x(), turn.y(), turn.z());
        body.applyTorque(body.getInvInertiaTensorWorld().inverse()
                         * (btScalar(stiff) * back - btScalar(damped) * body.getAngularVelocity()));
    }
    void after_step(const StackWorld& world, double) override {
        along_.push_back(double(world.body(1).getWorldTransform().getOrigin().x()));
    }
    int passed(const std::vector<Pose>& poses) const override { return poses[1].translation.x > 0; }
    std::vector<Figure> figures() const override {
        if (along_.empty()) return {};
        const auto from = along_.end() - static_cast<std::ptrdiff_t>(std::min(along_.size(), last_second_));
        const auto [least, most] = std::minmax_element(from, along_.end());
        return {{.name = "shakes by", .unit = "mm", .value = 1000 * (*most - *least), .most = 0.05}};
    }

private:
    double reach_;
    std::size_t last_second_;
    std::vector<double> along_;
};

Hold hand(const std::string& name, StackShape shape, double hertz) {
    Hold hold;
    hold.name = name;
    hold.means = "it shakes by less than 0.05 mm";
    double right = 0;
    for (const Vec3& v : shape.mesh.vertices) right = std::max(right, v.x);
    hold.stack = {name, {box_of({0.2, 4, 4}), std::move(shape)}, {}};
    hold.stack.gravity = 0;
    hold.stack.bodies.push_back({0, at(0.1, 0, 1), true});
    hold.stack.bodies.push_back({1, at(-right - 0.3, 0, 1)});
    hold.hertz = hertz;
    hold.seconds = 5;
    hold.ground = Ground::none;
    hold.course = [=] { return std::make_unique<Hand>(0.1 - right, hertz); };
    return hold;
}

/// Balls that fly at it begin at other parts of a step's way.
class Foil : public Course {
public:
    void begin(StackWorld& world) override {
        for (std::size_t i = 1; i <= flights; ++i) world.body(i).setLinearVelocity(btVector3(0, 0, -100));
    }
    int passed(const std::vector<Pose>& poses) const override {
        return static_cast<int>(
            std::count_if(poses.begin() + 1, poses.end(), [](const Pose& p) { return !(p.translation.z > 0); }));
    }
    static constexpr std::size_t flights = 8;
};

Hold foil(const char* name, StackShape ball) {
    Hold hold;
    hold.name = name;
    hold.means = "none of eight balls passes";
    hold.stack = {"foil", {box_of({40, 40, 0.001}), std::move(ball)}, {}};
    hold.stack.bodies.push_back({0, at(0, 0, 0), true});
    for (std::size_t i = 0; i < Foil::flights; ++i)
        hold.stack.bodies.push_back(
            {1, at(2.2 * (static_cast<double>(i) - 3.5), 0, 3 + 100.0 / 60 * static_cast<double>(i) / Foil::flights)});
    hold.seconds = 1;
    hold.slop = 0.0001; // a body may stay that deep: less than the foil is thick
    hold.rest = std::nullopt;
    hold.ground = Ground::none;
    hold.course = [] { return std::make_unique<Foil>(); };
    return hold;
}

/// Whether the middle circle of one ring goes through the disc in that of the other once.
bool linked(const Pose& a, const Pose& b, double radius) {
    constexpr int points = 48;
    int crossings = 0;
    const auto seen = [&](int k) {
        const double angle = 2 * std::numbers::pi * k / points;
        const Pose in = relative_pose(a, b);
        return transform_point(in, {radius * std::cos(angle), radius * std::sin(angle), 0});
    };
    for (int k = 0; k < points; ++k) {
        const Vec3 p = seen(k), q = seen(k + 1);
        if ((p.z > 0) == (q.z > 0)) continue;
        const double t = p.z / (p.z - q.z), x = p.x + t * (q.x - p.x), y = p.y + t * (q.y - p.y);
        crossings += x * x + y * y < radius * radius;
    }
    return crossings % 2 == 1;
}

constexpr double link_radius = 0.35, link_thick = 0.09, link_play = 0.001;

class Linked : public Course {
public:
    int passed(const std::vector<Pose>& poses) const override {
        int count = 0;
        for (std::size_t i = 1; i < poses.size(); ++i) count += !linked(poses[i - 1], poses[i], link_radius);
        return count;
    }
};

Hold chain(int links) {
    Hold hold;
    hold.name = "chain of " + std::to_string(links) + " links";
    hold.means = "the links stay linked and hang at rest";
    hold.seconds = 20 + links; // until it has swung out
    hold.stack = {hold.name, {shape_of(smooth_ring(link_radius, link_thick, 24, 12), false)}, {}};
    for (int k = 0; k <= links; ++k) {
        // In planes that hold z, by turns that of x and that of y.
        Pose pose = turned_at({}, k % 2 == 0 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, 0.25);
        pose.translation.z = -k * (2 * link_radius - 2 * link_thick - link_play);
        hold.stack.bodies.push_back({0, pose, k == 0});
        hold.stack.bodies.back().damping = 0.2;
        hold.stack.bodies.back().rolling = 0.005;
    }
    hold.ground = Ground::none;
    hold.course = [] { return std::make_unique<Linked>(); };
    return hold;
}

/// The first is driven by a motor, the second is braked.
class Gears : public Course {
public:
    static constexpr std::array<double, 2> teeth{20, 30};
    static constexpr double speed = 1; ///< rad/s, of the first

    void begin(StackWorld& world) override {
        for (std::size_t i = 0; i < 2; ++i) {
            auto hinge = std::make_unique<btHingeConstraint>(world.body(i), btVector3(0, 0, 0), btVector3(0, 0, 1));
            if (i == 0) hinge->enableAngularMotor(true, btScalar(speed), 100);
            world.keep(std::move(hinge));
            last_[i] = world.pose(i);
        }
    }
    void before_step(StackWorld& world, double) override {
        world.body(1).applyTorque(btVector3(0, 0, -20 * world.body(1).getAngularVelocity().z()));
    }
    void after_step(const StackWorld& world, double) override {
        for (std::size_t i = 0; i < 2; ++i) {
            const Pose now = world.pose(i), moved = relative_pose(last_[i], now);
            passed_teeth_[i] += std::atan2(moved.rotation[3], moved.rotation[0]) * teeth[i] / (2 * std::numbers::pi);
            last_[i] = now;
        }
        const double slip = passed_teeth_[0] + passed_teeth_[1]; // they turn against each other
        slip_ = std::max(slip_, std::abs(slip));
        turned_ = std::abs(passed_teeth_[1]);
        time_ += 1;
    }
    int passed(const std::vector<Pose>&) const override { return slip_ > 0.5; }
    std::vector<Figure> figures() const override {
        const double expected = speed * teeth[0] / (2 * std::numbers::pi) * time_ / 60;
        return {{.name = "out of step by", .unit = "teeth", .value = slip_, .most = 0.1},
                {.name = "driven by", .unit = "of its way", .value = turned_ / expected, .least = 0.98, .most = 1.02}};
    }

private:
    std::array<Pose, 2> last_;
    std::array<double, 2> passed_teeth_{};
    double slip_ = 0, turned_ = 0, time_ = 0;
};

Hold gears() {
    Hold hold;
    hold.name = "gears of 20 and 30 teeth";
    hold.means = "the second, braked, turns in step with the first";
    constexpr double module = 0.05;
    const double apart = module * (Gears::teeth[0] + Gears::teeth[1]) / 2;
    hold.stack = {hold.name,
                  {shape_of(involute_gear(20, module, 0.2), false), shape_of(involute_gear(30, module, 0.2), false)},
                  {}};
    hold.stack.bodies.push_back({0, at(0, 0, 0)});
    hold.stack.bodies.push_back({1, turned_at({apart, 0, 0}, {0, 0, 1}, 0.5 / Gears::teeth[1])});
    for (StackBody& gear : hold.stack.bodies) gear.friction = 0.3;
    hold.rest = std::nullopt;
    hold.ground = Ground::none;
    hold.course = [] { return std::make_unique<Gears>(); };
    return hold;
}

class OnAHook : public Course {
public:
    int passed(const std::vector<Pose>& poses) const override { return poses[1].translation.z < -2; }
};

Hold mug_on_a_hook() {
    Hold hold;
    hold.name = "mug on a hook";
    hold.means = "it hangs by its handle, at rest";
    Mesh cup = mug(0.4, 1, 0.06);
    const Vec3 middle = centre(cup);
    hold.stack = {hold.name, {shape_of(hook(0.8, 0.15, 0.04), false), shape_of(std::move(cup), false)}, {}};
    // The hook goes through the handle; the cup hangs below, on its side.
    hold.stack.bodies.push_back({0, turned_at({0, -0.4, 0}, {0, 0, 1}, 0.25), true});
    Pose pose = turned_at({}, {0, 1, 0}, -0.25); // the handle up
    const Vec3 inner = transform_point(pose, {0.4 + 0.55 - 0.06 - middle.x, 0, 5.0 / 12 + 1.0 / 12 - middle.z});
    pose.translation = {-inner.x, -inner.y, 0.04 - inner.z + 0.002};
    hold.stack.bodies.push_back({1, pose});
    hold.stack.bodies.back().damping = 0.5;
    hold.stack.bodies.back().rolling = 0.005;
    hold.ground = Ground::none;
    hold.course = [] { return std::make_unique<OnAHook>(); };
    return hold;
}

} // namespace

std::vector<Hold> contraptions() {
    std::vector<Hold> all;
    const StackShape bunny = shape_of(stood_up(scene_model("bunny", 902).mesh), false);
    for (const double hertz : {60.0, 90.0}) {
        const std::string at_rate = ", " + std::to_string(static_cast<int>(hertz)) + " Hz";
        all.push_back(hand("hand presses a bunny" + at_rate, bunny, hertz));
        all.push_back(hand("hand presses a cube" + at_rate, box_of({1, 1, 1}), hertz));
    }
    StackShape ball = shape_of(smooth_ball(0.5, 24, 11), true);
    all.push_back(foil("ball, a mesh, 100 m/s, foil of 1 mm", ball));
    ball.own = [] { return std::make_shared<btSphereShape>(btScalar(0.5)); };
    all.push_back(foil("ball, btSphereShape, the same", ball));
    for (const int links : {5, 10, 20, 50}) all.push_back(chain(links));
    all.push_back(gears());
    all.push_back(mug_on_a_hook());
    return all;
}

} // namespace raycontact::scenes
