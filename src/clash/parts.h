// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "broadphase/broad_phase.h"

#include <raycontact/clash.h>

#include <memory>

namespace raycontact::clash {

/// One part of an assembly, where its file places it.
struct Part {
    std::shared_ptr<const Mesh> mesh;
    Pose pose;
    std::shared_ptr<const Shape> shape; ///< null: not made, as no box of another part touches its own
    std::string fault;                  ///< why it cannot be tested; empty: it can
};

/// Throws InputError as find_clashes(), but for names.
void check_assembly(std::span<const AssemblyPart> parts, const ClashOptions& options);

/// The diagonal of the smaller part's box, metres. Both have shapes.
double smaller_size(const Part& a, const Part& b);

/// Those of meshes that lie far from their own origin get a copy of them near it, which their poses put back.
std::vector<Part> parts_of(std::span<const AssemblyPart> parts);

/// About a part as it is placed, and what rounding adds.
Box box_of(const Part& part);

/// Two parts, by their numbers.
struct PartPair {
    std::size_t a, b;
    double gap = 0;       ///< of their boxes, metres; 0: they touch
    double clearance = 0; ///< that the two should have, metres
    bool apart() const { return gap > 0; }
};
double gap_between(const Box& a, const Box& b);
/// Whose boxes are no farther apart, the first the lower; their clearance is not set.
std::vector<PartPair> near_boxes(const std::vector<Part>& parts, double reach);

/// Makes the shapes of all parts in these pairs, one for each mesh. A part that cannot have one gets a fault.
void make_shapes(std::vector<Part>& parts, const std::vector<PartPair>& pairs, const ClashOptions& options,
                 const std::function<void(std::size_t done, std::size_t total)>& progress);

} // namespace raycontact::clash
