# SPDX-License-Identifier: Apache-2.0
"""What contacts can do to a body that they hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import as_count, as_length, as_points
from ._core import InputError


def wrench_cone(
    points: ArrayLike,
    normals: ArrayLike,
    friction: float = 0.5,
    *,
    edges: int = 8,
    origin: ArrayLike = (0.0, 0.0, 0.0),
    length: float = 1.0,
) -> NDArray[np.float64]:
    """The wrenches along the edges of each contact's friction cone, for a push of 1 N along the normal.

    points, normals: (3,) or (..., 3), world frame, metres: where each contact pushes, and which way it pushes the body.
        Of `collide(finger, body)` these are `point_b` and `normal`, as normals point from a to b.
    friction: Coulomb's coefficient; the cone has so many `edges`, at least 3.
    origin: (3,), metres: torques are about it, as about the centre of mass. length: metres, that torques are divided
        by, as by the body's radius, so that forces and torques compare.
    Gives (..., edges, 6) float64: force (N), then torque / length (N). What contacts hold is the sum of such wrenches
    with weights of at least 0; by the largest ball about 0 in their convex hull grasps are ranked (Ferrari and Canny
    1992).
    Raises InputError for a normal that is zero or not finite, a friction that is negative, fewer than 3 edges and a
    length that is not above 0.
    """
    at, given, about = as_points(points, "points"), as_points(normals, "normals"), as_points(origin, "origin")
    sizes = np.linalg.norm(given, axis=-1, keepdims=True)
    if not (np.isfinite(sizes) & (sizes > 0)).all():
        raise InputError("normals: one is zero or not finite")
    share, count, unit = as_length(friction, "friction"), as_count(edges, "edges"), as_length(length, "length")
    if not 0 <= share < np.inf:
        raise InputError(f"friction: {share} is not a finite number of at least 0")
    if count < 3:
        raise InputError(f"edges: {count}; a cone has at least 3")
    if not 0 < unit < np.inf:
        raise InputError(f"length: {unit} is not a finite number of metres above 0")
    try:
        at, normal = np.broadcast_arrays(at, given / sizes)
    except ValueError:
        raise InputError(f"points {at.shape} and normals {given.shape} do not fit; give as many, or one") from None
    # The axis that is least along the normal gives a tangent that is never short.
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=-1)]
    first = np.cross(normal, axis)
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    second = np.cross(normal, first)
    angle = np.arange(count)[:, np.newaxis] * (2 * np.pi / count)
    around = np.cos(angle) * first[..., np.newaxis, :] + np.sin(angle) * second[..., np.newaxis, :]
    force = normal[..., np.newaxis, :] + share * around
    torque = np.cross((at - about)[..., np.newaxis, :], force) / unit
    return np.concatenate((force, torque), axis=-1)
