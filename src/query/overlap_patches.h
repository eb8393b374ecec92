// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/inner_surfaces.h"
#include "edges/loops.h"
#include "query/shadow.h"
#include "query/shape_pair.h"

#include <array>
#include <map>
#include <span>
#include <vector>

namespace raycontact {

/// Follows all loops of a pair.
void follow_all(const PairMeshes& meshes, const ShapePair& pair, Loops& loops);

/// What lies between a face of a and a face of b, inside both, along the normal of their patch.
struct FaceOverlap {
    std::array<std::uint32_t, 2> faces;
    std::uint32_t patch;
    double area;   ///< across the normal, m^2
    double volume; ///< m^3
    Vec3 middle;   ///< of the volume, b's centred frame
};

/// Where a part of the one surface lies over one of the other (docs/internals/patches.md).
struct OverlapPatch {
    std::array<std::uint32_t, 2> parts; ///< of a and of b
    Vec3 normal;                        ///< from a to b, unit, b's centred frame
    std::uint32_t region;               ///< of the faces on both sides
    std::vector<Vec3> hull;             ///< ContactPatch::hull, in the plane through that frame's origin; if asked for
};

/// What two closed bodies share, as patches of pressure. Keeps nothing but memory from one pair to the next.
class OverlapPatches {
public:
    /// Whether the surfaces cross, and in closed loops alone. Both bodies have an inside. of_file: as of PairMeshes.
    bool find(const PlacedBody& a, const PlacedBody& b, bool of_file, bool hulls = false);
    std::span<const FaceOverlap> faces() const { return overlaps_; } ///< sorted by faces, of a first
    std::span<const OverlapPatch> patches() const { return patches_; }
    const InnerSurfaces& surfaces() const { return surfaces_; }

private:
    using Parts = std::array<std::uint32_t, 2>; ///< of a and b

    /// Vector areas of two parts that lie over each other, m^2, and the sums of their lengths, as seen along that of
    /// either.
    struct Covered {
        std::array<std::array<Vec3, 2>, 2> areas{}; ///< by the part along which they are seen, by the part
        std::uint32_t region = 0;
    };
    /// A part as a whole.
    struct Part {
        Vec3 area;             ///< vector area, m^2
        double size = 0;       ///< the sum of its faces' areas
        std::uint32_t met = 0; ///< how many parts of the other side lie over it
        double flatness() const { return size > 0 ? length(area) / size : 0; }
    };
    void look_along(const PairMeshes& pair, std::size_t side, std::uint32_t part);
    Vec3 normal_of(const Parts& parts, const Covered& covered) const;
    void list_overlaps(const PairMeshes& pair, const Parts& parts, const Covered& covered);
    void list_by_part();
    void leave_out_pierced();
    std::span<const std::uint32_t> faces_of(std::uint32_t part) const {
        return std::span(by_part_).subspan(part_first_[part], part_first_[part + 1] - part_first_[part]);
    }

    bool hulls_ = false;
    Loops loops_;
    EdgePieces pieces_;
    InnerSurfaces surfaces_;
    std::vector<std::uint32_t> by_part_, part_first_; ///< places of the inner faces of one side or the other
    std::vector<Part> parts_;
    std::map<Parts, Covered> covered_;
    std::vector<FaceOverlap> overlaps_;
    std::vector<OverlapPatch> patches_;
};

} // namespace raycontact
