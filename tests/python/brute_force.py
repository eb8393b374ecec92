# SPDX-License-Identifier: Apache-2.0
"""Answers by trying everything, in NumPy alone. Points (n, 3), triangles (m, 3, 3), all in one frame."""

import numpy as np


def triangles_of(mesh, pose=None):
    """(m, 3, 3) corners of a mesh or shape, placed."""
    pose = np.eye(4) if pose is None else pose
    return (np.asarray(mesh.vertices) @ pose[:3, :3].T + pose[:3, 3])[np.asarray(mesh.triangles)]


def winding(points, triangles):
    """(n,) how often a mesh winds around each point: 1 inside, 0 outside, from solid angles (van Oosterom 1983)."""
    turns = []
    for point in points:
        a, b, c = (triangles - point).transpose(1, 0, 2)
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        dot = lambda x, y: np.sum(x * y, axis=1)  # noqa: E731
        below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
        turns.append(np.sum(np.arctan2(dot(a, np.cross(b, c)), below)) / (2 * np.pi))
    return np.array(turns)


def between_segments(p, q, r, s):
    """Least distances of segments p q and r s, broadcast over all but the last axis (Ericson 2005, section 5.1.9)."""
    u, v, w = q - p, s - r, p - r
    a, e, b = np.sum(u * u, axis=-1), np.sum(v * v, axis=-1), np.sum(u * v, axis=-1)
    c, f = np.sum(u * w, axis=-1), np.sum(v * w, axis=-1)
    e = np.where(e > 0, e, 1)
    below = a * e - b * b
    x = np.clip(np.where(below > 0, (b * f - c * e) / np.where(below > 0, below, 1), 0), 0, 1)
    y = (b * x + f) / e
    x = np.where(y < 0, np.clip(-c / np.where(a > 0, a, 1), 0, 1), x)
    x = np.where(y > 1, np.clip((b - c) / np.where(a > 0, a, 1), 0, 1), x)
    y = np.clip(y, 0, 1)
    return np.linalg.norm(w + x[..., None] * u - y[..., None] * v, axis=-1)


def to_triangles(points, triangles):
    """(n,) distance of each point from a mesh's surface."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    least = []
    for point in points:
        height = np.sum((point - a) * normal, axis=1)
        over = point - height[:, None] * normal
        inside = np.ones(len(a), bool)
        nearest = np.inf
        for start, end in ((a, b), (b, c), (c, a)):
            inside &= np.sum(np.cross(end - start, over - start) * normal, axis=1) >= 0
            nearest = min(nearest, between_segments(point, point, start, end).min())
        least.append(min(nearest, np.abs(height[inside]).min(initial=np.inf)))
    return np.array(least)


def edges_of(triangles):
    """(k, 2, 3), each once for either direction in which it runs alike."""
    ends = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    flipped = np.any(ends[:, 0] != ends[:, 1], axis=1) & _comes_first(ends[:, 1], ends[:, 0])
    ends[flipped] = ends[flipped, ::-1]
    return np.unique(ends.reshape(-1, 6), axis=0).reshape(-1, 2, 3)


def _comes_first(p, q):
    differs = p != q
    first = np.argmax(differs, axis=1)
    rows = np.arange(len(p))
    return p[rows, first] < q[rows, first]


def distance(a, b):
    """Of two meshes' surfaces that do not meet: vertices to triangles, and edges to edges."""
    least = min(to_triangles(np.unique(x.reshape(-1, 3), axis=0), y).min() for x, y in ((a, b), (b, a)))
    edges_b = edges_of(b)
    for p, q in edges_of(a):
        least = min(least, between_segments(p, q, edges_b[:, 0], edges_b[:, 1]).min())
    return least


def meet(a, b):
    """Whether an edge of one mesh goes through a triangle of the other. Touching is not decided."""
    for x, y in ((a, b), (b, a)):
        corner, one, other = y[:, 0], y[:, 1] - y[:, 0], y[:, 2] - y[:, 0]
        for p, q in edges_of(x):
            along = q - p
            h = np.cross(along, other)
            det = np.sum(one * h, axis=1)
            with np.errstate(divide="ignore", invalid="ignore"):
                u = np.sum((p - corner) * h, axis=1) / det
                k = np.cross(p - corner, one)
                v, t = k @ along / det, np.sum(other * k, axis=1) / det
                if np.any((u > 0) & (v > 0) & (u + v < 1) & (t > 0) & (t < 1)):
                    return True
    return False
