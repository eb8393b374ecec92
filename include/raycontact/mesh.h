// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/pose.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raycontact {

/// Triangles as a file gives them: nothing welded, nothing repaired, 0-based indices in the file's own order
/// (OBJ `v` order; STL 3 x facet + corner; PLY and OFF order; glTF in node order; 3MF as its build places objects).
/// Unused vertices that are not finite lie where a used one does. A polygon of n corners is n - 2 triangles: the fan of
/// its first corner where that is right, as it is for convex ones; else ears are cut off it, seen along the axis
/// closest to its normal. One that crosses itself or has no area stays a fan.
struct Mesh {
    std::string name;                                    ///< for messages; the file name when loaded
    std::vector<Vec3> vertices;                          ///< metres, body frame
    std::vector<std::array<std::uint32_t, 3>> triangles; ///< counter-clockwise seen from outside
    std::vector<std::string> repairs = {};               ///< what reading left out or mended, in words with counts
};

/// Reads OBJ, STL (ASCII and binary), PLY (ASCII and binary), OFF, glTF, GLB or 3MF; the format is told by the ending
/// (any case). 3MF alone says its unit: its lengths become metres. Throws InputError naming the file, and the line or
/// element where one is to blame, for: another ending, a missing, unreadable, truncated or damaged file, a folder, what
/// is not read of a format (as compressed glTF), 3MF in a library that is built without it, no triangles or more than
/// 715 827 881, an index out of range, a coordinate not finite of a vertex that a triangle uses.
RAYCONTACT_API Mesh load_mesh(const std::filesystem::path& file);

/// How the bytes of a mesh file are read; each format in all the kinds that the load_mesh() of a file reads.
enum class MeshFormat { obj, stl, ply, off, gltf, glb, threemf };

/// The same from memory: the bytes of a whole file. name: for messages and Mesh::name.
/// Throws InputError, which names it, as for a file; also for a glTF file whose buffers are files of their own.
RAYCONTACT_API Mesh load_mesh(std::span<const std::byte> bytes, MeshFormat format, const std::string& name = {});

/// From arrays. coordinates: x, y, z of each vertex, metres; corners: three vertices of each triangle,
/// counter-clockwise seen from outside. Throws InputError naming it and the element to blame for: no triangles or too
/// many, a number that is not a multiple of three, a vertex that does not exist, a coordinate not finite.
RAYCONTACT_API Mesh make_mesh(std::span<const double> coordinates, std::span<const std::uint32_t> corners,
                              const std::string& name = {});
/// The same from single precision. Throws InputError as that does.
RAYCONTACT_API Mesh make_mesh(std::span<const float> coordinates, std::span<const std::uint32_t> corners,
                              const std::string& name = {});

/// Joins vertices that are nearer than `length` (metres, 1e-12 to 1e9) to each other, as those of a file whose corners
/// differ in their last digits: they get one place, which prepare_mesh() welds. Each one goes to the nearest of those
/// that stay, less than `length` away; no two that stay are nearer than `length`. Which stay depends on the coordinates
/// alone, not on the order of the file. Indices stay. Triangles that lose their area are dropped and counted by
/// prepare_mesh(). A mesh may lie as far from the origin as doubles tell its vertices apart. Throws InputError naming
/// the mesh for another length, for one below the last digit of its largest coordinate, and as load_mesh() does.
RAYCONTACT_API Mesh weld_mesh(Mesh mesh, double length);

/// What a mesh is, after the repairs it names.
struct MeshReport {
    std::uint64_t vertices = 0;       ///< distinct positions in use by a triangle
    std::uint64_t triangles = 0;      ///< kept, and pieces of those that were split
    std::uint64_t file_vertices = 0;  ///< as in the file
    std::uint64_t file_triangles = 0; ///< as in the file, polygons split
    bool closed = false; ///< every edge has a triangle on both sides (each edge met an even number of times, >= 2)
    bool solid = false;  ///< has an inside: closed and oriented, but walls back to back that hold nothing are not
    std::uint64_t border_edges = 0;   ///< edges met an odd number of times; 0: closed
    std::uint64_t holes = 0;          ///< spanned ones, as Holes has it
    std::uint64_t spanning = 0;       ///< triangles that span them: not in the file, numbered after its own
    bool manifold = false;            ///< no edge has more than two triangles, no vertex more than one fan
    bool oriented = false;            ///< across every shared edge the two triangles wind the same way
    bool checked = true;              ///< false after Check::topology: self_intersecting and outward are not known
    bool self_intersecting = false;   ///< two triangles meet elsewhere than in their shared vertices or edge
    bool outward = false;             ///< closed and oriented, winding number 0 outside and 1 inside everywhere
    std::uint64_t components = 0;     ///< connected over shared vertices
    double volume = 0;                ///< m^3, signed; 0 unless solid
    double area = 0;                  ///< m^2
    Vec3 box_min;                     ///< least coordinates, body frame, metres
    Vec3 box_max;                     ///< greatest coordinates, body frame, metres
    std::vector<std::string> repairs; ///< with those of the Mesh, in words with counts; empty: nothing was changed
};

