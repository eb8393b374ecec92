# SPDX-License-Identifier: Apache-2.0
"""What users give, as the arrays that the C++ half takes; what is wrong with it, in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Optional, Protocol, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import InputError
from ._memory import is_on_cuda, to_host

_Answer = TypeVar("_Answer")


class HasMatrix(Protocol):
    """A transform or rotation of another library, as far as it is looked at; those of SciPy are."""

    def as_matrix(self) -> Any:
        """(..., 4, 4) of a transform, (..., 3, 3) of a rotation."""


RotationLike = Union[ArrayLike, HasMatrix]
"""Matrices (..., 3, 3), or SciPy's Rotation."""

PoseLike = Union[ArrayLike, HasMatrix, tuple[RotationLike, ArrayLike]]
"""Matrices (..., 4, 4), (R, t) or an object with `as_matrix`."""

OnePoint = Union[Sequence[float], np.ndarray[tuple[int], np.dtype[Any]]]
"""(3,), as far as types tell."""

ManyPoints = np.ndarray[tuple[int, int], np.dtype[Any]]
"""Arrays of more dimensions, or of as many as types do not tell: of all arrays but those that are a OnePoint."""

ScaleLike = Union[float, Sequence[float], NDArray[Any]]
"""A factor, or those of x, y and z."""


def as_numbers(value: Any, what: str, kinds: str = "fiu") -> NDArray[Any]:
    """A NumPy array of anything that is one: lists, arrays, tensors of other libraries, of CUDA devices, too."""
    if is_on_cuda(value):
        value = to_host(value, what)
    try:
        if not hasattr(value, "__array__") and hasattr(value, "__dlpack__"):
            array = np.from_dlpack(value)
        else:
            array = np.asarray(value)
    except (TypeError, ValueError, RuntimeError, BufferError) as error:
        raise InputError(f"{what}: is no array: {error}") from None
    if array.size == 0 and array.dtype.kind == "f":
        return array  # of an empty list NumPy makes floats
    if array.dtype.kind not in kinds:
        wanted = "whole numbers" if "f" not in kinds else "numbers"
        raise InputError(f"{what}: holds {array.dtype.name}, not {wanted}")
    return array


def as_points(value: Any, what: str) -> NDArray[np.float64]:
    """(..., 3) float64."""
    array = as_numbers(value, what)
    if array.ndim > 0 and array.shape[-1] == 3:
        return np.ascontiguousarray(array, np.float64)
    if array.size == 0 and array.ndim == 1:
        return np.empty((0, 3))
    raise InputError(f"{what}: has shape {array.shape}; give (3,) or (..., 3)")


def as_poses(value: Any, what: str, rigid: bool = False) -> NDArray[np.float64]:
    """(..., 4, 4) float64, of what PoseLike has. None is the identity.

    rigid: looks for that here, where the C++ half would name a pose otherwise than the user."""
    if value is None:
        return np.eye(4)
    if hasattr(value, "as_matrix"):
        value = value.as_matrix()
    elif isinstance(value, tuple) and len(value) == 2 and _is_rotation(value[0]):
        value = compose(value[1], value[0], f"{what}: ")
    try:
        array = as_numbers(value, what)
    except InputError as error:
        raise InputError(f"{error}; give (4, 4) or (..., 4, 4), or the tuple (R, t)") from None
    if array.ndim < 2 or array.shape[-2:] != (4, 4):
        if array.size == 0 and array.ndim == 1:
            return np.empty((0, 4, 4))
        if array.shape[-2:] == (3, 3):
            raise InputError(f"{what}: has shape {array.shape}, a rotation alone; give (R, t) with the translation")
        raise InputError(f"{what}: has shape {array.shape}; give (4, 4) or (..., 4, 4), or (R, t)")
    poses = np.ascontiguousarray(array, np.float64)
    if rigid and _core.are_rigid(poses.reshape(-1, 4, 4)):
        return poses
    _refuse(~np.isfinite(poses).all(axis=(-2, -1)), what, "an entry is not a finite number")
    last_row = (np.abs(poses[..., 3, :] - (0, 0, 0, 1)) <= 1e-4).all(axis=-1)
    _refuse(~last_row, what, "the last row is not 0 0 0 1; matrices have the translation in the last column")
    if rigid:
        turn = poses[..., :3, :3]
        shear = np.abs(np.swapaxes(turn, -2, -1) @ turn - np.eye(3)).max(axis=(-2, -1), initial=0.0)
        bent = (shear > 1e-4) | (np.linalg.det(turn) <= 0)
        _refuse(bent, what, "not rigid to 1e-4 (sheared, scaled or mirrored); nearest_rigid mends what drifted")
    return poses


def _is_rotation(value: Any) -> bool:
    if hasattr(value, "as_matrix"):
        return True
    try:
        return np.shape(value)[-2:] == (3, 3)
    except ValueError:  # rows of several lengths
        return False


def compose(translation: Any, rotation: Any, what: str = "") -> NDArray[np.float64]:
    """(..., 4, 4) of (..., 3) and (..., 3, 3), which broadcast. what: begins messages."""
    t = as_numbers(translation, f"{what}translation")
    if hasattr(rotation, "as_matrix"):  # of SciPy
        rotation = rotation.as_matrix()
    r = np.eye(3) if rotation is None else as_numbers(rotation, f"{what}rotation")
    if t.shape[-1:] != (3,):
        raise InputError(f"{what}translation: has shape {t.shape}; give (3,) or (..., 3)")
    if r.shape[-2:] != (3, 3):
        raise InputError(f"{what}rotation: has shape {r.shape}; give (3, 3) or (..., 3, 3)")
    try:
        matrices = np.zeros((*np.broadcast_shapes(t.shape[:-1], r.shape[:-2]), 4, 4))
    except ValueError:
        raise InputError(
            f"{what}translations {t.shape} and rotations {r.shape} do not fit; give as many, or one"
        ) from None
    matrices[..., :3, :3] = r
    matrices[..., :3, 3] = t
    matrices[..., 3, 3] = 1
    return matrices


