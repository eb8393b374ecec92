# SPDX-License-Identifier: Apache-2.0
"""Which parts of an assembly intersect, and how deep."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, NamedTuple, Optional, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import PoseLike, as_count, as_length, as_numbers, as_pose, as_poses
from ._core import InputError
from .mesh import Mesh, scaled_parts, split_parts, tell
from .queries import Separation

ClearanceLike = Union[tuple[float, str], tuple[float, str, str]]
"""Metres, and the names or patterns of one part or both."""


class Clash(NamedTuple):
    """Two parts that share a point, or are near.

    a: name of a part.
    b: name of a later part.
    depth: of the deepest contact, metres; 0: they touch; minus the distance of parts that are near. None: they share a
        point, and no rule of contact gives a depth, as one of them is open, intersects itself or winds the wrong way
        somewhere.
    point: (3,) float64, metres, frame of the assembly: of that contact; else one that both share; near: point_a.
    normal: (3,) float64, unit, from a to b: of that contact, or the shortest way; None without one.
    contacts: how many contacts the two have.
    duplicate: they are copies in one place.
    index_a: of a in the list of parts.
    index_b: of b in the list of parts.
    kind: "touching"; "overlapping": surfaces cross; "piercing": and one part falls apart where the other is taken out
        of it; "inside": one lies in the other; "duplicate"; "near": apart by no more than the clearance.
    distance: of parts that share no point, metres; else 0.
    point_a: (3,) float64, metres: of the deepest contact, or of the shortest way, on the surface of a.
    point_b: likewise on that of b.
    open: whether a, and whether b, is open. Then a depth says how far it reaches into the other alone.
    box: (2, 3) float64, metres: lowest and highest corner of what both share; where one has no inside, of where their
        surfaces cross. None: they touch, or are near.
    volume: that both share, m^3, if asked for; None where one has no inside.
    separation: as `separation` finds it, if asked for: the translation of b that parts them. None where one has no
        inside, and where they touch or are near.
    """

    a: str
    b: str
    depth: Optional[float]
    point: NDArray[np.float64]
    normal: Optional[NDArray[np.float64]]
    contacts: int
    duplicate: bool
    index_a: int
    index_b: int
    kind: str
    distance: float
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    open: tuple[bool, bool]
    box: Optional[NDArray[np.float64]]
    volume: Optional[float]
    separation: Optional[Separation]


class Fault(NamedTuple):
    """A part that could not be checked.

    part: its place in the list of parts.
    name: of the part.
    why: in words.
    """

    part: int
    name: str
    why: str


_One = TypeVar("_One")


class _Found(Sequence[_One]):
    """What a search found."""

    def __init__(self, found: list[_One], parts: list[str], pairs: int, faults: list[Fault]):
        self._found = found
        self.parts = parts
        """Names of all parts."""
        self.pairs = pairs
        """How many pairs of boxes touch, or are near; only these can clash."""
        self.faults = faults
        """Parts that could not be checked."""

    def __getitem__(self, which: Any) -> Any:
        return self._found[which]

    def __len__(self) -> int:
        return len(self._found)

    def __iter__(self) -> Iterator[_One]:
        return iter(self._found)

    def _not_checked(self) -> list[str]:
        return [f"not checked: {_some([fault.name for fault in self.faults])}"] if self.faults else []


class ClashGroup(NamedTuple):
    """Clashes that are one matter for a person.

    a: path of the part that all have, or of what their parts are in.
    b: of the other, which may be the same; None: of several other parts.
    clashes: in their order, the deepest first.
    box: (2, 3) float64, metres: lowest and highest corner of their boxes, and of points where they have none.
    """

    a: str
    b: Optional[str]
    clashes: list[Clash]
    box: NDArray[np.float64]


class Clashes(_Found[Clash]):
    """Clashes, the deepest first, then those without a depth, that touch, that are near."""

    def __init__(
        self,
        clashes: list[Clash],
        parts: list[str],
        pairs: int,
        faults: list[Fault],
        open: list[str],
        paths: list[str],
        tree: tuple[list[str], list[list[str]]],
    ):
        super().__init__(clashes, parts, pairs, faults)
        self.paths = paths
        """Of all parts, of files with a tree the names of the nodes that they are under before their own, with "/"
        between: "Building/Floor 2/Pipe 7"."""
        self.open = open
        """Parts without an inside."""
        self._tree = tree

    def groups(self, by: Union[str, int] = "part") -> list[ClashGroup]:
        """Clashes that are one matter, in the order of their deepest ones.

        by: "part": each clash is in the group of one of its parts: first all those of the part that has the most, then
            of the one that has the most of what is left; so 40 bolts in one flange are one group. "assembly": those of
            what is under one node with what is under another, or the same; a number n from 1: of nodes that the first n
            names of a path are. Raises InputError for anything else.
        """
        levels = {"part": -1, "assembly": 0}
        level = levels.get(by) if isinstance(by, str) else as_count(by, "by")
        if level is None or (level == 0 and by != "assembly"):
            raise InputError(f"by: {by!r} is not 'part', 'assembly' or a number from 1 on")
        pairs = [(one.index_a, one.index_b) for one in self]
        corners = [(one.point_a, one.point_b) if one.box is None else one.box for one in self]
        boxes = [np.concatenate((np.min(pair, axis=0), np.max(pair, axis=0))).tolist() for pair in corners]
        found = _core.group_clashes(self.parts, *self._tree, pairs, boxes, level)
        return [ClashGroup(a, b or None, [self[i] for i in numbers], box) for a, b, numbers, box in found]

    def __repr__(self) -> str:
        depths = [clash.depth for clash in self if clash.depth and clash.depth > 0]
        deepest = f", deepest {depths[0]:.6g} m" if depths else ""
        return f"<Clashes: {len(self)} among {len(self.parts)} parts{deepest}>"

    def __str__(self) -> str:
        lines = []
        for clash in self:
            depth = f"{clash.distance:.4g} m apart" if clash.kind == "near" else "touching"
            if clash.kind not in ("near", "touching"):
                depth = "no depth" if clash.depth is None else f"{clash.depth:.4g} m"
            a, b = self.paths[clash.index_a], self.paths[clash.index_b]
            apart = f", parted by {-clash.separation.distance:.4g} m" if clash.separation else ""
            lines.append(f"{depth:>12}  {a}  x  {b}{_NOTES.get(clash.kind, '')}{apart}")
        lines.append(repr(self)[1:-1])
        if self.open:
            lines.append(f"open, so that nothing is inside: {_some(self.open)}")
        return "\n".join(lines + self._not_checked())


class PathClash(NamedTuple):
    """A part that moves, and one that it meets or comes near on its way.

    moving: name of the part that moves.
    other: name of the other.
    meet: they meet, at `time` first; else they are nearest to each other then.
    time: from 0 to the number of moves less 1.
    distance: metres; of those that meet at most 1e-7 of the smaller part.
    point_moving: (3,) float64, metres, frame of the assembly: on the part that moves, where it is then.
    point_other: likewise on the other.
    index_moving: of the part that moves in the list of parts.
    index_other: of the other.
    at: what `clash_along` was told of that time; else the time.
    """

    moving: str
    other: str
    meet: bool
    time: float
    distance: float
    point_moving: NDArray[np.float64]
    point_other: NDArray[np.float64]
    index_moving: int
    index_other: int
    at: float


class PathClashes(_Found[PathClash]):
    """Those that meet, the first one first; then those that come no farther apart than the clearance, the nearest
    first."""

    def __init__(
        self, found: list[PathClash], parts: list[str], pairs: int, faults: list[Fault], nearest: Optional[PathClash]
    ):
        super().__init__(found, parts, pairs, faults)
        self.nearest = nearest
        """Of all that stay apart those that come nearest to each other; None: there are none."""

    def __repr__(self) -> str:
        meet = sum(one.meet for one in self)
        least = f"; of the others the nearest stay {self.nearest.distance:.6g} m apart" if self.nearest else ""
        return f"<PathClashes: {meet} meet among {len(self.parts)} parts{least}>"

    def __str__(self) -> str:
        lines = []
        for one in self:
            how = "meet" if one.meet else f"{one.distance:.4g} m apart"
            lines.append(f"{how:>16}  at {one.at:<10.6g}  {one.moving}  x  {one.other}")
        return "\n".join([*lines, repr(self)[1:-1], *self._not_checked()])


_NOTES = {
    "duplicate": "  (the same part in the same place)",
    "inside": "  (one inside the other)",
    "piercing": "  (one through the other)",
}


def _some(names: list[str]) -> str:
    return ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")


def clash(
    assembly: Any,
    *,
    scale: float = 1.0,
    weld: Optional[float] = None,
    components: bool = False,
    against: Union[str, Sequence[str], None] = None,
    exclude: Iterable[Union[str, tuple[str, str]]] = (),
    clearance: float = 0.0,
    clearances: Iterable[ClearanceLike] = (),
    tolerance: float = 0.0,
    ignore_touching: Optional[float] = None,
    volumes: bool = False,
    separations: bool = False,
    threads: int = 0,
    progress: Union[bool, Callable[[float], Any]] = False,
) -> Clashes:
    """Every pair of parts that shares a point (exact) or is near, with its kind and the depth of its deepest contact.

    assembly: a file or a list of files (of a glTF file each node with a mesh is a part); a list of parts: each an
        `AssemblyPart`, a tuple (name, mesh, pose) or a mesh where it lies; a dict of meshes by name; or a scene of
        trimesh. Parts stay where they are placed.
    scale: what coordinates and places are multiplied by; 0.001 makes metres of millimetres. Without it all lengths are
        in the unit of the parts.
    weld: as `Mesh` has it, of each part by itself, after scale.
    components: splits each part into what is closed by itself, with its cavities, and what is open and shares vertices;
        those of a part are "NAME #1", "NAME #2", ...
    against: names of parts or files, "*" and "?" stand for any; with "/" also what ends one of `Clashes.paths`, so that
        "Floor 2/*" are all parts under nodes of that name: they are tested against all others, and no more.
    exclude: pairs of such names that are left out; and "parent-child", for nodes of a glTF file and those under them.
    clearance: parts that are no farther apart are found, too: kind "near", metres.
    clearances: others for some pairs: (0.025, "pipe*") for those of which one part has such a name, (0.025, "pipe*",
        "wall*") where the other has that. Of all that apply, and `clearance`, the largest counts.
    tolerance: gaps, and depths but of two open parts, up to it are "touching", metres.
    volumes: asks for the volume that two parts share (slow).
    separations: asks for the translation that parts them (slow: seconds for large parts).
    ignore_touching: leaves out clashes no deeper than this, metres; 0: those that only touch. None leaves out none.
    progress: True draws a bar if tqdm is installed; or a function of what is done, from 0 to 1.

    Raises InputError for files that cannot be read, for fewer than two parts, for poses that are not rigid, for names
    that match nothing, for lengths below 0 and for a weld that `Mesh` refuses.
    """
    given = _given(assembly, scale, weld, components)
    options = _options(exclude, clearance, clearances, threads)
    options.against = [against] if isinstance(against, str) else list(against or ())
    options.tolerance = as_length(tolerance, "tolerance")
    options.volumes = bool(volumes)
    options.separations = bool(separations)
    with _Bar(progress) as bar:
        found, pairs, faults, opened, paths = _core.find_clashes(*given, options, bar.tell)
    names = given[0]

    def made(one: tuple[Any, ...]) -> Clash:
        parted = None if one[-1] is None else Separation(*one[-1])
        return Clash._make((names[one[5]], names[one[6]], *one[:-1], parted))

    clashes = [made(one) for one in found]
    if ignore_touching is not None:
        most = as_length(ignore_touching, "ignore_touching") * (1 + 1e-6)  # depths are float32
        clashes = [one for one in clashes if one.kind == "near" or one.depth is None or one.depth > most]
    return Clashes(
        clashes, names, pairs, _faults(names, faults), [names[i] for i in opened], paths, (given[3], given[5])
    )


def clash_along(
    assembly: Any,
    moving: Union[str, Sequence[str]],
    moves: PoseLike,
    *,
    at: Optional[ArrayLike] = None,
    scale: float = 1.0,
    weld: Optional[float] = None,
    components: bool = False,
    exclude: Iterable[Union[str, tuple[str, str]]] = (),
    clearance: float = 0.0,
    clearances: Iterable[ClearanceLike] = (),
    threads: int = 0,
    progress: Union[bool, Callable[[float], Any]] = False,
) -> PathClashes:
    """What some parts meet while they move together past all others, when first, and how near they come to what they
    do not meet.

    moving: names or patterns of the parts that move, as `clash` has them in `against`.
    moves: (n, 4, 4), rigid, n at least 1: from where the parts are placed to where they are at times 0, 1, ..., in the
        frame of the assembly; from each to the next by a screw, the shortest turn: give poses less than half a round
        apart, else it goes the other way. `turn` and `slide` make those of a
        hinge and of a drawer: `turn((0, 0, 1), np.linspace(0, 2, 3), hinge)`.
    at: (n,), what `PathClash.at` is at these times, as the angles of a turn; in between in proportion.
    clearance, clearances: metres; parts that come no farther apart are found, too.
    assembly, scale, weld, components, exclude, threads, progress: as of `clash`, which raises the same; translations of
        moves are in the unit that scale makes.

    Times, distances and tolerances are those of `path_clearance`: two that touch at the start have met there, so leave
    out a hinge with `exclude`. Raises InputError, too, for moves that are none or not rigid, and for an `at` that has
    not as many finite numbers.
    """
    given = _given(assembly, scale, weld, components)
    if moves is None:
        raise InputError("moves: is None; give poses, as turn() and slide() make them")
    poses = as_poses(moves, "moves", rigid=True)
    poses = poses[np.newaxis] if poses.ndim == 2 else poses
    if poses.ndim != 3:
        raise InputError(f"moves: has shape {poses.shape}; give (n, 4, 4)")
    values = np.arange(len(poses)) if at is None else as_numbers(at, "at")
    if values.shape != (len(poses),) or not np.isfinite(values).all():
        raise InputError(f"at: has shape {values.shape}; give {len(poses)} finite numbers, one for each move")
    names = given[0]

    def made(one: tuple[Any, ...]) -> PathClash:
        then = float(np.interp(one[1], range(len(values)), values))
        return PathClash._make((names[one[5]], names[one[6]], *one, then))

    with _Bar(progress) as bar:
        found, nearest, pairs, faults = _core.find_path_clashes(
            *given, [moving] if isinstance(moving, str) else list(moving), poses,
            _options(exclude, clearance, clearances, threads), bar.tell,
        )  # fmt: skip
    return PathClashes(
        [made(one) for one in found], names, pairs, _faults(names, faults), None if nearest is None else made(nearest)
    )


_Given = tuple[list[str], list[_core.Mesh], NDArray[np.float64], list[str], list[int], list[list[str]]]


def _given(assembly: Any, scale: float, weld: Optional[float], components: bool) -> _Given:
    """Names, meshes, poses and the rest of the parts, as the C++ half takes them."""
    given, files, parents, unders = _parts_of(assembly)
    parts = scaled_parts(given, scale, weld)
    if components and parts:
        parts, files, parents, unders = split_parts(parts, files, parents, unders)
    if len(parts) < 2:
        more = "" if components else "; components=True splits parts further"
        raise InputError(
            f"clash: {len(parts)} part given; give several, or a file that has parts: nodes, objects, groups or solids"
            + more
        )
    poses = np.ascontiguousarray(np.stack([part.pose for part in parts]))
    return [part.name for part in parts], [part.mesh._core for part in parts], poses, files, parents, unders


def _options(
    exclude: Iterable[Union[str, tuple[str, str]]], clearance: float, clearances: Iterable[ClearanceLike], threads: int
) -> _core.ClashOptions:
    options = _core.ClashOptions()
    options.exclude, options.exclude_parent_child = _excluded(exclude)
    options.clearance = as_length(clearance, "clearance")
    options.clearances = [_clearance_of(given) for given in clearances]
    options.threads = as_count(threads, "threads")
    return options


def _clearance_of(given: Any) -> _core.ClearanceOf:
    if (
        isinstance(given, (tuple, list))
        and len(given) in (2, 3)
        and all(isinstance(name, str) and name for name in given[1:])
    ):
        return _core.ClearanceOf(as_length(given[0], "clearances"), (given[1], "*" if len(given) == 2 else given[2]))
    raise InputError(f"clearances: {given!r} is no length with one or two names: (0.025, 'pipe*', 'wall*')")


def _faults(names: list[str], faults: list[tuple[int, str]]) -> list[Fault]:
    return [Fault(i, names[i], why) for i, why in faults]


def _excluded(exclude: Iterable[Union[str, tuple[str, str]]]) -> tuple[list[tuple[str, str]], bool]:
    if isinstance(exclude, str):
        exclude = [exclude]
    pairs, parent_child = [], False
    for pair in exclude:
        if pair == "parent-child":
            parent_child = True
        elif isinstance(pair, (tuple, list)) and len(pair) == 2 and all(isinstance(name, str) for name in pair):
            pairs.append((pair[0], pair[1]))
        else:
            raise InputError(f"exclude: {pair!r} is no pair of names, and not 'parent-child'")
    return pairs, parent_child


_Parts = tuple[list[tuple[str, _core.Mesh, NDArray[np.float64]]], list[str], list[int], list[list[str]]]


def _parts_of(assembly: Any) -> _Parts:
    """The parts; and, of parts from files, these, their parents and the names of what they are under."""
    if isinstance(assembly, (str, os.PathLike)):
        assembly = [assembly]
    if hasattr(assembly, "graph") and hasattr(assembly, "geometry"):  # of trimesh
        placed = [(node, *assembly.graph[node]) for node in assembly.graph.nodes_geometry]
        assembly = [(node, assembly.geometry[geometry], pose) for node, pose, geometry in placed]
    if isinstance(assembly, dict):
        assembly = [(name, mesh, None) for name, mesh in assembly.items()]
    if not isinstance(assembly, (list, tuple)) or hasattr(assembly, "faces"):
        raise InputError(f"clash: {type(assembly).__name__} is no file, and no list or dict of files or parts")
    if assembly and all(isinstance(item, (str, os.PathLike)) for item in assembly):
        parts, left_out = _core.load_parts([os.fspath(file) for file in assembly])
        tell(left_out)
        return parts
    made: dict[int, Mesh] = {}
    parts = []
    for i, item in enumerate(assembly):
        name, mesh, pose = item if isinstance(item, tuple) and len(item) == 3 else (None, item, None)
        matrices = as_pose(pose, f"part {i}: pose", rigid=True)[None]
        if getattr(mesh, "round", None) is not None:
            raise InputError(f"part {i}: is round, and clash is of meshes; Mesh(shape) is a picture of it by triangles")
        if id(mesh) not in made:
            made[id(mesh)] = mesh if isinstance(mesh, Mesh) else Mesh(mesh)
        own = made[id(mesh)]
        parts.append((str(name if name is not None else own.name or i), own._core, matrices.copy()))
    return parts, [], [], []


class _Bar:
    """What is done goes to a function, a bar of tqdm, or nowhere."""

    def __init__(self, progress: Union[bool, Callable[[float], Any]]) -> None:
        self.tell: Optional[Callable[[float], Any]] = progress if callable(progress) else None
        self._bar: Any = None
        if progress is True:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                return
            self._bar = tqdm(total=100, desc="clash", unit="%")
            self.tell = lambda done: self._bar.update(100 * done - self._bar.n)

    def __enter__(self) -> _Bar:
        return self

    def __exit__(self, *error: Any) -> None:
        if self._bar is not None:
            self._bar.close()


__all__ = ["Clash", "ClashGroup", "Clashes", "Fault", "PathClash", "PathClashes", "clash", "clash_along"]
