// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>
#include <scenes/options.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace raycontact::scenes {

/// A user's own meshes, dropped from a grid like the avalanche, in turn. z is up. The grid is so wide that no body
/// touches another at the start. Where the ground is a mesh its body is the last, above whose middle the grid is.
struct OwnOptions : SceneOptions {
    OwnOptions() { bodies = 64; }
    std::vector<std::filesystem::path> files; ///< meshes that fall, at least one
    std::optional<double> size; ///< longest edge of each mesh's box, metres; as in the file where not given
    std::optional<std::filesystem::path> ground; ///< a mesh as its file places it; without, the avalanche's slab ...
    bool plane = false;                          ///< ... or an endless plane z = 0, whose contacts are not counted
    double density = 1000;                       ///< kg/m^3
    Nesting nesting = Nesting::as_wound;
    std::optional<double> weld; ///< of weld_mesh(), metres, of the meshes as their files have them
};

/// The response's size becomes that of the smallest body. Throws InputError as load_mesh, weld_mesh and centred_shape
/// do.
SceneDescription own(const OwnOptions& options);

} // namespace raycontact::scenes
