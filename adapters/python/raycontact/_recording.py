# SPDX-License-Identifier: Apache-2.0
"""Recordings as glTF viewers read them: meshes, and where bodies are at each time, in float32.

docs/internals/recording.md has the layout. The exact data beside it are for `raycontact replay`.
"""

from __future__ import annotations

import json
import os
import struct
import zlib
from collections.abc import Iterator
from typing import Any, NamedTuple, Union

import numpy as np

from ._core import InputError

_FORMATS = {5125: "<u4", 5126: "<f4"}
_MOST_TEXT = 1 << 20
_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class Placed(NamedTuple):
    """Where all n bodies are at one time."""

    positions: np.ndarray
    """(n, 3) float32, metres."""
    wxyzs: np.ndarray
    """(n, 4) float32, unit quaternions."""
    present: np.ndarray
    """(n,) bool: false before a body is added and after it is removed."""


class Recording:
    """A finished recording. Raises InputError naming the file for one that is not, and for any other file.

    meshes: name, vertices (v, 3) float32, metres, and triangles (t, 3) uint32, of each shape.
    mesh_of: (n,) int64, which of them each of the n bodies has.
    moves: (n,) bool: false for bodies that stay where they are.
    times: (f,) float32, seconds.
    direction, features: of its run's settings.
    """

    meshes: list[tuple[str, np.ndarray, np.ndarray]]
    mesh_of: np.ndarray
    moves: np.ndarray
    times: np.ndarray
    direction: str
    features: str

    def __init__(self, file: Union[str, os.PathLike[str]]) -> None:
        name = os.fspath(file)
        try:
            with open(name, "rb") as opened:
                data = opened.read()
        except OSError as error:
            raise InputError(f"{name}: cannot be read: {error.strerror}") from None
        try:
            chunks = dict(_chunks(data))
            if b"RAYC" not in chunks:
                raise InputError(f"{name}: is no recording; name one that a Recorder or `raycontact run --record` made")
            blocks = dict(_blocks(chunks[b"RAYC"]))
            if b"END " not in blocks:
                raise InputError(f"{name}: was not finished, so it has no animation; `raycontact view` shows it")
            info = dict(json.loads(zlib.decompressobj().decompress(blocks[b"INFO"], _MOST_TEXT)))
            self.direction, self.features = str(info["direction"]), str(info.get("features", "vertices"))
            self._read(json.loads(chunks[b"JSON"]), chunks.get(b"BIN\0", b""))
        except InputError:
            raise
        except (ValueError, LookupError, TypeError, AttributeError, RecursionError, struct.error, zlib.error) as error:
            raise InputError(f"{name}: is no recording that can be shown: {error!r}") from None

    def _read(self, document: dict[str, Any], binary: bytes) -> None:
        def array(accessor: int) -> np.ndarray:
            what = document["accessors"][accessor]
            start = document["bufferViews"][what["bufferView"]].get("byteOffset", 0) + what.get("byteOffset", 0)
            width = _WIDTHS[what["type"]]
            flat = np.frombuffer(binary, _FORMATS[what["componentType"]], what["count"] * width, start)
            return flat.reshape(-1, width)

        # A mesh is there once for each colour; those with the same vertices are one shape.
        primitives = [(str(mesh.get("name", "")), mesh["primitives"][0]) for mesh in document.get("meshes", [])]
        keys = [(name, p["attributes"]["POSITION"], p["indices"]) for name, p in primitives]
        shapes = list(dict.fromkeys(keys))
        self.meshes = [(name, array(vertices), array(corners).reshape(-1, 3)) for name, vertices, corners in shapes]

        nodes = document["nodes"]
        bodies = nodes[0].get("children", [])  # node 0 turns z up into glTF's y up
        self.mesh_of = np.array([shapes.index(keys[nodes[i]["mesh"]]) for i in bodies], np.int64)
        start = [(*nodes[i]["translation"], *nodes[i]["rotation"], 1.0) for i in bodies]
        self._start = np.array(start, np.float32).reshape(-1, 8)  # position, quaternion x y z w, size
        place_of = {node: place for place, node in enumerate(bodies)}

        self._tracks: list[tuple[slice, np.ndarray, np.ndarray]] = []
        self.times = np.zeros(1, np.float32)
        self.moves = np.zeros(len(bodies), np.bool_)
        columns = {"translation": slice(0, 3), "rotation": slice(3, 7), "scale": slice(7, 8)}
        for animation in document.get("animations", []):
            samplers = animation["samplers"]
            self.times = array(samplers[0]["input"])[:, 0]
            for path, column in columns.items():
                channels = [c for c in animation["channels"] if c["target"]["path"] == path]
                if not channels:
                    continue
                places = np.array([place_of[c["target"]["node"]] for c in channels])
                tracks = np.stack([array(samplers[c["sampler"]]["output"]) for c in channels])
                if tracks.shape[1] != len(self.times):
                    raise ValueError("its animation has tracks of other lengths")
                self._tracks.append((column, places, tracks[:, :, : column.stop - column.start]))
                if path != "scale":
                    self.moves[places] = True

    def at(self, step: int) -> Placed:
        """Where bodies are at `times[step]`."""
        now = self._start.copy()
        for column, places, tracks in self._tracks:
            now[places, column] = tracks[:, step]
        return Placed(now[:, :3], now[:, [6, 3, 4, 5]], now[:, 7] > 0)


def _chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    if data[:4] != b"glTF":
        raise ValueError("not a .glb file")
    at = 12
    while at < len(data):
        length, kind = struct.unpack_from("<I4s", data, at)
        yield kind, data[at + 8 : at + 8 + length]
        at += 8 + length


def _blocks(chunk: bytes) -> Iterator[tuple[bytes, bytes]]:
    at = 16
    while at + 40 <= len(chunk):
        kind, stored = struct.unpack_from("<4s4xQ", chunk, at)
        end = at + 40 + (stored + 7) // 8 * 8
        if end > len(chunk):
            return  # not whole
        yield kind, chunk[at + 40 : at + 40 + stored]
        at = end
