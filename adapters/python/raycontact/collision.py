# SPDX-License-Identifier: Apache-2.0
"""The collision manager of trimesh, over RayContact: `from raycontact.collision import CollisionManager`.

Methods, arguments and forms of answers are those of `trimesh.collision`. It needs neither trimesh nor FCL.
docs/python.md says what differs.
"""

from __future__ import annotations

import weakref
from collections.abc import Hashable, Sequence
from typing import Any, NamedTuple, Optional, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import as_pose
from ._core import InputError
from ._shared_shapes import shared_shape
from .contacts import FeatureKind, PairContacts
from .queries import closest_point, collide, distance
from .shape import Shape, ShapeLike

_Value = TypeVar("_Value")

_EXTERNAL = "__external"
"""The name of a mesh that is in no manager, as trimesh has it."""

_MOST_ASKED = 1 << 16
"""Pairs of one call: each takes some 500 bytes meanwhile."""


class ContactData:
    """Where two objects are in contact.

    names: the set of the names of both; a mesh that was given to `in_collision_single` is "__external".
    pair: the two names in order; trimesh has no such thing. Of `in_collision_internal` as in its set of names, of
        `in_collision_single` the object in the manager first, of `in_collision_other` the one in this manager first.
    """

    __slots__ = ("names", "pair", "_normal", "_point", "_depth", "_indices")

    names: set[Hashable]
    pair: tuple[Hashable, Hashable]

    def __init__(
        self,
        pair: tuple[Hashable, Hashable],
        normal: NDArray[np.float64],
        point: NDArray[np.float64],
        depth: float,
        indices: tuple[int, int],
    ) -> None:
        self.names = set(pair)
        self.pair = pair
        self._normal = normal
        self._point = point
        self._depth = depth
        self._indices = indices

    @property
    def normal(self) -> NDArray[np.float64]:
        """(3,) float64, unit, world frame, from the first of `pair` to the second: moving the second along it separates
        them. NaN where depth is 0."""
        return self._normal

    @property
    def point(self) -> NDArray[np.float64]:
        """(3,) float64, metres, world frame: halfway between the two witness points. `point + depth / 2 * normal` is
        that of the first object, `point - depth / 2 * normal` that of the second. Where depth is 0, a point of both."""
        return self._point

    @property
    def depth(self) -> float:
        """Metres along the normal by which the two overlap here. 0 where they share a point and no contact says how
        deep: they only touch, or one is an open mesh."""
        return self._depth

    def index(self, name: Hashable) -> int:
        """The face of that object's mesh: it has the vertex or the edge in contact, or is the one that was hit.

        Two objects of the same name, of two managers: that of the second. Raises KeyError for another name.
        """
        return _of_name(self.pair, self._indices, name)

    def __repr__(self) -> str:
        return f"<ContactData {self.pair[0]!r}, {self.pair[1]!r}: depth {self._depth:.6g} m>"


class DistanceData:
    """Where two objects are nearest to each other.

    names: the set of the names of both; a mesh that was given to `min_distance_single` is "__external".
    pair: the two names in order, as of ContactData.
    """

    __slots__ = ("names", "pair", "_distance", "_points", "_indices")

    names: set[Hashable]
    pair: tuple[Hashable, Hashable]

    def __init__(
        self,
        pair: tuple[Hashable, Hashable],
        least: float,
        points: tuple[NDArray[np.float64], NDArray[np.float64]],
        indices: tuple[int, int],
    ) -> None:
        self.names = set(pair)
        self.pair = pair
        self._distance = least
        self._points = points
        self._indices = indices

    @property
    def distance(self) -> float:
        """Metres; 0 exactly where the two collide."""
        return self._distance

    def index(self, name: Hashable) -> int:
        """The face of that object's mesh on which its nearest point lies. Where the other object lies inside it: the
        face nearest to that point. Names as of ContactData.index."""
        return _of_name(self.pair, self._indices, name)

    def point(self, name: Hashable) -> NDArray[np.float64]:
        """(3,) float64, metres, world frame: of that object, nearest to the other. Where they collide a point of both.
        Names as of ContactData.index."""
        return _of_name(self.pair, self._points, name)

    def __repr__(self) -> str:
        return f"<DistanceData {self.pair[0]!r}, {self.pair[1]!r}: {self._distance:.6g} m>"


