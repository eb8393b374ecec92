# SPDX-License-Identifier: Apache-2.0
"""Closed, concave meshes for the examples, metres, wound outward."""

from __future__ import annotations

import numpy as np
import raycontact as rc


def sweep(rings: np.ndarray, name: str, closed: bool = True) -> rc.Mesh:
    """Joins rings (n, m, 3) of points; the first to the last if `closed`, else both ends get a convex cap."""
    n, m = rings.shape[:2]
    i, j = np.meshgrid(np.arange(n if closed else n - 1), np.arange(m), indexing="ij")
    a, b = i * m + j, i * m + (j + 1) % m
    c, d = (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m
    faces = [np.stack((a, b, d), axis=-1).reshape(-1, 3), np.stack((a, d, c), axis=-1).reshape(-1, 3)]
    if not closed:
        k = np.arange(1, m - 1)
        fan = np.stack((np.zeros_like(k), k + 1, k), axis=-1)
        faces += [fan, fan[:, ::-1] + (n - 1) * m]
    return rc.Mesh(rings.reshape(-1, 3), np.concatenate(faces), name=name)


def knot(p: int = 2, q: int = 3, size: float = 0.1, tube: float = 0.016, along: int = 96, around: int = 12) -> rc.Mesh:
    """A tube of radius `tube` along a torus knot that fits into a circle of radius `size`."""
    u = np.arange(along) * 2 * np.pi / along

    def line(u: np.ndarray) -> np.ndarray:
        r = 2 + np.cos(q * u)
        return np.stack((r * np.cos(p * u), r * np.sin(p * u), -np.sin(q * u)), axis=-1) * (size / 3)

    tangent = line(u + 1e-4) - line(u - 1e-4)
    side = np.cross(tangent, (0, 0, 1))
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    up = np.cross(tangent, side)
    up /= np.linalg.norm(up, axis=-1, keepdims=True)
    v = np.arange(around)[:, None] * 2 * np.pi / around
    return sweep(line(u)[:, None] + tube * (np.cos(v) * side[:, None] + np.sin(v) * up[:, None]), f"knot {p}-{q}")


def gear(teeth: int = 12, inner: float = 0.04, outer: float = 0.1, depth: float = 0.02, thick: float = 0.04) -> rc.Mesh:
    """A ring about the z axis with square teeth, `outer` at their tips and `depth` high."""
    angle = (np.arange(4 * teeth) + np.tile((0.15, -0.15, 0.0, 0.0), teeth) - 0.5) * np.pi / (2 * teeth)
    reach = np.tile((outer, outer, outer - depth, outer - depth), teeth)
    return sweep(_profile(angle, np.full_like(angle, inner), reach, thick), "gear")


def ring(inner: float, outer: float, thick: float, sides: int = 48) -> rc.Mesh:
    """A ring about the z axis, its corners on both radii."""
    angle = np.arange(sides) * 2 * np.pi / sides
    return sweep(_profile(angle, np.full_like(angle, inner), np.full_like(angle, outer), thick), "ring")


def bracket(width: float = 0.12, height: float = 0.1, wall: float = 0.015, thick: float = 0.06) -> rc.Mesh:
    """A U, open towards +y, its outer corner below at (-width / 2, 0), along z from -thick / 2 to thick / 2."""
    w = width / 2
    outside = np.array([(-w, height), (-w, 0), (w, 0), (w, height)])
    inside = np.array([(-w + wall, height), (-w + wall, wall), (w - wall, wall), (w - wall, height)])
    corners = [(outside, -1), (inside, -1), (inside, 1), (outside, 1)]
    rings = np.stack([np.c_[line, np.full(4, z * thick / 2)] for line, z in corners], axis=1)
    return sweep(rings, "bracket", closed=False)


def pad(reach: float = 0.03, height: float = 0.12, thick: float = 0.06) -> rc.Mesh:
    """A finger's pad, a V: its two edges at x = 0 face +x, the notch between them is `reach` / 2 deep."""
    y = np.array([-height / 2, 0, height / 2])
    front, back = np.array([0, -reach / 2, 0]), np.full(3, -reach)
    corners = [(front, -1), (back, -1), (back, 1), (front, 1)]
    rings = np.stack([np.stack((x, y, np.full(3, z * thick / 2)), axis=-1) for x, z in corners], axis=1)
    return sweep(rings, "pad", closed=False)


def _profile(angle: np.ndarray, inner: np.ndarray, outer: np.ndarray, thick: float) -> np.ndarray:
    corners = [(outer, -1), (inner, -1), (inner, 1), (outer, 1)]
    z = np.ones_like(angle) * thick / 2
    return np.stack([np.stack((r * np.cos(angle), r * np.sin(angle), s * z), axis=-1) for r, s in corners], axis=1)
