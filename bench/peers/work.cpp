// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/work.h>

#include <raycontact/error.h>
#include <recording/reader.h>
#include <scenes/avalanche.h>
#include <scenes/models/model.h>
#include <scenes/peers/clock.h>
#include <scenes/random.h>
#include <scenes/simulation.h>

#include "pairs/directed_pairs.h"
#include "pairs/displacement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace raycontact::bench {

namespace {

double size_of(const Shape& shape) {
    const Vec3 low = shape.box_min(), high = shape.box_max();
    return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

} // namespace

Pace pace(const Work& work) {
    std::vector<double> moved;
    for (std::size_t k = 1; k < work.steps.size(); ++k) {
        const WorkStep &before = work.steps[k - 1], &now = work.steps[k];
        for (const Pair& pair : now.pairs) {
            if (!std::binary_search(before.pairs.begin(), before.pairs.end(), pair)) continue;
            const Shape &a = work.shape(pair.first.slot), &b = work.shape(pair.second.slot);
            const bool a_is_smaller = size_of(a) <= size_of(b);
            const Shape& small = a_is_smaller ? a : b;
            const auto [own, other] = a_is_smaller ? std::pair(pair.first.slot, pair.second.slot)
                                                   : std::pair(pair.second.slot, pair.first.slot);
            moved.push_back(displacement_bound(relative_pose(before.poses[other], before.poses[own]),
                                               relative_pose(now.poses[other], now.poses[own]), small.radius(), 0)
                            / size_of(small));
        }
    }
    if (moved.empty()) return {};
    return {median(moved), *std::max_element(moved.begin(), moved.end())};
}

std::shared_ptr<const Shape> bench_mesh(std::uint32_t triangles, std::string& source) {
    scenes::Model model = scenes::scene_model("bunny", triangles);
    // The usual stand-in has a hole, and so half a percent fewer vertices for its triangles.
    if (model.stand_in) model = scenes::scene_model("sphere", triangles);
    source = model.source;
    return Shape::make(model.mesh);
}

std::shared_ptr<const Shape> one_metre_mesh(const std::filesystem::path& file) {
    Mesh mesh = load_mesh(file);
    Vec3 low = mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices) {
        low = {std::fmin(low.x, v.x), std::fmin(low.y, v.y), std::fmin(low.z, v.z)};
        high = {std::fmax(high.x, v.x), std::fmax(high.y, v.y), std::fmax(high.z, v.z)};
    }
    const double extent = std::fmax(high.x - low.x, std::fmax(high.y - low.y, high.z - low.z));
    if (!(extent > 0)) throw InputError(file.string() + ": all vertices are in one place; give a mesh with an area");
    for (Vec3& v : mesh.vertices)
        v = {(v.x - (low.x + high.x) / 2) / extent, (v.y - (low.y + high.y) / 2) / extent,
             (v.z - (low.z + high.z) / 2) / extent};
    return Shape::make(mesh);
}

Work avalanche_work(const AvalancheWorkOptions& options) {
    scenes::SceneOptions how;
    how.bodies = options.bodies;
    how.settings.speculative = Speculative::off; // what the peers find, too, is in each other
    scenes::Simulation scene(scenes::avalanche(how));
    Work work;
    work.name = "avalanche";
    const scenes::RunLog& log = scene.log();
    work.shapes = log.shapes;
    work.body_shape = log.body_shape;
    work.source = std::to_string(options.bodies) + " bodies and the ground, steps " + std::to_string(options.first)
                  + " to " + std::to_string(options.first + options.steps - 1) + " of the avalanche" + "; "
                  + log.mesh_source;
    work.stride = options.stride;
    for (std::uint32_t k = 0; k < options.first + options.steps; ++k) {
        if (k >= options.first) {
            // Bullet detects at the poses a step begins with.
            WorkStep& step = work.steps.emplace_back();
            step.poses = scene.poses();
        }
        scene.step();
    }
    find_pairs(work);
    return work;
}

Work recorded_work(const std::filesystem::path& file, const AvalancheWorkOptions& options) {
    recording::Reader reader(file);
    if (reader.steps() <= options.first)
        throw InputError(file.string() + ": holds " + std::to_string(reader.steps())
                         + " steps; ask for an earlier one with --avalanche-first");
    Work work;
    work.name = "avalanche";
    work.shapes = reader.shapes();
    for (const recording::Body& body : reader.bodies()) work.body_shape.push_back(body.shape);
    const std::uint32_t end = std::min(reader.steps(), options.first + options.steps);
    work.source = "recording of " + reader.info().scene + ", " + std::to_string(work.body_shape.size())
                  + " bodies, steps " + std::to_string(options.first) + " to " + std::to_string(end - 1) + "; "
                  + reader.info().mesh_source;
    work.stride = options.stride;
    std::vector<Pose> poses;
    std::vector<Pair> pairs;
    std::map<BodyId, BodyId> body_of; ///< of ids in the recorded scene
    for (std::uint32_t k = options.first; k < end; ++k) {
        WorkStep& step = work.steps.emplace_back();
        reader.read_step(k, poses, pairs);
        // Here every body keeps the place it has in the recording; one that is not there has no pair.
        step.poses.resize(reader.bodies().size());
        for (std::uint32_t body = 0; body < step.poses.size(); ++body) {
            const recording::Body& recorded = reader.bodies()[body];
            if (!recorded.alive(k)) continue;
            step.poses[body] = poses[recorded.id.slot];
            body_of[recorded.id] = {body, 0};
        }
        for (const auto& [a, b] : pairs) {
            const auto [first, second] = std::minmax(body_of.at(a), body_of.at(b));
            step.pairs.emplace_back(first, second);
        }
        std::sort(step.pairs.begin(), step.pairs.end());
    }
    return work;
}

} // namespace raycontact::bench
