# SPDX-License-Identifier: Apache-2.0
"""Meshes made by formula, to try things with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import as_length, as_numbers
from ._core import InputError
from .mesh import Mesh

_Lengths = Union[float, Sequence[float], NDArray[Any]]

_COLUMNS = 36
"""Corners of bolt and nut around their axis."""

_PITCH, _MAJOR = 1.5e-3, 5e-3
"""Of an M10 thread, metres: a turn, and the radius of its crest."""

_PLAY = 0.1e-3
"""Between the radii of bolt and nut, metres."""


def samples() -> dict[str, Mesh]:
    """Concave meshes by name, each closed and good for contacts, of the size of such things: 2 to 15 cm.

    "torus", "mug" (cup and handle cross, and are one solid as a Shape), "knot" (a trefoil), "gear", "bolt" and "nut"
    (M10 by 1.5 mm along z: the nut is on the bolt, without touching it, at `pose([0, 0, k * 0.0015])` for whole k from
    0 to 10, and turns from one to the next).
    """
    return {mesh.name: mesh for mesh in (_torus(), _mug(), _knot(), _gear(), _bolt(), _nut())}


def box(size: _Lengths = 1.0) -> Mesh:
    """A box around the origin; convex. size: metres, along x, y and z, or one for all. Raises InputError unless they
    are finite and above 0."""
    half = _lengths(size, 3, "size") / 2
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    faces = [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]  # fmt: skip
    return Mesh(corners, np.array(faces), name="box")


def heightfield(heights: ArrayLike, cell: _Lengths, floor: float) -> Mesh:
    """The closed solid under a grid of heights, down to a floor, with walls around.

    heights: (r, c), metres: `heights[i, j]` is z at x = i * cell, y = j * cell. At least 2 x 2. A cell is two
        triangles, which share its corners (i, j) and (i + 1, j + 1).
    cell: metres, along x and y, or one for both.
    floor: metres: z of the bottom, below all heights.
    Raises InputError for other shapes, heights that are not finite or not above the floor, and cells not above 0.
    """
    z = np.asarray(as_numbers(heights, "heights"), np.float64)
    if z.ndim != 2 or min(z.shape) < 2:
        raise InputError(f"heights: has shape {z.shape}; give (r, c), at least 2 each")
    low = as_length(floor, "floor")
    if not (np.isfinite(z).all() and np.isfinite(low) and z.min() > low):
        raise InputError(f"heights: one is not finite, or not above the floor at {floor!r}")
    size = _lengths(cell, 2, "cell")
    r, c = z.shape
    x, y = np.meshgrid(np.arange(r) * size[0], np.arange(c) * size[1], indexing="ij")
    top = np.stack((x, y, z), axis=-1).reshape(-1, 3)
    number = np.arange(r * c).reshape(r, c)
    around = np.r_[number[:-1, 0], number[-1, :-1], number[:0:-1, -1], number[0, :0:-1]]  # counter-clockwise from above
    bottom = np.c_[top[around, :2], np.full(len(around), low)]
    middle = [(r - 1) * size[0] / 2, (c - 1) * size[1] / 2, low]
    under = r * c + np.arange(len(around))
    following, following_under = np.roll(around, -1), np.roll(under, -1)
    faces = [
        _quads(number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]),
        _quads(under, following_under, following, around),
        np.stack((np.full(len(under), r * c + len(under)), following_under, under), axis=-1),
    ]
    return Mesh(np.concatenate((top, bottom, [middle])), np.concatenate(faces), name="heightfield")


def _lengths(value: Any, count: int, what: str) -> NDArray[np.float64]:
    """(count,), of as many or of one."""
    lengths = np.asarray(as_numbers(value, what), np.float64)
    if lengths.shape not in ((), (1,), (count,)):
        raise InputError(f"{what}: has shape {lengths.shape}; give one, or {count}")
    if not (np.isfinite(lengths).all() and (lengths > 0).all()):
        raise InputError(f"{what}: {value!r} is not finite and above 0")
    return np.broadcast_to(lengths, (count,))


def _quads(*corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """Two triangles for each; they share the first and the third corner."""
    a, b, c, d = (corner.reshape(-1) for corner in corners)
    return np.concatenate((np.stack((a, b, c), axis=-1), np.stack((a, c, d), axis=-1)))


def _skin(rings: NDArray[np.float64], ends: Any = None) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Joins rings (n, m, 3), counter-clockwise seen from where they go to. ends: the points that close the first and
    the last; None: these are joined, too."""
    n, m = rings.shape[:2]
    i, j = np.meshgrid(np.arange(n if ends is None else n - 1), np.arange(m), indexing="ij")
    faces = _quads(i * m + j, i * m + (j + 1) % m, (i + 1) % n * m + (j + 1) % m, (i + 1) % n * m + j)
    vertices = rings.reshape(-1, 3)
    if ends is not None:
        k = np.arange(m)
        first = np.stack((np.full(m, n * m), (k + 1) % m, k), axis=-1)
        last = np.stack((np.full(m, n * m + 1), k, (k + 1) % m), axis=-1) + [[0, (n - 1) * m, (n - 1) * m]]
        vertices, faces = np.concatenate((vertices, np.asarray(ends, float))), np.concatenate((faces, first, last))
    return vertices, faces


