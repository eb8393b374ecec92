// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/bullet/mesh_shape.h>
#include <raycontact/bullet/recommend.h>
#include <raycontact/settings.h>
#include <raycontact/shape.h>
#include <scenes/region.h>

#include <LinearMath/btTransform.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace raycontact::scenes {

/// How Bullet answers the contacts (sequential impulses).
struct Response {
    bullet::ManifoldSettings manifolds;
    double friction = 0.6;
    int iterations = bullet::SolverSettings{}.iterations;
    std::optional<double> slop; ///< metres; empty: 0.1 % of `size` with speculative contacts, 0.5 % without
    double size = 1;            ///< of the smallest body that moves, metres
    double erp = bullet::SolverSettings{}.erp;
    bool bullet_defaults = false; ///< the solver as Bullet sets it up; iterations, slop and erp above do not apply
    double linear_damping = 0, angular_damping = 0; ///< part of the speed lost in a second, 0 to 1
};

struct SceneShape {
    std::shared_ptr<const Shape> shape;
    bullet::Bounds bounds = bullet::Bounds::box; ///< what the broad phase sees; the paper's pair counts go with boxes
    std::string source; ///< what the mesh is and where it came from, for a person; empty for the ground of a scene
};

/// A body at the moment it comes.
struct BodyStart {
    std::uint32_t shape = 0;                       ///< index into SceneDescription::shapes
    btTransform pose = btTransform::getIdentity(); ///< of the shape's frame, whose origin is the centre of mass
    btVector3 velocity{0, 0, 0};                   ///< of the centre of mass, m/s
    btVector3 spin{0, 0, 0};                       ///< about the centre of mass, rad/s, world axes
    double density = 1000;                         ///< kg/m^3; 0: the body does not move
    std::uint32_t step = 0;                        ///< the first step it takes part in
};

/// All that decides a simulation. Right-handed, metres, seconds, kilograms.
struct SceneDescription {
    std::string name;
    std::string arguments; ///< of `raycontact run`, that name this scene and its number of bodies
    std::uint64_t seed = 1;
    std::vector<SceneShape> shapes;
    std::vector<BodyStart> bodies;     ///< in the order in which they come, by step
    std::optional<std::uint32_t> slab; ///< the body that is the ground, if one of them is
    bool plane = false;                ///< an endless ground z = 0, whose contacts are none of meshes and not counted
    Vec3 gravity{0, 0, -9.81};
    double dt = 1.0 / 60;      ///< of a step; the solver takes one substep
    std::uint32_t steps = 600; ///< planned; the log's frames are spread over these
    std::uint32_t frames = 8;
    Response response;
    Settings settings;         ///< of RayContact
    double depth_limit = 0.02; ///< metres; a deeper contact counts as deep (Health)
    Region region;             ///< bodies are meant to stay in it (Health); without limits: there is no ground
};

} // namespace raycontact::scenes
