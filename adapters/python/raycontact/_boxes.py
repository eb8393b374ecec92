# SPDX-License-Identifier: Apache-2.0
"""Boxes of many bodies, and which of them are near each other: sort and sweep."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

_MOST_PAIRS = 1 << 20
"""Of a chunk: what is looked at takes some 200 bytes a pair."""


class Boxes(NamedTuple):
    """Axis-aligned, world frame, metres. No body reaches out of its own."""

    low: NDArray[np.float64]
    """(n, 3)."""
    high: NDArray[np.float64]
    """(n, 3)."""


class Pairs(NamedTuple):
    """Pairs of boxes: places in two lists, or in one."""

    a: NDArray[np.int64]
    """(n,)."""
    b: NDArray[np.int64]
    """(n,); of one list above `a`."""
    gap: NDArray[np.float64]
    """(n,), metres between the two boxes: no more than between the bodies."""


def boxes_of(local: NDArray[np.float64], poses: NDArray[np.float64]) -> Boxes:
    """Of bodies whose own boxes (n, 2, 3) are placed by poses (n, 4, 4)."""
    middle, half = (local[:, 0] + local[:, 1]) / 2, (local[:, 1] - local[:, 0]) / 2
    rotation, translation = poses[:, :3, :3], poses[:, :3, 3]
    centre = np.einsum("nij,nj->ni", rotation, middle) + translation
    size = np.einsum("nij,nj->ni", np.abs(rotation), half)
    # What was rounded must not make a box too small: whether bodies meet is decided exactly, by the last bit.
    reach = np.einsum("nij,nj->ni", np.abs(rotation), np.abs(middle) + half) + np.abs(translation)
    size += 16 * np.finfo(float).eps * reach
    return Boxes(*(np.asfortranarray(ends) for ends in (centre - size, centre + size)))  # axes are looked at one by one


def pairs_within(gap: float, a: Boxes, b: Optional[Boxes] = None) -> Iterator[Pairs]:
    """All pairs of boxes of a and b that are at most `gap` metres apart, each once, in chunks; without b those of a.

    Memory is that of a chunk, however many pairs there are.
    """
    both = a if b is None else Boxes(*(np.concatenate(ends) for ends in zip(a, b)))
    if not (len(a.low) and len(both.low)):
        return
    axis = _longest_axis(both)
    if b is None:
        order = np.argsort(a.low[:, axis], kind="stable")
        begin, end = a.low[order, axis], a.high[order, axis]
        first = np.arange(1, len(order) + 1)
        for row, place in _ranges(first, np.searchsorted(begin, end + gap, "right")):
            one, other = order[row], order[place]
            yield _near(gap, a, a, np.minimum(one, other), np.maximum(one, other), axis)
        return
    # Of two boxes that are near, one begins in the other (widened), so each pair comes up in one of two sweeps.
    sweeps: tuple[tuple[Boxes, Boxes, Literal["left", "right"]], ...] = ((a, b, "left"), (b, a, "right"))
    for here, there, side in sweeps:
        order = np.argsort(there.low[:, axis], kind="stable")
        begin = there.low[order, axis]
        first = np.searchsorted(begin, here.low[:, axis], side)
        for row, place in _ranges(first, np.searchsorted(begin, here.high[:, axis] + gap, "right")):
            i, j = (row, order[place]) if here is a else (order[place], row)
            yield _near(gap, a, b, i, j, axis)


def some_near_pairs(a: Boxes, b: Optional[Boxes] = None, wanted: int = 16) -> Pairs:
    """A few pairs that are near each other, for a first bound: of each box its neighbours along one axis are tried."""
    other = a if b is None else b
    both = a if b is None else Boxes(*(np.concatenate(ends) for ends in zip(a, b)))
    if not (len(a.low) and len(other.low)):
        return Pairs(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))
    axis = _longest_axis(both)
    order = np.argsort(other.low[:, axis], kind="stable")
    place = np.searchsorted(other.low[order, axis], a.low[:, axis])
    places = np.clip(place[:, None] + np.arange(-4, 5), 0, len(order) - 1)
    one, two = np.repeat(np.arange(len(a.low)), places.shape[1]), order[places.ravel()]
    if b is None:
        one, two = np.minimum(one, two), np.maximum(one, two)
        one, two = one[one < two], two[one < two]
    pairs = _near(np.inf, a, other, one, two, axis)
    nearest = np.argsort(pairs.gap, kind="stable")[:wanted]
    return Pairs(pairs.a[nearest], pairs.b[nearest], pairs.gap[nearest])


def _longest_axis(boxes: Boxes) -> int:
    """Along which boxes are spread the most, measured in boxes: a sweep along it meets the fewest."""
    span = boxes.high.max(axis=0) - boxes.low.min(axis=0)
    size = (boxes.high - boxes.low).mean(axis=0)
    return int(np.argmax(span / np.maximum(size, np.finfo(float).tiny)))


def _ranges(first: NDArray[np.int64], last: NDArray[np.int64]) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Each row with each place from its first up to its last, in chunks of whole rows."""
    counts = np.maximum(last - first, 0)
    ends = np.cumsum(counts)
    row = 0
    while row < len(counts):
        done = ends[row] - counts[row]
        stop = max(row + 1, int(np.searchsorted(ends, done + _MOST_PAIRS, "right")))
        chunk = counts[row:stop]
        offsets = np.repeat(first[row:stop] - (ends[row:stop] - chunk - done), chunk)
        if len(offsets):
            yield np.repeat(np.arange(row, stop), chunk), np.arange(len(offsets)) + offsets
        row = stop


def _near(gap: float, a: Boxes, b: Boxes, i: NDArray[np.int64], j: NDArray[np.int64], swept: int) -> Pairs:
    # One axis after the other, as most pairs drop out at the first; that of the sweep tells little more.
    for axis in ((swept + 1) % 3, (swept + 2) % 3, swept):
        near = _apart(a, b, i, j, axis) <= gap
        i, j = i[near], j[near]
    between = np.sqrt(sum(np.maximum(_apart(a, b, i, j, axis), 0) ** 2 for axis in range(3)))
    near = between <= gap
    return Pairs(i[near], j[near], between[near])


def _apart(a: Boxes, b: Boxes, i: NDArray[np.int64], j: NDArray[np.int64], axis: int) -> NDArray[np.float64]:
    return np.maximum(b.low[:, axis][j] - a.high[:, axis][i], a.low[:, axis][i] - b.high[:, axis][j])
