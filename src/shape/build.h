// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/tree_order.h"
#include "shape/accelerators.h"

#include <memory>
#include <vector>

namespace raycontact {

/// Which vertices and edges share a block: their names there (kernels::VertexBlock), block by block.
struct SourceOrder {
    std::vector<kernels::uint> vertices, edges;
};

/// What takes longest to make of a shape, as one that was saved has it. The rest is made of the mesh as ever, so that
/// no number of these leads out of an array.
struct SlowParts {
    TreeOrder tree;
    SourceOrder sources;
    std::vector<float> exit_distances;
};

/// Shape::make() without the shape, in a FloatEnvironment. saved: what is known of it. Throws InputError as that, and
/// where what is known does not fit the mesh.
std::unique_ptr<ShapeData> build_shape(PreparedMesh mesh, Executor& executor, SlowParts* saved = nullptr);

// The stages of Shape::make(), in their order, and then those of Shape::prepare(). `normals` are the unit normals of
// the faces in double. Deterministic.

/// Outward unit normal of each triangle; zero for one without area.
std::vector<Vec3> face_normals(const ShapeData& shape);

/// Angle-weighted unit normal of each vertex (Thuermer and Wuethrich 1998); zero where the faces around it cancel out.
std::vector<Vec3> angle_weighted_normals(const ShapeData& shape, std::span<const Vec3> normals, Executor& executor);

/// Each vertex's share of the surface, m^2: a third of the area of its triangles, summed in double and rounded once.
std::vector<float> measure_areas(const ShapeData& shape);

/// Fills sharp_edges, longest_edge, hides, hides_most, hides_half and vertex_triangle. Needs `neighbours`.
void find_sharp_edges(ShapeData& shape, std::span<const Vec3> normals);

/// Fills component_vertices and components. Needs vertex_triangle.
void find_components(ShapeData& shape);

/// Fills perturbations; needs the vertices' normals.
void find_perturbations(ShapeData& shape);

/// How far the ray from each vertex along its inward normal travels inside its own mesh before it leaves, metres: the
/// closest face met from inside, without the triangles around the vertex. +inf if there is none, 0 if the ray points
/// out of the mesh at once. Needs points, vertex_normals, nodes and triangle_blocks. They never change, so the paper's
/// second test ("before leaving the source object", section 2.1) costs nothing at run time.
std::vector<float> measure_exits(const ShapeData& shape, std::span<const Vec3> normals, Executor& executor);

/// Fills vertex_blocks with the vertices that can cast a ray (a normal, an exit distance above 0), sixteen neighbours
/// a block, then with all edges, and clusters with the boxes of an implicit sixteen-wide tree above either.
void build_clusters(ShapeData& shape, Executor& executor);
/// What they were made by, and what makes the same again. False where it is no order of the shape's.
SourceOrder source_order_of(const ShapeData& shape);
[[nodiscard]] bool restore_clusters(ShapeData& shape, const SourceOrder& known);

/// Fills outside_cells and the grid of the header: a bit for each cubic cell of the box, set when the whole cell, grown
/// by the rounding of a look-up, lies outside the mesh. A vertex there cannot be in contact, whatever its ray, since
/// the first face that it meets is met from outside. Only for meshes whose winding number is 0 outside and 1 inside
/// everywhere (report.outward); other meshes, and those whose long needles make a grid too slow to build, get none and
/// lose only time. No distance is stored: only the number of rays that need not be cast depends on the resolution.
void build_outside_grid(const ShapeData& shape, Accelerators& made, const std::stop_token& stop);
/// Takes over the bits of one that was built; none where there was none. False if they are not as many as it has.
[[nodiscard]] bool restore_outside_grid(const ShapeData& shape, Accelerators& made, std::vector<kernels::uint> cells);

/// Fills `clearances` and its part of the header: for each cubic cell around the shape the largest useful ball that no
/// surface enters, and whether it is certainly outside (closed, outward meshes only). One look-up tells how far a
/// vertex can move before it could touch (docs/internals/certified.md). No contact depends on it; a coarser grid only
/// makes pairs be due earlier.
void build_clearance_grid(const ShapeData& shape, Accelerators& to, Executor& executor, const std::stop_token& stop);
/// Takes over the words of one that was built. False if they are not as many as it has.
[[nodiscard]] bool restore_clearance_grid(const ShapeData& shape, Accelerators& to, std::vector<kernels::uint> words);

/// The one of a single cell, which every shape has: that a point outside the box is outside, and how far.
void set_box_clearance(kernels::ShapeHeader& header);

/// Fills the normal-cone balls of the triangle blocks (kernels/normal_cone.h) with lower bounds; 0 for needles, for
/// triangles larger than their normal-cone ball, and if the mesh is not closed and outward. Needs the tree and the
/// header's flags and tolerance.
void build_normal_cones(const ShapeData& shape, Accelerators& to, Executor& executor, const std::stop_token& stop);
/// Takes over those that were built. False if they are not as many as there are.
[[nodiscard]] bool restore_normal_cones(const ShapeData& shape, Accelerators& to, std::vector<kernels::uint> cones);

} // namespace raycontact
