# SPDX-License-Identifier: Apache-2.0
"""When moving meshes meet."""

from __future__ import annotations

from typing import NamedTuple, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import Batch, PoseLike, as_count, as_length, as_poses
from ._core import InputError
from .shape import Shapes, as_shapes


class Impact(NamedTuple):
    """When two moving meshes come near each other first, and where. Of those that stay apart: inf, NaN and -1.

    time: a float or (n,) float64: from 0 to 1 between two poses; along p poses from 0 to p - 1.
    distance: a float or (n,) float64, metres, between the two points; 0 where they share a point at the start.
    point_a: (3,) or (n, 3) float64, metres, world frame: on the surface of a at that time.
    point_b: likewise on that of b.
    normal: (3,) or (n, 3) float64, unit, world frame, from a to b; zero where they share a point at the start.
    triangle_a: an int or (n,) int64: on which point_a lies, index in the mesh; -1 for a mesh inside of which the other
        lies.
    triangle_b: likewise for point_b.
    """

    time: Union[float, NDArray[np.float64]]
    distance: Union[float, NDArray[np.float64]]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    normal: NDArray[np.float64]
    triangle_a: Union[int, NDArray[np.int64]]
    triangle_b: Union[int, NDArray[np.int64]]


class PathClearance(NamedTuple):
    """The least distance of two meshes on their ways, and when that is. Beyond `max`: inf, NaN and -1.

    distance: a float or (n,) float64, metres; at most 1e-7 of the smaller mesh's diagonal where they meet.
    point_a: (3,) or (n, 3) float64, metres, world frame: on the surface of a at that time.
    point_b: likewise on that of b.
    triangle_a: an int or (n,) int64: on which point_a lies, index in the mesh; -1 for a mesh inside of which the other
        lies.
    triangle_b: likewise for point_b.
    time: a float or (n,) float64: from 0 to 1 between two poses; along p poses from 0 to p - 1.
    meet: a bool or (n,) bool: they do, as `time_of_impact` has it.
    """

    distance: Union[float, NDArray[np.float64]]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    triangle_a: Union[int, NDArray[np.int64]]
    triangle_b: Union[int, NDArray[np.int64]]
    time: Union[float, NDArray[np.float64]]
    meet: Union[bool, NDArray[np.bool_]]


class BodyImpact(NamedTuple):
    """When moving meshes meet the first of the bodies of a scene, and where. Of those that meet none: inf, NaN and -1.

    time: a float or (n,) float64, from 0 to 1.
    distance: a float or (n,) float64, metres, between the two points; 0 where they share a point at the start.
    point: (3,) or (n, 3) float64, metres, world frame: on the moving mesh at that time.
    body_point: likewise on the body.
    normal: (3,) or (n, 3) float64, unit, world frame, from the moving mesh to the body; zero where they share a point
        at the start.
    triangle: an int or (n,) int64, index in the moving mesh; -1 where the body lies inside it.
    body_triangle: likewise in the body's mesh.
    body: an int or (n,) int64: id.
    """

    time: Union[float, NDArray[np.float64]]
    distance: Union[float, NDArray[np.float64]]
    point: NDArray[np.float64]
    body_point: NDArray[np.float64]
    normal: NDArray[np.float64]
    triangle: Union[int, NDArray[np.int64]]
    body_triangle: Union[int, NDArray[np.int64]]
    body: Union[int, NDArray[np.int64]]


def time_of_impact(
    a: Shapes,
    b: Shapes,
    path_a: Optional[PoseLike] = None,
    path_b: Optional[PoseLike] = None,
    *,
    distance: float = 0.0,
    tolerance: float = 0.0,
    threads: int = 0,
) -> Impact:
    """The first time at which two moving meshes touch, or are not farther apart than `distance` metres.

    Never late: at no earlier time are they that near. Early by no more than the tolerance: at the time told they are
    within distance + tolerance.

    a, b: a shape, or a list; anything that `Shape` takes alone is made one.
    path_a, path_b: rigid poses, from the body's frame to the world, metres, in any form that `collide` takes. (4, 4)
        stays there, None at the identity; (p, 4, 4), or a list of p poses, goes from each to the next in a unit of time
        by the screw that leads there: a turn about an axis by at most half a round, and a shift along it, both at
        constant rates. (..., p, 4, 4) are many paths, which fit together with the shapes as NumPy broadcasts.
    tolerance: metres; 0 takes 1e-7 of the smaller mesh's diagonal.
    threads: 0 is one for each core; no bit depends on it.
    Raises InputError for poses that are not finite and rigid to 1e-4, for paths that differ in how many poses they have
    (one pose fits any), and for a distance or a tolerance that is negative or not finite.
    """
    moving = _Moving(a, b, path_a, path_b, "time_of_impact")
    metres = as_length(distance, "distance"), as_length(tolerance, "tolerance")
    return Impact(*moving.answers(_core.times_of_impact(*moving.given, *metres, as_count(threads, "threads"))))


def path_clearance(
    a: Shapes,
    b: Shapes,
    path_a: Optional[PoseLike] = None,
    path_b: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    tolerance: float = 0.0,
    threads: int = 0,
) -> PathClearance:
    """The least distance of two moving meshes, and when that is; of those that meet the time when they do.

    At no time are they nearer by more than the tolerance; at the time told they are that far apart, as `distance` has
    it. A few times the work of `time_of_impact` and some dozens of `distance`.

    a, b, path_a, path_b, threads: as of `time_of_impact`, which raises the same.
    max: metres, beyond which it is not looked for; a small one saves work.
    tolerance: metres; 0 takes 1e-4 of the smaller mesh's diagonal.
    """
    moving = _Moving(a, b, path_a, path_b, "path_clearance")
    metres = as_length(max, "max"), as_length(tolerance, "tolerance")
    *least, meet = _core.path_clearances(*moving.given, *metres, as_count(threads, "threads"))
    return PathClearance(*moving.answers((*least, meet.view(np.bool_))))


class _Moving(Batch):
    """Pairs of moving shapes for the C++ half."""

    def __init__(
        self, a: Shapes, b: Shapes, path_a: Optional[PoseLike], path_b: Optional[PoseLike], asked: str
    ) -> None:
        shapes_a, lead_a = as_shapes(a, "a", asked)
        shapes_b, lead_b = as_shapes(b, "b", asked)
        paths_a, paths_b = _paths(path_a, "path_a"), _paths(path_b, "path_b")
        steps_a, steps_b = paths_a.shape[-3], paths_b.shape[-3]
        if 0 in (steps_a, steps_b):
            raise InputError("a path has no pose; give one at least")
        if steps_a != steps_b and 1 not in (steps_a, steps_b):
            raise InputError(f"path_a has {steps_a} poses and path_b {steps_b}; give as many, or one of what stays")
        super().__init__(a=lead_a, b=lead_b, path_a=paths_a.shape[:-3], path_b=paths_b.shape[:-3])
        self.given = (
            self.listed(shapes_a, lead_a),
            self.flat(paths_a, paths_a.shape[:-3]).reshape(-1, 4, 4),
            steps_a,
            self.listed(shapes_b, lead_b),
            self.flat(paths_b, paths_b.shape[:-3]).reshape(-1, 4, 4),
            steps_b,
        )


def _paths(given: Optional[PoseLike], what: str) -> NDArray[np.float64]:
    """(..., p, 4, 4)."""
    poses = as_poses(given, what, rigid=True)
    return poses[np.newaxis] if poses.ndim == 2 else poses
