// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/gltf_file.h"
#include "mesh/vector.h"

#include <span>
#include <vector>

namespace raycontact {

/// An affine map: where the axes and the origin go.
struct Placement {
    Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin;

    /// Of a matrix of 4 x 4 by columns, whose last row is taken for 0 0 0 1.
    static Placement of_matrix(std::span<const double> m) {
        return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
    }
    Vec3 turned(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
    Vec3 placed(const Vec3& p) const { return turned(p) + origin; }
    Placement after(const Placement& inner) const {
        return {turned(inner.x), turned(inner.y), turned(inner.z), placed(inner.origin)};
    }
    bool mirrors() const { return dot({x.x, y.x, z.x}, cross({x.y, y.y, z.y}, {x.z, y.z, z.z})) < 0; }
};

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
