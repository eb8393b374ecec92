# SPDX-License-Identifier: Apache-2.0
"""Questions about one or two shapes, without a scene.

Each takes one item or many: shapes one or a list, poses (4, 4) or (..., 4, 4), points (3,) or (..., 3). They fit
together as NumPy broadcasts: what is there once counts for all, and l shapes with poses (n, l, 4, 4) have answers (n,
l). Of many, answers are arrays over the items, found by several threads; Ctrl-C ends them. Where docstrings say (n,),
the batch may have more dimensions. Poses are rigid matrices from the body's frame to the world, None the identity;
lengths are metres. A single question has a `One...` of its answer, whose numbers are plain floats and ints, for type
checkers, too. Triangles from `report.file_triangles` on span holes: the mesh does not have them. Where an answer is
called exact, it is that for the mesh's own double coordinates, rotated and moved, without a tolerance.
"""

from __future__ import annotations

import operator
from typing import NamedTuple, Optional, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Batch, ManyPoints, OnePoint, PoseLike, as_count, as_length, as_points, as_poses
from ._core import InputError
from ._settings import as_settings
from .contacts import PairContacts
from .shape import Shape, ShapeLike, Shapes, as_shape, as_shapes, as_solid

_PLAIN = (np.ndarray, list, tuple)
"""Of which the C++ half takes a point."""


class Distance(NamedTuple):
    """The least distance of two surfaces. Beyond `max` it is inf, with NaN and -1.

    distance: a float or (n,) float64, metres; 0 exactly where `intersects` is true.
    point_a: (3,) or (n, 3) float64, metres, world frame: on the surface of a; where they intersect, one that both
        share.
    point_b: likewise on that of b.
    triangle_a: an int or (n,) int64: on which point_a lies, index in the mesh; -1 for a mesh inside of which the other
        lies.
    triangle_b: likewise for point_b.
    """

    distance: Union[float, NDArray[np.float64]]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    triangle_a: Union[int, NDArray[np.int64]]
    triangle_b: Union[int, NDArray[np.int64]]


class OneDistance(Distance):
    """A `Distance` of a single question.

    distance: a float, metres.
    point_a: (3,) float64.
    point_b: (3,) float64.
    triangle_a: an int.
    triangle_b: an int.
    """

    __slots__ = ()
    distance: float
    triangle_a: int
    triangle_b: int


class Separation(NamedTuple):
    """How far two meshes are apart, or how far the second has to go so that they are.

    distance: a float or (n,) float64, metres: of meshes that share no point their distance; else below 0: minus the
        length of a translation that parts them.
    normal: (3,) or (n, 3) float64, unit, world frame, from a to b: b moved by -distance along it is parted from a. The
        gradient of the distance for b's translation.
    point_a: (3,) or (n, 3) float64, metres, world frame: on the surface of a; of the closest points, once they are
        parted.
    point_b: likewise on that of b, which is where it is given.
    """

    distance: Union[float, NDArray[np.float64]]
    normal: NDArray[np.float64]
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]


class ContactPatches(NamedTuple):
    """Where pairs of solids press on each other; those of a pair in a row, the largest volume first.

    pair: (n,) int64: which of the pairs.
    area: (n,) float64, m^2, across the normal.
    volume: (n,) float64, m^3, of what both share there.
    depth: (n,) float64, metres, the mean: volume / area.
    centre: (n, 3) float64, metres, world frame: the middle of that volume, where its pressure acts.
    normal: (n, 3) float64, unit, world frame, from a to b: the way in which b leaves a there.
    corners: (m, 3) float64, metres, world frame: of the convex hulls, one after the other; see `hull`.
    first_corner: (n + 1,) int64: where those of each begin.
    """

    pair: NDArray[np.int64]
    area: NDArray[np.float64]
    volume: NDArray[np.float64]
    depth: NDArray[np.float64]
    centre: NDArray[np.float64]
    normal: NDArray[np.float64]
    corners: NDArray[np.float64]
    first_corner: NDArray[np.int64]

    def hull(self, i: int) -> NDArray[np.float64]:
        """(m, 3): the corners of the convex hull of what presses in the i-th patch, in the plane through its centre
        across its normal; counter-clockwise where the normal points at the reader. Raises IndexError where there is no
        such patch; -1 is the last one."""
        i = range(len(self.area))[operator.index(i)]
        return self.corners[self.first_corner[i] : self.first_corner[i + 1]]

    def wrench_basis(self, i: int, about: ArrayLike) -> NDArray[np.float64]:
        """(m, 6): what the i-th patch can do to b without friction, however its pressure is spread: forces of 1 N along
        the normal at the corners of the hull, and their torques about a point, (3,), metres, world frame. Sums of
        these rows with factors from 0 on are all there is."""
        origin = as_points(about, "about")
        if origin.shape != (3,) or not np.isfinite(origin).all():
            raise InputError(f"about: has shape {origin.shape}; give three finite numbers")
        arms = self.hull(i) - origin
        force = np.broadcast_to(self.normal[i], arms.shape)
        return np.hstack([force, np.cross(arms, force)])


