# SPDX-License-Identifier: Apache-2.0
"""Questions about one or two shapes, without a scene.

Each takes one item or many: shapes one or a list, poses (4, 4) or (n, 4, 4), points (3,) or (n, 3). What is there once
counts for all items. Of many, answers are arrays over the items, found by several threads; Ctrl-C ends them. Poses are
rigid matrices from the body's frame to the world, None the identity; lengths are metres. Where an answer is called
exact, it is that for the mesh's own double coordinates, rotated and moved, without a tolerance.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Optional, Union

import numpy as np

from . import _core
from ._arrays import as_count, as_length, as_points, as_poses, one_of
from .contacts import PairContacts
from .scene import as_settings
from .shape import ShapeLike, as_shape, as_shapes

Shapes = Union[ShapeLike, Sequence[ShapeLike]]


class Distance(NamedTuple):
    """The least distance of two surfaces. Beyond `max` it is inf, with NaN and -1."""

    distance: Union[float, np.ndarray]
    """() or (n,) float64, metres; 0 exactly where `intersects` is true."""
    point_a: np.ndarray
    """(3,) or (n, 3) float64, metres, world frame: on the surface of a; where they intersect, one that both share."""
    point_b: np.ndarray
    """Likewise on that of b."""
    triangle_a: Union[int, np.ndarray]
    """() or (n,) int64: on which point_a lies, index in the mesh; -1 for a mesh inside of which the other lies."""
    triangle_b: Union[int, np.ndarray]
    """Likewise for point_b."""


class ClosestPoint(NamedTuple):
    """The point of a surface nearest to another. Beyond `max`: inf, NaN and -1."""

    distance: Union[float, np.ndarray]
    """() or (n,) float64, metres; `contains` tells on which side of a closed mesh."""
    point: np.ndarray
    """(3,) or (n, 3) float64, metres, world frame."""
    triangle: Union[int, np.ndarray]
    """() or (n,) int64: on which it lies, index in the mesh; of several the lowest."""


class RayHit(NamedTuple):
    """Where a ray meets a mesh first. Without a hit: inf, NaN and -1."""

    distance: Union[float, np.ndarray]
    """() or (n,) float64, metres, whatever the direction's length."""
    point: np.ndarray
    """(3,) or (n, 3) float64, metres, world frame."""
    normal: np.ndarray
    """(3,) or (n, 3) float64, unit, world frame: of the face as the shape winds it."""
    triangle: Union[int, np.ndarray]
    """() or (n,) int64: index in the mesh; of equally close ones the lowest."""


class _Pairs:
    """Pairs of placed shapes for the C++ half."""

    def __init__(self, a: Shapes, b: Shapes, pose_a: Optional[np.ndarray], pose_b: Optional[np.ndarray], threads: int):
        self.a, one_a = as_shapes(a, "a")
        self.b, one_b = as_shapes(b, "b")
        self.pose_a, one_pose_a = as_poses(pose_a, "pose_a")
        self.pose_b, one_pose_b = as_poses(pose_b, "pose_b")
        self.is_one = one_a and one_b and one_pose_a and one_pose_b
        self.core = _core.PlacedPairs(self.a, self.pose_a, self.b, self.pose_b, as_count(threads, "threads"))


def collide(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[np.ndarray] = None,
    pose_b: Optional[np.ndarray] = None,
    *,
    direction: str = "reprojected",
    features: str = "edges",
    max_contacts_per_pair: int = 0,
    devices: str = "cpu",
    threads: int = 0,
) -> PairContacts:
    """All contacts of two meshes, or of many pairs of them, once: those that a Scene with the bodies would find.

    Normals point from a to b. `contacts.pair` says to which pair each contact belongs. To ask about the same bodies in
    many poses one after the other, keep a Scene.
    direction, features, max_contacts_per_pair, devices: as of Scene.
    Raises InputError for poses that are not finite and rigid to 1e-4, and where numbers of shapes and poses differ.
    """
    pairs = _Pairs(a, b, pose_a, pose_b, threads)
    settings = as_settings(
        {
            "direction": direction,
            "features": features,
            "max_contacts_per_pair": max_contacts_per_pair,
            "devices": devices,
            "threads": threads,
        }
    )
    found = _core.collide(pairs.a, pairs.pose_a, pairs.b, pairs.pose_b, pairs.core.count, settings)
    return PairContacts._from_bytes(found)


