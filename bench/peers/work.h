// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::bench {

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

/// How far pairs move from one step to the next, as a part of the size of the smaller body: any of its vertices, seen
/// from the other body. The size of a body is the largest extent of its box.
struct Pace {
    double median = 0, most = 0;
};
Pace pace(const Work& work);

/// Of the smallest shape that moves, metres.
double body_size(const Work& work);

/// The reduced bunny of that many triangles where it can be made, else a closed bumpy sphere; says which in `source`.
std::shared_ptr<const Shape> bench_mesh(std::uint32_t triangles, std::string& source);

/// A mesh file, its box centred on the origin, largest extent 1 m. Throws InputError as load_mesh does.
std::shared_ptr<const Shape> one_metre_mesh(const std::filesystem::path& file);

struct AvalancheWorkOptions {
    std::uint32_t bodies = 512;
    std::uint32_t first = 200; ///< step
    std::uint32_t steps = 200; ///< from there on
    std::uint32_t stride = 20; ///< see Work
    std::uint64_t seed = 1;
};

/// Steps of the scene avalanche, simulated here and now; its pairs by our own sweep and prune.
Work avalanche_work(const AvalancheWorkOptions& options);

/// The same steps of a recording of any scene, with the pairs that it holds; `bodies` is not looked at. Throws
/// InputError for a file that is none or damaged, or that ends before `first`.
Work recorded_work(const std::filesystem::path& file, const AvalancheWorkOptions& options);

/// A work's bodies in one scene of ours.
std::unique_ptr<Scene> make_scene(const Work& work, const Settings& settings);
/// The default settings but for the method, on one thread.
Settings one_thread(Method method, Caster caster = Caster::bvh, Features features = Features::vertices);
void place(Scene& scene, const WorkStep& step);
/// Before a run over the steps of a work: the scene keeps nothing, as if it had never moved; its arrays stay.
void rest(Scene& scene, const WorkStep& first);

/// Fills in the pairs whose world boxes overlap, by our own sweep and prune: the same list for everyone.
void find_pairs(Work& work);

} // namespace raycontact::bench