def _turned(radius: ArrayLike, z: ArrayLike, columns: int) -> NDArray[np.float64]:
    """(n, columns, 3) rings about the z axis, of radii (n,) or (n, columns) and heights (n,)."""
    angle = np.arange(columns) * 2 * np.pi / columns
    r, height = np.broadcast_arrays(np.asarray(radius, float).reshape(len(np.asarray(z)), -1), np.reshape(z, (-1, 1)))
    r, height = (np.broadcast_to(x, (len(x), columns)) for x in (r, height))
    return np.stack((r * np.cos(angle), r * np.sin(angle), height), axis=-1)


def _tube(
    line: NDArray[np.float64], along: NDArray[np.float64], aside: ArrayLike, radius: float, corners: int
) -> NDArray[np.float64]:
    """(n, corners, 3) rings about the points of a line (n, 3); aside: across it, nearly."""
    along = along / np.linalg.norm(along, axis=-1, keepdims=True)
    one = np.cross(np.asarray(aside), along)
    one /= np.linalg.norm(one, axis=-1, keepdims=True)
    other = np.cross(along, one)
    v = np.arange(corners)[:, None] * 2 * np.pi / corners
    return line[:, None] + radius * (np.cos(v) * one[:, None] + np.sin(v) * other[:, None])


def _torus(radius: float = 0.05, tube: float = 0.02, around: int = 48, across: int = 24) -> Mesh:
    u = np.arange(around)[:, None] * 2 * np.pi / around
    out = np.concatenate((np.cos(u), np.sin(u), 0 * u), axis=-1)
    along = np.concatenate((-np.sin(u), np.cos(u), 0 * u), axis=-1)
    return Mesh(*_skin(_tube(radius * out, along, (0, 0, 1), tube, across)), name="torus")


def _knot(size: float = 0.05, tube: float = 0.008, along: int = 120, across: int = 12) -> Mesh:
    """A trefoil."""
    u = np.arange(along) * 2 * np.pi / along
    r, scale = 2 + np.cos(3 * u), size / 3
    line = np.stack((r * np.cos(2 * u), r * np.sin(2 * u), -np.sin(3 * u)), axis=-1) * scale
    growth = -3 * np.sin(3 * u)
    turn_x, turn_y = -2 * r * np.sin(2 * u), 2 * r * np.cos(2 * u)
    tangent = np.stack((growth * np.cos(2 * u) + turn_x, growth * np.sin(2 * u) + turn_y, -3 * np.cos(3 * u)), axis=-1)
    return Mesh(*_skin(_tube(line, tangent, (0, 0, 1), tube, across)), name="knot")


def _mug(radius: float = 0.04, height: float = 0.095, wall: float = 0.004, columns: int = 48) -> Mesh:
    """A cup, and a handle whose ends lie in its wall."""
    inner = radius - wall
    cup = _turned([radius, radius, inner, inner], [0, height, height, wall], columns)
    vertices, faces = _skin(cup, [(0, 0, 0), (0, 0, wall)])
    a = np.linspace(-np.pi / 2, np.pi / 2, 25)
    middle = radius - wall / 2
    line = np.stack((middle + 0.03 * np.cos(a), 0 * a, height / 2 + 0.026 * np.sin(a)), axis=-1)
    along = np.stack((-0.03 * np.sin(a), 0 * a, 0.026 * np.cos(a)), axis=-1)
    handle, more = _skin(_tube(line, along, (0, 1, 0), 0.005, 16), line[[0, -1]])
    return Mesh(np.concatenate((vertices, handle)), np.concatenate((faces, more + len(vertices))), name="mug")


def _gear(teeth: int = 16, bore: float = 0.012, foot: float = 0.04, tip: float = 0.05, thick: float = 0.02) -> Mesh:
    """A ring with teeth that narrow towards their tips."""
    angle = (np.repeat(np.arange(teeth), 4) + np.tile((-0.28, -0.14, 0.14, 0.28), teeth)) * 2 * np.pi / teeth
    outer, inner = np.tile((foot, tip, tip, foot), teeth), np.full(4 * teeth, bore)
    corners = [(inner, -1), (outer, -1), (outer, 1), (inner, 1)]
    circle = np.cos(angle), np.sin(angle)
    rings = [np.stack((r * circle[0], r * circle[1], np.full_like(r, s * thick / 2)), axis=-1) for r, s in corners]
    return Mesh(*_skin(np.stack(rings)), name="gear")


