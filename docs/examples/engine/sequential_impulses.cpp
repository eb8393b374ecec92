// SPDX-License-Identifier: Apache-2.0
// Sequential impulses (Catto, Iterative Dynamics with Temporal Coherence, 2005; Fast and Simple Physics using
// Sequential Impulses, GDC 2006): each contact in turn gets the impulse that it needs, round after round; each step
// begins with the impulses of the last one.
//   example_sequential_impulses [MESH [POSES]]
#include "engine.h"

#include <exception>

namespace {

using engine::Body, raycontact::Vec3;

constexpr double dt = 1.0 / 60;
constexpr int rounds = 20;

/// A contact as the solver has it. Speeds are b's less a's.
struct Point {
    Body *a, *b;
    Vec3 arm_a, arm_b; // from the centres of mass
    Vec3 normal;       // from a to b
    double least;      // m/s along the normal
    Vec3* impulse;     // on b, N s: of the last step, then of this one

    Vec3 speed() const { return b->velocity_at(arm_b) - a->velocity_at(arm_a); }
    double yields(const Vec3& along) const { return a->yields(arm_a, along) + b->yields(arm_b, along); }
    void push(const Vec3& by) const {
        a->push(arm_a, -by);
        b->push(arm_b, by);
    }
    void solve() const {
        // The sum never pulls; this round's share may.
        const double before = dot(*impulse, normal);
        const double pressed = std::max(0.0, before + (least - dot(speed(), normal)) / yields(normal));
        push((pressed - before) * normal);
        // Friction, within its cone.
        const Vec3 now = speed(), sliding = now - dot(now, normal) * normal;
        const Vec3 held_before = *impulse - before * normal;
        Vec3 held = held_before;
        if (length2(sliding) > 0) held -= sliding / yields(unit(sliding));
        const double strong = length(held), strongest = engine::friction * pressed;
        if (strong > strongest) held *= strongest / strong;
        push(held - held_before);
        *impulse = pressed * normal + held;
    }
};

/// The least speed along a contact's normal: so that a gap closes and no more, and that depth goes, a part a step.
double least_speed(const raycontact::Contact& contact, double slop) {
    if (contact.is_speculative()) return contact.depth / dt;
    return std::min(0.2 * std::max(0.0, contact.depth - slop) / dt, 1.0);
}

} // namespace

int main(int argc, char** argv) try {
    raycontact::Settings settings;
    settings.speculative = raycontact::Speculative::on; // contacts before anything touches
    settings.max_contacts_per_pair = 8;                 // those that stand for all
    engine::Heap heap(argc, argv, settings);
    engine::Kept<Vec3> impulses;

    for (int step = 1; step * dt <= engine::seconds; ++step) {
        for (Body& body : heap.bodies) {
            if (body.inverse_mass > 0) body.velocity += dt * engine::gravity;
            heap.scene.set_pose(body.id, body.pose);
            heap.scene.set_next_pose(body.id, body.pose_after(dt)); // where it goes if nothing stops it
        }
        impulses.next_step();
        std::vector<Point> points;
        for (const raycontact::Contact& contact : heap.scene.find_contacts()) {
            Body &a = heap.bodies[contact.body_a.slot], &b = heap.bodies[contact.body_b.slot];
            points.push_back({&a, &b, contact.point_a - a.pose.translation, contact.point_b - b.pose.translation,
                              contact.normal, least_speed(contact, 0.001), &impulses.of(contact)});
        }
        for (const Point& point : points) point.push(*point.impulse); // the warm start
        for (int round = 0; round < rounds; ++round)
            for (const Point& point : points) point.solve();
        for (Body& body : heap.bodies) body.pose = body.pose_after(dt);
        heap.watch(step * dt);
    }
    return heap.verdict(0.01);
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
