// SPDX-License-Identifier: Apache-2.0
#include <view/layers.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raycontact::view {

namespace {

using Triple = std::array<double, 3>;

Triple triple(const Vec3& v) {
    return {v.x, v.y, v.z};
}

std::uint16_t part_of(double value, double low, double high) {
    return quantised(high > low ? (value - low) / (high - low) : 0);
}

std::uint16_t octahedral(const Triple& v) {
    const double sum = std::fabs(v[0]) + std::fabs(v[1]) + std::fabs(v[2]);
    if (!(sum > 0)) return 0x8080;
    double x = v[0] / sum, y = v[1] / sum;
    if (v[2] < 0) {
        const double folded = (1 - std::fabs(y)) * (x < 0 ? -1 : 1);
        y = (1 - std::fabs(x)) * (y < 0 ? -1 : 1);
        x = folded;
    }
    const auto byte = [](double a) { return static_cast<unsigned>(std::lround(127.5 + 127.5 * a)) & 255U; };
    return static_cast<std::uint16_t>(byte(x) | byte(y) << 8);
}

std::uint32_t device_of(const Scene& scene, BodyId a, BodyId b) {
    const auto pairs = scene.pairs();
    const auto at = std::ranges::lower_bound(pairs, Pair(a, b));
    return scene.device_of_pair(static_cast<std::size_t>(at - pairs.begin()));
}

} // namespace

LayerStep read_layer(const Scene& scene, std::uint32_t step) {
    LayerStep layer{step, {}, {}};
    const auto start = [&](const auto& found, const Vec3& point) {
        const BodyId body = found.feature.source == Side::a ? found.body_a : found.body_b;
        Segment segment;
        segment.device = device_of(scene, found.body_a, found.body_b);
        segment.point = triple(point);
        return std::pair(segment, body);
    };
    const auto outward = [&](BodyId body, std::uint32_t vertex) {
        const Shape& shape = scene.shape(body);
        const auto at = std::ranges::lower_bound(shape.vertex_index(), vertex); // ascending
        const Vec3& normal = shape.vertex_normals()[static_cast<std::size_t>(at - shape.vertex_index().begin())];
        return triple(transform_point({scene.pose(body).rotation, {}}, normal));
    };
    for (const Contact& contact : scene.contacts()) {
        auto [segment, body] = start(contact, contact.point());
        segment.normal = triple(contact.normal);
        // A vertex's ray goes inward; the others' goes along the normal, the way out.
        const bool inward =
            contact.feature.kind == FeatureKind::vertex || contact.feature.kind == FeatureKind::vertex_face;
        segment.direction = inward ? outward(body, contact.feature.source_index()) : segment.normal;
        if (inward || contact.feature.source == Side::a)
            for (double& part : segment.direction) part = -part;
        segment.length = double(contact.ray_length);
        segment.depth = double(contact.depth);
        layer.contacts.push_back(segment);
    }
    for (const Prediction& prediction : scene.predictions()) {
        auto [segment, body] = start(prediction, prediction.point);
        segment.direction = outward(body, prediction.feature.source_index());
        const Triple ahead = triple(prediction.ahead);
        for (std::size_t i = 0; i < 3; ++i) segment.length += (ahead[i] - segment.point[i]) * segment.direction[i];
        segment.length = std::max(segment.length, 0.0); // a little behind, where a walk passed an edge
        layer.predictions.push_back(segment);
    }
    return layer;
}

void Found::add(const Scene& scene, bool with_layer) {
    if (with_layer) layers.push_back(read_layer(scene, static_cast<std::uint32_t>(pairs.size())));
    const StepStats& stats = scene.stats();
    pairs.push_back(stats.pairs);
    contacts.push_back(stats.contacts);
    depths.push_back(stats.depth_max);
    for (std::size_t k = devices.size(); k < stats.details.work.size(); ++k)
        devices.push_back(stats.details.work[k].device);
}

LayerScale scale_of(const std::vector<LayerStep>& steps) {
    constexpr double far = std::numeric_limits<double>::infinity();
    LayerScale scale;
    scale.low.fill(far);
    scale.high.fill(-far);
    for (const LayerStep& step : steps)
        for (const auto* segments : {&step.contacts, &step.predictions})
            for (const Segment& segment : *segments) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    scale.low[axis] = std::min(scale.low[axis], segment.point[axis]);
                    scale.high[axis] = std::max(scale.high[axis], segment.point[axis]);
                }
                scale.length = std::max(scale.length, segment.length);
                scale.depth = std::max(scale.depth, segment.depth);
            }
    if (!(scale.low[0] <= scale.high[0])) scale.low = scale.high = {};
    return scale;
}

Bytes columns(const std::vector<Segment>& segments, const LayerScale& scale, bool contacts) {
    Bytes bytes;
    const auto column = [&](auto number_of) {
        std::vector<std::uint16_t> numbers;
        numbers.reserve(segments.size());
        for (const Segment& segment : segments) numbers.push_back(number_of(segment));
        const Bytes split = split_bytes(numbers);
        bytes.insert(bytes.end(), split.begin(), split.end());
    };
    column([](const Segment& s) { return static_cast<std::uint16_t>(s.device); });
    for (std::size_t axis = 0; axis < 3; ++axis)
        column([&](const Segment& s) { return part_of(s.point[axis], scale.low[axis], scale.high[axis]); });
    column([](const Segment& s) { return octahedral(s.direction); });
    column([&](const Segment& s) { return part_of(s.length, 0, scale.length); });
    if (!contacts) return bytes;
    column([](const Segment& s) { return octahedral(s.normal); });
    column([&](const Segment& s) { return part_of(s.depth, 0, scale.depth); });
    return bytes;
}

} // namespace raycontact::view
