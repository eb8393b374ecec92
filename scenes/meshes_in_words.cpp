// SPDX-License-Identifier: Apache-2.0
#include <scenes/meshes_in_words.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace raycontact::scenes {

namespace {

/// Each mesh of the moving, or of the resting, bodies that come within the planned steps, and how many there are.
std::vector<std::pair<std::string, std::size_t>> kinds_of(const SceneDescription& scene, bool moving) {
    std::vector<std::pair<std::string, std::size_t>> kinds;
    for (std::size_t k = 0; k < scene.shapes.size(); ++k) {
        const auto count = std::count_if(scene.bodies.begin(), scene.bodies.end(), [&](const BodyStart& body) {
            return body.shape == k && (body.density > 0) == moving && body.step < scene.steps;
        });
        if (count > 0 && !scene.shapes[k].source.empty()) kinds.emplace_back(scene.shapes[k].source, count);
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
