# SPDX-License-Identifier: Apache-2.0
"""Bodies with shapes and poses, stepped in time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Optional, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import (
    Batch,
    ManyPoints,
    OnePoint,
    PoseLike,
    as_count,
    as_id,
    as_id_array,
    as_ids,
    as_length,
    as_pairs,
    as_points,
    as_pose,
    as_poses,
)  # fmt: skip
from ._core import InputError, StepStats
from ._memory import as_column
from ._settings import as_settings
from .contacts import Contacts
from .impacts import BodyImpact
from .queries import Distance, OneDistance
from .shape import Shape, ShapeLike, Shapes, as_shapes

_Id = Union[int, np.integer[Any]]
"""Of one body."""


class LostContacts(NamedTuple):
    """Contacts that touched in the last step but one and do not in the last.

    bodies: (n, 2) int64: ids; these bodies may have been removed since.
    key: (n,) uint64: Contacts.key of each.
    """

    bodies: NDArray[np.int64]
    key: NDArray[np.uint64]


class Touches(NamedTuple):
    """Pairs of bodies that touch, by slots.

    bodies: (n, 2) int64: ids; of those that ended, bodies may have been removed since.
    point: (n, 3) float64, metres, world frame: between the witness points of the deepest contact of the last step in
        which the two had any.
    normal: (n, 3) float32, unit, world frame: that contact's.
    depth: (n,) float32, metres: that contact's.
    sensor: (n,) bool: one of the two is a sensor.
    """

    bodies: NDArray[np.int64]
    point: NDArray[np.float64]
    normal: NDArray[np.float32]
    depth: NDArray[np.float32]
    sensor: NDArray[np.bool_]


class SceneState(NamedTuple):
    """What `Scene.save_state` tells; can be pickled.

    data: all but the shapes.
    shapes: those of the bodies, each once, which `data` names by their places.
    """

    data: bytes
    shapes: list[Shape]

    def __repr__(self) -> str:
        return f"<SceneState: {len(self.data)} bytes, {len(self.shapes)} shapes>"


class BodyRayHits(NamedTuple):
    """Where rays meet the bodies of a scene first. A ray without a hit has distance inf, NaN and -1.

    distance: a float or (n,) float64, metres, whatever the direction's length.
    point: (3,) or (n, 3) float64, metres, world frame.
    normal: (3,) or (n, 3) float64, unit, world frame: of the face as its shape winds it.
    triangle: an int or (n,) int64: index in the mesh.
    body: an int or (n,) int64: id.
    """

    distance: Union[float, NDArray[np.float64]]
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    triangle: Union[int, NDArray[np.int64]]
    body: Union[int, NDArray[np.int64]]


class OneBodyRayHit(BodyRayHits):
    """A `BodyRayHits` of a single question.

    distance: a float, metres.
    point: (3,) float64.
    normal: (3,) float64.
    triangle: an int.
    body: an int.
    """

    __slots__ = ()
    distance: float
    triangle: int
    body: int


class BodyClosestPoints(NamedTuple):
    """Points of all surfaces that are nearest to others. Where none is near enough: inf, NaN and -1.

    distance: a float or (n,) float64, metres.
    point: (3,) or (n, 3) float64, metres, world frame.
    triangle: an int or (n,) int64: index in the mesh.
    body: an int or (n,) int64: id.
    """

    distance: Union[float, NDArray[np.float64]]
    point: NDArray[np.float64]
    triangle: Union[int, NDArray[np.int64]]
    body: Union[int, NDArray[np.int64]]


class OneBodyClosestPoint(BodyClosestPoints):
    """A `BodyClosestPoints` of a single question.

    distance: a float, metres.
    point: (3,) float64.
    triangle: an int.
    body: an int.
    """

    __slots__ = ()
    distance: float
    triangle: int
    body: int


class BodyOverlaps(NamedTuple):
    """Which shapes of a batch meet which bodies, sorted by item, then by the body's slot.

    item: (n,) int64: place in the batch, last dimension first (`np.unravel_index`).
    body: (n,) int64: id.
    """

    item: NDArray[np.int64]
    body: NDArray[np.int64]


class Scene:
    """Bodies with shapes and poses. It finds every contact between them where they are; it moves nothing.

    A step is one call of `find_contacts`. Poses are rigid 4 x 4 matrices from the body's frame to the world, metres,
    the translation in the last column; ids are whole numbers that count from 0 as long as nothing is removed. One scene
    is used by one thread at a time; a second one gets a RuntimeError. Computing does not hold the GIL.

    What is found:
        method: "certified" (skips what cannot touch yet; contacts as "standard"), "standard" (every ray, every step),
            "iterative", "predictive" (Lehericey et al. 2013).
        direction: what normals and depths are made of: "reprojected" (the face that was hit), "refined" (the nearest
            way out), "ray" (along the ray, Hermann et al. 2008), "weighted" (with edges patches, for springs).
        features: "edges" (vertices and sharp edges: no two closed meshes intersect unnoticed) or "vertices" (the
            paper's rule).
        speculative: also contacts before anything touches, with depth <= 0, within `speculative_margin` metres (None:
            a four-hundredth of the smaller body's diagonal) or on the way to the next step.
        max_contacts_per_pair, max_contacts: keep those that stand for all; 0 keeps all.
    How: devices ("auto": the CPU or the first GPU, whichever is faster when both are tried, see `device_choice`;
        "all": every GPU; or ids of `list_devices` with commas, which share the pairs), threads (0: one per core),
        schedule ("balanced", "sticky", "counted"), inexact (accept devices that round differently).
    The paper's own constants, for "iterative" and "predictive": caster, displacement_threshold, confidence,
        culling_distance, distance_extension, max_iterations, cast_lost_walks, skip_outside.

    Raises InputError (a ValueError) for settings that make no sense and devices that cannot be used.
    """

    def __init__(
        self,
        *,
        method: str = "certified",
        direction: str = "reprojected",
        features: str = "edges",
        speculative: bool = False,
        speculative_margin: Optional[float] = None,
        max_contacts_per_pair: int = 0,
        max_contacts: int = 0,
        devices: str = "auto",
        threads: int = 0,
        schedule: str = "balanced",
        inexact: bool = False,
        caster: str = "bvh",
        displacement_threshold: Optional[float] = None,
        confidence: float = 2.0,
        culling_distance: Optional[float] = None,
        distance_extension: Optional[float] = None,
        max_iterations: int = 16,
        cast_lost_walks: bool = True,
        skip_outside: bool = True,
    ) -> None:
        words = {key: value for key, value in locals().items() if key != "self"}
        if speculative_margin is not None and not speculative:
            raise InputError("speculative_margin: does nothing without speculative=True")
        self._core = _core.Scene(as_settings(words))

    @overload
    def add(self, shapes: ShapeLike, poses: None = None) -> int: ...

    @overload
    def add(
        self, shapes: Union[list[Shape], tuple[Shape, ...]], poses: Optional[PoseLike] = None
    ) -> NDArray[np.int64]: ...

    @overload
    def add(self, shapes: Shapes, poses: Optional[PoseLike] = None) -> Union[int, NDArray[np.int64]]: ...

    def add(self, shapes: Shapes, poses: Optional[PoseLike] = None) -> Union[int, NDArray[np.int64]]:
        """Adds bodies: all or none.

        shapes: one for all poses, or a list of one for each.
        poses: one for all shapes or one for each, (4, 4) or (n, 4, 4), or (R, t), as of `collide`, rigid, from the
            body's frame to the world, metres; None is the identity.
        Returns an id for one shape and one pose, else (n,) int64. No id is ever given twice.
        Raises InputError for poses that are not finite and rigid to 1e-4, and for numbers that do not fit.
        """
        cores, lead = as_shapes(shapes, "shapes")
        matrices = as_poses(poses, "poses")
        count = len(cores) if lead or matrices.ndim == 2 else len(matrices)
        ids = self._core.add(cores, _for_each(matrices, count))
        return int(ids[0]) if lead == () and matrices.ndim == 2 else ids

    def remove(self, ids: ArrayLike) -> None:
        """Removes bodies. ids: one or (n,). Raises InputError at the first that is not in the scene; those before it
        are gone."""
        self._core.remove(as_ids(ids, "ids")[0])

    def set_poses(self, ids: ArrayLike, poses: PoseLike) -> None:
        """Moves bodies: all or none.

        ids: one or (n,). poses: (n, 4, 4), or (4, 4) for all, or (R, t), as of `collide`, from the body's frame to the
            world, metres, taken as they are (`nearest_rigid` mends those that drifted). Of a CUDA device, too: what has
            a `__cuda_array_interface__` (torch, CuPy, Numba, Warp, JAX) is read when its stream has written it, or,
            where it names none, when the device has done what it was given.
        Raises InputError naming the place in the list: an id that is not in the scene, a pose that is not finite and
        rigid to 1e-4; and where numbers of ids and poses differ.
        """
        if poses is None:
            raise InputError("poses: is None; give (4, 4) or (n, 4, 4)")
        if type(ids) is int and self._core.set_pose(ids, poses):
            return
        numbers, _ = as_ids(ids, "ids")
        self._core.set_poses(numbers, _for_each(as_poses(poses, "poses"), len(numbers)))

    def poses(self, ids: Optional[ArrayLike] = None) -> NDArray[np.float64]:
        """(n, 4, 4) float64, or (4, 4) for one id, from the body's frame to the world, metres; None: of all bodies, as
        `ids`. Raises InputError for an id that is not in the scene."""
        numbers, one = (self.ids, False) if ids is None else as_ids(ids, "ids")
        matrices = self._core.poses(numbers)
        return matrices[0] if one else matrices

    def set_next_poses(self, ids: ArrayLike, poses: PoseLike) -> None:
        """Where bodies are expected after the next step, for its speculative contacts; without it they are expected to
        go on as they did. Does nothing unless the scene is speculative. Arguments and errors are those of `set_poses`,
        but bodies before the one to blame have theirs."""
        numbers, _ = as_ids(ids, "ids")
        self._core.set_next_poses(numbers, _for_each(as_poses(poses, "poses"), len(numbers)))

    def set_speculative_margin(self, id: _Id, margin: Optional[float]) -> None:
        """Metres, for contacts of this body with any other; None: as the scene's settings say. Raises InputError for an
        id that is not in the scene, and a margin that is negative or not finite."""
        number = as_id(id, "id")
        self._core.set_speculative_margin(number, None if margin is None else as_length(margin, "margin"))

    def set_filter(self, ids: ArrayLike, groups: int, mask: int) -> None:
        """`find_contacts()` pairs two bodies only if the groups of each have a bit in common with the mask of the
        other. At first a body is in group 1 and its mask has all 32 bits.

        ids: one or (n,). Raises InputError for an id that is not in the scene, and bits beyond 32.
        """
        self._core.set_filter(as_ids(ids, "ids")[0], as_count(groups, "groups"), as_count(mask, "mask"))

    def set_static(self, ids: ArrayLike, static: bool = True) -> None:
        """A static body makes no pair with another static one: for what stays, and for bodies that sleep. What touched
        when both became static goes on touching as long as the two stay near each other. A list of pairs that is given
        to `find_contacts` is tested all the same.

        ids: one or (n,). Raises InputError for an id that is not in the scene.
        """
        self._core.set_static(as_ids(ids, "ids")[0], bool(static))

    def is_static(self, id: _Id) -> bool:
        """As `set_static` has it. Raises InputError for an id that is not in the scene."""
        return self._core.is_static(as_id(id, "id"))

    def set_sensor(self, ids: ArrayLike, sensor: bool = True) -> None:
        """A sensor has no contacts: `begun`, `ended` and `touching` alone tell what touches it, from the next step on.

        ids: one or (n,). Raises InputError for an id that is not in the scene.
        """
        self._core.set_sensor(as_ids(ids, "ids")[0], bool(sensor))

    def is_sensor(self, id: _Id) -> bool:
        """As `set_sensor` has it. Raises InputError for an id that is not in the scene."""
        return self._core.is_sensor(as_id(id, "id"))

    def set_pair_filter(self, callback: Optional[Callable[[int, int], bool]]) -> None:
        """callback(a, b) is asked about each pair that would come into being, as its boxes begin to touch, and once
        about all that are there when it is set: False keeps the two apart until their boxes have parted. a has the
        lower slot. It must not use the scene; what it raises, `find_contacts` raises. None: no callback. A list of
        pairs that is given to `find_contacts` is tested all the same. A callback that holds the scene keeps both alive,
        until another one, or None, takes its place."""
        if callback is not None and not callable(callback):
            raise InputError(f"callback: a {type(callback).__name__} cannot be called")
        self._core.set_pair_filter(callback)

    def clear(self) -> None:
        """Removes all bodies."""
        self._core.clear()

    def save_state(self) -> SceneState:
        """All that later steps depend on, but for settings and the pair filter: bodies with ids, poses and filters,
        contacts, touches, and what the method keeps of pairs. Call it between two steps."""
        data, shapes = self._core.save_state()
        return SceneState(data, [Shape._wrap(shape) for shape in shapes])

    def load_state(self, state: SceneState) -> None:
        """Puts back what `save_state` told, in this scene or in another with equal settings (devices and threads may
        differ): later steps find, bit for bit, what they found after it. Ids mean again what they meant; what was here
        is gone, and nothing is told of it.

        Raises InputError for a state that is damaged, of another version, of other settings or with other shapes,
        before anything changes.
        """
        if not isinstance(state, tuple) or len(state) != 2:
            raise InputError(f"state: is a {type(state).__name__}; give what save_state() returned")
        data, shapes = state
        if not isinstance(data, (bytes, bytearray)) or not all(isinstance(shape, Shape) for shape in shapes):
            raise InputError("state: is not data and shapes; give what save_state() returned")
        self._core.load_state(bytes(data), [shape._core for shape in shapes])

    def shape(self, id: _Id) -> Shape:
        """The one that the body was added with. Raises InputError for an id that is not in the scene."""
        return Shape._wrap(self._core.shape(as_id(id, "id")))

    @property
    def ids(self) -> NDArray[np.int64]:
        """(n,) int64: of all bodies, by slot."""
        return self._core.ids

    @property
    def slot_count(self) -> int:
        """Rows of an array that `Contacts.slots` index: one more than the highest slot of a body that is there."""
        ids = self._core.ids
        return int(ids[-1] % 2**32) + 1 if len(ids) else 0

    def __contains__(self, id: _Id) -> bool:
        return self._core.has(as_id(id, "id"))

    def __len__(self) -> int:
        return len(self._core.ids)

    @property
    def settings(self) -> dict[str, Any]:
        """As they were given, or changed by `set_settings`; `Scene(**scene.settings)` is another one like this."""
        return self._core.settings

    def set_settings(self, **settings: Any) -> None:
        """Changes settings between two steps; forgets what the last method kept. Devices, threads, schedule and inexact
        are fixed. Raises InputError for these and as Scene does, TypeError for a word that is none."""
        unknown = set(settings) - set(self._core.settings)
        if unknown:
            raise TypeError(f"set_settings() got an unexpected keyword argument {sorted(unknown)[0]!r}")
        self._core.set_settings(as_settings(settings))

    def prepare(self) -> None:
        """`Shape.prepare` for the shapes of all bodies, so that the next step is as fast as later ones."""
        self._core.prepare()

    def find_contacts(self, pairs: Optional[ArrayLike] = None) -> Contacts:
        """One step: all contacts where the bodies are now, sorted by the slots of both bodies, then by key.

        pairs: (n, 2) ids from a broad phase of your own, in any order; None: those whose boxes overlap.
        Raises InputError for a pair of a body with itself or with one that is not in the scene. After Ctrl-C there are
        no contacts, and the next step finds all anew.
        """
        found = self._core.find_contacts(None if pairs is None else as_pairs(pairs, "pairs"))
        return Contacts._from_bytes(found)

    @property
    def contacts(self) -> Contacts:
        """Of the last step."""
        return Contacts._from_bytes(self._core.contacts)

    def write_contacts(self, **columns: Any) -> int:
        """Writes columns of the last step's contacts into arrays of your own, in the host's memory or a CUDA device's,
        in the order of `contacts`; returns how many there are. Rows behind them stay as they are.

        columns: by the names of Contacts, each a contiguous array, (rows,) or (rows, numbers of a contact), of NumPy or
            with a `__cuda_array_interface__` (torch, CuPy, Numba, Warp), of the column's type; integers may be signed,
            and `point_a` and `point_b` are float64 or float32. Of a CUDA device they are there for what the
            array's stream is given afterwards.
        Raises InputError, before anything is written, naming a column that is unknown, of another type or shape, or has
        fewer rows than there are contacts.
        """
        return self._core.write_contacts([as_column(name, array) for name, array in columns.items()])

    @property
    def lost_contacts(self) -> LostContacts:
        """What the last step lost; `Contacts.is_new` marks what it gained."""
        return LostContacts(*self._core.lost_contacts())

    @property
    def begun(self) -> Touches:
        """Pairs of bodies that began to touch in the last step, those of sensors, too; `len(scene.begun.bodies)` is
        their number. Two bodies begin to touch with a contact that touches, or, but for sensors, with a speculative one
        that will, if both go on to where they are expected (`set_next_poses`). They end without a contact when the
        points that touched last are farther apart along its normal than 0.0025 of the smaller body's box diagonal, or a
        quarter of it beside: what trembles goes on touching."""
        return _touches(self._core.begun())

    @property
    def ended(self) -> Touches:
        """Pairs that no longer touch, and those of which a body was removed since the last step."""
        return _touches(self._core.ended())

    @property
    def touching(self) -> Touches:
        """All pairs that touch."""
        return _touches(self._core.touching())

    @property
    def pairs(self) -> NDArray[np.int64]:
        """(n, 2) int64: ids of the pairs of the last step, sorted by slots."""
        return self._core.pairs

    @property
    def stats(self) -> StepStats:
        """What the last step did."""
        return self._core.stats

    @property
    def device_choice(self) -> str:
        """Which device has the pairs, and why.

        With devices="auto" as "cpu: 1.2 ms a step, cuda:0 3.41 ms, measured with 7650 pairs" (milliseconds of the
        narrow phase); else as "cpu: as given".
        """
        return self._core.device_choice

    @overload
    def raycast(
        self, origins: ManyPoints, directions: ArrayLike, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> BodyRayHits: ...

    @overload
    def raycast(
        self, origins: ArrayLike, directions: ManyPoints, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> BodyRayHits: ...

    @overload
    def raycast(
        self, origins: OnePoint, directions: OnePoint, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> OneBodyRayHit: ...

    @overload
    def raycast(
        self, origins: ArrayLike, directions: ArrayLike, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> BodyRayHits: ...

    def raycast(
        self, origins: ArrayLike, directions: ArrayLike, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> BodyRayHits:
        """The body that each ray meets first, poses set since the last step included.

        origins, directions: (3,) or (..., 3), metres, world frame; directions of any length; they fit as NumPy
            broadcasts. max: metres.
        wanted: (n,), ids of the bodies that count; None: all.
        Raises InputError for a direction that is zero or not finite, an origin that is not finite, a `max` that is
        negative or NaN, an id that is not in the scene, and where numbers of origins and directions differ.
        """
        batch, starts, along = _rays(origins, directions)
        hits = self._core.raycast(starts, along, as_length(max, "max"), _wanted(wanted))
        return batch.answer(OneBodyRayHit, BodyRayHits, (*hits[0], hits[1]))

    def raycast_all(
        self, origin: OnePoint, direction: OnePoint, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> BodyRayHits:
        """Each body that one ray meets, with its first hit: arrays (n,) and (n, 3), by distance, then by slot.
        Arguments and errors are those of `raycast`, but origin and direction (3,)."""
        batch, starts, along = _rays(origin, direction)
        if batch.shape != ():
            raise InputError(f"raycast_all: takes one ray, not {batch.shape}; ask about one after the other")
        hits = self._core.raycast_all(starts, along, as_length(max, "max"), _wanted(wanted))
        columns = (*hits[0], hits[1])
        return BodyRayHits(*columns)

    @overload
    def raycast_any(
        self, origins: ManyPoints, directions: ArrayLike, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> Union[bool, NDArray[np.bool_]]: ...

    @overload
    def raycast_any(
        self, origins: ArrayLike, directions: ManyPoints, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> Union[bool, NDArray[np.bool_]]: ...

    @overload
    def raycast_any(
        self, origins: OnePoint, directions: OnePoint, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> bool: ...

    @overload
    def raycast_any(
        self, origins: ArrayLike, directions: ArrayLike, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> Union[bool, NDArray[np.bool_]]: ...

    def raycast_any(
        self, origins: ArrayLike, directions: ArrayLike, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> Union[bool, NDArray[np.bool_]]:
        """Whether `raycast` has a hit; ends at the first one found. Arguments and errors are those of `raycast`. Gives
        a bool, or (n,) bool for many rays."""
        batch, starts, along = _rays(origins, directions)
        met = self._core.raycast_any(starts, along, as_length(max, "max"), _wanted(wanted))
        (found,) = batch.answers((met.view(np.bool_),))
        return found

    @overload
    def closest_point(
        self, points: ManyPoints, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> BodyClosestPoints: ...

    @overload
    def closest_point(
        self, points: OnePoint, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> OneBodyClosestPoint: ...

    @overload
    def closest_point(
        self, points: ArrayLike, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> BodyClosestPoints: ...

    def closest_point(
        self, points: ArrayLike, max: float = np.inf, *, wanted: Optional[ArrayLike] = None
    ) -> BodyClosestPoints:
        """The point of all surfaces that is nearest to each point, within `max` metres.

        points: (3,) or (n, 3), metres, world frame. Poses set since the last step count.
        wanted: (n,), ids of the bodies that count; None: all.
        Raises InputError for a point that is not finite, a `max` that is negative or NaN, and an id that is not in the
        scene.
        """
        places = as_points(points, "points")
        batch = Batch(points=places.shape[:-1])
        found = self._core.closest_points(places.reshape(-1, 3), as_length(max, "max"), _wanted(wanted))
        return batch.answer(OneBodyClosestPoint, BodyClosestPoints, (*found[0], found[1]))

    @overload
    def overlaps(
        self, shapes: ShapeLike, poses: None = None, *, wanted: Optional[ArrayLike] = None
    ) -> NDArray[np.int64]: ...

    @overload
    def overlaps(
        self,
        shapes: Union[list[Shape], tuple[Shape, ...]],
        poses: Optional[PoseLike] = None,
        *,
        wanted: Optional[ArrayLike] = None,
    ) -> BodyOverlaps: ...

    @overload
    def overlaps(
        self, shapes: Shapes, poses: Optional[PoseLike] = None, *, wanted: Optional[ArrayLike] = None
    ) -> Any: ...

    def overlaps(
        self, shapes: Shapes, poses: Optional[PoseLike] = None, *, wanted: Optional[ArrayLike] = None
    ) -> Union[NDArray[np.int64], BodyOverlaps]:
        """The bodies whose meshes intersect others, placed here. Exact.

        shapes: one, or a list. poses: (4, 4) or (..., 4, 4), or (R, t), as of `collide`, rigid, from the shape's frame
            to the world, metres; None is the identity. They fit as NumPy broadcasts.
        wanted: (n,), ids of the bodies that count; None: all.
        Gives (n,) int64, ids by slot, for one shape and one pose; else BodyOverlaps, whose (n,) say which item meets
        which body. Raises InputError for poses that are not finite and rigid to 1e-4, and an id that is not in the
        scene.
        """
        if type(shapes) is Shape and wanted is None:
            one = self._core.one_overlaps(shapes._core, poses)
            if one is not None:
                return one
        cores, matrices, lead, _ = _placed(shapes, poses)
        item, body = self._core.overlaps(cores, matrices, _wanted(wanted))
        return body if lead == () else BodyOverlaps(item, body)

    @overload
    def overlaps_any(
        self, shapes: ShapeLike, poses: None = None, *, each: bool = False, wanted: Optional[ArrayLike] = None
    ) -> bool: ...

    @overload
    def overlaps_any(
        self,
        shapes: Shapes,
        poses: Optional[PoseLike] = None,
        *,
        each: bool = False,
        wanted: Optional[ArrayLike] = None,
    ) -> Union[bool, NDArray[np.bool_]]: ...

    def overlaps_any(
        self,
        shapes: Shapes,
        poses: Optional[PoseLike] = None,
        *,
        each: bool = False,
        wanted: Optional[ArrayLike] = None,
    ) -> Union[bool, NDArray[np.bool_]]:
        """Whether any body meets a shape, or any of a list, as of the links of a robot; ends at the first one found.

        A list of l shapes is one thing: with poses (n, l, 4, 4) it has answers (n,), and a bool with (l, 4, 4).
        each: asks for each shape by itself: (n, l).
        shapes, poses, wanted and errors are those of `overlaps`. Gives a bool, or (n,) bool. The scene's threads share
        the work.
        """
        if wanted is None and not each:
            if type(shapes) is Shape:
                one = self._core.one_overlaps_any([shapes._core], poses, False)
                if one is not None:
                    return one
            elif type(shapes) is list and poses is not None and all([type(shape) is Shape for shape in shapes]):
                one = self._core.one_overlaps_any([shape._core for shape in shapes], poses, True)
                if one is not None:
                    return one
        cores, matrices, lead, is_list = _placed(shapes, poses)
        links = 1
        if is_list and not each:
            lead, links = lead[:-1], lead[-1]
            if links != (count := len(cores)):
                raise InputError(f"poses: for {links} shapes, and {count} are given; give poses (..., {count}, 4, 4)")
        if links == 0:
            return np.zeros(lead, np.bool_) if lead else False
        found = self._core.overlaps_any(cores, matrices, links, _wanted(wanted)).view(np.bool_)
        return bool(found[0]) if lead == () else found.reshape(lead)

    def sweep(
        self,
        shapes: Shapes,
        begin: PoseLike,
        end: PoseLike,
        *,
        distance: float = 0.0,
        wanted: Optional[ArrayLike] = None,
    ) -> BodyImpact:
        """The body that a moving mesh meets first, or comes nearer to than `distance` metres: a shape cast.

        shapes: one, or a list. begin, end: poses as of `collide`, (4, 4) or (..., 4, 4): the mesh goes from one to the
            other by a screw, as `time_of_impact` has it; the bodies stay where they are. All fit as NumPy broadcasts.
        wanted: (n,), ids of the bodies that count; None: all.
        Raises InputError as `time_of_impact`, and for an id that is not in the scene.
        """
        cores, lead = as_shapes(shapes, "shapes")
        first, last = as_poses(begin, "begin", rigid=True), as_poses(end, "end", rigid=True)
        batch = Batch(shapes=lead, begin=first.shape[:-2], end=last.shape[:-2])
        found, body = self._core.sweep(
            batch.listed(cores, lead),
            batch.flat(first, first.shape[:-2]),
            batch.flat(last, last.shape[:-2]),
            as_length(distance, "distance"),
            _wanted(wanted),
        )
        return BodyImpact(*batch.answers((*found, body)))

    def sweep_all(
        self,
        shape: ShapeLike,
        begin: PoseLike,
        end: PoseLike,
        *,
        distance: float = 0.0,
        wanted: Optional[ArrayLike] = None,
    ) -> BodyImpact:
        """All bodies that a moving mesh could meet, each for itself, by time: arrays (n,) and (n, 3).

        Arguments and errors are those of `sweep`, but one shape, begin and end (4, 4).
        """
        found, body = self._core.sweep_all(
            as_shapes(shape, "shape")[0][0],
            as_pose(begin, "begin", rigid=True)[np.newaxis],
            as_pose(end, "end", rigid=True)[np.newaxis],
            as_length(distance, "distance"),
            _wanted(wanted),
        )
        columns = (*found, body)
        return BodyImpact(*columns)

    @overload
    def distance(self, a: _Id, b: _Id, *, max: float = np.inf) -> OneDistance: ...

    @overload
    def distance(self, a: ArrayLike, b: ArrayLike, *, max: float = np.inf) -> Distance: ...

    def distance(self, a: ArrayLike, b: ArrayLike, *, max: float = np.inf) -> Distance:
        """The least distance of two bodies' surfaces, as `raycontact.distance` has it, poses set since the last step
        included.

        a, b: ids, one or (...,), which fit as NumPy broadcasts. max: metres, beyond which it is not looked for. Raises
        InputError for an id that is not in the scene, and a `max` that is negative or NaN.
        """
        ids_a, ids_b = as_id_array(a, "a"), as_id_array(b, "b")
        batch = Batch(a=ids_a.shape, b=ids_b.shape)
        found = self._core.distances(
            batch.flat(ids_a, ids_a.shape), batch.flat(ids_b, ids_b.shape), as_length(max, "max")
        )
        return batch.answer(OneDistance, Distance, found)

    def __repr__(self) -> str:
        settings = self._core.settings
        return f"<Scene: {len(self)} bodies, method {settings['method']}, devices {settings['devices']}>"


def _touches(columns: tuple[NDArray[Any], ...]) -> Touches:
    bodies, point, normal, depth, sensor = columns
    return Touches(bodies, point, normal, depth, sensor.view(np.bool_))


def _wanted(ids: Optional[ArrayLike]) -> Optional[NDArray[np.int64]]:
    return None if ids is None else as_ids(ids, "wanted")[0]


def _rays(origins: ArrayLike, directions: ArrayLike) -> tuple[Batch, NDArray[np.float64], NDArray[np.float64]]:
    """The batch, and both of one ray or of all."""
    starts, along = as_points(origins, "origins"), as_points(directions, "directions")
    batch = Batch(origins=starts.shape[:-1], directions=along.shape[:-1])
    return batch, batch.flat(starts, starts.shape[:-1]), batch.flat(along, along.shape[:-1])


def _placed(
    shapes: Shapes, poses: Optional[PoseLike]
) -> tuple[list[_core.Shape], NDArray[np.float64], tuple[int, ...], bool]:
    """Shapes of the C++ half, which repeat, a pose for each item, the batch's shape, whether shapes are a list."""
    cores, lead = as_shapes(shapes, "shapes")
    matrices = as_poses(poses, "poses", rigid=True)
    shape = Batch(shapes=lead, poses=matrices.shape[:-2]).shape
    matrices = np.ascontiguousarray(np.broadcast_to(matrices, (*shape, 4, 4))).reshape(-1, 4, 4)
    return cores, matrices, shape, lead != ()


def _for_each(poses: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """(count, 4, 4), contiguous."""
    if poses.ndim > 3 or (poses.ndim == 3 and len(poses) not in (1, count)):
        raise InputError(f"poses: have shape {poses.shape} for {count} bodies; give one for each, or one for all")
    return np.ascontiguousarray(np.broadcast_to(poses, (count, 4, 4)))


__all__ = [
    "BodyClosestPoints", "BodyOverlaps", "BodyRayHits", "LostContacts", "OneBodyClosestPoint", "OneBodyRayHit", "Scene",
    "StepStats",
]  # fmt: skip
