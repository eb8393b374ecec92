// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/gltf_file.h"
#include "mesh/placement.h"

#include <span>
#include <vector>

namespace raycontact {

// Morph targets (glTF 2.0, section 3.7.2.2): lists of displacements, each added to the vertices as often as its weight.

/// The node's weights of the targets of its mesh, else the mesh's; none where neither has any.
std::vector<double> morph_weights(const GltfFile& file, const GltfFile::Item& node, const GltfFile::Item& mesh);

/// Moves the positions of a primitive, three numbers each. `weights`: of its targets, or none.
void add_morph_targets(const GltfFile& file, const GltfFile::Item& primitive, std::span<const double> weights,
                       std::span<double> positions);

/// A skin in the pose that its file has (glTF 2.0, section 3.7.3): joints place the vertices of a mesh, in place of the
/// node that holds it.
class GltfSkin {
public:
    /// `joints`: where the scene has them.
    GltfSkin(const GltfFile& file, const GltfFile::Item& skin, std::vector<Placement> joints);

    /// From the frame of a mesh to the scene, for each vertex of a primitive with these attributes.
    std::vector<Placement> placements(const GltfFile& file, const GltfFile::Item& attributes,
                                      std::size_t vertices) const;

private:
    std::vector<Placement> joints_; ///< from the frame of a mesh to the scene
};

} // namespace raycontact
