# SPDX-License-Identifier: Apache-2.0
"""Triangle meshes, from files, arrays or other libraries."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable
from typing import Any, NamedTuple, Optional, Protocol, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import ScaleLike, as_factors, as_length, as_numbers, as_scale
from ._core import InputError, MeshReport


class HasFaces(Protocol):
    """A mesh of another library, as far as it is looked at; a `trimesh.Trimesh` is one."""

    @property
    def vertices(self) -> ArrayLike:
        """(n, 3) numbers, metres, body frame."""

    @property
    def faces(self) -> ArrayLike:
        """(m, 3) whole numbers: rows of `vertices`, counter-clockwise seen from outside."""


class Mesh:
    """Triangles as a file or arrays give them: nothing is welded, nothing repaired (that is `Shape`).

    `Mesh("part.stl")` reads OBJ, STL, PLY, OFF, glTF, GLB or 3MF, told by the ending. `Mesh(vertices, triangles)` takes
    arrays: (n, 3) numbers, metres, body frame; (m, 3) whole numbers from 0, counter-clockwise seen from outside.
    `Mesh(mesh)` takes an object with `vertices` and `faces`, such as a `trimesh.Trimesh`. What is given is copied.

    scale: what coordinates are multiplied by; 0.001 for a file in millimetres. 3MF says its unit: its are metres. Three
        factors are those of x, y and z, as URDF has them. Negative ones mirror: triangles are turned over where their
        number is odd, so that outside stays outside.
    weld: metres, after scale: vertices that are nearer to each other are joined, as those of a file whose corners
        differ in their last digits. None moves farther; `repairs` says how many did.
    name: for messages; that of the file where one is read.

    Raises InputError (a ValueError) naming the file or the element to blame: a file that is missing, unreadable or
    damaged, no triangles, a vertex that does not exist, a coordinate that is not finite, arrays of other shapes, a
    scale that is 0 or not finite, a weld not from 1e-12 to 1e9, or below the last digit of the largest coordinate.
    """

    @overload
    def __init__(
        self,
        source: MeshLike,
        triangles: None = None,
        *,
        scale: ScaleLike = 1.0,
        weld: Optional[float] = None,
        name: Optional[str] = None,
    ) -> None: ...

    @overload
    def __init__(
        self,
        source: ArrayLike,
        triangles: ArrayLike,
        *,
        scale: ScaleLike = 1.0,
        weld: Optional[float] = None,
        name: Optional[str] = None,
    ) -> None: ...

    def __init__(
        self,
        source: Union[MeshLike, ArrayLike],
        triangles: Optional[ArrayLike] = None,
        *,
        scale: ScaleLike = 1.0,
        weld: Optional[float] = None,
        name: Optional[str] = None,
    ) -> None:
        self._core = _welded(_core_of(source, triangles, scale, name), weld)

    @classmethod
    def from_bytes(cls, data: bytes, format: str, name: str = "") -> Mesh:
        """A mesh from the bytes of a whole file. format: "obj", "stl", "ply", "off", "gltf", "glb" or "3mf".

        Raises InputError as for a file, and for a glTF whose buffers are files of their own.
        """
        return cls._wrap(_core.parse_mesh(bytes(data), format, name))

    @classmethod
    def _wrap(cls, core: _core.Mesh) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._core = core
        return mesh

    @property
    def name(self) -> str:
        """For messages; may be empty."""
        return self._core.name

    @property
    def repairs(self) -> list[str]:
        """What reading a file left out or mended, in words with counts; `Shape.report.repairs` has them, too."""
        return self._core.repairs

    @property
    def vertices(self) -> NDArray[np.float64]:
        """(n, 3) float64, metres, body frame. Shows the mesh's own memory; not writable."""
        return self._core.vertices

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(m, 3) uint32: rows of `vertices`, counter-clockwise seen from outside. Not writable."""
        return self._core.triangles

    faces = triangles
    """The same, by the name that other libraries use."""

    def __reduce__(self) -> Any:
        return _unpickled, (self.vertices, self.triangles, self.name, self.repairs)

    def __repr__(self) -> str:
        return f"<Mesh {self.name!r}: {len(self.vertices)} vertices, {len(self.triangles)} triangles>"


MeshLike = Union[Mesh, str, os.PathLike[str], HasFaces]
"""A Mesh, the path of a file, or an object with `vertices` and `faces`, as those of trimesh have."""


def _unpickled(vertices: NDArray[np.float64], triangles: NDArray[np.uint32], name: str, repairs: list[str]) -> Mesh:
    return Mesh._wrap(_make(vertices, triangles, None, name, repairs))


def _core_of(
    source: Union[MeshLike, ArrayLike], triangles: Optional[ArrayLike], scale: ScaleLike, name: Optional[str]
) -> _core.Mesh:
    given: Any = source
    by = as_factors(scale)
    if isinstance(given, (str, os.PathLike)):
        if triangles is not None:
            raise InputError("Mesh: give a file, or vertices and triangles")
        core = _core.load_mesh(os.fspath(given))
        return core if by is None and name is None else _scaled(core, by, name)
    if isinstance(given, Mesh) and triangles is None:
        return given._core if by is None and name is None else _scaled(given._core, by, name)
    if triangles is None:
        if not (hasattr(given, "vertices") and hasattr(given, "faces")):
            raise InputError(
                f"Mesh: {type(given).__name__} is no file name and has no vertices and faces; "
                "give a file, vertices and triangles, or such an object"
            )
        given, triangles = given.vertices, given.faces
    return _make(given, triangles, by, name or "")


def _welded(core: _core.Mesh, weld: Optional[float]) -> _core.Mesh:
    return core if weld is None else _core.weld_mesh(core, as_length(weld, "weld"))


def _make(
    vertices: ArrayLike,
    triangles: ArrayLike,
    by: Optional[NDArray[np.float64]],
    name: str,
    repairs: Iterable[str] = (),
) -> _core.Mesh:
    points = as_numbers(vertices, "vertices")
    corners = as_numbers(triangles, "triangles", "iu")
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"vertices: has shape {points.shape}; give (n, 3)")
    if corners.ndim != 2 or corners.shape[1] != 3:
        raise InputError(f"triangles: has shape {corners.shape}; give (m, 3); polygons must be split")
    if corners.size and (corners.min() < 0 or corners.max() > 0xFFFFFFFF):
        row = int(np.argmax(((corners < 0) | (corners > 0xFFFFFFFF)).any(axis=1)))
        raise InputError(f"triangle {row}: has the vertex {corners[row].tolist()}; indices begin at 0")
    points = np.ascontiguousarray(points, np.float64)
    if by is not None:
        points = points * by
        if np.prod(np.sign(by)) < 0:  # mirrored
            corners = corners[:, ::-1]
    return _core.make_mesh(points, np.ascontiguousarray(corners, np.uint32), name, list(repairs))


def _scaled(core: _core.Mesh, by: Optional[NDArray[np.float64]], name: Optional[str]) -> _core.Mesh:
    return _make(core.vertices, core.triangles, by, core.name if name is None else name, core.repairs)


class AssemblyPart(NamedTuple):
    """A part of an assembly.

    name: of its node, "nodes[3]" where it has none, object, group or solid; or of its file.
    mesh: metres, in the part's own frame, scaled as the file scales it. Parts that are one mesh in several places share
        it.
    pose: (4, 4) float64, rigid, from the part's frame to that of the assembly, metres.
    """

    name: str
    mesh: Mesh
    pose: NDArray[np.float64]


def load_assembly(
    file: Union[str, os.PathLike[str]], *, scale: float = 1.0, weld: Optional[float] = None, components: bool = False
) -> list[AssemblyPart]:
    """Of a glTF file each node of its scene that places a mesh, in node order; of a 3MF file each object with a mesh as
    often as its build places it; of OBJ its objects or groups, of STL its solids; of any other file its one mesh.
    What is left out is told by a UserWarning that names it.

    scale: what coordinates and places are multiplied by; 0.001 for a file in millimetres. weld: as `Mesh` has it, of
    each part by itself. components: splits each part into what is closed by itself, with its cavities, and what is
    open and shares vertices; those of a part are "NAME #1", "NAME #2", ... Raises InputError as `Mesh` does for a file.
    """
    parts, left_out = _core.load_assembly(os.fspath(file))
    tell(f"{os.fspath(file)}: {words}" for words in left_out)
    made = scaled_parts(parts, scale, weld)
    return split_parts(made, [], [], [])[0] if components else made


def tell(left_out: Iterable[str]) -> None:
    """What was left out of files, to the caller's caller."""
    for words in left_out:
        warnings.warn(words, stacklevel=3)


