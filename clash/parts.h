// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/assembly.h>
#include <raycontact/shape.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::clash {

/// One part of an assembly, where its file places it.
struct Part : AssemblyPart {
    std::shared_ptr<const Shape>
        shape;         ///< shared as the mesh; null: not made, as no box of another part touches its own
    std::string fault; ///< why it cannot be tested; empty: it can
};

/// The diagonal of the smaller part's box, metres. Both have shapes.
double smaller_size(const Part& a, const Part& b);

/// The parts of all files, in their order (load_assembly). Where several have the same name, the file is set before it,
/// or a number is added. left_out: gets a line for each thing that was left out or mended, with the file before
/// it. Throws InputError as load_mesh().
std::vector<Part> load_parts(const std::vector<std::filesystem::path>& files, std::vector<std::string>& left_out);

/// Two parts whose boxes touch, by their numbers; the first is the lower.
struct PartPair {
    std::size_t a, b;
};
std::vector<PartPair> touching_boxes(const std::vector<Part>& parts);

/// Makes the shapes of all parts in these pairs, one for each mesh. A part that cannot have one gets a fault. progress
/// is told, from any thread but from one at a time, how many are made.
void make_shapes(std::vector<Part>& parts, const std::vector<PartPair>& pairs, std::uint32_t threads,
                 const std::function<void(std::size_t done, std::size_t total)>& progress,
                 const std::function<bool()>& stop);

} // namespace raycontact::clash