class ClosestPoint(NamedTuple):
    """The point of a surface nearest to another. Beyond `max`: inf, NaN and -1.

    distance: a float or (n,) float64, metres; `contains` tells on which side of a closed mesh.
    point: (3,) or (n, 3) float64, metres, world frame.
    triangle: an int or (n,) int64: on which it lies, index in the mesh; of several the lowest.
    """

    distance: Union[float, NDArray[np.float64]]
    point: NDArray[np.float64]
    triangle: Union[int, NDArray[np.int64]]


class OneClosestPoint(ClosestPoint):
    """A `ClosestPoint` of a single question.

    distance: a float, metres.
    point: (3,) float64.
    triangle: an int.
    """

    __slots__ = ()
    distance: float
    triangle: int


class SignedDistance(NamedTuple):
    """How far a point is from a mesh, on which side, and what of the mesh is nearest.

    distance: a float or (n,) float64, metres from the surface; below 0 inside, as `contains` has it.
    point: (3,) or (n, 3) float64, metres, world frame: the nearest of the surface.
    triangle: an int or (n,) int64: on which that lies, index in the mesh; of several the lowest.
    gradient: (3,) or (n, 3) float64, unit, world frame: the way in which the distance grows; on the surface the face's
        normal.
    """

    distance: Union[float, NDArray[np.float64]]
    point: NDArray[np.float64]
    triangle: Union[int, NDArray[np.int64]]
    gradient: NDArray[np.float64]


class OneSignedDistance(SignedDistance):
    """A `SignedDistance` of a single question.

    distance: a float, metres.
    point: (3,) float64.
    triangle: an int.
    gradient: (3,) float64.
    """

    __slots__ = ()
    distance: float
    triangle: int


class RayHit(NamedTuple):
    """Where a ray meets a mesh first. Without a hit: inf, NaN and -1.

    distance: a float or (n,) float64, metres, whatever the direction's length.
    point: (3,) or (n, 3) float64, metres, world frame.
    normal: (3,) or (n, 3) float64, unit, world frame: of the face as the shape winds it.
    triangle: an int or (n,) int64: index in the mesh; of equally close ones the lowest.
    """

    distance: Union[float, NDArray[np.float64]]
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    triangle: Union[int, NDArray[np.int64]]


class OneRayHit(RayHit):
    """A `RayHit` of a single question.

    distance: a float, metres.
    point: (3,) float64.
    normal: (3,) float64.
    triangle: an int.
    """

    __slots__ = ()
    distance: float
    triangle: int


class _Pairs(Batch):
    """Pairs of placed shapes for the C++ half."""

    def __init__(
        self,
        a: Shapes,
        b: Shapes,
        pose_a: Optional[PoseLike],
        pose_b: Optional[PoseLike],
        threads: int,
        asked: Optional[str] = None,
    ) -> None:
        shapes_a, lead_a = as_shapes(a, "a", asked)
        shapes_b, lead_b = as_shapes(b, "b", asked)
        poses_a, poses_b = as_poses(pose_a, "pose_a", rigid=True), as_poses(pose_b, "pose_b", rigid=True)
        super().__init__(a=lead_a, b=lead_b, pose_a=poses_a.shape[:-2], pose_b=poses_b.shape[:-2])
        self.core = _core.PlacedPairs(
            self.listed(shapes_a, lead_a),
            self.flat(poses_a, poses_a.shape[:-2]),
            self.listed(shapes_b, lead_b),
            self.flat(poses_b, poses_b.shape[:-2]),
            as_count(threads, "threads"),
        )


