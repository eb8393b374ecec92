// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/error.h>
#include <raycontact/export.h>
#include <raycontact/pose.h>
#include <raycontact/rigid_motion.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

// Questions about one or two shapes, without a scene (docs/queries.md). They copy nothing and change nothing: safe to
// call from several threads, on the same shapes. Points are in the world frame unless said otherwise, lengths in
// metres. A mesh's vertices are Shape::file_vertices(): not rounded. Where an answer is called exact, it is that for
// the real numbers rotation * vertex + translation, with the doubles of the mesh and the pose, and no tolerance;
// coordinates and entries of rotations below 1e-36 count as 0. Indices "in the file" from
// MeshReport::file_triangles on are of triangles that span holes.

namespace raycontact {

/// For queries without a greatest distance.
constexpr double any_distance = std::numeric_limits<double>::infinity();

/// Where a ray meets a mesh.
struct RayHit {
    std::uint32_t triangle = Shape::no_triangle; ///< index in the file
    double distance = 0;                         ///< from the origin, metres, whatever the direction's length
    Vec3 normal;                                 ///< of the face as the shape winds it, unit, world frame
    Vec3 point;                                  ///< world frame
};

/// The closest triangle that a ray meets within `max` metres of its origin; of equally close ones the lowest. Both
/// sides of a face count, and so do its edges and a face on which the origin lies; one that is seen exactly edge-on
/// does not. Watertight: the ray is placed in the body frame, rounded to double, and from there on it is decided
/// exactly which triangles it meets (Shewchuk 1997) and which first, so none slips between two that share an edge. The
/// distance is rounded. direction: of any length. Throws InputError for a pose that is not finite and rigid to 1e-4,
/// for a pose or an origin beyond 1e30 m or not finite, for a direction that is zero or not finite, and for a `max`
/// that is negative or not a number.
RAYCONTACT_API std::optional<RayHit> raycast(const Shape& shape, const Pose& pose, const Vec3& origin,
                                             const Vec3& direction, double max = any_distance);

/// Whether raycast() has a hit; ends at the first one found. Throws InputError as it does.
RAYCONTACT_API bool raycast_any(const Shape& shape, const Pose& pose, const Vec3& origin, const Vec3& direction,
                                double max = any_distance);

/// The point of a surface that is nearest to another point.
struct ClosestPoint {
    std::uint32_t triangle = Shape::no_triangle; ///< on which it lies, index in the file; of several the lowest
    Vec3 point;                                  ///< world frame
    double distance = 0;                         ///< metres; contains() tells on which side of a closed mesh
};

/// The closest point of a mesh's surface, if it is within `max` metres. The point is placed in the body frame, rounded
/// to double; from there on it is decided exactly which triangle is the closest. Point and distance are rounded: right
/// to some 1e-15 of the size of the mesh and its distance from the origins. Throws InputError for pose, point and `max`
/// as raycast().
RAYCONTACT_API std::optional<ClosestPoint> closest_point(const Shape& shape, const Pose& pose, const Vec3& point,
                                                         double max = any_distance);

/// How far a point is from a mesh, on which side, and what of the mesh is nearest.
struct SignedDistance {
    double distance = 0; ///< metres from the surface; below 0 exactly where contains() is true, but on the surface
    std::uint32_t triangle = Shape::no_triangle; ///< on which the nearest point lies, index in the file
    Vec3 point;                                  ///< the nearest of the surface, world frame
    Vec3 gradient; ///< unit, world frame: the way in which the distance grows; on the surface the face's normal
};

/// The signed distance of many points, in their order. Value, point and triangle are those of closest_point(). Of a
/// mesh without an inside no distance is below 0. Points near each other share work, wherever they are in the list.
/// threads 0: one per core; no bit depends on it. Throws InputError for pose and points as raycast(), and for more than
/// 1024 threads.
RAYCONTACT_API std::vector<SignedDistance> signed_distance(const Shape& shape, const Pose& pose,
                                                           std::span<const Vec3> points, std::uint32_t threads = 0);

/// The least distance of two meshes, and where it is.
struct Distance {
    double distance = 0; ///< metres; 0 exactly where intersects() is true
    Vec3 point_a;        ///< on the surface of a, world frame; where they intersect, one that both share, to rounding
    Vec3 point_b;        ///< likewise on that of b
    /// On which point_a lies, index in the file. no_triangle for a mesh inside of which the other lies.
    std::uint32_t triangle_a = Shape::no_triangle;
    std::uint32_t triangle_b = Shape::no_triangle; ///< likewise for point_b
};

/// The least distance of two surfaces, if it is within `max` metres; 0 where they intersect, or one lies inside the
/// other. Whether it is 0 is decided exactly, as by intersects(); else it is as right as that of closest_point(), but
/// between edges parallel to some 1e-8: to 1e-8 of their length. Branch and bound over both trees. A small `max` saves
/// work. Throws InputError for poses and `max` as raycast().
RAYCONTACT_API std::optional<Distance> distance(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                                                double max = any_distance);

/// Whether two meshes share a point: their surfaces meet (touching counts), or one lies inside the other, if that is
/// closed and wound alike everywhere. Exact: parts of one assembly that share faces touch. Where both poses are equal
/// they do not matter at all. Ends at the first triangles that meet. Throws InputError for poses as raycast().
RAYCONTACT_API bool intersects(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

/// A point that both share, to rounding: where two triangles meet, or a vertex of the one inside the other. Nothing if
/// intersects() is false. Throws InputError as it does.
RAYCONTACT_API std::optional<Vec3> common_point(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);

/// When two moving meshes come near each other, and where.
struct Impact {
    double time = 0;     ///< from 0 to 1; along paths from 0 to their number of poses less 1
    double distance = 0; ///< between the two points, metres; 0 where they share a point at the start
    Vec3 point_a;        ///< on a at that time, world frame: of the triangles that came near first
    Vec3 point_b;        ///< likewise on b
    Vec3 normal;         ///< from a to b, unit, world frame; zero where they share a point at the start
    std::uint32_t triangle_a = Shape::no_triangle; ///< on which point_a lies, as Distance has it
    std::uint32_t triangle_b = Shape::no_triangle; ///< likewise for point_b
};

/// The first time at which two moving meshes are not farther apart than `distance` metres (the time of impact, where
/// that is 0); nothing if they stay apart from time 0 to 1. Never late: at no earlier time are they that near. Early by
/// no more than the tolerance: at the time told they are within distance + tolerance. So what passes nearer than that
/// counts as met. At the start it is decided as by distance(), on the way by bounds in double. tolerance: metres; 0
/// takes 1e-7 of the smaller mesh's diagonal; what is rounded on the way (some 1e-12 of sizes, places and paths) is the
/// least. Each pair of triangles advances by what can move it along its closest direction (conservative advancement:
/// Mirtich 1996; Tang et al. 2009), and only those are looked at that may meet first. Throws InputError for poses as
/// screw_motion(), for motions that are not finite, and for a distance or a tolerance that is negative or not finite.
RAYCONTACT_API std::optional<Impact> time_of_impact(const Shape& a, const RigidMotion& motion_a, const Shape& b,
                                                    const RigidMotion& motion_b, double distance = 0,
                                                    double tolerance = 0);
/// The same of screws from pose to pose.
RAYCONTACT_API std::optional<Impact> time_of_impact(const Shape& a, const Pose& from_a, const Pose& to_a,
                                                    const Shape& b, const Pose& from_b, const Pose& to_b,
                                                    double distance = 0, double tolerance = 0);
/// The same along paths: a screw from each pose to the next, each a unit of time long. A path of one pose stays there.
/// Throws InputError, too, for paths of no pose, and of different numbers of poses if both have several.
RAYCONTACT_API std::optional<Impact> time_of_impact(const Shape& a, std::span<const Pose> path_a, const Shape& b,
                                                    std::span<const Pose> path_b, double distance = 0,
                                                    double tolerance = 0);

/// The least distance of two meshes on their ways, and when that is.
struct PathClearance : Distance {
    double time = 0;   ///< from 0 to 1; along paths from 0 to their number of poses less 1
    bool meet = false; ///< they meet, as time_of_impact() with the same tolerance has it
};

/// The least distance of two moving meshes from time 0 to 1, if it is within `max` metres; of those that meet what
/// time_of_impact() tells. At the time told they are that far apart, as distance() has it; at no time are they nearer
/// by more than the tolerance. tolerance: metres; 0 takes 1e-4 of the smaller mesh's diagonal. A few times the work of
/// time_of_impact() and some dozens of distance(). Throws InputError as the first, and for a `max` that is negative or
/// not a number.
RAYCONTACT_API std::optional<PathClearance> path_clearance(const Shape& a, const RigidMotion& motion_a, const Shape& b,
                                                           const RigidMotion& motion_b, double max = any_distance,
                                                           double tolerance = 0);
/// The same along paths, as time_of_impact() has them.
RAYCONTACT_API std::optional<PathClearance> path_clearance(const Shape& a, std::span<const Pose> path_a, const Shape& b,
                                                           std::span<const Pose> path_b, double max = any_distance,
                                                           double tolerance = 0);

/// Where two solids press on each other: what lies between a convex part of the one surface and one of the other.
struct ContactPatch {
    double area = 0;   ///< across the normal, m^2
    double volume = 0; ///< of what both share there, m^3
    double depth = 0;  ///< the mean: volume / area, metres
    Vec3 centre;       ///< of that volume, world frame: where its pressure acts
    Vec3 normal;       ///< from a to b, unit, world frame: the way in which b leaves a there
    /// The corners of the convex hull of what presses there, in the plane through `centre` across the normal, world
    /// frame; counter-clockwise where the normal points at the reader. What presses lies at most 1e-9 of its size
    /// beyond it.
    std::vector<Vec3> hull{};
};

/// A force and its torque about a point, world frame.
struct Wrench {
    Vec3 force;  ///< newtons
    Vec3 torque; ///< newton metres
};

/// What a patch without friction can do to b, however its pressure is spread: wrenches of 1 N each along the normal at
/// the corners of the hull, in their order, with torques about a point of the world. Sums of them with factors from 0
/// on are all there is.
RAYCONTACT_API std::vector<Wrench> wrench_basis(const ContactPatch& patch, const Vec3& about);

/// The patches in which two solids overlap, the largest volume first. How finely a mesh is divided does not matter. A
/// pressure that grows with depth pushes with stiffness x volume along the normal at the centre (Hasegawa and Sato
/// 2004). In a corner each wall has a patch of its own; something round in a hole has one for each facet of the hole.
/// None where surfaces touch to 1e-7 of their size, where one body pierces the other, or lies inside it
/// (docs/internals/patches.md). Throws InputError for poses as raycast(), and for a mesh without an inside.
RAYCONTACT_API std::vector<ContactPatch> contact_patches(const Shape& a, const Pose& pose_a, const Shape& b,
                                                         const Pose& pose_b);

/// Whether a point lies in a mesh that is closed and wound alike everywhere, or on its surface; false for others.
/// Exact. The point is in the body frame. Throws InputError for a point that is not finite or beyond 1e30 m.
RAYCONTACT_API bool contains(const Shape& shape, const Vec3& point);
/// The same of a placed mesh, the point in the world frame. Throws InputError for pose and point as raycast().
RAYCONTACT_API bool contains(const Shape& shape, const Pose& pose, const Vec3& point);

// Regions of one mesh, in the body frame, by Shape::vertices(). What was in `found` is replaced: by indices, ascending,
// each once. What is not a number is nowhere.

/// A box along the axes of a frame: the body's, or the one that is named.
struct AxisBox {
    Vec3 low;  ///< its lowest corner, metres
    Vec3 high; ///< its highest corner, metres
};

/// About a shape that is placed, along the axes of the world; a little larger than it is, by what is rounded: shapes
/// whose boxes do not touch share no point. Takes any pose; of one that is not rigid it means nothing.
RAYCONTACT_API AxisBox placed_box(const Shape& shape, const Pose& pose);

/// The triangles whose own boxes touch a box: indices of Shape::triangles().
RAYCONTACT_API void triangles_in_box(const Shape& shape, const Vec3& low, const Vec3& high,
                                     std::vector<std::uint32_t>& found);
/// The vertices with normal . v < offset: indices of Shape::vertices(). normal: of any length.
RAYCONTACT_API void vertices_below(const Shape& shape, const Vec3& normal, double offset,
                                   std::vector<std::uint32_t>& found);
/// Boxes that together hold the mesh, no more than `most` but at least one: of its tree, the largest ones opened.
RAYCONTACT_API std::vector<AxisBox> covering_boxes(const Shape& shape, std::size_t most);

} // namespace raycontact