def as_pose(value: Any, what: str, rigid: bool = False) -> NDArray[np.float64]:
    """(4, 4) float64."""
    pose = as_poses(value, what, rigid)
    if pose.ndim != 2:
        raise InputError(f"{what}: has shape {pose.shape}; give one, (4, 4)")
    return pose


def _refuse(wrong: Any, what: str, why: str) -> None:
    if wrong.any():
        place = ", ".join(str(i) for i in np.argwhere(wrong)[0])
        raise InputError(f"{what}{f'[{place}]' if place else ''}: {why}")


class Batch:
    """Arguments that belong together, by names: of each the dimensions before those of a single item. They fit as
    NumPy's broadcasting says. The C++ half takes flat lists, of one item or of all."""

    def __init__(self, **leads: tuple[int, ...]) -> None:
        try:
            self.shape = np.broadcast_shapes(*leads.values())
        except ValueError:
            given = ", ".join(f"{name} {lead}" for name, lead in leads.items() if lead)
            raise InputError(f"{given} do not fit together; give as many, or one") from None

    def flat(self, items: NDArray[Any], lead: tuple[int, ...]) -> NDArray[Any]:
        """(1, ...) or (n, ...), contiguous."""
        tail, count = items.shape[len(lead) :], math.prod(lead)
        if count != 1:
            items, count = np.broadcast_to(items, self.shape + tail), math.prod(self.shape)
        return np.ascontiguousarray(items).reshape(count, *tail)

    def listed(self, items: list[Any], lead: tuple[int, ...]) -> list[Any]:
        """`flat` of a list."""
        return [items[i] for i in self.flat(np.arange(len(items)).reshape(lead), lead)]

    def answers(self, columns: tuple[NDArray[Any], ...]) -> tuple[Any, ...]:
        """Of a single item what the columns hold, else arrays of the batch's shape."""
        if self.shape == ():
            return tuple(column[0] if column.ndim > 1 else column[0].item() for column in columns)
        return tuple(column.reshape(self.shape + column.shape[1:]) for column in columns)

    def answer(
        self, one: Callable[..., _Answer], many: Callable[..., _Answer], columns: tuple[NDArray[Any], ...]
    ) -> _Answer:
        """`answers` as `one` of a single item, else as `many`."""
        return (one if self.shape == () else many)(*self.answers(columns))


def as_id_array(value: Any, what: str) -> NDArray[np.int64]:
    """(...,) int64."""
    return np.asarray(as_numbers(value, what, "iu"), np.int64)


def as_ids(value: Any, what: str) -> tuple[NDArray[np.int64], bool]:
    """(n,) int64, and whether a single id was given."""
    array = as_numbers(value, what, "iu")
    if array.ndim > 1:
        raise InputError(f"{what}: has shape {array.shape}; give one id or (n,)")
    return np.ascontiguousarray(array.reshape(-1), np.int64), array.ndim == 0


def as_id(value: Any, what: str) -> int:
    """One id."""
    numbers, _ = as_ids(value, what)
    if len(numbers) != 1:
        raise InputError(f"{what}: {len(numbers)} given; give one")
    return int(numbers[0])


def as_pairs(value: Any, what: str) -> NDArray[np.int64]:
    """(n, 2) int64."""
    array = as_numbers(value, what, "iu")
    if array.size == 0:
        return np.empty((0, 2), np.int64)
    if array.ndim != 2 or array.shape[1] != 2:
        raise InputError(f"{what}: has shape {array.shape}; give (n, 2)")
    return np.ascontiguousarray(array, np.int64)


def as_length(value: Any, what: str) -> float:
    """A number of metres."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"{what}: {value!r} is no number") from None


def as_scale(value: Any) -> float:
    """What coordinates are multiplied by."""
    scale = as_length(value, "scale")
    if not 0 < scale < np.inf:
        raise InputError(f"scale: {value!r} is not finite and above 0; 0.001 makes metres of millimetres")
    return scale


def as_factors(value: Any) -> Optional[NDArray[np.float64]]:
    """(3,) float64: what x, y and z are multiplied by; None: they stay."""
    try:
        factors = np.array([float(x) for x in value] if np.ndim(value) == 1 else [float(value)])
    except (TypeError, ValueError):
        raise InputError(f"scale: {value!r} is neither a number nor three") from None
    if len(factors) not in (1, 3):
        raise InputError(f"scale: {value!r} has {len(factors)} factors; give one, or three for x, y and z")
    if not (np.isfinite(factors).all() and factors.all()):
        raise InputError(
            f"scale: {value!r} has a factor that is 0 or not finite; 0.001 makes metres of millimetres, -1 mirrors"
        )
    return None if (factors == 1).all() else np.broadcast_to(factors, 3)


def as_count(value: Any, what: str) -> int:
    """A whole number that 32 bits hold."""
    try:
        count = value.__index__()
    except AttributeError:
        raise InputError(f"{what}: {value!r} is no whole number") from None
    if not 0 <= count < 2**32:
        raise InputError(f"{what}: {count} is not in 0 to {2**32 - 1}")
    return count
