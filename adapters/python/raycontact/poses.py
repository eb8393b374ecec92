# SPDX-License-Identifier: Apache-2.0
"""Rigid poses as 4 x 4 matrices: the translation, metres, in the last column."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import as_numbers, as_poses
from ._core import InputError


def pose(translation: ArrayLike = (0, 0, 0), rotation: Optional[ArrayLike] = None) -> NDArray[np.float64]:
    """(..., 4, 4) float64 from translations (..., 3), metres, and rotations (..., 3, 3), which broadcast.

    rotation: taken as it is (`nearest_rigid` mends one that drifted); None turns nothing.
    Raises InputError for other shapes, and where numbers of translations and rotations differ.
    """
    t = as_numbers(translation, "translation")
    turn: Any = rotation
    if hasattr(turn, "as_matrix"):  # of SciPy
        turn = turn.as_matrix()
    r = np.eye(3) if turn is None else as_numbers(turn, "rotation")
    if t.shape[-1:] != (3,):
        raise InputError(f"translation: has shape {t.shape}; give (3,) or (n, 3)")
    if r.shape[-2:] != (3, 3):
        raise InputError(f"rotation: has shape {r.shape}; give (3, 3) or (n, 3, 3)")
    try:
        matrices = np.zeros((*np.broadcast_shapes(t.shape[:-1], r.shape[:-2]), 4, 4))
    except ValueError:
        raise InputError(f"translations {t.shape} and rotations {r.shape} do not fit; give as many, or one") from None
    matrices[..., :3, :3] = r
    matrices[..., :3, 3] = t
    matrices[..., 3, 3] = 1
    return matrices


def pose_from_quaternion(translation: ArrayLike, quaternion: ArrayLike) -> NDArray[np.float64]:
    """(..., 4, 4) float64 from translations (..., 3), metres, and quaternions (..., 4), w x y z, of any length but 0.

    Raises InputError as `pose` does, and for a quaternion that is zero or not finite.
    """
    q = np.asarray(as_numbers(quaternion, "quaternion"), np.float64)
    if q.shape[-1:] != (4,):
        raise InputError(f"quaternion: has shape {q.shape}; give (4,) or (n, 4), w x y z")
    size = np.linalg.norm(q, axis=-1, keepdims=True)
    if not (np.isfinite(size).all() and (size > 0).all()):
        raise InputError("quaternion: one is zero or not finite")
    w, x, y, z = np.moveaxis(q / size, -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return pose(translation, np.stack([np.stack(row, axis=-1) for row in rows], axis=-2))


def nearest_rigid(poses: ArrayLike) -> NDArray[np.float64]:
    """The rigid poses nearest to (..., 4, 4) that are not: drifted, scaled or sheared (polar decomposition).

    Gives float64 of the same shape; translations stay. Raises InputError for one that is not finite, mirrored or flat.
    """
    matrices = as_poses(poses, "poses")
    return _core.nearest_rigid(matrices.reshape(-1, 4, 4)).reshape(matrices.shape)


__all__ = ["nearest_rigid", "pose", "pose_from_quaternion"]
