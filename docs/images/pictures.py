#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the pictures of docs/engine.md, planning.md and assembly-motion.md beside itself, by the library's own rays.

In the repository's root, with the package in PYTHONPATH (build/python):
    build/bin/raycontact samples
    build/bin/example_penalty samples/hare.obj poses.txt
    python docs/images/pictures.py samples/hare.obj poses.txt
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import raycontact as rc

HERE = Path(__file__).parent
sys.path.append(str(HERE.parents[1] / "adapters/python/examples"))
import picture  # noqa: E402

SHALLOW, DEEP, GREY = np.array((244, 214, 92.0)), np.array((196, 30, 44.0)), np.array((205, 202, 194.0))
BLUE, ORANGE, GHOST = np.array((58, 124, 190.0)), np.array((222, 104, 44.0)), np.array((190, 208, 228.0))


def draw(name: str, bodies: list, eye, at) -> None:
    """bodies: of each its shape, pose and colour, 0 to 255. Contacts of the bodies are not drawn."""
    scene = rc.Scene()
    for shape, pose, _ in bodies:
        scene.add(shape, pose)
    picture.COLOURS = np.array([colour for _, _, colour in bodies])
    picture.save(
        str(HERE / name), picture.draw(scene, np.array(eye, float), np.array(at, float), np.arange(len(bodies)))
    )


def heap(mesh_file: str, poses_file: str) -> None:
    """Hares at rest, each in the colour of its deepest contact; the bin's walls are left out."""
    mesh = rc.Mesh(mesh_file)
    hare = rc.Shape(rc.Mesh(mesh.vertices - rc.Shape(mesh).mass.centre, mesh.triangles))
    rows = np.loadtxt(poses_file)
    poses = rc.pose(rows[:, 9:], rows[:, :9].reshape(-1, 3, 3))
    floor = rc.Shape(rc.box((5.0, 5.0, 0.2)))
    scene = rc.Scene(features="vertices", direction="weighted")
    ids = [scene.add(floor, rc.pose([0, 0, -0.1]))] + [scene.add(hare, pose) for pose in poses]
    deepest = np.zeros(len(ids))
    found = scene.find_contacts()
    for side in found.slots.T:
        np.maximum.at(deepest, side, found.depth)
    share = np.clip(deepest / deepest[1:].max(), 0, 1)[:, None]
    colours = SHALLOW + share * (DEEP - SHALLOW)
    print(f"deepest of all: {1e3 * deepest[1:].max():.2f} mm")
    draw("engine-heap.png", [(floor, rc.pose([0, 0, -0.1]), GREY)] + list(zip([hare] * 50, poses, colours[1:])),
         (2.0, -5.2, 4.4), (0, -0.1, 0.35))  # fmt: skip


def sweep() -> None:
    """The mug of docs/planning.md on its way down to the board that it meets, and past it."""
    mug, board = rc.Shape(rc.samples()["mug"]), rc.Shape(rc.box((1.0, 0.3, 0.02)))
    at = rc.pose([0, 0.5, 0.4])
    down = rc.pose([[0.1, 0.5, 0.8], [0.1, 0.5, 0.1]])
    past = rc.pose([[-0.2, 0.5, 0.8], [-0.2, 0.2, 0.8], [-0.2, 0.2, 0.1]])
    met = rc.time_of_impact(mug, board, down, at)
    assert rc.time_of_impact(mug, board, past, at).time == np.inf
    print(f"met at {met.time:.4f}")

    def mugs(path, times, colour):
        for time in times:
            k = min(int(time), len(path) - 2)
            pose = path[k].copy()
            pose[:3, 3] += (time - k) * (path[k + 1] - path[k])[:3, 3]
            yield mug, pose, colour

    ghosts = list(mugs(down, np.linspace(0, met.time, 5)[:-1], GHOST)) + list(mugs(down, [met.time], ORANGE))
    ghosts += mugs(past, np.arange(0, 2.01, 0.25), BLUE)
    draw("planning-sweep.png", [(board, at, GREY)] + ghosts, (0.75, -1.1, 0.95), (-0.08, 0.4, 0.45))


def lever() -> None:
    """The lever of docs/examples/lever.obj as it turns up about its pin, and where it meets the hood."""
    parts = {part.name: rc.Shape(part.mesh) for part in rc.load_assembly(HERE.parent / "examples/lever.obj")}
    pin = np.array((0, 0, 0.1))

    def turned(degrees: float) -> np.ndarray:
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        return rc.pose(pin, [[c, 0, -s], [0, 1, 0], [s, 0, c]]) @ rc.pose(-pin)

    path = np.array([turned(angle) for angle in (0, 30, 60, 90)])
    met = 30 * rc.time_of_impact(parts["lever"], parts["hood"], path, rc.pose()).time
    print(f"met at {met:.4f} degrees")
    colours = {"hood": BLUE, "sensor": DEEP}
    bodies = [(shape, rc.pose(), colours.get(name, GREY)) for name, shape in parts.items() if name != "lever"]
    behind = rc.pose([0, 1e-4, 0])  # faces in one plane would be drawn through each other
    bodies += [(parts["lever"], behind @ turned(angle), GHOST) for angle in (0, met / 2)]
    bodies.append((parts["lever"], turned(met), ORANGE))
    draw("assembly-lever.png", bodies, (0.23, -0.55, 0.27), (0.06, 0, 0.115))


if __name__ == "__main__":
    heap(*sys.argv[1:3])
    sweep()
    lever()
