// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::peers {

/// Poses of all bodies, and the pairs whose world boxes overlap there.
struct WorkStep {
    std::vector<Pose> poses;
    std::vector<Pair> pairs;
};

/// Poses and pairs fixed beforehand: the same question for everyone.
struct Work {
    std::string name;   ///< as in --works
    std::string source; ///< what it is made of, for a person
    std::vector<std::shared_ptr<const Shape>> shapes;
    std::vector<std::uint32_t> body_shape; ///< index into shapes, per body
    std::vector<WorkStep> steps;           ///< one after the other, as a simulation goes
    std::uint32_t stride = 1; ///< of these, every how many are given to those who keep nothing and are slow

    const Shape& shape(std::uint32_t body) const { return *shapes[body_shape[body]]; }
    std::uint64_t pair_steps() const;
};

/// A work's bodies in one scene of ours.
std::unique_ptr<Scene> make_scene(const Work& work, const Settings& settings);
/// The default settings but for the method, on one thread.
Settings one_thread(Method method, Caster caster = Caster::bvh, Features features = Features::vertices);
void place(Scene& scene, const WorkStep& step);
/// Before a run over the steps of a work: the scene keeps nothing, as if it had never moved; its arrays stay.
void rest(Scene& scene, const WorkStep& first);

/// Fills in the pairs whose world boxes overlap, by our own broad phase: the same list for everyone.
void find_pairs(Work& work);

} // namespace raycontact::peers
