# SPDX-License-Identifier: Apache-2.0
"""Meshes made ready for queries and scenes."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from typing import Any, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import ScaleLike, as_count, as_length
from ._core import InputError, MeshReport
from .mesh import Mesh, MeshLike


class SheetWarning(UserWarning):
    """A question about the inside of a shape that has none, told once for each shape.

    `warnings.simplefilter("ignore", raycontact.SheetWarning)` silences it where sheets are meant.
    """


class Mass(NamedTuple):
    """Of a body filled with matter of unit density.

    volume: m^3; times the density it is the mass.
    centre: (3,) float64, of mass, metres, body frame.
    inertia: (3, 3) float64, about the centre, body axes, m^5; times the density it is kg m^2.
    """

    volume: float
    centre: NDArray[np.float64]
    inertia: NDArray[np.float64]


class Round(NamedTuple):
    """A ball, or a capsule: all points within `radius` of a segment. Body frame, metres.

    start: (3,) float64, one end of the segment.
    end: (3,) float64, its other end; a ball's is the same.
    radius: metres.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    radius: float


class Shape:
    """An immutable mesh made ready for rays: welded, checked, with its tree. Share one among any number of bodies.

    `Shape(mesh)` takes whatever `Mesh` takes alone: a Mesh, a file, an object with `vertices` and `faces`. To make one
    costs some microseconds a triangle, so make it once.

    scale: what coordinates are multiplied by, as `Mesh` has it: a factor or three, negative ones mirror.
    repair: drop degenerate and duplicate triangles, make windings agree, turn components as `nesting` says; `report`
        names what was done. False: change nothing.
    nesting: which way closed components wind: "as_wound" (outermost ones outward, those inside others as they are),
        "cavities" (by turns outward and inward), "solids" (all outward).
    holes: which are spanned with triangles of our own, numbered after those of the mesh: "of_solids" (all, if the
        winding number says that the mesh is a solid; docs/conventions.md, Holes), "of_all" (of sheets, too, if they are
        flat or smaller than a tenth of the diagonal), "none".
    overlaps: parts of one closed mesh that cross or lie in each other become one solid ("unite"), or stay ("leave").
    threads: 0 is one for each core; no bit depends on it.

    It can be pickled, and sent to another process: there it is the same to the bit, vertices, triangles, indices,
    report and contacts. Nothing is repaired anew, and what `prepare` made is there, too. A pickle holds what `save`
    gives: to keep a shape for other versions of the library, keep its mesh.

    Raises InputError for a mesh without area, and as `Mesh` does. Safe to use from any thread.
    """

    def __init__(
        self,
        mesh: MeshLike,
        *,
        scale: ScaleLike = 1.0,
        repair: bool = True,
        nesting: str = "as_wound",
        holes: str = "of_solids",
        overlaps: str = "unite",
        threads: int = 0,
    ) -> None:
        if isinstance(mesh, Shape) and mesh.round is not None:
            raise InputError("mesh: is a round shape; use it as it is, or Mesh(shape), a picture of it by triangles")
        if not isinstance(mesh, Mesh) or type(scale) is not float or scale != 1.0:
            mesh = Mesh(mesh, scale=scale)
        self._core = _core.make_shape(
            mesh._core, bool(repair), str(nesting), str(holes), str(overlaps), as_count(threads, "threads")
        )
        self._untold = not self._core.has_inside

    @classmethod
    def _wrap(cls, core: _core.Shape) -> Shape:
        shape = cls.__new__(cls)
        shape._core = core
        shape._untold = not core.has_inside
        return shape

    def _tell_sheet(self, asked: str) -> None:
        """Warns the first time, if the shape has no inside. Callers look at `_untold` first."""
        self._untold = False
        name = f"the mesh {self.name!r}" if self.name else "a mesh"
        words = f"{asked}: {name} has no inside, so {_OF_SHEETS[asked]}; it is {self.report.verdict}"
        warnings.warn(words, SheetWarning, stacklevel=_levels_out())

    def prepare(self, threads: int = 0) -> None:
        """Makes what only speeds up later steps: 10 to 45 times the work of making the shape. A scene has it made
        beside its steps; call it where the first steps must be as fast as later ones. No contact of the methods
        "standard" and "certified" depends on it. Does nothing the second time. threads: 0 is one for each core."""
        self._core.prepare(as_count(threads, "threads"))

    @property
    def is_prepared(self) -> bool:
        """`prepare` was done, by whomever."""
        return self._core.is_prepared

    def save(self) -> bytes:
        """The shape with what `prepare` made, if it did, as bytes for `load` by this version of the library on this
        kind of machine (order of bytes)."""
        return self._core.save()

    @classmethod
    def load(cls, data: bytes) -> Shape:
        """What `save` gave: the same to the bit in all that it answers, in a part of the time that making and
        preparing it takes.

        Raises InputError for bytes that `save` did not give, that are damaged or not all there, or of another version
        of the library or kind of machine.
        """
        if not isinstance(data, (bytes, bytearray)):
            raise InputError(f"data: is a {type(data).__name__}; give the bytes that save() returned")
        return cls._wrap(_core.load_shape(bytes(data)))

    @property
    def name(self) -> str:
        """The mesh's."""
        return self._core.name

    @property
    def report(self) -> MeshReport:
        """What the mesh is, and what was repaired; `print` it. `report.verdict` is one line."""
        return self._core.report

    @property
    def has_inside(self) -> bool:
        """A point can be inside it: it is closed, wound alike everywhere, and holds something."""
        return self._core.has_inside

    @property
    def round(self) -> Optional[Round]:
        """What `ball` and `capsule` made; None for meshes. Queries and contacts go by it; the mesh is a picture."""
        made = self._core.round
        return None if made is None else Round(np.array(made[0]), np.array(made[1]), made[2])

    @property
    def vertices(self) -> NDArray[np.float64]:
        """(n, 3) float64, metres, body frame: distinct positions, as the mesh had them. Not writable."""
        return self._core.vertices

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(m, 3) uint32: rows of `vertices`. Not writable."""
        return self._core.triangles

    faces = triangles
    """The same, by the name that other libraries use."""

    @property
    def vertex_index(self) -> NDArray[np.uint32]:
        """(n,) uint32: which vertex of the mesh each is (the lowest where several were welded)."""
        return self._core.vertex_index

    @property
    def triangle_index(self) -> NDArray[np.uint32]:
        """(m,) uint32: which triangle of the mesh each is. Contacts and queries give those of the mesh."""
        return self._core.triangle_index

    @property
    def vertex_normals(self) -> NDArray[np.float64]:
        """(n, 3) float64, unit, body frame, outward: angle-weighted (Baerentzen and Aanaes 2005); 0 where the triangles
        around a vertex cancel out."""
        return self._core.vertex_normals

    @property
    def vertex_areas(self) -> NDArray[np.float32]:
        """(n,) float32, m^2: a third of the area of the triangles around each vertex."""
        return self._core.vertex_areas

    @property
    def exit_distances(self) -> NDArray[np.float32]:
        """(n,) float32, metres: how far the ray from a vertex along its inward normal travels inside the mesh: the
        thickness there. inf where it never leaves."""
        return self._core.exit_distances

    @property
    def box(self) -> NDArray[np.float64]:
        """(2, 3) float64, metres, body frame: least and greatest coordinates."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @property
    def radius(self) -> float:
        """Largest distance of a vertex from the body's origin, metres."""
        return self._core.radius

    @property
    def longest_edge(self) -> float:
        """Of all edges of the mesh, metres."""
        return self._core.longest_edge

    @property
    def mass(self) -> Mass:
        """By volume integrals over the closed mesh, for unit density; the volume is `report.volume`. All 0 where the
        mesh is open or encloses nothing, negative where it winds inward. Of round shapes by closed formulas."""
        volume, centre, inertia = self._core.mass
        return Mass(volume, np.array(centre), inertia)

    @property
    def memory_bytes(self) -> int:
        """What the shape takes on the host."""
        return self._core.memory_bytes

    def __deepcopy__(self, memo: Any) -> Shape:
        return self  # nobody can change it

    def __copy__(self) -> Shape:
        return self

    def __reduce__(self) -> Any:
        return _loaded, (self.save(),)

    def __repr__(self) -> str:
        return f"<Shape {self.name!r}: {self.report.triangles} triangles, {self.report.verdict}>"


