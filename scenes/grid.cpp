// SPDX-License-Identifier: Apache-2.0
#include <scenes/grid.h>

namespace raycontact::scenes {

std::uint32_t Grid::side() const {
    std::uint32_t n = 1;
    while (static_cast<std::uint64_t>(n) * n * n < places) ++n;
    return n;
}

double Grid::top() const {
    const std::uint32_t layers_below = (places - 1) / (side() * side());
    return bottom + layers_below * spacing;
}

std::vector<btTransform> Grid::poses(Random& random) const {
    const std::uint32_t n = side();
    const double middle = (n - 1) / 2.0;
    std::vector<btTransform> all;
    for (std::uint32_t i = 0; i < places; ++i) {
        const std::uint32_t ix = i % n, iy = (i / n) % n, iz = i / (n * n);
        const double dx = random.symmetric(), dy = random.symmetric();
        const double x = (ix - middle) * spacing + jitter * dx, y = (iy - middle) * spacing + jitter * dy,
                     z = bottom + iz * spacing;
        const auto q = random.tilt(tilt); // w first
        all.emplace_back(btQuaternion(btScalar(q[1]), btScalar(q[2]), btScalar(q[3]), btScalar(q[0])),
                         btVector3(btScalar(x), btScalar(y), btScalar(z)));
    }
    return all;
}

} // namespace raycontact::scenes
