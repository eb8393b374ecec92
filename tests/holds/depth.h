// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>
#include <tests/stacks/stack_world.h>

#include <memory>
#include <vector>

namespace raycontact::scenes {

/// How deep bodies are in each other, whoever moved them. Of vertices: whether one is inside is decided by exact
/// predicates (raycontact::contains), how deep by the nearest point of the surface in double. Of edges that cross: the
/// contacts of a Scene of its own, without what is only near.
class DepthProbe {
public:
    DepthProbe(const Stack& stack, Ground ground);
    /// Metres; the most of all pairs.
    double deepest(const std::vector<Pose>& poses);

private:
    struct Body {
        std::shared_ptr<const Shape> shape;
        BodyId id;
        bool fixed = false;
    };
    double deepest_vertex(const Body& in, const Pose& pose_in, const Body& of, const Pose& pose_of) const;

    Scene scene_;
    std::vector<Body> bodies_;
};

} // namespace raycontact::scenes
