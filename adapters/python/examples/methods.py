# SPDX-License-Identifier: Apache-2.0
"""What the methods of Lehericey et al. (2013) cost and miss on a pair that slides and turns: wrong contacts, rays cast.

python methods.py [--steps N] [--features edges] [--picture rays.png] [--page methods.html]
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import parts
import picture
import raycontact as rc

METHODS = ("standard", "iterative", "predictive", "certified")


def shapes() -> list[rc.Shape]:
    return [rc.Shape(parts.knot(along=192, around=24)), rc.Shape(parts.gear(teeth=24))]


def poses(steps: int) -> np.ndarray:
    """(steps, 4, 4) of the second body: it turns about z and y while it passes through the first."""
    turn = np.linspace(0, np.pi / 8, steps)
    about_z = np.c_[np.cos(turn / 2), np.zeros((steps, 2)), np.sin(turn / 2)]
    about_y = np.c_[np.cos(turn / 4), np.zeros(steps), np.sin(turn / 4), np.zeros(steps)]
    turned = rc.pose_from_quaternion(np.zeros(3), about_z) @ rc.pose_from_quaternion(np.zeros(3), about_y)
    along = np.c_[0.16 - 0.04 * np.arange(steps) / steps, np.zeros((steps, 2))]
    return rc.pose(along, turned[:, :3, :3])


def main() -> None:
    parser = picture.options(__doc__)
    parser.add_argument("--steps", type=int, default=400)
    parser.add_argument("--features", choices=("vertices", "edges"), default="vertices", help="vertices: the paper")
    options = parser.parse_args()
    path, bodies = poses(options.steps), shapes()
    rays = np.zeros((len(METHODS), options.steps), np.int64)
    found: list[list[np.ndarray]] = []
    with tempfile.TemporaryDirectory() as folder:
        for method, cast in zip(METHODS, rays):
            scene = rc.Scene(method=method, features=options.features, devices="cpu")
            ids = scene.add(bodies, np.stack((np.eye(4), path[0])))
            with rc.Recorder(Path(folder) / f"{method}.glb", scene, name=method) as recorder:
                found.append([])
                for step, pose in enumerate(path):
                    scene.set_poses(ids[1], pose)
                    found[-1].append(scene.find_contacts().key)
                    cast[step] = scene.stats.details.rays_cast
                    recorder.record()
            if options.page and method == "certified":
                rc.show(Path(folder) / f"{method}.glb", out=options.page)

    # A contact is missed or invented if the standard method has, or has not, one of its key in the same step.
    print(f"{options.steps} steps, {sum(map(len, found[0]))} contacts, features {options.features}")
    print("method        contacts  missed  invented  rays cast  of standard's")
    for method, keys, cast in zip(METHODS, found, rays):
        missed = sum(len(np.setdiff1d(true, own)) for true, own in zip(found[0], keys))
        invented = sum(len(np.setdiff1d(own, true)) for true, own in zip(found[0], keys))
        share = cast.sum() / rays[0].sum()
        print(f"{method:<12} {sum(map(len, keys)):9d} {missed:7d} {invented:9d} {cast.sum():10d} {100 * share:13.1f} %")
    if options.picture:
        means = [[part.mean() for part in np.array_split(cast, min(80, len(cast)))] / rays.max() for cast in rays]
        picture.save(options.picture, np.concatenate([picture.bars(mean, 480, 90) for mean in means]))


if __name__ == "__main__":
    main()
