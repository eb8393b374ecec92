// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/gltf_file.h"
#include "mesh/placement.h"

#include <vector>

namespace raycontact {

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
