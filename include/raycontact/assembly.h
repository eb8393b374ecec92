// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/mesh.h>
#include <raycontact/pose.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace raycontact {

/// A part of an assembly. Parts that are the same mesh in several places share it.
struct AssemblyPart {
    std::string name;                 ///< of its node, "nodes[3]" without, object, group or solid; or of its file
    std::shared_ptr<const Mesh> mesh; ///< metres, in the part's own frame, scaled as the file scales it
    Pose pose;                        ///< of that frame in the assembly; of a mesh with a skin the identity
    std::string file{};               ///< that it is from
    /// Number of the part that its node is under, the nearest one; no_part where there is none.
    std::size_t parent = no_part;
    static constexpr std::size_t no_part = static_cast<std::size_t>(-1); ///< the number of none
    /// Names of the nodes, of 3MF the objects, that it is under, with a mesh or without, from the root; of names of
    /// more than 1024 bytes in all the nearest ones.
    std::vector<std::string> under{};
};

/// What a part is under, and its name, with "/" between: "Building/Floor 2/Pipe 7".
RAYCONTACT_API std::string path_of(const AssemblyPart& part);

/// Of a glTF file each node of its scene that places a mesh, in node order; an instance of a node is "NODE[3]". Of a
/// 3MF file each object with a mesh as often as its build places it. Of an OBJ file its objects (`o`) if there are
/// several, else its groups (`g`); of an STL file its solids; of any other file its one mesh. Objects, groups and
/// solids that are patches of one surface, open along an edge that they share, are one part; so what is closed by
/// itself is a part of its own. split_components() (clash.h) splits parts further. Indices of a part's vertices and
/// triangles begin at 0; those of objects, groups and solids are numbered as their triangles come to them. left_out:
/// becomes what was left out or mended, in words that name it. Throws InputError as load_mesh().
RAYCONTACT_API std::vector<AssemblyPart> load_assembly(const std::filesystem::path& file,
                                                       std::vector<std::string>* left_out = nullptr);

} // namespace raycontact