/// Whether prepare_mesh may change anything beyond welding for connectivity.
enum class Repair {
    allowed, ///< drop degenerate and duplicate triangles, which never opens a closed edge (where a degenerate one joins
             ///< a corner with the side of a triangle on which it lies, that triangle is split at the corner), and one
             ///< of two closed surfaces back to back; stitch T-junctions (docs/conventions.md, T-junctions); make
             ///< windings agree; span holes as Holes, turn components as Nesting, unite parts as Overlaps has it
    as_is,   ///< change nothing; connectivity is still found by exact position
};

/// Which way a repair lets closed components wind. A component is outermost if it is in no other closed one.
enum class Nesting {
    as_wound, ///< outermost ones outward; those inside others stay as the file has them: a solid in a solid, which
              ///< Overlaps unites, or a cavity
    cavities, ///< by turns: outward, in there a cavity, in there outward, ... The winding number is 0 or 1 everywhere
    solids,   ///< all outward: undoes cavities
};

/// Which holes prepare_mesh() spans with triangles of its own, where it may repair. A hole is a closed line of border
/// edges. It is spanned by triangles over its corners, of the least area where it is not flat (Barequet and Sharir
/// 1995); they close the mesh, and repairs name each hole.
enum class Holes {
    /// All those of a solid. A mesh with holes is a solid if the winding number says so (Jacobson, Kavan and
    /// Sorkine-Hornung 2013): in front of and behind at least nine tenths of its surface it is within 0.15 of a whole
    /// number, and at least 1 behind half of it. Any other mesh stays a one-sided sheet.
    of_solids,
    of_all, ///< those of sheets, too, if they are flat or smaller than a tenth of the diagonal
    none,
};

/// What prepare_mesh() does about parts of one closed mesh that lie in each other or cross, where it may repair.
enum class Overlaps {
    /// They are one solid: triangles are cut where they cross, and the pieces dropped that have a winding number of 1
    /// or more in front, or less than 1 behind.
    unite,
    leave,
};

/// How much of a mesh prepare_mesh looks at.
enum class Check {
    full,
    /// Of a mesh that is not united (Overlaps) neither self-intersections nor which way the whole winds, a third of
    /// what it takes to make a shape: for one that is needed at once. Shape::prepare() looks for them, since the grids
    /// that it makes need them.
    topology,
};

/// A mesh ready to become a shape: welded by exact position, checked, with the way back to the file's indices.
struct PreparedMesh {
    std::string name;                                    ///< for messages
    std::vector<Vec3> vertices;                          ///< distinct positions, in order of their lowest file index
    std::vector<std::array<std::uint32_t, 3>> triangles; ///< indices into vertices
    std::vector<std::uint32_t> vertex_index;   ///< file index (the lowest, where several were welded) of each vertex,
                                               ///< ascending; from report.file_vertices on: of those where parts cross
    std::vector<std::uint32_t> triangle_index; ///< file index of each triangle, ascending; of pieces that of the whole;
                                               ///< from report.file_triangles on: of those that span holes
    MeshReport report;                         ///< what it is, and what was repaired
};

/// What prepare_mesh() does.
struct PrepareOptions {
    Repair repair = Repair::allowed;     ///< whether the mesh may be changed
    Nesting nesting = Nesting::as_wound; ///< which parts that lie in others are cavities
    Holes holes = Holes::of_solids;      ///< which are spanned
    Overlaps overlaps = Overlaps::unite; ///< what becomes of parts that cross
    Check check = Check::full;           ///< how much of the mesh is looked at
    std::uint32_t threads = 0;           ///< 0: one per core; no bit depends on it
};

/// Welds, checks and, where allowed, repairs. Throws InputError naming the mesh for: no triangles or too many, an index
/// out of range, a coordinate not finite or beyond 1e9 m, no triangle with an area, a box less than 1e-6 m long; and
/// for more than 1024 threads.
RAYCONTACT_API PreparedMesh prepare_mesh(const Mesh& mesh, const PrepareOptions& options = {});

/// The length by which weld_mesh() closes an open mesh whose corners differ in their last digits: the least power of
/// ten that does, metres, up to 1e-4 of the diagonal of its box. None where none does, or the file is closed.
RAYCONTACT_API std::optional<double> closing_weld(const PreparedMesh& mesh);

/// Whether contacts with a mesh are what the rule of contact says: it is solid, wound outward, and does not intersect
/// itself.
struct Verdict {
    bool good;        ///< they are
    std::string text; ///< one line: "good for contacts", or what is wrong and what to do
};
/// Of a mesh that has this report.
RAYCONTACT_API Verdict verdict_of(const MeshReport& report);

/// "solid", "solid with holes", which are spanned, or "sheet", which has no inside.
RAYCONTACT_API std::string kind_of(const MeshReport& report);

/// As text for a person.
RAYCONTACT_API std::string to_text(const MeshReport& report);
/// As the JSON of `raycontact mesh --json`.
RAYCONTACT_API std::string to_json(const MeshReport& report);

} // namespace raycontact
