// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/triangle_tree.h"

#include <raycontact/shape.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

namespace raycontact {

/// A vertex or box corner as the kernels see it: float32, relative to the shape's centre.
using Point3f = kernels::Packed3;

/// Where an array is, for AT() without a buffer (docs/internals/dialect.md).
template <class T>
kernels::ulong host_place(const std::vector<T>& values) {
    return reinterpret_cast<std::uintptr_t>(values.data()) / sizeof(kernels::ulong);
}

struct Accelerators;
class AcceleratorSlot;

/// Everything a shape is made of. The kernel arrays use offsets from their own beginning.
struct Shape::Data : TriangleTree {
    PreparedMesh mesh; ///< vertices replaced by centre + float32 offset
    /// As they were before that, for exact queries; empty where no coordinate was changed. 24 bytes a vertex.
    std::vector<Vec3> file_vertices;
    TriangleTree slivers;            ///< over the triangles that have an area only before that; often empty
    std::vector<std::uint32_t> flat; ///< those that have one only after it, rising
    Vec3 centre;
    std::vector<Point3f> points; ///< float32 offsets from centre
    std::vector<Vec3> vertex_normals;
    std::vector<float> vertex_areas;
    std::vector<float> exit_distances;
    std::vector<std::array<std::uint32_t, 3>> neighbours;
    /// Per triangle a bit for each of its edges (0-1, 1-2, 2-0) that is sharp, or a border, and of which it is the
    /// lowest triangle.
    std::vector<std::uint8_t> sharp_edges;
    /// Per triangle and edge of which it is the lowest triangle: how deep an overlap can be that the edge alone
    /// crosses, metres (docs/internals/edges.md).
    std::vector<std::array<float, 3>> hides;
    std::vector<Vec3> perturbations; ///< per vertex, how the edges' rule moves it, in units of 1e-7 of the size
                                     ///< (docs/internals/edges.md)
    std::vector<std::uint32_t> vertex_triangle;    ///< the lowest triangle of each vertex
    std::vector<std::uint32_t> component_vertices; ///< the lowest vertex of each connected component
    Vec3 box_min, box_max; ///< body frame; header.low and high are the same box about centre, exactly that of points
    bool rays_end = true;  ///< every vertex's inward ray ends in the mesh
    double diagonal = 0;   ///< of the box, metres
    double radius = 0;
    double longest_edge = 0; ///< metres
    double hides_most = 0;   ///< of `hides`, the most
    double hides_half = 0;   ///< half of the edges hide no more
    double grain = 0; ///< about as long as an edge: the diagonal over the root of the number of triangles, metres
    double reach = 0; ///< largest distance of a vertex from centre, metres

    std::vector<kernels::Face> faces; ///< per triangle
    std::vector<kernels::VertexBlock> vertex_blocks;
    std::vector<kernels::ClusterBlock> clusters;
    std::vector<kernels::Component> components; ///< as component_vertices
    std::vector<kernels::Packed3> face_normals; ///< outward unit, per triangle
    /// Of a clearance grid of one cell, until there are Accelerators: all that is known is outside of the box.
    std::vector<kernels::uint> clearances{0};
    kernels::ShapeHeader header{};
    std::optional<Round> round; ///< what it is instead of its mesh; of a core what that is the segment of
    /// Of a round shape its segment, as a triangle without an area that has no number in a file. See queried().
    std::shared_ptr<const Data> core;

    /// Enters where the kernel arrays are, once they are all there.
    void set_places() {
        header.nodes = host_place(nodes);
        header.triangle_blocks = host_place(triangle_blocks);
        header.faces = host_place(faces);
        header.face_normals = host_place(face_normals);
        header.vertex_blocks = host_place(vertex_blocks);
        header.clusters = host_place(clusters);
        header.components = host_place(components);
        header.clearances = host_place(clearances);
    }

    Vec3 point(std::uint32_t vertex) const { return {points[vertex].x, points[vertex].y, points[vertex].z}; }
    const Vec3& file_vertex(std::uint32_t vertex) const {
        return file_vertices.empty() ? mesh.vertices[vertex] : file_vertices[vertex];
    }
    bool is_flat(std::uint32_t triangle) const {
        return !flat.empty() && std::binary_search(flat.begin(), flat.end(), triangle);
    }
    Vec3 corner(std::uint32_t triangle, std::size_t k) const { return point(mesh.triangles[triangle][k]); }

    std::shared_ptr<AcceleratorSlot> accelerators; ///< see accelerators_of()
};
using ShapeData = Shape::Data;

/// What queries walk: of a round shape its core, which lies `radius_of` within it.
inline const ShapeData& queried(const Shape& shape) {
    return shape.data().core ? *shape.data().core : shape.data();
}
/// Of a round shape, or its core; 0 of meshes. Metres.
inline double radius_of(const ShapeData& shape) {
    return shape.round ? shape.round->radius : 0;
}

} // namespace raycontact
