# SPDX-License-Identifier: Apache-2.0
"""Bodies and contacts in a browser, through viser (https://viser.studio), which is only imported here."""

from __future__ import annotations

import contextlib
import io
import os
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import as_count, as_ids, as_length
from ._core import InputError
from .contacts import Contacts
from .mesh import Mesh
from .recording import Recording
from .scene import Scene
from .shape import Shape

_COLOURS = np.array([(196, 84, 40), (40, 106, 170), (206, 158, 48), (60, 140, 72), (132, 78, 156)], np.uint8)
_GREY = (150, 147, 138)
_SHALLOW, _DEEP, _APART = (255, 214, 0), (214, 0, 36), (0, 190, 210)
_CORNERS = np.array([(i & 1, i >> 1 & 1, i >> 2) for i in range(8)])
_SEE_THROUGH = 0.5
"""Contacts lie where bodies overlap, so opaque bodies would hide them."""


def show(
    what: Union[Scene, Shape, Mesh, str, os.PathLike[str]],
    *,
    out: Union[str, os.PathLike[str], None] = None,
    contacts: bool = True,
    static: ArrayLike = (),
    fps: float = 30.0,
    host: str = "127.0.0.1",
    port: int = 8080,
    block: bool = True,
) -> Any:
    """Shows a scene or a shape, or plays a recording, in a browser. Needs viser: `pip install viser`.

    what: a Scene, as it is now; a Shape or Mesh alone; or the .glb file of a Recorder or of `raycontact run --record`.
    out: writes a page that needs no server to this file instead of serving; it can be mailed, or put on a web site.
    contacts: draws contacts as points and their normals as lines, and bodies see-through. Yellow ones are shallow, the
        deepest shown so far is red, speculative ones are blue. A scene's are those of its last step; a recording's are
        found again by its direction, features and limits, without speculative ones.
    static: ids of a scene's bodies that are drawn grey, as a recording's bodies that never move are.
    fps: pictures a second of a recording; it plays as fast as it was recorded.
    host, port: where to serve; the next free port where this one is taken. "0.0.0.0" lets other machines see it.
    block: serves until Ctrl-C. False: returns viser's server at once; `server.stop()` ends it.

    Prints the address that it serves at. World frame, metres, z up. Raises ImportError without viser, and InputError
    for a file that is no recording, for ids that are not in the scene and for fps <= 0.
    """
    rate = as_length(fps, "fps")
    if not 0 < rate < np.inf:
        raise InputError(f"fps: {fps!r} is not finite and above 0")
    if isinstance(what, (Shape, Mesh)):
        shape, what = what, Scene()
        what.add(shape)
    if isinstance(what, Scene):
        film = _film_of_scene(what, static)
    elif isinstance(what, (str, os.PathLike)):
        film = _film_of_recording(Recording(what), rate)
    else:
        raise InputError(f"show: {type(what).__name__} is no Scene, Shape or Mesh, and no file of a recording")

    if out is not None:
        with _server("127.0.0.1", 0) as server:
            page = _page(_Stage(server, film, contacts))
        Path(out).write_text(page, encoding="utf-8")
        return None
    with _server(host, as_count(port, "port"), keep=not block) as server:
        _Stage(server, film, contacts).start()
        with contextlib.suppress(KeyboardInterrupt) if block else contextlib.nullcontext():
            print(f"raycontact.show: http://{server.get_host()}:{server.get_port()}", flush=True)
            while block:
                time.sleep(1.0)
    return None if block else server


class _Placed(NamedTuple):
    poses: np.ndarray  # (n, 4, 4)
    present: np.ndarray  # (n,) bool

    def wxyzs(self) -> np.ndarray:
        return _quaternions(self.poses[:, :3, :3])


class _Film(NamedTuple):
    shapes: list[Shape]
    shape_of: np.ndarray  # (n,) int64
    static: np.ndarray  # (n,) bool
    times: np.ndarray  # (f,), seconds
    poses: Callable[[int], _Placed]
    contacts: Callable[[int], Contacts]


def _film_of_scene(scene: Scene, static: ArrayLike) -> _Film:
    ids = scene.ids
    grey = as_ids(static, "static")[0]
    unknown = grey[~np.isin(grey, ids)]
    if len(unknown):
        raise InputError(f"static: body {unknown[0]} is not in the scene")
    bodies = [scene.shape(body) for body in ids]
    # Bodies that share a shape have the same one of the C++ half.
    shapes = list({id(shape._core): shape for shape in bodies}.values())
    place_of = {id(shape._core): place for place, shape in enumerate(shapes)}
    shape_of = np.array([place_of[id(shape._core)] for shape in bodies], np.int64)
    placed = _Placed(scene.poses(), np.ones(len(ids), np.bool_))
    found = scene.contacts
    return _Film(shapes, shape_of, np.isin(ids, grey), np.zeros(1), lambda step: placed, lambda step: found)


