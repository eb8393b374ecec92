// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// Of a triangle that goes into no mesh.
constexpr std::uint32_t in_none = 0xffffffffu;

/// A mesh, without a name, of the triangles of each set: `set_of` each triangle, below `count`, or in_none. Triangles
/// keep their order; vertices are numbered as triangles come to them.
std::vector<Mesh> split_mesh(const Mesh& mesh, std::span<const std::uint32_t> set_of, std::size_t count);

} // namespace raycontact
