# SPDX-License-Identifier: Apache-2.0
"""What several tests make or compare."""

import meshes
import numpy as np
import raycontact as rc

RNG = np.random.default_rng(47)


def random_poses(n, spread):
    return rc.pose(RNG.uniform(-spread, spread, (n, 3)), meshes.random_rotations(n, RNG))


def same(a, b):
    """Bit by bit, but for the bytes between the fields."""
    return len(a) == len(b) and all(np.array_equal(x, y) for x, y in zip(a.columns().values(), b.columns().values()))


def placed(points, pose):
    return points @ pose[:3, :3].T + pose[:3, 3]


def ring_scene(torus, **settings):
    scene = rc.Scene(**settings)
    ids = scene.add(torus, rc.pose(np.c_[np.arange(8) * 2.5, np.zeros(8), np.zeros(8)]))
    return scene, ids
