// SPDX-License-Identifier: Apache-2.0
#include <reproduce/plane_test.h>

#include <raycontact/scene.h>
#include <reproduce/plan.h>
#include <scenes/models/machined.h>
#include <scenes/models/trigonometry.h>
#include <scenes/random.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace raycontact::reproduce {

namespace {

/// Evenly distributed over all rotations (Shoemake 1992); no library sine, so the same bits from every compiler.
std::array<double, 9> rotation(scenes::Random& random) {
    const auto unit = [&] { return (random.symmetric() + 1) / 2; };
    const double u = unit(), a = std::sqrt(1 - u), b = std::sqrt(u);
    const auto first = scenes::sine_cosine(unit()), second = scenes::sine_cosine(unit());
    const double x = a * first.sine, y = a * first.cosine, z = b * second.sine, w = b * second.cosine;
    return {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
            2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
}

double lowest(const Shape& shape, const std::array<double, 9>& r) {
    double z = std::numeric_limits<double>::infinity();
    for (const Vec3& v : shape.vertices()) z = std::min(z, r[6] * v.x + r[7] * v.y + r[8] * v.z);
    return z;
}

} // namespace

Deviation plane_deviation(const PlaneTest& test, Direction direction) {
    Settings settings = by_default(Method::standard);
    settings.direction = direction;
    Scene scene(settings);
    // The objects come first, so that a contact's normal points from the object into the plane, and all of a step's
    // orientations are one batch.
    scenes::Random random(1);
    std::vector<Pose> poses(test.orientations);
    std::vector<double> height(test.orientations);
    std::vector<BodyId> bodies;
    std::vector<Pair> pairs;
    for (std::uint32_t k = 0; k < test.orientations; ++k) {
        poses[k].rotation = rotation(random);
        height[k] = -lowest(*test.shape, poses[k].rotation);
        bodies.push_back(scene.add(test.shape, poses[k]));
    }
    // 20 m wide, objects are 1 m; its top is at 0.
    const BodyId plane = scene.add(Shape::make(scenes::solid_box({20, 20, 10})), {.translation = {0, 0, -5}});
    pairs.reserve(bodies.size());
    for (const BodyId body : bodies) pairs.emplace_back(body, plane);
    const Vec3 low = test.shape->box_min(), high = test.shape->box_max();
    const double size = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    Deviation result;
    double ratios = 0;
    for (std::uint32_t d = 1; d <= test.depths; ++d) {
        const double depth = test.depth_part * size * d / test.depths;
        for (std::uint32_t k = 0; k < test.orientations; ++k) {
            poses[k].translation = {0, 0, height[k] - depth};
            scene.set_pose(bodies[k], poses[k]);
        }
        std::vector<Vec3> force(test.orientations); // on the plane
        for (const Contact& contact : scene.find_contacts(pairs)) {
            // Of a spring: nothing moves, so no damper acts. A ratio of forces does not depend on the stiffness.
            const double push = static_cast<double>(contact.weight) * static_cast<double>(contact.depth);
            const Vec3 normal = contact.normal;
            Vec3& of = force[contact.body_a.slot];
            of = {of.x + push * normal.x, of.y + push * normal.y, of.z + push * normal.z};
        }
        for (const Vec3& of : force) {
            if (of.z == 0) continue;
            ratios += std::sqrt(of.x * of.x + of.y * of.y) / std::fabs(of.z);
            ++result.cases;
        }
    }
    if (result.cases > 0) result.percent = 100 * ratios / static_cast<double>(result.cases);
    return result;
}

} // namespace raycontact::reproduce