def _thread(height: float, play: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(n, columns) radii and heights of rows that wind upwards with the thread, from z = 0 to `height`, where they are
    cut off; rows there coincide. A row goes on, after its last column, as the one that is a turn higher."""
    depth = 0.5413 * _PITCH  # ISO 68-1: flanks at 60 degrees, root and crest a quarter and an eighth of a turn wide
    places = np.array([0, 1 / 4, 9 / 16, 11 / 16])
    radii = np.array([_MAJOR - depth, _MAJOR - depth, _MAJOR, _MAJOR]) + play
    turns = np.arange(-1, int(np.ceil(height / _PITCH)) + 1)
    column = np.arange(_COLUMNS + 1)
    turn = turns[:, None, None] + (column == _COLUMNS)
    z = _PITCH * (turn + places[:, None] + column % _COLUMNS / _COLUMNS).reshape(-1, len(column))
    cut = np.clip(z, 0, height)
    phase = (cut / _PITCH - column % _COLUMNS / _COLUMNS) % 1
    r = np.where(z == cut, np.tile(radii, len(turns))[:, None], np.interp(phase, places, radii, period=1))
    return np.asarray(r, np.float64), np.asarray(cut, np.float64)


def _threaded(height: float, play: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices and triangles, seen from outside, of a thread; its first and its last row are rings of _COLUMNS."""
    r, z = _thread(height, play)
    n, m = r.shape
    angle = np.arange(m) % _COLUMNS * 2 * np.pi / _COLUMNS
    vertices = np.stack((r * np.cos(angle), r * np.sin(angle), z), axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n - 1), np.arange(m - 1), indexing="ij")
    return vertices, _quads(i * m + j, i * m + j + 1, (i + 1) * m + j + 1, (i + 1) * m + j)


def _hexagon(flats: float, z: ArrayLike) -> NDArray[np.float64]:
    """(n, _COLUMNS, 3) rings; flats: the distance of two sides."""
    angle = np.arange(_COLUMNS) * 2 * np.pi / _COLUMNS
    side = (angle + np.pi / 6) % (np.pi / 3) - np.pi / 6
    return _turned(np.tile(flats / 2 / np.cos(side), (len(np.asarray(z)), 1)), z, _COLUMNS)


def _joined(name: str, *pieces: tuple[NDArray[np.float64], NDArray[np.int64]]) -> Mesh:
    """One mesh, its vertices in the same place joined, without the triangles that collapse."""
    first = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    vertices = np.concatenate([vertices for vertices, _ in pieces])
    faces = np.concatenate([faces + start for (_, faces), start in zip(pieces, first)])
    vertices, which = np.unique(vertices, axis=0, return_inverse=True)
    faces = which.reshape(-1)[faces]
    whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return Mesh(vertices, faces[whole], name=name)


def _bolt(length: float = 24e-3, flats: float = 16e-3, head: float = 6.4e-3) -> Mesh:
    """Its tip at the origin, its head from z = length upwards."""
    vertices, faces = _threaded(length, 0)
    rows = vertices.reshape(-1, _COLUMNS + 1, 3)[:, :-1]
    cap = _skin(np.stack((rows[0],) * 2), [(0, 0, 0)] * 2)
    cap = cap[0], cap[1][-2 * _COLUMNS : -_COLUMNS]
    top = _skin(np.concatenate((rows[-1:], _hexagon(flats, [length, length + head]))), [(0, 0, length + head)] * 2)
    top = top[0], np.delete(top[1], np.s_[-2 * _COLUMNS : -_COLUMNS], axis=0)  # without the lower end
    return _joined("bolt", (vertices, faces), cap, top)


def _nut(height: float = 8e-3, flats: float = 16e-3) -> Mesh:
    """From z = 0 upwards."""
    vertices, faces = _threaded(height, _PLAY)
    rows = vertices.reshape(-1, _COLUMNS + 1, 3)[:, :-1]
    rings = np.concatenate((rows[:1], _hexagon(flats, [0, height]), rows[-1:]))
    outer = _skin(rings)
    keep = outer[1].reshape(2, 4, _COLUMNS, 3)[:, :-1].reshape(-1, 3)  # the last ring is not joined with the first
    return _joined("nut", (vertices, faces[:, ::-1]), (outer[0], keep))


__all__ = ["box", "heightfield", "samples"]
