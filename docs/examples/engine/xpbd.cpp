// SPDX-License-Identifier: Apache-2.0
// Position-based dynamics of rigid bodies (Macklin, Mueller and Chentanez, XPBD, 2016; Mueller et al., Detailed Rigid
// Body Simulation with Extended Position Based Dynamics, 2020): bodies go on as if nothing were there, contacts move
// them back, and velocities are what came of it. Contacts are held a little apart: what rests has speculative ones
// alone.
//   example_xpbd [MESH [POSES]]
#include "engine.h"

#include <exception>
#include <utility>

namespace {

using engine::Body, raycontact::Vec3;

constexpr double dt = 1.0 / 240;
constexpr int rounds = 4;
// Metres: contacts are not nearer than this after a step, unless they were before it. Those are not to come nearer
// still, and below a half of it they get apart slowly: what is put right at once shakes the heap.
constexpr double rest_offset = 0.002, recovery = 0.1;

/// What moved body b, kg m: an impulse x dt. The next step begins with it, as sequential impulses do.
struct Push {
    double pressed = 0; // along the normal
    Vec3 held;          // across it
};

struct Point {
    Body *a, *b;
    Vec3 on_a, on_b; // body frames: they go with the bodies
    Vec3 normal;     // from a to b
    Vec3 was;        // on_b less on_a before the step, world frame, metres
    double least;    // how far b shall be along the normal, metres
    Push* push;

    Vec3 reach_a() const { return transform_point(a->pose, on_a); }
    Vec3 reach_b() const { return transform_point(b->pose, on_b); }
    Vec3 apart() const { return reach_b() - reach_a(); }
    double yields(const Vec3& along) const {
        return a->yields(reach_a() - a->pose.translation, along) + b->yields(reach_b() - b->pose.translation, along);
    }
    void move(const Vec3& by) const {
        const Vec3 arm_a = reach_a() - a->pose.translation, arm_b = reach_b() - b->pose.translation;
        shift(*a, arm_a, -by);
        shift(*b, arm_b, by);
    }
    static void shift(Body& body, const Vec3& arm, const Vec3& by) {
        body.pose = raycontact::pose_at({body.pose, body.inverse_mass * by, body.turned_by(cross(arm, by)), {}}, 1);
    }
    void start() const {
        push->held -= dot(push->held, normal) * normal; // the normal may have turned
        move(push->pressed * normal + push->held);
    }
    void solve() const {
        // The sum never pulls; this round's share may.
        const double lacks = (least - dot(apart(), normal)) / yields(normal);
        const double pressed = std::max(0.0, push->pressed + lacks);
        move((pressed - std::exchange(push->pressed, pressed)) * normal);
        // Friction takes back what the bodies slid in this step, within its cone.
        const Vec3 way = apart() - was, slid = way - dot(way, normal) * normal;
        Vec3 held = push->held;
        if (length2(slid) > 0) held -= slid / yields(unit(slid));
        const double strong = length(held), strongest = engine::friction * pressed;
        if (strong > strongest) held *= strongest / strong;
        move(held - std::exchange(push->held, held));
    }
};

/// How far apart a contact shall be after the step, if it was `gap` before it.
double least_gap(double gap) {
    return std::min(gap, rest_offset) + recovery * std::max(0.0, rest_offset / 2 - gap);
}

} // namespace

int main(int argc, char** argv) try {
    raycontact::Settings settings;
    settings.speculative = raycontact::Speculative::on;
    settings.speculative_margin = 2 * rest_offset;
    settings.max_contacts_per_pair = 8;
    engine::Heap heap(argc, argv, settings);
    engine::Kept<Push> pushes;

    for (int step = 1; step * dt <= engine::seconds; ++step) {
        const std::vector<Body> before = heap.bodies;
        for (Body& body : heap.bodies) {
            if (body.inverse_mass > 0) body.velocity += dt * engine::gravity;
            body.pose = body.pose_after(dt);
            heap.scene.set_pose(body.id, body.pose);
            heap.scene.set_next_pose(body.id, body.pose); // contacts of where the bodies are, none of their way
        }
        pushes.next_step();
        std::vector<Point> points;
        for (const raycontact::Contact& contact : heap.scene.find_contacts()) {
            const auto slot_a = contact.body_a.slot, slot_b = contact.body_b.slot;
            Body &a = heap.bodies[slot_a], &b = heap.bodies[slot_b];
            const Vec3 on_a = a.to_own(contact.point_a), on_b = b.to_own(contact.point_b);
            const Vec3 was = transform_point(before[slot_b].pose, on_b) - transform_point(before[slot_a].pose, on_a);
            const double least = least_gap(dot(was, contact.normal));
            points.push_back({&a, &b, on_a, on_b, contact.normal, was, least, &pushes.of(contact)});
        }
        for (const Point& point : points) point.start();
        for (int round = 0; round < rounds; ++round)
            for (const Point& point : points) point.solve();
        for (std::size_t i = 1; i < heap.bodies.size(); ++i) {
            const auto way = straight_motion(before[i].pose, heap.bodies[i].pose);
            heap.bodies[i].velocity = way.velocity / dt;
            heap.bodies[i].spin = way.angular_velocity / dt;
        }
        heap.watch(step * dt);
    }
    return heap.verdict(0);
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