def scaled_parts(
    parts: Iterable[tuple[str, _core.Mesh, NDArray[np.float64]]], scale: float, weld: Optional[float] = None
) -> list[AssemblyPart]:
    """Of parts as the C++ half gives them; those that share a mesh share it afterwards."""
    by = as_scale(scale)
    factors = as_factors(by)
    kept, shared = list(parts), {}  # the list keeps each core, so their ids stay theirs
    made = []
    for name, core, poses in kept:
        if id(core) not in shared:
            shared[id(core)] = Mesh._wrap(_welded(core if factors is None else _scaled(core, factors, None), weld))
        pose = poses[0]
        pose[:3, 3] *= by
        made.append(AssemblyPart(name, shared[id(core)], pose))
    return made


def split_parts(
    parts: list[AssemblyPart],
    files: list[str],
    parents: list[int],
    unders: list[list[str]],
) -> tuple[list[AssemblyPart], list[str], list[int], list[list[str]]]:
    """The components of parts, with their files, parents and the names of what they are under."""
    names, meshes = [part.name for part in parts], [part.mesh._core for part in parts]
    poses = np.stack([part.pose for part in parts])
    (split, files, parents, unders), left_out = _core.split_components(names, meshes, poses, files, parents, unders)
    tell(left_out)
    return scaled_parts(split, 1.0), files, parents, unders


__all__ = ["AssemblyPart", "HasFaces", "Mesh", "MeshLike", "MeshReport", "load_assembly"]