def _film_of_recording(recording: Recording, fps: float) -> _Film:
    if not len(recording):
        raise InputError("show: the recording has no step")
    times = np.arange(len(recording)) * recording.dt
    # The first step of each period, and the last of all.
    steps = np.unique(np.floor(times * fps + 1e-3), return_index=True)[1]
    steps = np.union1d(steps, len(times) - 1)
    shapes, shape_of = recording.shapes, recording.shape_of
    # By "certified", which finds what is there in any step.
    kept = ("direction", "features", "max_contacts_per_pair", "max_contacts")
    scene = Scene(**{key: recording.settings[key] for key in kept})
    ids = np.array([scene.add(shapes[i]) for i in shape_of], np.int64)
    still, first = np.ones(len(ids), np.bool_), recording[0].poses
    for step in steps:
        at = recording[int(step)]
        still &= ~at.present | (at.poses == first).all(axis=(1, 2))

    def poses(frame: int) -> _Placed:
        step = recording[int(steps[frame])]
        return _Placed(step.poses, step.present)

    def contacts(frame: int) -> Contacts:
        step = recording[int(steps[frame])]
        scene.set_poses(ids, step.poses)
        return scene.find_contacts(ids[step.pairs])

    return _Film(shapes, shape_of, still & ~still.all(), times[steps], poses, contacts)


class _Stage:
    """A film in a server's scene."""

    def __init__(self, server: Any, film: _Film, with_contacts: bool) -> None:
        self.server, self.film = server, film
        placed = film.poses(0)
        low, high = _box(film)
        size = float(np.linalg.norm(high - low)) or 1.0
        # Everything is placed from here, so that float32 is fine enough far away from the world's origin, too.
        self.middle = (low + high) / 2
        sizes = np.array([np.linalg.norm(np.diff(shape.box, axis=0)) for shape in film.shapes])[film.shape_of]
        self.grain = max(float(np.median(sizes)), 0.05 * size) if len(film.shapes) else size
        self.deepest = 0.0

        camera = server.initial_camera
        camera.fov = 0.8
        camera.near, camera.far = 1e-3 * size, 100 * size
        camera.look_at = self.middle
        camera.position = self.middle + size * np.array((0.5, -0.9, 0.5))
        own = (np.where(film.static, 0, np.cumsum(~film.static) - 1)) % len(_COLOURS)
        colours = np.where(film.static[:, None], np.array(_GREY, np.uint8), _COLOURS[own])
        self.batches = []
        wxyzs = placed.wxyzs()
        for i, shape in enumerate(film.shapes):
            which = np.flatnonzero(film.shape_of == i)
            batch = server.scene.add_batched_meshes_simple(
                f"/bodies/{i} {shape.name.replace('/', ' ')}".rstrip(),  # a slash begins a node below
                shape.vertices,
                shape.triangles,
                wxyzs[which],
                placed.poses[which, :3, 3] - self.middle,
                batched_scales=placed.present[which].astype(np.float32),
                batched_colors=colours[which],
                lod="off",
                opacity=_SEE_THROUGH if with_contacts else None,
                flat_shading=True,
                side="front" if shape.has_inside else "double",
                cast_shadow=False,
                position=self.middle,
            )
            self.batches.append((which, batch))
        self.points = self.normals = None
        if with_contacts:
            # Something must be there; it is not seen.
            nothing, black = np.zeros((1, 3), np.float32), np.zeros(3, np.uint8)
            self.points = server.scene.add_point_cloud(
                "/contacts/points", nothing, black, point_size=0.018 * self.grain, point_shape="circle",
                precision="float32", position=self.middle, visible=False,
            )  # fmt: skip
            self.normals = server.scene.add_line_segments(
                "/contacts/normals", np.zeros((1, 2, 3), np.float32), black, thickness=0.006 * self.grain,
                position=self.middle, visible=False,
            )  # fmt: skip
        self.draw(0)

    def draw(self, frame: int) -> None:
        placed = self.film.poses(frame)
        found = None if self.points is None else self.film.contacts(frame)
        with self.server.atomic():
            wxyzs = placed.wxyzs()
            for which, batch in self.batches:
                batch.batched_positions = placed.poses[which, :3, 3] - self.middle
                batch.batched_wxyzs = wxyzs[which]
                batch.batched_scales = placed.present[which].astype(np.float32)
            if found is not None:
                self.draw_contacts(found)

    def draw_contacts(self, found: Contacts) -> None:
        if self.points is None or self.normals is None:
            return
        self.points.visible = self.normals.visible = len(found) > 0
        if not len(found):
            return
        points, normals = found.point_a - self.middle, found.normal
        self.deepest = max(self.deepest, float(found.depth.max(initial=0.0)))
        share = np.clip(found.depth / (self.deepest or 1.0), 0.0, 1.0)[:, None]
        colours = np.where(found.depth[:, None] > 0, (1 - share) * _SHALLOW + share * _DEEP, _APART).astype(np.uint8)
        self.points.points, self.points.colors = points.astype(np.float32), colours
        ends = np.stack([points, points + 0.09 * self.grain * normals], axis=1)
        self.normals.points, self.normals.colors = ends.astype(np.float32), np.repeat(colours[:, None], 2, axis=1)

    def start(self) -> None:
        """Buttons, and a thread that plays, for a film of several frames."""
        times = self.film.times
        if len(times) == 1:
            return
        playing = self.server.gui.add_checkbox("Play", True)
        slider = self.server.gui.add_slider("Picture", 0, len(times) - 1, 1, 0)
        over = threading.Event()
        stop = self.server.stop

        def end() -> None:
            over.set()
            stop()

        self.server.stop = end

        def play() -> None:
            drawn = 0
            while not over.is_set():
                began = time.monotonic()
                frame = slider.value
                if playing.value:
                    frame = slider.value = (frame + 1) % len(times)
                if frame != drawn:
                    self.draw(frame)
                    drawn = frame
                step = max(float(times[frame] - times[frame - 1]), 0.01) if frame else 0.5
                over.wait(max(step - (time.monotonic() - began), 0.0))

        threading.Thread(target=play, name="raycontact.show", daemon=True).start()


