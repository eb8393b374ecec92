// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/peers/work.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace raycontact::bench {

using namespace peers;

/// How far pairs move from one step to the next, as a part of the size of the smaller body: any of its vertices, seen
/// from the other body. The size of a body is the largest extent of its box.
struct Pace {
    double median = 0, most = 0;
};
Pace pace(const Work& work);

/// The reduced bunny of that many triangles where it can be made, else a closed bumpy sphere; says which in `source`.
std::shared_ptr<const Shape> bench_mesh(std::uint32_t triangles, std::string& source);

/// A mesh file, its box centred on the origin, largest extent 1 m. Throws InputError as load_mesh does.
std::shared_ptr<const Shape> one_metre_mesh(const std::filesystem::path& file);

struct AvalancheWorkOptions {
    std::uint32_t bodies = 512;
    std::uint32_t first = 200; ///< step
    std::uint32_t steps = 200; ///< from there on
    std::uint32_t stride = 20; ///< see Work
};

/// Steps of the scene avalanche, simulated here and now; its pairs by our own broad phase.
Work avalanche_work(const AvalancheWorkOptions& options);

/// The same steps of a recording of any scene, with the pairs that it holds; `bodies` is not looked at. Throws
/// InputError for a file that is none or damaged, or that ends before `first`.
Work recorded_work(const std::filesystem::path& file, const AvalancheWorkOptions& options);

} // namespace raycontact::bench
