# SPDX-License-Identifier: Apache-2.0
"""What a step or a query found: arrays without copies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import IntEnum
from typing import Any, SupportsIndex, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

from . import _core

_Self = TypeVar("_Self", bound="Contacts")
_Index = Union[SupportsIndex, slice, Sequence[int], NDArray[np.bool_], NDArray[np.integer[Any]]]


def _type_of_contacts() -> np.dtype[np.void]:
    fields = _core.contact_layout()
    return np.dtype(
        {
            "names": [name for name, _, _, _ in fields],
            "formats": [(kind, (length,)) if length else kind for _, kind, length, _ in fields],
            "offsets": [offset for _, _, _, offset in fields],
            "itemsize": _core.contact_size,
        }
    )


CONTACT_DTYPE = _type_of_contacts()
"""A contact as the library holds it: the columns of Contacts by name, but for `key` and `slots`."""

_RECORDS = np.dtype((np.record, CONTACT_DTYPE))


class FeatureKind(IntEnum):
    """What is in contact.

    VERTEX: a vertex inside the other mesh; its ray met the closest face from inside (Hermann et al. 2008).
    EDGES: an edge of either body; they pass each other where the surfaces cross.
    INSIDE: the whole body lies inside the other mesh; its deepest vertex stands for it.
    VERTEX_FACE: a vertex and a face that it is near or comes to, beside another contact of that vertex.
    FACES: a face of either body, of direction "weighted"; what the bodies share between them.
    ROUND: a ball or capsule and the other body, in closed form.
    """

    VERTEX = 0
    EDGES = 1
    INSIDE = 2
    VERTEX_FACE = 3
    FACES = 4
    ROUND = 5


class Contacts:
    """Contacts in columns, each an array over all contacts. n is their number, `len(contacts)`.

    Columns show the memory that the library wrote, without a copy, and keep it: they stay valid and unchanged when the
    scene steps on or is gone. They are arrays with strides; what needs contiguous memory copies
    (`np.ascontiguousarray`). They are read-only, which not all that take arrays by DLPack know: give them a `.copy()`
    (`torch.from_dlpack(contacts.depth.copy())`).

    `contacts[mask]` and `contacts[i:j]` choose some; iterating gives a record of CONTACT_DTYPE for each contact,
    without a copy: `for c in contacts: c.depth`, or `c["depth"]`.

    data: all of it as one structured array, (n,) of CONTACT_DTYPE.
    """

    __slots__ = ("data",)

    data: NDArray[np.void]

    def __init__(self, data: NDArray[np.void]) -> None:
        self.data = data

    @classmethod
    def _from_bytes(cls: type[_Self], memory: NDArray[np.uint8]) -> _Self:
        memory.flags.writeable = False  # the scene and its recorder look at the same memory
        return cls(memory.view(CONTACT_DTYPE))

    @property
    def bodies(self) -> NDArray[np.int64]:
        """(n, 2) int64: ids of bodies a and b; a has the lower slot."""
        return self.data["bodies"]

    @property
    def slots(self) -> NDArray[np.uint32]:
        """(n, 2) uint32: the places of bodies a and b in the scene; indices into arrays of your own."""
        return self.data["bodies"].view(np.uint32)[..., ::2]

    @property
    def kind(self) -> NDArray[np.uint8]:
        """(n,) uint8: FeatureKind."""
        return self.data["kind"]

    @property
    def source(self) -> NDArray[np.uint8]:
        """(n,) uint8: whose vertex it is, or who is round: 0 is a and 1 is b; of edges, faces and two rounds 0."""
        return self.data["source"]

    @property
    def indices(self) -> NDArray[np.uint32]:
        """(n, 2) uint32: the feature on a and on b. Of the source a vertex of the mesh, of the other body the triangle
        that was hit; of edges an edge of either: 3 x its lowest triangle + its first corner there; of faces a triangle
        of either. Of a round source the place on it (ContactFeature in contact.h), of the other body the triangle, or
        2^32 - 1 if it is round, too."""
        return self.data["indices"]

    @property
    def is_new(self) -> NDArray[np.bool_]:
        """(n,) bool: the last step had no such contact that touched."""
        return self.data["is_new"]

    @property
    def point_a(self) -> NDArray[np.float64]:
        """(n, 3) float64, metres, world frame: the witness point of a."""
        return self.data["point_a"]

    @property
    def point_b(self) -> NDArray[np.float64]:
        """(n, 3) float64, metres, world frame: that of b. point_a - point_b = depth x normal."""
        return self.data["point_b"]

    @property
    def normal(self) -> NDArray[np.float32]:
        """(n, 3) float32, unit, world frame, from a to b."""
        return self.data["normal"]

    @property
    def depth(self) -> NDArray[np.float32]:
        """(n,) float32, metres along the normal (Lehericey et al. 2013, section 3.2). At most 0: a speculative contact,
        minus the gap."""
        return self.data["depth"]

    @property
    def ray_length(self) -> NDArray[np.float32]:
        """(n,) float32, metres from the point to the hit."""
        return self.data["ray_length"]

    @property
    def weight(self) -> NDArray[np.float32]:
        """(n,) float32: with direction "weighted" an area, m^2: what faces share, or of a surface; else 1."""
        return self.data["weight"]

    @property
    def key(self) -> NDArray[np.uint64]:
        """(n,) uint64, a copy: names the same contact from step to step, unique in its pair."""
        data = self.data
        one, other = (data["indices"][:, i].astype(np.uint64) for i in (0, 1))
        source = data["source"].astype(np.uint64)
        own = np.where(source == 0, one, other)
        vertex = source << np.uint64(62) | own
        edges = np.uint64(2 << 62) | one << np.uint64(31) | other
        inside = np.uint64(3 << 62) | source << np.uint64(32) | own
        vertex_face = (
            np.uint64(7 << 61) | source << np.uint64(60) | own << np.uint64(30) | np.where(source == 0, other, one)
        )
        faces = np.uint64(13 << 60) | one << np.uint64(30) | other
        if not len(data):
            return np.empty(0, np.uint64)
        return np.choose(data["kind"], (vertex, edges, inside, vertex_face, faces))

    @property
    def touching(self: _Self) -> _Self:
        """Those that touch: without speculative contacts."""
        return self[self.depth > 0]

    def deepest(self: _Self) -> _Self:
        """The deepest of each pair of bodies, pairs in order."""
        if not len(self):
            return self
        slots = self.slots
        order = np.lexsort((-self.depth, slots[:, 1], slots[:, 0]))
        begins = np.r_[True, (slots[order[1:]] != slots[order[:-1]]).any(axis=1)]
        return self[order[begins]]

    def columns(self) -> dict[str, NDArray[Any]]:
        """All columns by name, as views; `key` is a copy."""
        return {**{name: self.data[name] for name in CONTACT_DTYPE.names or ()}, "key": self.key}

    def __len__(self) -> int:
        return len(self.data)

    def __getitem__(self: _Self, which: _Index) -> _Self:
        if isinstance(which, str):
            raise TypeError(f"contacts[{which!r}]: columns are attributes: contacts.{which}")
        chosen = self.data[which]
        return type(self)(chosen if chosen.ndim else chosen.reshape(1))

    def __iter__(self) -> Iterator[np.record]:
        return iter(self.data.view(_RECORDS))

    def __repr__(self) -> str:
        depth = f", deepest {self.depth.max():.6g} m" if len(self) else ""
        return f"<{type(self).__name__}: {len(self)} of {len(np.unique(self.bodies, axis=0))} pairs{depth}>"


class PairContacts(Contacts):
    """Contacts of `collide`, whose bodies are those of its pairs: a of pair i is body 2 i, b is body 2 i + 1."""

    __slots__ = ()

    @property
    def pair(self) -> NDArray[np.int64]:
        """(n,) int64, ascending: the pair of each contact."""
        return self.data["bodies"][:, 0] // 2


__all__ = ["CONTACT_DTYPE", "Contacts", "FeatureKind", "PairContacts"]
