# SPDX-License-Identifier: Apache-2.0
"""Arrays in the memory of CUDA devices, by __cuda_array_interface__ (torch, CuPy, Numba, Warp, JAX)."""

from __future__ import annotations

from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import InputError
from .contacts import CONTACT_DTYPE

_EVERY_STREAM = 2**64 - 1


class _Stretch(NamedTuple):
    """Contiguous memory. stream: 0 is CUDA's default; of the host's memory it means nothing."""

    is_cuda: bool
    address: int
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    stream: int
    read_only: bool

    @property
    def bytes(self) -> int:
        return int(np.prod(self.shape, dtype=np.int64)) * self.dtype.itemsize


def is_on_cuda(value: Any) -> bool:
    if isinstance(value, (np.ndarray, list, tuple, int, float)):
        return False
    try:
        return value.__cuda_array_interface__ is not None
    except AttributeError:  # of a tensor in the host's memory, too
        return False
    except Exception:  # a tensor that wants its gradient, say: to_host() tells
        return True


def _on_cuda(value: Any, what: str) -> _Stretch:
    try:
        told = value.__cuda_array_interface__
    except Exception as error:  # a tensor that wants its gradient, say
        raise InputError(f"{what}: {error}") from None
    dtype, shape = np.dtype(told["typestr"]), tuple(told["shape"])
    strides = told.get("strides")
    if strides is not None and tuple(strides) != _contiguous(shape, dtype.itemsize):
        raise InputError(f"{what}: is not contiguous; give a contiguous copy")
    address, read_only = told["data"]
    # What names no stream (torch, Warp) may be of any; None says that nothing need be waited for.
    stream = int(told["stream"] or 0) if "stream" in told else _EVERY_STREAM
    return _Stretch(True, int(address), shape, dtype, stream, bool(read_only))


def _contiguous(shape: tuple[int, ...], size: int) -> tuple[int, ...]:
    strides = []
    for length in reversed(shape):
        strides.append(size)
        size *= length
    return tuple(reversed(strides))


def to_host(value: Any, what: str) -> NDArray[Any]:
    """A copy, made when what its stream was given before is done."""
    memory = _on_cuda(value, what)
    array = np.empty(memory.shape, memory.dtype)
    if array.size > 0:
        _core.copy_from_cuda(memory.address, memory.stream, array.ctypes.data, memory.bytes)
    return array


def _columns() -> dict[str, tuple[np.dtype[Any], tuple[int, ...]]]:
    """Of each column that C++ writes: type, numbers of a contact."""
    fields = [(name, CONTACT_DTYPE[name]) for name in CONTACT_DTYPE.names or ()]
    return {name: (field.base, field.shape) for name, field in fields} | {
        "slots": (np.dtype("u4"), (2,)),
        "key": (np.dtype("u8"), ()),
    }


_COLUMNS = _columns()


def _holds(given: np.dtype[Any], wanted: np.dtype[Any]) -> bool:
    """Whole numbers and answers by their size: not every library has unsigned ones. Points in float32, too."""
    if wanted.kind == "f":
        return given == wanted or (wanted == np.float64 and given == np.float32)
    return given.kind in "iub" and given.itemsize == wanted.itemsize and given.isnative


def as_column(name: str, value: Any) -> tuple[str, bool, int, int, int, bool]:
    """What the C++ half takes: name, on CUDA, address, bytes, stream, in float32."""
    if name not in _COLUMNS:
        raise InputError(f"contacts have no column {name!r}; choose from {', '.join(_COLUMNS)}")
    wanted, tail = _COLUMNS[name]
    memory: Optional[_Stretch] = None
    if is_on_cuda(value):
        memory = _on_cuda(value, name)
    elif isinstance(value, np.ndarray):
        if not value.flags.c_contiguous:
            raise InputError(f"{name}: is not contiguous; give a contiguous array")
        memory = _Stretch(False, value.ctypes.data, value.shape, value.dtype, 0, not value.flags.writeable)
    if memory is None:
        raise InputError(f"{name}: is no NumPy array, and has no __cuda_array_interface__")
    if not _holds(memory.dtype, wanted):
        raise InputError(f"{name}: holds {memory.dtype.name}; give {wanted.name}")
    if len(memory.shape) != 1 + len(tail) or memory.shape[1:] != tail:
        raise InputError(
            f"{name}: has shape {memory.shape}; give (rows{''.join(f', {n}' for n in tail)}{'' if tail else ','})"
        )
    if memory.read_only:
        raise InputError(f"{name}: is read-only")
    single = wanted == np.float64 and memory.dtype == np.float32
    return name, memory.is_cuda, memory.address, memory.bytes, memory.stream, single
