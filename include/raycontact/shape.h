// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/mesh.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace raycontact {

/// A ball, or a capsule: all points within `radius` of a segment. Body frame, metres.
struct Round {
    Vec3 from;         ///< one end of the segment
    Vec3 to;           ///< its other end; a ball's is the same
    double radius = 0; ///< metres
};

/// An immutable triangle mesh made ready for rays: welded and checked, with adjacency, angle-weighted vertex normals,
/// exit distances, vertex clusters and a BVH. Share one among any number of bodies; safe to use from any thread.
class RAYCONTACT_API Shape : public std::enable_shared_from_this<Shape> {
public:
    /// From a prepared mesh. threads 0: one per core. Deterministic: equal input gives equal bits, whatever the
    /// threads. Throws InputError for what prepare_mesh() does not make: no triangle with an area, indices that do not
    /// fit, a coordinate not finite or beyond 1e9 m, a box less than 1e-6 m long; for more than some 16 million
    /// triangles, and for more than 1024 threads.
    static std::shared_ptr<const Shape> make(PreparedMesh mesh, std::uint32_t threads = 0);
    /// From a mesh, prepared with all repairs allowed; report() says which were made. Throws InputError as
    /// prepare_mesh() and the other one.
    static std::shared_ptr<const Shape> make(const Mesh& mesh, std::uint32_t threads = 0);

    /// What save() gave, prepared if it was: the same to the bit in all that it answers, in a part of the time that it
    /// took to be made (docs/performance.md). Throws InputError for any bytes that save() did not give, damaged ones,
    /// and those of another version of the library or another kind of machine; no bytes do harm.
    static std::shared_ptr<const Shape> load(std::span<const std::byte> bytes);

    ~Shape();
    Shape(const Shape&) = delete;
    Shape& operator=(const Shape&) = delete;

    /// Makes what only speeds up later steps (docs/performance.md): 10 to 45 times the work of make(). A Scene has it
    /// made beside its steps for shapes that meet others in more than one step, so nobody needs to call this; call it
    /// where the first steps must be as fast as the later ones, or where counts of work must repeat exactly. No contact
    /// of `standard` or `certified` depends on it. threads 0: one per core. Does nothing the second time. Throws
    /// InputError for more than 1024 threads.
    void prepare(std::uint32_t threads = 0) const;
    /// prepare() was done, by whomever.
    bool is_prepared() const noexcept;

    /// The shape as bytes, 45 a triangle; 80 to 200 with what prepare() made, if it did. They are a cache for load()
    /// by this version of the library on this kind of machine (order of bytes): keep the mesh, too.
    std::vector<std::byte> save() const;

    const std::string& name() const noexcept;  ///< the mesh's
    const MeshReport& report() const noexcept; ///< what the mesh is, and what was repaired
    /// It is closed and wound alike everywhere, so that a point can be inside it.
    bool has_inside() const noexcept;

    /// What the shape is, where it is round (primitives.h); null for meshes. Queries and contacts go by it; the mesh of
    /// such a shape is a picture of it.
    const Round* round() const noexcept;

    /// Body frame. Kernels see vertices relative to `centre` (the middle of the box) in float32, so that meshes far
    /// from their origin lose nothing; these positions are centre + float32 offset, in double.
    std::span<const Vec3> vertices() const noexcept;
    /// Body frame, not rounded: those that the mesh had, of which queries decide (query.h). They are kept, 24 bytes a
    /// vertex, only where they differ from vertices().
    std::span<const Vec3> file_vertices() const noexcept;
    /// Indices into vertices().
    std::span<const std::array<std::uint32_t, 3>> triangles() const noexcept;
    /// File index of each vertex, ascending; from report().file_vertices on: of those where parts cross.
    std::span<const std::uint32_t> vertex_index() const noexcept;
    /// The same of each triangle, ascending; from report().file_triangles on: of those that span holes.
    std::span<const std::uint32_t> triangle_index() const noexcept;
    Vec3 centre() const noexcept;   ///< middle of the box, body frame
    Vec3 box_min() const noexcept;  ///< body frame
    Vec3 box_max() const noexcept;  ///< body frame
    double radius() const noexcept; ///< largest distance of a vertex from the body origin, metres
    /// Metres. With Features::vertices it is what can pass through another mesh unseen, between two vertices.
    double longest_edge() const noexcept;

    /// Angle-weighted unit vertex normals (Thuermer and Wuethrich 1998; Baerentzen and Aanaes 2005), body frame; zero
    /// where the triangles around a vertex cancel out: such a vertex casts no ray.
    std::span<const Vec3> vertex_normals() const noexcept;
    /// Each vertex's share of the surface, m^2: a third of the area of its triangles, rounded once from double.
    /// Contact::weight of direction `weighted`.
    std::span<const float> vertex_areas() const noexcept;
    /// How far the ray from a vertex along its inward normal travels inside its own mesh, metres: t_max of its rays.
    /// +inf where it never leaves, 0 where it points out of the mesh at once.
    std::span<const float> exit_distances() const noexcept;
    /// Triangle across each edge (0-1, 1-2, 2-0), or no_triangle at a border. Where several meet, as where solids touch
    /// in an edge, the one across the solid; where their windings leave none, the lowest other index.
    std::span<const std::array<std::uint32_t, 3>> neighbours() const noexcept;
    /// The lowest triangle at each vertex, or no_triangle where none is.
    std::span<const std::uint32_t> vertex_triangles() const noexcept;
    /// The index of none.
    static constexpr std::uint32_t no_triangle = 0xffffffffu;

    /// What the shape takes on the host.
    std::uint64_t memory_bytes() const;

    /// What a shape is made of: a type that only the library knows.
    struct Data;
    const Data& data() const noexcept { return *data_; } ///< for the library alone

private:
    explicit Shape(std::unique_ptr<Data> data);
    std::unique_ptr<Data> data_;
};

} // namespace raycontact
