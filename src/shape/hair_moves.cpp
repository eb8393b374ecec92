// SPDX-License-Identifier: Apache-2.0
#include "mesh/vector.h"
#include "shape/build.h"

namespace raycontact {

namespace {

// Each component in [-1, 1), by splitmix64.
Vec3 shaken(std::uint64_t vertex) {
    std::uint64_t state = vertex;
    const auto next = [&state] {
        std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
    };
    const double x = next(), y = next();
    return {x, y, next()};
}

} // namespace

void find_hair_moves(ShapeData& shape) {
    shape.hair_moves.resize(shape.points.size());
    for (std::uint32_t v = 0; v < shape.points.size(); ++v)
        shape.hair_moves[v] = 0.01 * shaken(v) - shape.vertex_normals[v];
}

} // namespace raycontact