def intersects(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[np.ndarray] = None,
    pose_b: Optional[np.ndarray] = None,
    *,
    threads: int = 0,
) -> Union[bool, np.ndarray]:
    """Whether two meshes share a point: their surfaces meet (touching counts), or one lies inside the other, if that is
    closed and wound alike everywhere. Exact. bool, or (n,) bool."""
    pairs = _Pairs(a, b, pose_a, pose_b, threads)
    found = _core.intersects(pairs.core).view(np.bool_)
    return bool(found[0]) if pairs.is_one else found


def common_point(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[np.ndarray] = None,
    pose_b: Optional[np.ndarray] = None,
    *,
    threads: int = 0,
) -> np.ndarray:
    """A point that both meshes share, to rounding: (3,) or (n, 3), metres, world frame; NaN where `intersects` is false."""
    pairs = _Pairs(a, b, pose_a, pose_b, threads)
    found = _core.common_points(pairs.core)
    return found[0] if pairs.is_one else found


def distance(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[np.ndarray] = None,
    pose_b: Optional[np.ndarray] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> Distance:
    """The least distance of two surfaces, and where it is; 0 where they intersect or one lies inside the other.

    Whether it is 0 is decided exactly; else it is right to some 1e-15 of size and distance from the origin, between
    edges parallel to some 1e-8 to 1e-8 of their length. A small `max` saves work.
    """
    pairs = _Pairs(a, b, pose_a, pose_b, threads)
    return Distance(*one_of(_core.distances(pairs.core, as_length(max, "max")), pairs.is_one))


def closest_point(
    shape: ShapeLike, points: np.ndarray, pose: Optional[np.ndarray] = None, *, max: float = np.inf, threads: int = 0
) -> ClosestPoint:
    """The point of a mesh's surface that is nearest to each point, if it is within `max` metres.

    points: world frame. In double: right to some 1e-15 of the mesh's size and its distance from the origins.
    """
    places, one_point = as_points(points, "points")
    matrices, one_pose = as_poses(pose, "pose")
    found = _core.closest_points(
        as_shape(shape)._core, matrices, places, as_length(max, "max"), as_count(threads, "threads")
    )
    return ClosestPoint(*one_of(found, one_point and one_pose))


def raycast(
    shape: ShapeLike,
    origins: np.ndarray,
    directions: np.ndarray,
    pose: Optional[np.ndarray] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> RayHit:
    """The closest triangle that each ray meets within `max` metres of its origin; both sides of a face count.

    Watertight: exact predicates decide which triangles a ray meets (Shewchuk 1997). directions: of any length. Raises
    InputError for one that is zero or not finite.
    """
    starts, along, matrices, one = _rays(origins, directions, pose)
    shape_core, most = as_shape(shape)._core, as_length(max, "max")
    return RayHit(*one_of(_core.ray_hits(shape_core, matrices, starts, along, most, as_count(threads, "threads")), one))


def raycast_any(
    shape: ShapeLike,
    origins: np.ndarray,
    directions: np.ndarray,
    pose: Optional[np.ndarray] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> Union[bool, np.ndarray]:
    """Whether `raycast` has a hit; ends at the first one found. bool, or (n,) bool."""
    starts, along, matrices, one = _rays(origins, directions, pose)
    shape_core, most = as_shape(shape)._core, as_length(max, "max")
    found = _core.rays_meet(shape_core, matrices, starts, along, most, as_count(threads, "threads")).view(np.bool_)
    return bool(found[0]) if one else found


def contains(
    shape: ShapeLike, points: np.ndarray, pose: Optional[np.ndarray] = None, *, threads: int = 0
) -> Union[bool, np.ndarray]:
    """Whether each point lies in a mesh that is closed and wound alike everywhere, or on its surface; False for others.

    Exact. points: world frame. bool, or (n,) bool.
    """
    places, one_point = as_points(points, "points")
    matrices, one_pose = as_poses(pose, "pose")
    found = _core.contains(as_shape(shape)._core, matrices, places, as_count(threads, "threads")).view(np.bool_)
    return bool(found[0]) if one_point and one_pose else found


def _rays(origins: np.ndarray, directions: np.ndarray, pose: Optional[np.ndarray]) -> tuple:
    starts, one_origin = as_points(origins, "origins")
    along, one_direction = as_points(directions, "directions")
    matrices, one_pose = as_poses(pose, "pose")
    return starts, along, matrices, one_origin and one_direction and one_pose


__all__ = [
    "ClosestPoint", "Distance", "RayHit", "closest_point", "collide", "common_point", "contains", "distance",
    "intersects", "raycast", "raycast_any",
]  # fmt: skip