def _page(stage: _Stage) -> str:
    recorder = stage.server.get_scene_serializer()
    times = stage.film.times
    for frame in range(1, len(times)):
        recorder.insert_sleep(float(times[frame] - times[frame - 1]))
        stage.draw(frame)
    if len(times) > 1:
        recorder.insert_sleep(0.5)  # before it begins anew
    return recorder.as_html()


@contextlib.contextmanager
def _server(host: str, port: int, *, keep: bool = False) -> Iterator[Any]:
    """A server that ends with the block; with `keep` only if that fails."""
    try:
        import viser
    except ImportError:
        raise ImportError("raycontact.show needs viser: pip install viser") from None
    with contextlib.redirect_stdout(io.StringIO()):  # it has a banner of its own
        server = viser.ViserServer(host=host, port=port, label="RayContact", verbose=False)
    try:
        yield server
    except BaseException:
        keep = False
        raise
    finally:
        if not keep:
            with contextlib.redirect_stdout(io.StringIO()):
                server.stop()


def _box(film: _Film) -> np.ndarray:
    """(2, 3) around bodies at the beginning and at the end; a ground is large, so static ones count only if all are."""
    boxes = np.array([shape.box for shape in film.shapes]).reshape(-1, 2, 3)
    corners = boxes[:, _CORNERS, [0, 1, 2]][film.shape_of]
    ends = []
    for frame in (0, len(film.times) - 1):
        placed = film.poses(frame)
        counted = placed.present if film.static.all() else placed.present & ~film.static
        poses = placed.poses[counted]
        ends.append((corners[counted] @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]).reshape(-1, 3))
    points = np.concatenate(ends)
    return np.array([points.min(axis=0), points.max(axis=0)]) if len(points) else np.zeros((2, 3))


def _quaternions(rotations: np.ndarray) -> np.ndarray:
    """(n, 4) w x y z of (n, 3, 3); from the largest component, so nothing cancels."""
    r = rotations
    w, x, y, z = (1 + a * r[:, 0, 0] + b * r[:, 1, 1] + c * r[:, 2, 2] for a, b, c in
                  ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)))  # fmt: skip
    wx, wy, wz = r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]
    xy, yz, zx = r[:, 1, 0] + r[:, 0, 1], r[:, 2, 1] + r[:, 1, 2], r[:, 0, 2] + r[:, 2, 0]
    rows = np.array([(w, wx, wy, wz), (wx, x, xy, zx), (wy, xy, y, yz), (wz, zx, yz, z)])  # 4 q q^T
    largest = np.argmax([w, x, y, z], axis=0)
    q = rows[largest, :, np.arange(len(r))]
    return q / np.linalg.norm(q, axis=1, keepdims=True)


__all__ = ["show"]
