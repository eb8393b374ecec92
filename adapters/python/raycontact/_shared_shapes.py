# SPDX-License-Identifier: Apache-2.0
"""One shape for a mesh, however often it is given."""

from __future__ import annotations

import hashlib
import os
import weakref
from collections.abc import Callable, Hashable
from typing import Any, Optional

import numpy as np

from ._arrays import as_numbers
from .mesh import Mesh
from .shape import Shape, ShapeLike

# A shape lives as long as somebody uses it, or a mesh that it was made of.
_shapes: weakref.WeakValueDictionary[Hashable, Shape] = weakref.WeakValueDictionary()
_of_mesh: dict[int, tuple[Any, Shape]] = {}


def shared_shape(mesh: ShapeLike) -> Shape:
    """A shape of what the mesh holds now. Meshes that hold the same share one; one that was changed gets another."""
    if isinstance(mesh, Shape):
        return mesh
    if isinstance(mesh, Mesh) and id(mesh) in _of_mesh:
        return _of_mesh[id(mesh)][1]  # a Mesh never changes
    content = _content(mesh)
    if content is None:
        return Shape(mesh)
    shape = _shapes.get(content)
    if shape is None:
        shape = _shapes[content] = Shape(mesh)
    try:
        _of_mesh[id(mesh)] = (weakref.ref(mesh, _forget(id(mesh))), shape)
    except TypeError:
        pass  # of what has no weak references the shape lives as long as it is used
    return shape


def _forget(key: int) -> Callable[[Any], None]:
    of_mesh = _of_mesh  # at the end of the program the callback finds no globals

    def forget(_: Any) -> None:
        of_mesh.pop(key, None)

    return forget


def _content(mesh: Any) -> Optional[Hashable]:
    """Differs where meshes differ; None for what is no mesh: `Shape` says so."""
    if isinstance(mesh, (str, os.PathLike)):
        try:
            state = os.stat(mesh)
        except OSError:
            return None
        return os.path.abspath(mesh), state.st_mtime_ns, state.st_size
    if not (hasattr(mesh, "vertices") and hasattr(mesh, "faces")):
        return None
    return _numbers(mesh.vertices, "vertices"), _numbers(mesh.faces, "triangles")


def _numbers(array: Any, what: str) -> Hashable:
    # trimesh's arrays know a hash of their numbers until these change, which spares reading all of them each time.
    if type(array).__module__.startswith("trimesh.") and type(array).__hash__ is not None:
        return array.shape, hash(array)
    numbers = np.ascontiguousarray(as_numbers(array, what))
    content = hashlib.blake2b(numbers.reshape(-1).view(np.uint8).data, digest_size=16)
    return numbers.shape, numbers.dtype.str, content.digest()