def ball(radius: float) -> Shape:
    """A ball about the origin, radius in metres.

    Queries and contacts take it as what it is, to rounding: in queries its triangles are -1, and its vertices are a
    picture of it. `contact_patches` and `clash` take meshes alone and raise InputError for it; so does a radius that is
    not from 1e-6 to 1e8 m.
    """
    return Shape._wrap(_core.make_ball(as_length(radius, "radius")))


def capsule(radius: float, half_length: float) -> Shape:
    """All within `radius` metres of the segment from (0, 0, -half_length) to (0, 0, half_length); round as `ball` is.

    Raises InputError as that, and for a half length that is not from 0 to 1e8 m.
    """
    return Shape._wrap(_core.make_capsule(as_length(radius, "radius"), as_length(half_length, "half_length")))


def plane(half_extent: float = 1000.0, thickness: float = 10.0) -> Shape:
    """The ground: a box whose top is z = 0, metres. It is finite because scenes sort bodies by their boxes.

    Raises InputError for measures that are not from 1e-6 to 1e8 m.
    """
    return Shape._wrap(_core.make_plane(as_length(half_extent, "half_extent"), as_length(thickness, "thickness")))


_OF_SHEETS = {
    "contains": "no point is in it",
    "signed_distance": "no point is below 0",
    "distance": "what lies in it is not at 0 but at the distance of the surfaces",
}


