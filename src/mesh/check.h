// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/mesh.h>

#include "mesh/mesh_tree.h"
#include "mesh/patches.h"

namespace raycontact {

/// Throws InputError, which calls the mesh `name`, if it is empty, too large, not finite or out of range.
void check_mesh(const Mesh& mesh, const std::string& name);

/// Rays are cast in float32: products of four coordinates must not overflow, and of what is smaller than `least_size`
/// the products underflow (the first contacts go wrong at some 1e-10 m). Metres.
constexpr double greatest_coordinate = 1e9, least_size = 1e-6;

/// Throws InputError, which calls the mesh `name`, where a vertex lies further from the origin.
void check_reach(const Mesh& mesh, const std::string& name);

/// Throws InputError, which calls the mesh `name`, where its box is smaller or reaches further.
void check_size(std::span<const Vec3> vertices, const std::string& name);

/// Fills the report, except its repairs, the counts of the file, and what check_surface() fills.
void fill_report(PreparedMesh& prepared, std::span<const HalfEdge> edges);

/// Fills self_intersecting and outward. After fill_report(). The hierarchy is over snapped vertices.
void check_surface(PreparedMesh& prepared, const Patches& patches, std::span<const Vec3> snapped_vertices,
                   const MeshTree& tree, Executor& executor);

/// What the report of a mesh should say; the counts of its file and its repairs are taken over. Its coordinates must be
/// those that prepare_mesh() takes. Throws InputError where no triangle has an area.
MeshReport measured_report(const PreparedMesh& mesh, Executor& executor);
/// The same on all cores; shown to raycontact::recording.
RAYCONTACT_API MeshReport measured_report(const PreparedMesh& mesh);

} // namespace raycontact