class _Placed(Batch):
    """Points or rays at one shape that has poses."""

    def __init__(self, pose: Optional[PoseLike], **vectors: ArrayLike) -> None:
        matrices = as_poses(pose, "pose", rigid=True)
        lists = {name: as_points(value, name) for name, value in vectors.items()}
        super().__init__(**{name: value.shape[:-1] for name, value in lists.items()}, pose=matrices.shape[:-2])
        self.poses = self.flat(matrices, matrices.shape[:-2])
        self.vectors = {name: self.flat(value, value.shape[:-1]) for name, value in lists.items()}


def collide(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[PoseLike] = None,
    pose_b: Optional[PoseLike] = None,
    *,
    direction: str = "reprojected",
    features: str = "edges",
    margin: float = 0.0,
    max_contacts_per_pair: int = 0,
    devices: str = "cpu",
    threads: int = 0,
) -> PairContacts:
    """All contacts of two shapes, or of many pairs of them, once: those that a Scene with the bodies would find.

    Normals point from a to b. `contacts.pair` says to which pair each contact belongs. To ask about the same bodies in
    many poses one after the other, keep a Scene.

    a, b: a shape, or a list; anything that `Shape` takes alone is made one.
    pose_a, pose_b: (4, 4) or (..., 4, 4), rigid, from the body's frame to the world, metres; None is the identity. Or
        (R, t), (..., 3, 3) or SciPy's Rotation and (..., 3); or what has `as_matrix`, as SciPy's RigidTransform. a, b,
        pose_a and pose_b fit together as NumPy broadcasts; `contacts.pair` counts through the batch, last dimension
        first (`np.unravel_index`).
    direction, features, max_contacts_per_pair, devices: as of Scene.
    margin: metres; surfaces that are apart by up to this have contacts, too, with depth <= 0, minus the gap.
    threads: 0 is one for each core; no bit depends on it.
    Raises InputError for poses that are not finite and rigid to 1e-4, where numbers of shapes and poses differ, and as
    Scene does for settings.
    """
    metres = as_length(margin, "margin")
    if not 0 <= metres <= 1e12:
        raise InputError(f"margin: {metres:g} is not from 0 to 1e12 m")
    quick = devices == "cpu" and threads == max_contacts_per_pair == metres == 0
    if quick and type(a) is Shape and type(b) is Shape:
        one = _core.one_collide(a._core, pose_a, b._core, pose_b, direction, features)
        if one is not None:
            return PairContacts._from_bytes(one)
    pairs = _Pairs(a, b, pose_a, pose_b, threads)
    settings = as_settings(
        {
            "direction": direction,
            "features": features,
            "max_contacts_per_pair": max_contacts_per_pair,
            "devices": devices,
            "speculative": metres > 0,
            "speculative_margin": metres if metres > 0 else None,
        }
    )
    found = _core.collide(pairs.core, settings)
    return PairContacts._from_bytes(found)


@overload
def intersects(a: ShapeLike, b: ShapeLike, pose_a: None = None, pose_b: None = None, *, threads: int = 0) -> bool: ...


@overload
def intersects(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[PoseLike] = None,
    pose_b: Optional[PoseLike] = None,
    *,
    threads: int = 0,
) -> Union[bool, NDArray[np.bool_]]: ...


def intersects(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[PoseLike] = None,
    pose_b: Optional[PoseLike] = None,
    *,
    threads: int = 0,
) -> Union[bool, NDArray[np.bool_]]:
    """Whether two meshes share a point: their surfaces meet (touching counts), or one lies inside the other, if that
    has an inside (`Shape.has_inside`). Exact.

    Arguments and errors are those of `collide`. Gives a bool, or (n,) bool for lists.
    """
    if type(a) is Shape and type(b) is Shape and threads == 0:
        one = _core.one_intersects(a._core, pose_a, b._core, pose_b)
        if one is not None:
            return one
    pairs = _Pairs(a, b, pose_a, pose_b, threads)
    (found,) = pairs.answers((_core.intersects(pairs.core).view(np.bool_),))
    return found