def _loaded(data: bytes) -> Shape:
    return Shape.load(data)


def _levels_out() -> int:
    """Where this package was called from, as `warnings.warn` counts for a caller of this."""
    frame, levels = sys._getframe(1), 1
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith(f"{__package__}."):
        frame, levels = frame.f_back, levels + 1
    return levels


ShapeLike = Union[Shape, MeshLike]
"""A Shape, or what it is made of: a Mesh, the path of a file, an object with `vertices` and `faces`."""

Shapes = Union[ShapeLike, Sequence[ShapeLike], NDArray[np.object_]]
"""One, or a list of them."""


def as_shape(value: ShapeLike) -> Shape:
    """The shape itself, or one made of what is given."""
    return value if isinstance(value, Shape) else Shape(value)


def as_solid(value: ShapeLike, asked: str) -> Shape:
    """As `as_shape`; warns if it has no inside. asked: the question."""
    shape = as_shape(value)
    if shape._untold:
        shape._tell_sheet(asked)
    return shape


def as_shapes(value: Any, what: str, asked: Optional[str] = None) -> tuple[list[_core.Shape], tuple[int, ...]]:
    """The C++ half's shapes, and () for a single one or (n,). What is there several times is made once.

    asked: a question that warns of those without an inside."""
    made, lead = _as_shapes(value, what)
    if asked is not None:
        for shape in made:
            if shape._untold:
                shape._tell_sheet(asked)
    return [shape._core for shape in made], lead


def _as_shapes(value: Any, what: str) -> tuple[list[Shape], tuple[int, ...]]:
    if isinstance(value, Shape):
        return [value], ()
    is_list = isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.dtype == object)
    if not is_list or hasattr(value, "faces"):
        return [as_shape(value)], ()
    made: dict[int, Shape] = {}
    shapes = []
    for i, item in enumerate(value):
        if id(item) not in made:
            try:
                made[id(item)] = as_shape(item)
            except InputError as error:
                raise InputError(f"{what}[{i}]: {error}") from None
        shapes.append(made[id(item)])
    return shapes, (len(shapes),)


__all__ = ["Mass", "Round", "Shape", "ShapeLike", "Shapes", "SheetWarning", "ball", "capsule", "plane"]
