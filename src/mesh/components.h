// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace raycontact {

/// The solids and sheets that a mesh is made of.
struct Components {
    std::uint32_t count = 0;
    std::vector<std::uint32_t> of; ///< by triangle; in_none of those that a repair drops
};

/// After the repairs of prepare_mesh(): what is closed by itself, with its cavities, is a component, whatever it
/// touches; what is open hangs together over shared vertices. By their lowest triangles. nullopt where the cavities
/// would take too long to find. Throws InputError as prepare_mesh().
std::optional<Components> find_components(const Mesh& mesh, std::uint32_t threads);

} // namespace raycontact