def common_point(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[PoseLike] = None,
    pose_b: Optional[PoseLike] = None,
    *,
    threads: int = 0,
) -> NDArray[np.float64]:
    """A point that both meshes share, to rounding; NaN where `intersects` is false.

    Arguments and errors are those of `collide`. Gives (3,) or (n, 3) float64, metres, world frame.
    """
    pairs = _Pairs(a, b, pose_a, pose_b, threads)
    (found,) = pairs.answers((_core.common_points(pairs.core),))
    return found


@overload
def distance(
    a: ShapeLike, b: ShapeLike, pose_a: None = None, pose_b: None = None, *, max: float = np.inf, threads: int = 0
) -> OneDistance: ...


@overload
def distance(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[PoseLike] = None,
    pose_b: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> Distance: ...


def distance(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[PoseLike] = None,
    pose_b: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> Distance:
    """The least distance of two surfaces, and where it is; 0 where they intersect or one lies inside the other.

    Warns of a mesh without an inside (SheetWarning). Whether it is 0 is decided exactly; else it is right to some 1e-15
    of size and distance from the origin, between edges parallel to some 1e-8 to 1e-8 of their length.

    Arguments and errors are those of `collide`, and max: metres, beyond which it is not looked for; a small one saves
    work. One that is negative or NaN raises InputError.
    """
    if type(a) is Shape and type(b) is Shape and type(max) is float and threads == 0:
        one = _core.one_distance(a._core, pose_a, b._core, pose_b, max)
        if one is not None:
            if a._untold or b._untold:
                as_solid(a, "distance"), as_solid(b, "distance")
            return OneDistance(*one)
    pairs = _Pairs(a, b, pose_a, pose_b, threads, "distance")
    return pairs.answer(OneDistance, Distance, _core.distances(pairs.core, as_length(max, "max")))


def separation(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[PoseLike] = None,
    pose_b: Optional[PoseLike] = None,
    *,
    threads: int = 0,
) -> Separation:
    """The signed distance of two meshes: outside as `distance` has it, inside by a translation that parts them.

    After that translation they share no point, and are some 1e-6 of the smaller mesh's diagonal apart. Two convex
    meshes cannot be parted by one that is shorter by 1 %; of others it is the best that a search found.

    Arguments and errors are those of `collide`.
    """
    pairs = _Pairs(a, b, pose_a, pose_b, threads, "separation")
    return Separation(*pairs.answers(_core.separations(pairs.core)))


def contact_patches(
    a: Shapes,
    b: Shapes,
    pose_a: Optional[PoseLike] = None,
    pose_b: Optional[PoseLike] = None,
    *,
    threads: int = 0,
) -> ContactPatches:
    """The patches in which solids overlap: area, mean depth, centre, normal; however finely meshes are divided.

    A pressure that grows with depth pushes with stiffness x volume along the normal at the centre (Hasegawa and Sato
    2004). In a corner each wall has its own patch. Where one mesh pierces the other, or lies inside it, there is none.

    Arguments and errors are those of `collide`; a mesh without an inside raises InputError, too.
    """
    pairs = _Pairs(a, b, pose_a, pose_b, threads)
    return ContactPatches(*(np.asarray(column) for column in _core.contact_patches(pairs.core)))


@overload
def closest_point(
    shape: ShapeLike, points: ManyPoints, pose: Optional[PoseLike] = None, *, max: float = np.inf, threads: int = 0
) -> ClosestPoint: ...


@overload
def closest_point(
    shape: ShapeLike, points: OnePoint, pose: None = None, *, max: float = np.inf, threads: int = 0
) -> OneClosestPoint: ...


@overload
def closest_point(
    shape: ShapeLike, points: ArrayLike, pose: Optional[PoseLike] = None, *, max: float = np.inf, threads: int = 0
) -> ClosestPoint: ...


def closest_point(
    shape: ShapeLike, points: ArrayLike, pose: Optional[PoseLike] = None, *, max: float = np.inf, threads: int = 0
) -> ClosestPoint:
    """The point of a mesh's surface that is nearest to each point, if it is within `max` metres.

    In double: right to some 1e-15 of the mesh's size and its distance from the origins.

    points: (3,) or (n, 3), metres, world frame.
    pose: (4, 4) or (n, 4, 4), or as of `collide`, rigid, from the mesh's frame to the world, metres; None is the
        identity.
    threads: 0 is one for each core; no bit depends on it.
    Raises InputError for a point that is not finite, a pose that is not finite and rigid to 1e-4, a `max` that is
    negative or NaN, and where numbers of points and poses differ; each may be there once for all.
    """
    if type(shape) is Shape and type(points) in _PLAIN and type(max) is float and threads == 0:
        one = _core.one_closest_point(shape._core, pose, points, max)
        if one is not None:
            return OneClosestPoint(*one)
    placed = _Placed(pose, points=points)
    found = _core.closest_points(
        as_shape(shape)._core,
        placed.poses,
        placed.vectors["points"],
        as_length(max, "max"),
        as_count(threads, "threads"),
    )
    return placed.answer(OneClosestPoint, ClosestPoint, found)


@overload
def signed_distance(
    shape: ShapeLike, points: ManyPoints, pose: Optional[PoseLike] = None, *, threads: int = 0
) -> SignedDistance: ...


@overload
def signed_distance(
    shape: ShapeLike, points: OnePoint, pose: None = None, *, threads: int = 0
) -> OneSignedDistance: ...


@overload
def signed_distance(
    shape: ShapeLike, points: ArrayLike, pose: Optional[PoseLike] = None, *, threads: int = 0
) -> SignedDistance: ...


def signed_distance(
    shape: ShapeLike, points: ArrayLike, pose: Optional[PoseLike] = None, *, threads: int = 0
) -> SignedDistance:
    """How far each point is from a mesh: above 0 outside, below 0 inside; never below 0 of a mesh without an inside.

    Warns of such a mesh (SheetWarning). Which side is decided exactly, value and point are as right as those of
    `closest_point`. Points that lie near each other share work, in whatever order they come. Arguments and errors are
    those of `closest_point`.
    """
    if type(shape) is Shape and type(points) in _PLAIN and threads == 0:
        one = _core.one_signed_distance(shape._core, pose, points)
        if one is not None:
            if shape._untold:
                as_solid(shape, "signed_distance")
            return OneSignedDistance(*one)
    placed = _Placed(pose, points=points)
    places = placed.vectors["points"]
    made = as_solid(shape, "signed_distance")
    found = _core.signed_distances(made._core, placed.poses, places, as_count(threads, "threads"))
    return placed.answer(OneSignedDistance, SignedDistance, found)


def distance_grid(
    shape: ShapeLike,
    counts: tuple[int, int, int],
    low: Optional[ArrayLike] = None,
    high: Optional[ArrayLike] = None,
    *,
    threads: int = 0,
) -> NDArray[np.float64]:
    """`signed_distance` at the points of a grid: `grid[i, j, k]` of the i-th x, the j-th y and the k-th z.

    counts: points along x, y and z, at least 1 each.
    low, high: (3,), metres, body frame: the first and the last point of each axis; None is the mesh's box.
    Gives counts float64, metres. Raises InputError for counts below 1 and corners that are not finite.
    """
    made = as_shape(shape)
    sizes = [as_count(count, "counts") for count in counts]
    if len(sizes) != 3 or min(sizes) < 1:
        raise InputError("counts are three numbers of points, each at least 1")
    ends = [as_points(given, name).reshape(3) for given, name in (
        (made.box[0] if low is None else low, "low"), (made.box[1] if high is None else high, "high"))]  # fmt: skip
    axes = [np.linspace(ends[0][k], ends[1][k], sizes[k]) for k in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    return np.asarray(signed_distance(made, points, threads=threads).distance)


@overload
def raycast(
    shape: ShapeLike,
    origins: ManyPoints,
    directions: ArrayLike,
    pose: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> RayHit: ...


@overload
def raycast(
    shape: ShapeLike,
    origins: ArrayLike,
    directions: ManyPoints,
    pose: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> RayHit: ...


@overload
def raycast(
    shape: ShapeLike,
    origins: OnePoint,
    directions: OnePoint,
    pose: None = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> OneRayHit: ...


@overload
def raycast(
    shape: ShapeLike,
    origins: ArrayLike,
    directions: ArrayLike,
    pose: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> RayHit: ...


def raycast(
    shape: ShapeLike,
    origins: ArrayLike,
    directions: ArrayLike,
    pose: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> RayHit:
    """The closest triangle that each ray meets within `max` metres of its origin; both sides of a face count.

    Watertight: exact predicates decide which triangles a ray meets (Shewchuk 1997).

    origins, directions: (3,) or (n, 3), metres, world frame; directions of any length.
    pose, threads: as of `closest_point`.
    Raises InputError for a direction that is zero or not finite, and as `closest_point` does.
    """
    if type(shape) is Shape and type(origins) in _PLAIN and type(max) is float and threads == 0:
        one = _core.one_raycast(shape._core, pose, origins, directions, max)
        if one is not None:
            return OneRayHit(*one)
    rays = _Placed(pose, origins=origins, directions=directions)
    starts, along = rays.vectors["origins"], rays.vectors["directions"]
    found = _core.ray_hits(
        as_shape(shape)._core, rays.poses, starts, along, as_length(max, "max"), as_count(threads, "threads")
    )
    return rays.answer(OneRayHit, RayHit, found)


@overload
def raycast_any(
    shape: ShapeLike,
    origins: ManyPoints,
    directions: ArrayLike,
    pose: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> Union[bool, NDArray[np.bool_]]: ...


@overload
def raycast_any(
    shape: ShapeLike,
    origins: ArrayLike,
    directions: ManyPoints,
    pose: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> Union[bool, NDArray[np.bool_]]: ...


@overload
def raycast_any(
    shape: ShapeLike,
    origins: OnePoint,
    directions: OnePoint,
    pose: None = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> bool: ...


@overload
def raycast_any(
    shape: ShapeLike,
    origins: ArrayLike,
    directions: ArrayLike,
    pose: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> Union[bool, NDArray[np.bool_]]: ...


def raycast_any(
    shape: ShapeLike,
    origins: ArrayLike,
    directions: ArrayLike,
    pose: Optional[PoseLike] = None,
    *,
    max: float = np.inf,
    threads: int = 0,
) -> Union[bool, NDArray[np.bool_]]:
    """Whether `raycast` has a hit; ends at the first one found.

    Arguments and errors are those of `raycast`. Gives a bool, or (n,) bool for lists.
    """
    if type(shape) is Shape and type(origins) in _PLAIN and type(max) is float and threads == 0:
        one = _core.one_raycast_any(shape._core, pose, origins, directions, max)
        if one is not None:
            return one
    rays = _Placed(pose, origins=origins, directions=directions)
    starts, along = rays.vectors["origins"], rays.vectors["directions"]
    met = _core.rays_meet(
        as_shape(shape)._core, rays.poses, starts, along, as_length(max, "max"), as_count(threads, "threads")
    )
    (found,) = rays.answers((met.view(np.bool_),))
    return found


@overload
def contains(
    shape: ShapeLike, points: ManyPoints, pose: Optional[PoseLike] = None, *, threads: int = 0
) -> Union[bool, NDArray[np.bool_]]: ...


@overload
def contains(shape: ShapeLike, points: OnePoint, pose: None = None, *, threads: int = 0) -> bool: ...


@overload
def contains(
    shape: ShapeLike, points: ArrayLike, pose: Optional[PoseLike] = None, *, threads: int = 0
) -> Union[bool, NDArray[np.bool_]]: ...


def contains(
    shape: ShapeLike, points: ArrayLike, pose: Optional[PoseLike] = None, *, threads: int = 0
) -> Union[bool, NDArray[np.bool_]]:
    """Whether each point lies in a mesh that has an inside, or on its surface; False for others, of which it warns
    (SheetWarning).

    Exact. Arguments and errors are those of `closest_point`. Gives a bool, or (n,) bool for lists.
    """
    if type(shape) is Shape and type(points) in _PLAIN and threads == 0:
        one = _core.one_contains(shape._core, pose, points)
        if one is not None:
            if shape._untold:
                as_solid(shape, "contains")
            return one
    placed = _Placed(pose, points=points)
    places = placed.vectors["points"]
    made = as_solid(shape, "contains")
    inside = _core.contains(made._core, placed.poses, places, as_count(threads, "threads"))
    (found,) = placed.answers((inside.view(np.bool_),))
    return found


__all__ = [
    "ClosestPoint", "ContactPatches", "Distance", "OneClosestPoint", "OneDistance", "OneRayHit", "OneSignedDistance",
    "RayHit", "SignedDistance", "closest_point", "collide", "common_point", "contact_patches", "contains", "distance",
    "distance_grid", "intersects", "raycast", "raycast_any", "signed_distance",
]  # fmt: skip
