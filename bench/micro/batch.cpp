// SPDX-License-Identifier: Apache-2.0
#include "bench/micro/batch.h"

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

Batch make_batch(std::uint32_t triangles, std::size_t pairs) {
    Batch batch;
    batch.name = "knot_" + std::to_string(triangles);
    batch.mesh = scenes::scene_model("knot", triangles).mesh;
    batch.shape = Shape::make(batch.mesh);
    const double apart = 0.35 * batch.shape->data().diagonal;
    scenes::Random random(7);
    for (std::size_t i = 0; i < 2 * pairs; ++i) {
        double at[3], turn[4];
        for (double& x : at) x = apart * random.symmetric();
        for (double& x : turn) x = random.symmetric();
        PlacedBody& body = batch.bodies.emplace_back();
        body.shape = batch.shape.get();
        body.pose = pose_from_quaternion({at[0], at[1], at[2]}, turn[0], turn[1], turn[2], turn[3]);
        body.centred = body.pose;
        body.centred.translation = transform_point(body.pose, batch.shape->centre());
    }
    for (BodySlot i = 0; i < 2 * pairs; i += 2) batch.pairs.emplace_back(i, i + 1);
    Executor executor(1);
    order_pairs(executor, batch.bodies, batch.pairs, batch.ordered);
    std::vector<PlacedBody> later = batch.bodies;
    for (PlacedBody& body : later) {
        const double step = 0.003 * batch.shape->data().diagonal;
        const Vec3 shift{step * random.symmetric(), step * random.symmetric(), step * random.symmetric()};
        const std::array<double, 4> turn = random.tilt(0.006);
        Pose small = pose_from_quaternion({}, turn[0], turn[1], turn[2], turn[3]);
        body.centred.rotation = product(body.centred.rotation, small.rotation);
        body.centred.translation = {body.centred.translation.x + shift.x, body.centred.translation.y + shift.y,
                                    body.centred.translation.z + shift.z};
    }
    order_pairs(executor, later, batch.pairs, batch.moved);
    return batch;
}

std::vector<WorldBox> make_boxes(std::size_t count) {
    // Two unit cubes overlap when their middles are less than 1 apart on every axis: a volume of 8.
    const double half = 0.5 * std::cbrt(8.0 * static_cast<double>(count) / 3);
    scenes::Random random(11);
    std::vector<WorldBox> boxes;
    for (BodySlot i = 0; i < count; ++i) {
        const double x = half * random.symmetric(), y = half * random.symmetric(), z = half * random.symmetric();
        boxes.push_back({i, {x - 0.5, y - 0.5, z - 0.5}, {x + 0.5, y + 0.5, z + 0.5}});
    }
    return boxes;
}

} // namespace raycontact::bench
