// SPDX-License-Identifier: Apache-2.0
// A small box a little way into a large one: what its contacts look like is known.
#include "reference/meshes.h"

#include <view/layers.h>

#include <cmath>
#include <gtest/gtest.h>

namespace raycontact::view {
namespace {

constexpr double into = 0.01;

LayerStep layer_of(Method method) {
    Settings settings;
    settings.method = method;
    settings.execution.threads = 1;
    Scene scene(settings);
    scene.add(Shape::make(reference::box_mesh({2, 2, 1})));
    Pose pose;
    pose.translation = {0.3, 0.2, 1.25 - into};
    scene.add(Shape::make(reference::box_mesh({0.25, 0.25, 0.25})), pose);
    scene.find_contacts();
    return read_layer(scene, 3);
}

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

TEST(Layers, RaysGoFromVertexToHit) {
    const LayerStep layer = layer_of(Method::standard);
    EXPECT_EQ(layer.step, 3u);
    ASSERT_EQ(layer.contacts.size(), 4u); // the lower corners
    for (const Segment& contact : layer.contacts) {
        EXPECT_NEAR(contact.point[2], 1 - into, 1e-6);
        EXPECT_NEAR(dot(contact.direction, contact.direction), 1, 1e-9);
        EXPECT_NEAR(contact.point[2] + contact.length * contact.direction[2], 1, 1e-6); // the hit is on the large box
        EXPECT_NEAR(contact.normal[2], 1, 1e-6);                                        // from A, below, to B
        EXPECT_NEAR(contact.depth, into, 1e-6);
    }
}

std::uint16_t word(const Bytes& bytes, std::size_t column, std::size_t count, std::size_t i) {
    const std::size_t at = 2 * column * count + i;
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + count] << 8);
}

// As view/page/decode.js does it.
std::array<double, 3> direction(std::uint16_t word) {
    double x = (word & 255) / 127.5 - 1, y = (word >> 8) / 127.5 - 1;
    const double z = 1 - std::fabs(x) - std::fabs(y);
    if (z < 0) {
        const double folded = (1 - std::fabs(y)) * (x < 0 ? -1 : 1);
        y = (1 - std::fabs(x)) * (y < 0 ? -1 : 1);
        x = folded;
    }
    const double length = std::sqrt(x * x + y * y + z * z);
    return {x / length, y / length, z / length};
}

TEST(Layers, ColumnsCanBeReadAgain) {
    const LayerStep layer = layer_of(Method::standard);
    const LayerScale scale = scale_of({layer});
    const std::size_t count = layer.contacts.size();
    const Bytes bytes = columns(layer.contacts, scale, true);
    ASSERT_EQ(bytes.size(), 2 * 8 * count);
    for (std::size_t i = 0; i < count; ++i) {
        const Segment& contact = layer.contacts[i];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double extent = scale.high[axis] - scale.low[axis];
            EXPECT_NEAR(scale.low[axis] + word(bytes, 1 + axis, count, i) / 65535.0 * extent, contact.point[axis],
                        extent / 65535 + 1e-12);
        }
        EXPECT_GT(dot(direction(word(bytes, 4, count, i)), contact.direction), 0.9999);
        EXPECT_NEAR(word(bytes, 5, count, i) / 65535.0 * scale.length, contact.length, scale.length / 65535);
        EXPECT_GT(dot(direction(word(bytes, 6, count, i)), contact.normal), 0.9999);
        EXPECT_NEAR(word(bytes, 7, count, i) / 65535.0 * scale.depth, contact.depth, scale.depth / 65535);
    }
}

TEST(Layers, DirectionsOfAllEightSidesKeepTheirWay) {
    std::vector<Segment> segments;
    for (const double x : {-1.0, 0.0, 0.3, 1.0})
        for (const double y : {-1.0, 0.0, 0.5, 1.0})
            for (const double z : {-1.0, -0.2, 0.7, 1.0}) {
                const double length = std::sqrt(x * x + y * y + z * z);
                Segment segment;
                segment.direction = {x / length, y / length, z / length};
                segments.push_back(segment);
            }
    const Bytes bytes = columns(segments, scale_of({}), false);
    for (std::size_t i = 0; i < segments.size(); ++i)
        EXPECT_GT(dot(direction(word(bytes, 4, segments.size(), i)), segments[i].direction), 0.9998) << i;
}

TEST(Layers, PredictionsReachTheFaceAhead) {
    Settings settings;
    settings.method = Method::predictive;
    settings.paper.displacement_threshold = 0.05;
    settings.execution.threads = 1;
    Scene scene(settings);
    scene.add(Shape::make(reference::box_mesh({2, 2, 1})));
    Pose pose;
    pose.translation = {0.3, 0.2, 1.25 + 0.02}; // just above
    scene.add(Shape::make(reference::box_mesh({0.25, 0.25, 0.25})), pose);
    scene.find_contacts(std::vector<Pair>{{BodyId{0}, BodyId{1}}});
    const LayerStep layer = read_layer(scene, 0);
    EXPECT_TRUE(layer.contacts.empty());
    ASSERT_EQ(layer.predictions.size(), 4u);
    for (const Segment& p : layer.predictions) EXPECT_NEAR(p.point[2] + p.length * p.direction[2], 1, 1e-6);
}

} // namespace
} // namespace raycontact::view
