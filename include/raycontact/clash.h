// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/assembly.h>
#include <raycontact/error.h>
#include <raycontact/export.h>
#include <raycontact/query.h>
#include <raycontact/separation.h>
#include <raycontact/shape.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Which parts of an assembly intersect, how, and how deep. Lengths are in the parts' unit, called metres here; points
// are in the frame of the assembly, in double. Of parts far from the origin (UTM coordinates) nothing is lost.

namespace raycontact {

/// How two parts lie to each other. Exact but for rounding: what is less than 1e-6 of the smaller part counts as none.
enum class ClashKind {
    touching,    ///< they share points, but no depth; or gap and depth are within ClashOptions::tolerance
    overlapping, ///< their surfaces cross, and what either leaves of the other hangs together
    /// Their surfaces cross in closed curves, and one part falls apart where the other is taken out of it, as a pipe
    /// does that goes through a wall: the surface of the rest has more pieces than before, among those that the curves
    /// lie on. Of two parts that have an inside.
    piercing,
    inside,    ///< one lies in the other: no point of it is outside
    duplicate, ///< the same part in the same place, to 1e-6 of its size
    nearby,    ///< "near": they share no point, and are not farther apart than the clearance of the two
};
/// "touching", ...: as the program prints it.
RAYCONTACT_API const char* to_string(ClashKind kind);

/// Two parts that clash.
struct Clash {
    std::size_t a = 0;                    ///< number of a part
    std::size_t b = 0;                    ///< number of a later part
    ClashKind kind = ClashKind::touching; ///< how they clash
    /// Of the deepest contact, metres; 0: they touch; negative: minus the distance of parts that are near. None: no
    /// rule of contact gives one, as a part is open, intersects itself or winds the wrong way somewhere.
    std::optional<double> depth = 0;
    double distance = 0;      ///< of parts that share no point, metres
    Vec3 point;               ///< in both parts: of that contact, on the surface of one; else any; near: point_a
    Vec3 point_a;             ///< of that contact, or the closest one: on the surface of a
    Vec3 point_b;             ///< likewise on that of b
    Vec3 normal;              ///< of that contact, unit, from a to b; near: the way from point_a to point_b; else 0
    std::size_t contacts = 0; ///< how many the two have
    bool open_a = false;      ///< a has no inside, and a depth says how far it reaches into b alone
    bool open_b = false;      ///< likewise b
    /// About what both share, along the axes, right to some 1e-7 of the smaller part. Where one of them has no inside:
    /// about the curves in which they cross. None: they touch, or are near.
    std::optional<AxisBox> box;
    std::optional<double> volume; ///< that they share, m^3, if asked for; none where one has no inside
    /// The translation of b that parts them, as separation() finds it, if asked for; none where one has no inside, and
    /// where they touch or are near.
    std::optional<Separation> separation;
};

/// How near some pairs may come.
struct ClearanceOf {
    double clearance = 0; ///< metres
    /// Patterns as of ClashOptions::against: of pairs of which one part matches the one, and the other the other.
    std::array<std::string, 2> parts{"*", "*"};
};

/// What find_clashes() looks for.
struct ClashOptions {
    /// Patterns of names of parts or files ("*" stands for any text, "?" for a character); with "/" also of path_of()
    /// or its end, so that "Floor 2/*" are all parts under nodes of that name. Parts that match are tested against all
    /// that do not. Empty: all against all.
    std::vector<std::string> against{};
    /// Pairs of such patterns: parts of which one matches either are not tested against each other.
    std::vector<std::array<std::string, 2>> exclude{};
    bool exclude_parent_child = false;     ///< leaves out pairs of a part and its AssemblyPart::parent
    double clearance = 0;                  ///< metres; pairs not farther apart are `near`
    std::vector<ClearanceOf> clearances{}; ///< of some pairs; of all that apply, and `clearance`, the largest counts
    double tolerance = 0;                  ///< metres; gaps, and depths but of two open parts, up to it are `touching`
    bool volumes = false;                  ///< asks for Clash::volume: seconds for parts of 100 000 triangles
    bool separations = false;  ///< asks for Clash::separation: some times the search, seconds for large parts
    std::uint32_t threads = 0; ///< 0: one per core; no result depends on it
    /// Told what is done, from 0 to 1; from any thread, but from one at a time.
    std::function<void(double)> progress = [](double) {};
    std::function<bool()> stop = [] { return false; }; ///< asked on any thread; true: the search ends there
};

/// What find_clashes() finds.
struct ClashReport {
    /// Deepest first, then those without a depth, then those that touch, then those that are near, the nearest first;
    /// ties in the parts' order.
    std::vector<Clash> clashes;
    std::size_t pairs = 0; ///< that were tested: their boxes are no farther apart than clearance or tolerance
    std::vector<std::pair<std::size_t, std::string>> faults; ///< parts that could not be tested, and why; rising
    std::vector<std::size_t> open;                           ///< parts that were tested and have no inside; rising
};

/// The parts of all files, in their order (load_assembly), under names that differ: where several have the same, the
/// file is set before it, or a number is added. Of several files each is the root of what its parts are under, unless
/// it is one part of that name. left_out: gets a line for each thing that was left out or mended, with
/// the file before it. Throws InputError as load_mesh().
RAYCONTACT_API std::vector<AssemblyPart> load_parts(const std::vector<std::filesystem::path>& files,
                                                    std::vector<std::string>* left_out = nullptr);

/// The components of all parts, in their order, in place of those that have several: what is closed by itself, with its
/// cavities, is one, whatever it touches; what is open hangs together over shared vertices, as exact positions are one
/// vertex. They are found after the repairs of prepare_mesh(), without triangles that these drop, and begin their
/// indices at 0, in the part's order. They have the part's name and a number; names differ. The parent of a part that
/// is split is the first of its components. A part that prepare_mesh() refuses stays whole, and one of which so many
/// components lie in each other that their cavities would take too long to find. left_out: gets a line for each of the
/// latter. Throws InputError for a part without a mesh.
RAYCONTACT_API std::vector<AssemblyPart> split_components(const std::vector<AssemblyPart>& parts,
                                                          std::vector<std::string>* left_out = nullptr);

/// Every pair of parts that shares a point (exactly, as intersects()) or is near. Depths are those of collide() with
/// Direction::refined, so that of threads and tubes none is deeper than the way out is long; where faces coincide, so
/// that rounding would decide, small moves tell touching parts from others. Throws InputError for fewer than two parts,
/// for a pose that is not rigid, a length that is negative or not finite, a pattern that matches nothing, `against`
/// that matches all, and more than 1024 threads.
RAYCONTACT_API ClashReport find_clashes(std::span<const AssemblyPart> parts, const ClashOptions& options = {});

/// Clashes that are one matter for a person.
struct ClashGroup {
    std::string a;                    ///< path_of() the part that all have, or of what their parts are in
    std::string b;                    ///< of the other, which may be the same; of several other parts empty
    std::vector<std::size_t> clashes; ///< which of those given, rising; so the first is the deepest
    AxisBox box;                      ///< about their boxes, or points where they have none
};

/// Each clash in the group of one of its parts: first all those of the part that has the most, then of the one that
/// has the most of what is left, and so on; of equals the lowest part. So 40 bolts in one flange are one group. In the
/// order of their first clashes. clashes: of find_clashes(), or some of them, in their order. Throws InputError for
/// clashes of parts that are not there.
RAYCONTACT_API std::vector<ClashGroup> group_by_part(std::span<const AssemblyPart> parts,
                                                     std::span<const Clash> clashes);
/// All clashes of what is in one assembly with what is in another, or in the same, are a group. level: 0: a part's
/// assembly is the node that it is under; else that of the first `level` names of its path. A part that is under none,
/// or has no more names, is one by itself. Order and errors as group_by_part().
RAYCONTACT_API std::vector<ClashGroup> group_by_assembly(std::span<const AssemblyPart> parts,
                                                         std::span<const Clash> clashes, std::size_t level = 0);

/// Two parts of which the first moves.
struct PathClash {
    std::size_t moving = 0; ///< number of a part
    std::size_t other = 0;  ///< number of a part that stays
    bool meet = false;      ///< they do, at `place.time` first; else they are nearest to each other then
    PathClearance place; ///< time: from 0 to the number of moves less 1; point_a on the moving part, where it is then
};

/// What find_path_clashes() finds.
struct PathClashReport {
    /// Those that meet, the first one first; then those that come no farther apart than their clearance, the nearest
    /// first; ties in the parts' order.
    std::vector<PathClash> clashes;
    /// Of all that stay apart those that come nearest to each other: the least clearance on the way.
    std::optional<PathClash> nearest;
    std::size_t pairs = 0; ///< that were tested: their boxes come as near as the clearance
    std::vector<std::pair<std::size_t, std::string>> faults; ///< as of ClashReport
};

/// What some parts meet while they move together past all others, and how near they come to what they do not meet.
/// moving: patterns of their names. moves: poses that bring them from where they are placed to where they are at times
/// 0, 1, ..., in the frame of the assembly, by a screw from each to the next (time_of_impact()); one at least. Times,
/// distances and tolerances are those of path_clearance(). Of options count exclude, exclude_parent_child, clearance,
/// clearances, threads, progress and stop. Throws InputError as find_clashes(), and for moves that are none or not
/// rigid.
RAYCONTACT_API PathClashReport find_path_clashes(std::span<const AssemblyPart> parts,
                                                 const std::vector<std::string>& moving, std::span<const Pose> moves,
                                                 const ClashOptions& options = {});

/// The volume that two closed, outward meshes share, m^3, by Shape::file_vertices(); exact but for rounding in double.
/// No predicate decides anything, so touching and flush faces are no special cases. Where a mesh winds around a point
/// more than once, as often counts the point. Far slower than contacts. Throws InputError for poses as intersects().
RAYCONTACT_API double overlap_volume(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

} // namespace raycontact
