// SPDX-License-Identifier: Apache-2.0
#include "bench/instructions/batch.h"

#include "scenes/models/model.h"
#include "scenes/random.h"
#include "shape/shape_data.h"

#include <array>
#include <cmath>

namespace raycontact::bench {

namespace {

using Matrix = std::array<double, 9>;

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            c[3 * i + j] = (a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j]) + a[3 * i + 2] * b[6 + j];
    return c;
}

} // namespace

Batch make_batch(std::uint32_t triangles, std::size_t pairs, std::size_t steps) {
    Batch batch;
    batch.mesh = scenes::scene_model("knot", triangles).mesh;
    batch.shape = Shape::make(batch.mesh);
    batch.shape->prepare();
    const double diagonal = batch.shape->data().diagonal;
    scenes::Random random(7);
    std::vector<PlacedBody> bodies;
    for (std::size_t i = 0; i < 2 * pairs; ++i) {
        double at[3], turn[4];
        for (double& x : at) x = 0.35 * diagonal * random.symmetric();
        for (double& x : turn) x = random.symmetric();
        PlacedBody& body = bodies.emplace_back();
        body.shape = batch.shape.get();
        body.pose = pose_from_quaternion({at[0], at[1], at[2]}, turn[0], turn[1], turn[2], turn[3]);
    }
    for (BodySlot i = 0; i < 2 * pairs; i += 2) batch.pairs.emplace_back(i, i + 1);

    std::vector<Pose> ways; // a step's
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const double share = 0.0001 * static_cast<double>(1u << 2 * (i / 2 % 4));
        const auto shift = [&] { return share * diagonal * random.symmetric(); };
        const double x = shift(), y = shift(), z = shift();
        const std::array<double, 4> turn = random.tilt(2 * share);
        ways.push_back(pose_from_quaternion({x, y, z}, turn[0], turn[1], turn[2], turn[3]));
    }
    for (std::size_t step = 0; step < steps; ++step) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            Pose& pose = bodies[i].pose;
            const Vec3 &at = pose.translation, &way = ways[i].translation;
            if (step > 0) pose = {product(pose.rotation, ways[i].rotation), {at.x + way.x, at.y + way.y, at.z + way.z}};
            bodies[i].centred = centred_pose(*batch.shape, pose);
        }
        batch.steps.push_back(bodies);
    }
    return batch;
}

std::vector<WorldBox> make_boxes(std::size_t count) {
    // Two unit cubes overlap when their middles are less than 1 apart on every axis: a volume of 8.
    const double half = 0.5 * std::cbrt(8.0 * static_cast<double>(count) / 3);
    scenes::Random random(11);
    std::vector<WorldBox> boxes;
    for (BodySlot i = 0; i < count; ++i) {
        const double x = half * random.symmetric(), y = half * random.symmetric(), z = half * random.symmetric();
        boxes.push_back({{{x - 0.5, y - 0.5, z - 0.5}, {x + 0.5, y + 0.5, z + 0.5}}, i});
    }
    return boxes;
}

} // namespace raycontact::bench
