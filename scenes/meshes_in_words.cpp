// SPDX-License-Identifier: Apache-2.0
#include <scenes/meshes_in_words.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace raycontact::scenes {

namespace {

/// Tells one file in two sizes apart.
std::string with_size(const SceneShape& shape) {
    const Vec3 low = shape.shape->box_min(), high = shape.shape->box_max();
    return fmt::format("{}, {:.3g} m long", shape.source, std::max({high.x - low.x, high.y - low.y, high.z - low.z}));
}

/// Each mesh of the moving, or of the resting, bodies that come within the planned steps, and how many there are.
std::vector<std::pair<std::string, std::size_t>> kinds_of(const SceneDescription& scene, bool moving) {
    std::vector<std::pair<std::string, std::size_t>> kinds;
    for (std::size_t k = 0; k < scene.shapes.size(); ++k) {
        const auto count = std::count_if(scene.bodies.begin(), scene.bodies.end(), [&](const BodyStart& body) {
            return body.shape == k && (body.density > 0) == moving && body.step < scene.steps;
        });
        const SceneShape& shape = scene.shapes[k];
        if (count == 0 || shape.source.empty()) continue;
        const bool alone = std::ranges::count(scene.shapes, shape.source, &SceneShape::source) == 1;
        kinds.emplace_back(alone ? shape.source : with_size(shape), count);
    }
    return kinds;
}

std::string listed(const std::vector<std::pair<std::string, std::size_t>>& kinds, bool always_counted) {
    if (kinds.size() == 1 && !always_counted) return kinds.front().first;
    std::string text;
    for (const auto& [source, count] : kinds)
        text += (text.empty() ? "" : "; ") + std::to_string(count) + " x " + source;
    return text;
}

} // namespace

std::string meshes_in_words(const SceneDescription& scene) {
    std::string text = listed(kinds_of(scene, true), false);
    const std::string resting = listed(kinds_of(scene, false), true);
    if (!resting.empty()) text += (text.empty() ? "" : "; ") + ("standing still: " + resting);
    return text;
}

std::string mesh_in_words(const std::string& name, const Shape& shape) {
    return name + " (" + std::to_string(shape.vertices().size()) + " vertices and "
           + std::to_string(shape.triangles().size()) + " triangles)";
}

} // namespace raycontact::scenes
