# SPDX-License-Identifier: Apache-2.0
"""Recordings of scenes: writing them, and reading them to the bit."""

from __future__ import annotations

import os
from typing import Any, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import as_length
from .scene import Scene
from .shape import Shape


class Recorder:
    """Records what a scene does, from its next step on: `raycontact replay` finds its contacts again, `raycontact view`
    and `raycontact.show` show it, and any glTF viewer plays it.

    Call `record` after each `find_contacts`; use it in a `with` statement, which ends with `finish`.

    file: its name should end in .glb; what was there is lost. name, mesh_source: what the recording says of itself.
    dt: seconds between two steps.
    Raises InputError when the file cannot be made and for dt <= 0; `record` raises RuntimeError when it cannot be
    written.
    """

    def __init__(
        self,
        file: Union[str, os.PathLike[str]],
        scene: Scene,
        *,
        dt: float = 1.0 / 60,
        name: str = "recording",
        mesh_source: str = "",
    ) -> None:
        self._core = _core.Recorder(os.fspath(file), scene._core, name, as_length(dt, "dt"), mesh_source)
        self._finished = False

    def record(self) -> None:
        """Adds the scene's last step. Raises RuntimeError when the file cannot be written."""
        self._core.record()

    def finish(self) -> None:
        """Adds the contacts' hash and the animation for viewers. Nothing can be recorded afterwards."""
        self._core.finish()
        self._finished = True

    @property
    def steps(self) -> int:
        """Recorded so far."""
        return self._core.steps

    @property
    def bytes(self) -> int:
        """Of the file."""
        return self._core.bytes

    @property
    def hash(self) -> str:
        """Of the contacts so far: the same for every device and number of threads."""
        return self._core.hash

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        if kind is None and not self._finished:
            self.finish()


class RecordedStep(NamedTuple):
    """One step of a recording. n is the number of bodies that ever were there.

    poses: (n, 4, 4) float64, from the body's frame to the world, metres, to the bit; the identity for bodies that are
        not there.
    present: (n,) bool: false before a body is added and after it is removed.
    pairs: (m, 2) int64: the pairs of the step, by rows of `poses`.
    """

    poses: NDArray[np.float64]
    present: NDArray[np.bool_]
    pairs: NDArray[np.int64]


class Recording:
    """What a Recorder or `raycontact run --record` wrote, finished or not, to the bit. Used by one thread at a time.

    Raises InputError for a file that is missing, no recording, or damaged, naming it and the place.
    """

    def __init__(self, file: Union[str, os.PathLike[str]]) -> None:
        self._core = _core.Recording(os.fspath(file))

    @property
    def shapes(self) -> list[Shape]:
        """The very shapes that were recorded."""
        return [Shape._wrap(core) for core in self._core.shapes()]

    @property
    def shape_of(self) -> NDArray[np.int64]:
        """(n,) int64: which of `shapes` each body has."""
        return self._core.shape_of()

    @property
    def ids(self) -> NDArray[np.int64]:
        """(n,) int64: as the scene gave them."""
        return self._core.ids()

    @property
    def settings(self) -> dict[str, Any]:
        """Of the scene; `Scene(**recording.settings)` is one like it."""
        return self._core.settings

    @property
    def name(self) -> str:
        """What the recording says of itself."""
        return self._core.name

    @property
    def dt(self) -> float:
        """Seconds between two steps."""
        return self._core.dt

    @property
    def hash(self) -> Optional[str]:
        """Of all its contacts, as Recorder.hash; None where the recording was not finished."""
        return self._core.hash

    def __len__(self) -> int:
        return self._core.steps

    def __getitem__(self, step: int) -> RecordedStep:
        """Cheap in ascending order. Raises IndexError for a step that there is not."""
        count = len(self)
        at = step + count if step < 0 else step
        if not 0 <= at < count:
            raise IndexError(f"there is no step {step}; the recording has {count}")
        poses, present, pairs = self._core.step(at)
        return RecordedStep(poses, present.view(np.bool_), pairs)

    def __repr__(self) -> str:
        return f"<Recording {self.name!r}: {len(self)} steps of {len(self.ids)} bodies>"


__all__ = ["RecordedStep", "Recorder", "Recording"]
