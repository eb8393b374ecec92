// SPDX-License-Identifier: Apache-2.0
#include <scenes/circle_source.h>

#include <scenes/models/trigonometry.h>

#include <algorithm>
#include <cmath>

namespace raycontact::scenes {

std::uint32_t CircleSource::step_of(std::uint32_t k, double dt) const {
    const double step = first_step + std::floor(k / (rate * dt) + 0.5);
    return static_cast<std::uint32_t>(std::fmin(step, 4294967295.0));
}

void add_source(SceneDescription& description, const CircleSource& source, Random& random) {
    for (std::uint32_t k = 0; k < source.bodies; ++k) {
        BodyStart body;
        body.step = source.step_of(k, description.dt);
        if (body.step >= description.steps) break;
        const SineCosine at = sine_cosine((body.step - source.first_step) * description.dt / source.period);
        const auto q = random.rotation(); // w first
        body.shape = source.shapes[k % source.shapes.size()];
        body.pose =
            btTransform(btQuaternion(btScalar(q[1]), btScalar(q[2]), btScalar(q[3]), btScalar(q[0])),
                        btVector3(btScalar(source.centre.x + source.radius * at.cosine),
                                  btScalar(source.centre.y + source.radius * at.sine), btScalar(source.centre.z)));
        body.velocity =
            btVector3(btScalar(source.velocity.x), btScalar(source.velocity.y), btScalar(source.velocity.z));
        body.density = source.density;
        description.bodies.push_back(body);
    }
    std::stable_sort(description.bodies.begin(), description.bodies.end(),
                     [](const BodyStart& a, const BodyStart& b) { return a.step < b.step; });
}

} // namespace raycontact::scenes
