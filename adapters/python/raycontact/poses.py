# SPDX-License-Identifier: Apache-2.0
"""Rigid poses as 4 x 4 matrices: the translation, metres, in the last column."""

from __future__ import annotations

from typing import Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import PoseLike, RotationLike, as_numbers, as_points, as_poses, compose
from ._core import InputError


def pose(translation: ArrayLike = (0, 0, 0), rotation: Optional[RotationLike] = None) -> NDArray[np.float64]:
    """(..., 4, 4) float64 from translations (..., 3), metres, and rotations (..., 3, 3), which broadcast.

    rotation: taken as it is (`nearest_rigid` mends one that drifted), or of SciPy; None turns nothing.
    Raises InputError for other shapes, and where numbers of translations and rotations differ.
    """
    return compose(translation, rotation)


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


def turn(axis: ArrayLike, angle: ArrayLike, point: ArrayLike = (0, 0, 0)) -> NDArray[np.float64]:
    """(..., 4, 4) float64 that turn about axes (..., 3) through points (..., 3), metres, by angles (...), radians,
    right-handed; they broadcast. Of a path from one to the next neighbours are less than half a round apart.

    axis: of any length but 0. Raises InputError for one that is zero, and for numbers that are not finite.
    """
    half = _finite(angle, "angle")[..., np.newaxis] / 2
    sine = np.sin(half) * _unit(axis, "axis")
    cosine = np.broadcast_to(np.cos(half), (*sine.shape[:-1], 1))
    rotation = pose_from_quaternion((0, 0, 0), np.concatenate((cosine, sine), axis=-1))[..., :3, :3]
    at = _finite(as_points(point, "point"), "point")
    return pose(at - (rotation @ at[..., np.newaxis])[..., 0], rotation)


def slide(way: ArrayLike, length: ArrayLike) -> NDArray[np.float64]:
    """(..., 4, 4) float64 that move along ways (..., 3), of any length but 0, by lengths (...), metres; they broadcast.

    Raises InputError for a way that is zero, and for numbers that are not finite.
    """
    return pose(_finite(length, "length")[..., np.newaxis] * _unit(way, "way"))


def _finite(value: ArrayLike, what: str) -> NDArray[np.float64]:
    array = np.asarray(as_numbers(value, what), np.float64)
    if not np.isfinite(array).all():
        raise InputError(f"{what}: one is not finite")
    return array


def _unit(value: ArrayLike, what: str) -> NDArray[np.float64]:
    vectors = _finite(as_points(value, what), what)
    largest = np.abs(vectors).max(axis=-1, keepdims=True)
    if not (largest > 0).all():
        raise InputError(f"{what}: one is zero")
    vectors = vectors / largest  # else squares overflow, or vanish
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def nearest_rigid(poses: PoseLike) -> NDArray[np.float64]:
    """The rigid poses nearest to (..., 4, 4) that are not: drifted, scaled or sheared (polar decomposition).

    Gives float64 of the same shape; translations stay. Raises InputError for one that is not finite, mirrored or flat.
    """
    matrices = as_poses(poses, "poses")
    return _core.nearest_rigid(matrices.reshape(-1, 4, 4)).reshape(matrices.shape)


__all__ = ["nearest_rigid", "pose", "pose_from_quaternion", "slide", "turn"]
