# SPDX-License-Identifier: Apache-2.0
"""Concave bodies fall on a ground and come to rest.

python falling.py [--bodies N] [--seconds S] [--record run.glb] [--picture run.png] [--page run.html]
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import parts
import picture
import raycontact as rc
from penalty import GRAVITY, STEP, World

STEPS_A_PICTURE = 32


def world(count: int) -> World:
    kinds = [rc.Shape(parts.gear()), rc.Shape(parts.knot(along=48, around=8)), rc.Shape(parts.bracket())]
    centred = [rc.Shape(rc.Mesh(s.vertices - s.mass.centre, s.triangles, name=s.name)) for s in kinds]
    ground = rc.Shape(rc.box((2.4, 2.4, 0.2)))
    random = np.random.default_rng(3)
    i = np.arange(count)
    places = np.stack((0.16 * (i % 3 - 1), 0.16 * (i // 3 % 2) - 0.08, 0.1 + 0.14 * i), axis=-1)
    turns = random.normal(size=(count, 4))
    shapes = [ground] + [centred[k % 3] for k in i]
    return World(shapes, np.r_[[(0, 0, -0.1)], places], np.r_[[(1, 0, 0, 0)], turns])


def main() -> None:
    parser = picture.options(__doc__)
    parser.add_argument("--bodies", type=int, default=9)
    parser.add_argument("--seconds", type=float, default=2.5)
    parser.add_argument("--record", metavar="FILE.glb", help="keeps the run, for raycontact.show and `raycontact view`")
    options = parser.parse_args()
    here = world(options.bodies)
    with tempfile.TemporaryDirectory() as folder:
        file = options.record or str(Path(folder) / "falling.glb")
        with rc.Recorder(file, here.scene, dt=STEPS_A_PICTURE * STEP, name="falling") as recorder:
            deepest = 0.0
            for i in range(round(options.seconds / STEP)):
                here.step()
                deepest = max(deepest, here.scene.stats.depth_max)
                if i % STEPS_A_PICTURE == 0:
                    recorder.record()
        if options.page:
            rc.show(file, out=options.page)
    fastest = np.linalg.norm(here.speed, axis=1).max()
    print(f"{options.bodies} bodies after {options.seconds} s: the fastest moves at {1e3 * fastest:.2f} mm/s")
    print(f"the ground carries {-here.carried[2]:.2f} N of {GRAVITY * here.mass[1:].sum():.2f} N")
    print(f"deepest contact: {1e3 * deepest:.2f} mm, at the end {1e3 * here.scene.stats.depth_max:.2f} mm")
    if options.picture:
        colours = np.r_[picture.GREY, np.arange(options.bodies) % picture.GREY]
        picture.save(options.picture, picture.draw(here.scene, (0.5, -1.05, 0.65), (0, 0, 0.05), colours))


if __name__ == "__main__":
    main()
