// SPDX-License-Identifier: Apache-2.0
// Penalty forces: each contact is a spring and a damper, and friction a spring across, which slips at Coulomb's limit
// (Cundall and Strack, A Discrete Numerical Model for Granular Assemblies, 1979). Each vertex inside another body
// pushes by its share of the surface (direction `weighted`; Hermann et al. 2008): its force begins at 0 and does not
// jump.
//   example_penalty [MESH [POSES]]
#include "engine.h"

#include <exception>

namespace {

using engine::Body, raycontact::Vec3;

constexpr double dt = 1.0 / 4000;
// By area, as forces are: N/m^3 and N s/m^3.
constexpr double stiffness = 1e8, damping = 1e6;

/// How far friction's spring is drawn out, metres, across the normal: of b against a. Without it friction would need
/// speed, and what rests on a slope would creep.
using Stretch = Vec3;

/// The force on b of a contact, newtons; a has the opposite one.
Vec3 force_on_b(const raycontact::Contact& contact, const Vec3& velocity, Stretch& stretch) {
    const Vec3 normal = contact.normal;
    const double parting = dot(velocity, normal);
    const double pressed = contact.weight * std::max(0.0, stiffness * contact.depth - damping * parting);
    const Vec3 sliding = velocity - parting * normal;
    stretch += dt * sliding;
    stretch -= dot(stretch, normal) * normal; // the normal may have turned
    const double most = engine::friction * contact.depth;
    if (length(stretch) > most) stretch *= most / length(stretch); // it slips
    Vec3 held = -contact.weight * (stiffness * stretch + damping * sliding);
    const double strong = length(held), strongest = engine::friction * pressed;
    if (strong > strongest) held *= strongest / strong;
    return pressed * normal + held;
}

} // namespace

int main(int argc, char** argv) try {
    raycontact::Settings settings;
    settings.direction = raycontact::Direction::weighted;
    settings.features = raycontact::Features::vertices; // patches would serve coarse meshes, too; they take longer
    engine::Heap heap(argc, argv, settings);
    engine::Kept<Stretch> stretches;

    for (int step = 1; step * dt <= engine::seconds; ++step) {
        heap.set_poses();
        const std::vector<Body> now = heap.bodies; // all forces are of the same moment
        for (Body& body : heap.bodies)
            if (body.inverse_mass > 0) body.velocity += dt * engine::gravity;
        stretches.next_step();
        for (const raycontact::Contact& contact : heap.scene.find_contacts()) {
            const Body &a = now[contact.body_a.slot], &b = now[contact.body_b.slot];
            // Both push where they meet, half-way between the two surfaces.
            const Vec3 point = 0.5 * (contact.point_a + contact.point_b);
            const Vec3 arm_a = point - a.pose.translation, arm_b = point - b.pose.translation;
            const Vec3 velocity = b.velocity_at(arm_b) - a.velocity_at(arm_a);
            const Vec3 impulse = dt * force_on_b(contact, velocity, stretches.of(contact));
            heap.bodies[contact.body_a.slot].push(arm_a, -impulse);
            heap.bodies[contact.body_b.slot].push(arm_b, impulse);
        }
        for (Body& body : heap.bodies) body.pose = body.pose_after(dt);
        heap.watch(step * dt);
    }
    return heap.verdict(0.02);
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
