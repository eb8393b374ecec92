// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <view/blob.h>

#include <raycontact/scene.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace raycontact::view {

/// What is drawn of one contact or prediction; world frame, metres.
struct Segment {
    std::uint32_t device = 0;          ///< entry of StepStats::work
    std::array<double, 3> point{};     ///< the vertex
    std::array<double, 3> direction{}; ///< unit: of the ray; of a prediction: ahead, against the ray
    double length = 0;                 ///< from the vertex to the hit, or to the face ahead
    std::array<double, 3> normal{};    ///< unit, from body A to body B; contacts only
    double depth = 0;                  ///< contacts only
};

/// The contacts and predictions of one step.
struct LayerStep {
    std::uint32_t step = 0;
    std::vector<Segment> contacts, predictions;
};

/// Of the step that the scene has just done.
LayerStep read_layer(const Scene& scene, std::uint32_t step);

/// What the steps of a run found.
struct Found {
    std::vector<LayerStep> layers;              ///< of some steps
    std::vector<std::uint64_t> pairs, contacts; ///< by step
    std::vector<double> depths;                 ///< of the deepest contact of each step, metres
    std::vector<std::string> devices;

    /// The step that the scene has just done, which is the next one.
    void add(const Scene& scene, bool with_layer);
};

/// Over what the 16 bits of a number are spread.
struct LayerScale {
    std::array<double, 3> low{}, high{}; ///< of points, metres
    double length = 0, depth = 0;        ///< the largest, metres
};
LayerScale scale_of(const std::vector<LayerStep>& steps);

/// Columns of 16 bits for the page, one after another, each split into lower and upper bytes: device, x, y, z,
/// direction, length; of contacts also normal and depth. Directions are two bytes on an octahedron (Meyer et al. 2010).
Bytes columns(const std::vector<Segment>& segments, const LayerScale& scale, bool contacts);

} // namespace raycontact::view
