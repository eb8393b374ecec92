# SPDX-License-Identifier: Apache-2.0
"""Meshes to test with: closed, concave where the name does not say otherwise."""

import numpy as np


def box(size=(1.0, 1.0, 1.0)):
    """Vertices and triangles of a box around the origin; convex."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    faces = [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]  # fmt: skip
    return signs * np.array(size) / 2, np.array(faces)


def torus(radius=1.0, tube=0.35, around=24, across=12):
    """Vertices and triangles of a torus about the z axis."""
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(across) * 2 * np.pi / across, indexing="ij")
    ring = radius + tube * np.cos(v)
    vertices = np.stack([ring * np.cos(u), ring * np.sin(u), tube * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    return vertices, np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])


def bracket():
    """Vertices and triangles of an L-shaped prism, 2 x 2 x 1 with arms 1 wide."""
    outline = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], float)
    caps = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    low = np.c_[outline, np.zeros(6)]
    sides = [t for i in range(6) for j in [(i + 1) % 6] for t in ([i, j, j + 6], [i, j + 6, i + 6])]
    faces = [c[::-1] for c in caps] + [[i + 6 for i in c] for c in caps] + sides
    return np.r_[low, low + (0, 0, 1)], np.array(faces)


def random_rotations(n, rng):
    """(n, 3, 3), uniform."""
    q, r = np.linalg.qr(rng.normal(size=(n, 3, 3)))
    q *= np.sign(np.einsum("nii->ni", r))[:, None, :]
    q[:, :, 0] *= np.linalg.det(q)[:, None]
    return q


def ascii_stl(vertices, faces):
    """The bytes of a file."""
    lines = ["solid test"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(repr(float(x)) for x in vertices[i]) for i in face]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid test", ""]).encode()