class _Object(NamedTuple):
    """What a name stands for."""

    shape: Shape
    pose: NDArray[np.float64]
    """(4, 4); where it was when objects were last listed."""


class _Objects:
    """Objects in lists, for questions about many."""

    def __init__(self, objects: dict[Hashable, _Object]) -> None:
        self.names = list(objects)
        self.shapes = [item.shape for item in objects.values()]
        poses = np.array([item.pose for item in objects.values()]).reshape(-1, 4, 4)
        self.placed = _core.PlacedList([shape._core for shape in self.shapes], poses)
        self.rows = {name: row for row, name in enumerate(objects)}

    def by_name(self, i: int, j: int) -> tuple[int, int]:
        """Two rows, i < j, sorted by their names; as they are where names do not compare."""
        try:
            one, other = cast(Any, self.names[i]), cast(Any, self.names[j])
            return (j, i) if other < one else (i, j)
        except TypeError:
            return i, j


class CollisionManager:
    """Objects with names: which of them collide, where, and how far apart they are.

    Used as `trimesh.collision.CollisionManager` is. A mesh is whatever `Shape` takes: a Shape, a Mesh, a
    `trimesh.Trimesh`, the path of a file. What it holds when it is added counts; the object does not follow later
    changes. Objects whose meshes hold the same share one shape. Names are anything hashable. A transform is a rigid
    (4, 4) matrix from the mesh's frame to the world, metres, the translation in the last column.

    Two objects collide where their surfaces share a point (touching counts), or where one lies inside the other and
    that has an inside. This is exact, in double.

    Raises InputError (a ValueError) for a name that is not in the manager, a transform of another shape or one that is
    not finite and rigid to 1e-4, and a mesh that no Shape can be made of.
    """

    def __init__(self) -> None:
        self._objects: dict[Hashable, _Object] = {}
        self._allowed: set[frozenset[Hashable]] = set()
        self._listed: Optional[_Objects] = None

    def add_object(self, name: Hashable, mesh: ShapeLike, transform: Optional[ArrayLike] = None) -> Shape:
        """Adds an object, in place of any that has the name. transform: (4, 4); None: the identity.

        Gives the object's shape; trimesh gives an object of FCL. Raises InputError as the class says; then nothing is
        changed.
        """
        made = _place(mesh, transform, f"object {name!r}")
        self._forget_list()
        self._objects[name] = made
        return self._objects[name].shape

    def remove_object(self, name: Hashable) -> None:
        """Removes an object. Raises InputError where there is no such name."""
        self._find(name)
        self._forget_list()
        del self._objects[name]
        self._allowed = {pair for pair in self._allowed if name not in pair}

    def set_transform(self, name: Hashable, transform: ArrayLike) -> None:
        """Moves an object: (4, 4), in place of the transform it had. Raises InputError as the class says."""
        if transform is None:
            raise InputError(f"object {name!r}: transform: is None; give (4, 4)")
        listed = self._listed or self._list()
        row = listed.rows.get(name)
        if row is None:
            self._find(name)
        elif not listed.placed.set_pose(row, transform):
            listed.placed.set_pose(row, _rigid(transform, f"object {name!r}"))

    def allow_collision(self, name: Hashable, other: Hashable, allowed: bool = True) -> None:
        """Leaves a pair of objects out of `in_collision_internal` and `min_distance_internal`, as neighbours of an arm
        that always touch; False: asks it again. An object that is added anew under its name keeps its pairs. trimesh
        has no such. Raises InputError where there is no such name."""
        self._find(name), self._find(other)
        (self._allowed.add if allowed else self._allowed.discard)(frozenset((name, other)))
        self._forget_list()

    # What these give depends on what is asked for, so to a type checker it is Any, as of trimesh.

    def in_collision_single(
        self,
        mesh: ShapeLike,
        transform: Optional[ArrayLike] = None,
        return_names: bool = False,
        return_data: bool = False,
    ) -> Any:
        """Whether a mesh, placed by a transform, collides with any object.

        Gives a bool. With return_names a tuple of it and the set of names of all objects that collide with the mesh,
        with return_data of it and a list of ContactData, with both of all three. The list has at least one of each pair
        that collides. The mesh's name there is "__external".
        """
        one, mine = _external(mesh, transform), self._list()
        if not (return_names or return_data):
            return mine.placed.any(one.placed)
        i, j = mine.placed.all(one.placed)
        names = {mine.names[k] for k in i.tolist()}
        data = _contacts(mine, one, i, j) if return_data else []
        return _answer(bool(len(i)), return_names, names, return_data, data)

    def in_collision_internal(self, return_names: bool = False, return_data: bool = False) -> Any:
        """Whether any two objects collide.

        Gives a bool. With return_names a tuple of it and the set of all pairs (name, name) that collide, with
        return_data of it and a list of ContactData, with both of all three. A pair has its names sorted; names that do
        not compare stand in the order in which they were added.
        """
        mine = self._list()
        if not (return_names or return_data):
            return mine.placed.any(None)
        i, j = mine.placed.all(None)
        i, j = _sorted_by_name(mine, i, j)  # normals lead from the first name to the second
        names = {(mine.names[k], mine.names[m]) for k, m in zip(i.tolist(), j.tolist())}
        data = _contacts(mine, mine, i, j) if return_data else []
        return _answer(bool(len(i)), return_names, names, return_data, data)

    def in_collision_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """Whether any object collides with one of another manager.

        Gives a bool. With return_names a tuple of it and the set of all pairs (name, name in the other manager) that
        collide, with return_data of it and a list of ContactData, with both of all three.
        """
        mine, others = self._list(), _list_of(other_manager)
        if not (return_names or return_data):
            return mine.placed.any(others.placed)
        i, j = mine.placed.all(others.placed)
        names = {(mine.names[k], others.names[m]) for k, m in zip(i.tolist(), j.tolist())}
        data = _contacts(mine, others, i, j) if return_data else []
        return _answer(bool(len(i)), return_names, names, return_data, data)

    def min_distance_single(
        self,
        mesh: ShapeLike,
        transform: Optional[ArrayLike] = None,
        return_name: bool = False,
        return_data: bool = False,
    ) -> Any:
        """The least distance of a mesh, placed by a transform, from any object: metres; 0 where they collide.

        Gives a float. With return_name a tuple of it and the name of the nearest object, with return_data of it and a
        DistanceData, with both of all three. The mesh's name there is "__external". Without an object: inf, None, None.
        """
        mine, one = self._list(), _external(mesh, transform)
        least, pair = _nearest(mine, one)
        name = None if pair is None else mine.names[pair[0]]
        data = _distance_data(mine, one, least, pair) if return_data else None
        return _answer(least, return_name, name, return_data, data)

    def min_distance_internal(
        self, name: Optional[Hashable] = None, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """The least distance of any two objects, or of the one with that name from any other: metres; 0 where they
        collide.

        Gives a float. With return_names a tuple of it and the pair of names, sorted as of `in_collision_internal`, with
        return_data of it and a DistanceData, with both of all three. With fewer than two objects: inf, None, None.
        Raises InputError for a name that is not in the manager.
        """
        mine = self._list()
        if name is None:
            least, pair = _nearest(mine, None)
        else:
            own = self._find(name)
            row = mine.rows[name]
            one = _Objects({name: own._replace(pose=mine.placed.poses[row])})
            allowed = [mine.rows[other] for pair in self._allowed if name in pair for other in pair]
            least, pair = _nearest(one, mine, but=[row, *allowed])
            if pair is not None:
                pair = min(row, pair[1]), max(row, pair[1])
        if pair is not None:
            pair = mine.by_name(*pair)
        names = None if pair is None else (mine.names[pair[0]], mine.names[pair[1]])
        data = _distance_data(mine, mine, least, pair) if return_data else None
        return _answer(least, return_names, names, return_data, data)

    def min_distance_other(
        self, other_manager: CollisionManager, return_names: bool = False, return_data: bool = False
    ) -> Any:
        """The least distance of any object from one of another manager: metres; 0 where they collide.

        Gives a float. With return_names a tuple of it and the pair (name, name in the other manager), with return_data
        of it and a DistanceData, with both of all three. Without two objects: inf, None, None.
        """
        mine, others = self._list(), _list_of(other_manager)
        least, pair = _nearest(mine, others)
        names = None if pair is None else (mine.names[pair[0]], others.names[pair[1]])
        data = _distance_data(mine, others, least, pair) if return_data else None
        return _answer(least, return_names, names, return_data, data)

    def _find(self, name: Hashable) -> _Object:
        try:
            return self._objects[name]
        except KeyError:
            raise InputError(f"object {name!r}: is not in the manager; add it with add_object") from None

    def _forget_list(self) -> None:
        """Before objects come or go."""
        if self._listed is not None:
            for item, pose in zip(self._objects.values(), self._listed.placed.poses):
                item.pose[:] = pose
        self._listed = None

    def _list(self) -> _Objects:
        if self._listed is None:
            made = _Objects(self._objects)
            pairs = (sorted(made.rows[name] for name in pair) for pair in self._allowed if len(pair) == 2)
            made.placed.set_allowed([(i, j) for i, j in pairs])
            self._listed = made
        return self._listed

    def __repr__(self) -> str:
        return f"<CollisionManager: {len(self._objects)} objects>"


def scene_to_collision(scene: Any) -> tuple[CollisionManager, dict[Hashable, Shape]]:
    """A manager with each mesh of a `trimesh.Scene`, named and placed as its node, and the shapes by those names.

    A node that scales, shears or mirrors has that done to its mesh; its object's transform is the rotation and the
    translation that remain. Raises InputError naming the node: no mesh, or a transform that is flat or not finite.
    """
    manager = CollisionManager()
    shapes = {}
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        mesh, pose = _without_stretch(scene.geometry[geometry], transform, f"object {node!r}")
        shapes[node] = manager.add_object(node, mesh, pose)
    return manager, shapes


class _Stretched(NamedTuple):
    """A mesh that a scene draws in another size."""

    vertices: NDArray[np.float64]
    faces: NDArray[Any]


def _without_stretch(mesh: Any, transform: ArrayLike, what: str) -> tuple[Any, NDArray[np.float64]]:
    """A mesh and a rigid transform that place it as any transform does (polar decomposition)."""
    pose = as_pose(transform, f"{what}: transform").copy()
    if _fault(pose) is None or not (hasattr(mesh, "vertices") and hasattr(mesh, "faces")):
        return mesh, pose
    linear = pose[:3, :3]
    sign = np.linalg.det(linear) if np.isfinite(pose).all() else 0.0
    if not abs(sign) > 0:
        raise InputError(f"{what}: its transform is flat or not finite; give one that keeps the mesh's volume")
    left, sizes, right = np.linalg.svd(linear)
    pose[:3, :3] = np.sign(sign) * (left @ right)
    stretch = np.sign(sign) * ((right.T * sizes) @ right)
    faces = np.asarray(mesh.faces)
    # A mirror turns triangles inside out.
    return _Stretched(np.asarray(mesh.vertices) @ stretch.T, faces if sign > 0 else faces[:, ::-1]), pose


def _place(mesh: ShapeLike, transform: Optional[ArrayLike], what: str) -> _Object:
    pose = _rigid(transform, what)
    try:
        shape = shared_shape(mesh)
    except InputError as error:
        raise InputError(f"{what}: {error}") from None
    return _Object(shape, pose)


def _external(mesh: ShapeLike, transform: Optional[ArrayLike]) -> _Objects:
    return _Objects({_EXTERNAL: _place(mesh, transform, "mesh")})


def _list_of(manager: Any) -> _Objects:
    if not isinstance(manager, CollisionManager):
        raise InputError(
            f"other_manager: is a {type(manager).__module__}.{type(manager).__name__}; "
            "give a raycontact.CollisionManager"
        )
    return manager._list()


def _rigid(transform: Optional[ArrayLike], what: str) -> NDArray[np.float64]:
    """A copy: what is the user's may change."""
    pose = as_pose(transform, f"{what}: transform")
    fault = _fault(pose)
    if fault:
        raise InputError(f"{what}: transform: {fault}")
    return pose.copy()


def _fault(pose: NDArray[np.float64]) -> Optional[str]:
    """What queries would refuse, known when it is given."""
    if not (np.abs(pose) <= 1e30).all():
        return "has an entry that is not finite or beyond 1e30"
    rotation = pose[:3, :3]
    if not (np.abs(rotation.T @ rotation - np.eye(3)) <= 1e-4).all():
        return "is not rigid to 1e-4 (sheared or scaled); scale the mesh, or see raycontact.nearest_rigid"
    if not np.linalg.det(rotation) > 0:
        return "is mirrored; mirror the mesh"
    return None


def _of_name(pair: tuple[Hashable, Hashable], values: tuple[_Value, _Value], name: Hashable) -> _Value:
    return dict(zip(pair, values))[name]


def _answer(result: Any, wants_names: bool, names: Any, wants_data: bool, data: Any) -> Any:
    """The form that the flags ask for."""
    parts = (result, *([names] if wants_names else []), *([data] if wants_data else []))
    return parts if len(parts) > 1 else result


def _ask(question: Any, a: _Objects, b: _Objects, i: NDArray[np.int64], j: NDArray[np.int64], **words: Any) -> Any:
    """What a query of the package says of pairs of objects."""
    return question(
        [a.shapes[k] for k in i.tolist()],
        [b.shapes[k] for k in j.tolist()],
        a.placed.poses[i],
        b.placed.poses[j],
        **words,
    )


def _sorted_by_name(
    objects: _Objects, i: NDArray[np.int64], j: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    pairs = np.array([objects.by_name(*pair) for pair in zip(i.tolist(), j.tolist())], np.int64).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def _contacts(a: _Objects, b: _Objects, i: NDArray[np.int64], j: NDArray[np.int64]) -> list[ContactData]:
    """Of pairs that collide, in their order: each has at least one."""
    made: list[ContactData] = []
    for begin in range(0, len(i), _MOST_ASKED):
        part = slice(begin, begin + _MOST_ASKED)
        made += _contacts_of(a, b, i[part], j[part])
    return made


def _contacts_of(a: _Objects, b: _Objects, i: NDArray[np.int64], j: NDArray[np.int64]) -> list[ContactData]:
    found: PairContacts = _ask(collide, a, b, i, j)
    pair = found.pair
    # Exactly touching, or with an open mesh: no contact of the rule, yet they collide.
    bare = np.setdiff1d(np.arange(len(i)), pair)
    points, faces = _common_points(a, b, i[bare], j[bare])
    order = np.argsort(np.concatenate([pair, bare]), kind="stable")
    columns = (
        (pair, bare),
        (found.normal.astype(np.float64), np.full((len(bare), 3), np.nan)),
        ((found.point_a + found.point_b) / 2, points),
        (found.depth.astype(np.float64), np.zeros(len(bare))),
        (_faces_in_contact(found, a, b, i[pair], j[pair]), faces),
    )
    pair, normal, point, depth, face = (np.concatenate(column)[order] for column in columns)
    names = [(a.names[k], b.names[m]) for k, m in zip(i.tolist(), j.tolist())]
    return [
        ContactData(names[k], along, at, deep, (face_a, face_b))
        for k, along, at, deep, (face_a, face_b) in zip(pair.tolist(), normal, point, depth.tolist(), face.tolist())
    ]


_NO_INDEX = 2**32 - 1  # ContactFeature::no_index


def _faces_in_contact(
    found: PairContacts, a: _Objects, b: _Objects, i: NDArray[np.int64], j: NDArray[np.int64]
) -> NDArray[np.int64]:
    """(n, 2): of each contact a face of either mesh, -1 of balls and capsules."""
    faces = found.indices.astype(np.int64)
    is_edges, is_round = found.kind == FeatureKind.EDGES, found.kind == FeatureKind.ROUND
    faces[is_edges] //= 3  # an edge is named by its lowest triangle and a corner there
    faces[is_round, found.source[is_round]] = -1  # a place on what has no faces
    faces[faces == _NO_INDEX] = -1
    for side, (objects, rows) in enumerate(((a, i), (b, j))):
        of_vertices = np.flatnonzero(~is_edges & ~is_round & (found.source == side))
        of_vertices = of_vertices[np.argsort(rows[of_vertices], kind="stable")]
        for chosen in np.split(of_vertices, np.flatnonzero(np.diff(rows[of_vertices])) + 1):
            if len(chosen):
                faces[chosen, side] = _face_at_vertex(objects.shapes[rows[chosen[0]]])[faces[chosen, side]]
    return faces


_faces_at: weakref.WeakKeyDictionary[Shape, NDArray[np.int64]] = weakref.WeakKeyDictionary()


def _face_at_vertex(shape: Shape) -> NDArray[np.int64]:
    """By vertex of the mesh, the lowest triangle that has it; of welded vertices by the lowest."""
    faces = _faces_at.get(shape)
    if faces is None:
        corners = shape.vertex_index[shape.triangles]
        faces = np.full(int(corners.max()) + 1, np.iinfo(np.int64).max)
        np.minimum.at(faces, corners, shape.triangle_index.astype(np.int64)[:, None])
        _faces_at[shape] = faces
    return faces


def _common_points(
    a: _Objects, b: _Objects, i: NDArray[np.int64], j: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A point that two colliding objects share, (n, 3), and the faces at it, (n, 2)."""
    if not len(i):
        return np.empty((0, 3)), np.empty((0, 2), np.int64)
    found = _ask(distance, a, b, i, j, max=0.0)
    return found.point_a, np.stack([_surface(a, i, found.triangle_a, found.point_a),
                                    _surface(b, j, found.triangle_b, found.point_b)], axis=1)  # fmt: skip


def _surface(
    objects: _Objects, rows: NDArray[np.int64], triangles: NDArray[np.int64], points: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Triangles of a distance; the nearest one for a mesh that has the whole other one inside."""
    triangles, poses = triangles.copy(), objects.placed.poses
    for k in np.flatnonzero(triangles < 0):
        triangles[k] = closest_point(objects.shapes[rows[k]], points[k], poses[rows[k]]).triangle
    return triangles


def _nearest(a: _Objects, b: Optional[_Objects], but: Sequence[int] = ()) -> tuple[float, Optional[tuple[int, int]]]:
    """The least distance of a and b but its rows `but`, or within a, and the pair that has it; inf and None without a
    pair."""
    least, i, j = a.placed.nearest(None if b is None else b.placed, list(but))
    return (least, (i, j)) if least < np.inf else (np.inf, None)


def _distance_data(a: _Objects, b: _Objects, least: float, pair: Optional[tuple[int, int]]) -> Optional[DistanceData]:
    if pair is None:
        return None
    i, j = pair
    row_a, row_b = np.array([i]), np.array([j])
    found = _ask(distance, a, b, row_a, row_b)
    faces = _surface(a, row_a, found.triangle_a, found.point_a), _surface(b, row_b, found.triangle_b, found.point_b)
    return DistanceData(
        (a.names[i], b.names[j]), least, (found.point_a[0], found.point_b[0]), (int(faces[0][0]), int(faces[1][0]))
    )


__all__ = ["CollisionManager", "ContactData", "DistanceData", "scene_to_collision"]
