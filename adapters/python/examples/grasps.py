# SPDX-License-Identifier: Apache-2.0
"""A thousand grasps of a mug by two pads that close on it, ranked by the least wrench that they cannot hold.

python grasps.py [PART] [--grasps N] [--friction MU] [--page grasps.html]
"""

from __future__ import annotations

import argparse

import numpy as np
import raycontact as rc
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

PAD = (0.006, 0.02, 0.02)
"""Metres; it closes along its x."""


def closing(shape: rc.Shape, count: int, rng: np.random.Generator) -> np.ndarray:
    """(count, 2, 2, 4, 4): of each grasp both pads, from wide open to the middle, which lies in the part's box."""
    turn = Rotation.random(count, rng).as_matrix()
    low, high = shape.box
    middle = rng.uniform(low, high, (count, 3))
    far = 2 * shape.radius + PAD[0]
    sides = [turn, turn @ np.diag((-1.0, -1.0, 1.0))]  # the other pad is turned by half a turn
    return np.stack(
        [np.stack([rc.pose(middle - reach * side[:, :, 0], side) for reach in (far, 0)], axis=1) for side in sides],
        axis=1,
    )


def pressed(paths: np.ndarray, times: np.ndarray, depth: float) -> np.ndarray:
    """(count, 2, 4, 4): the pads where they touch, and `depth` metres further."""
    poses = paths[:, :, 0].copy()
    way = paths[:, :, 1, :3, 3] - paths[:, :, 0, :3, 3]
    far = np.linalg.norm(way, axis=-1)
    poses[..., :3, 3] += way * (np.where(np.isfinite(times), times, 0) + depth / far)[..., None]
    return poses


def quality(wrenches: np.ndarray) -> float:
    """The radius of the largest ball about 0 in the hull of wrenches (n, 6); 0: something moves the part freely."""
    try:
        return max(0.0, -ConvexHull(wrenches).equations[:, -1].max())
    except (QhullError, ValueError):  # flat
        return 0.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", nargs="?", help="a closed mesh in metres instead of a mug")
    parser.add_argument("--grasps", type=int, default=1000)
    parser.add_argument("--friction", type=float, default=0.4)
    parser.add_argument("--page", help="writes a page of the best grasp")
    options = parser.parse_args()
    part = rc.Shape(options.part or rc.samples()["mug"])
    pad = rc.Shape(rc.box(PAD))

    # Both pads of all grasps close at once, each until it touches the part.
    paths = closing(part, options.grasps, np.random.default_rng(1))
    first = rc.time_of_impact(pad, part, paths)
    closed = (np.isfinite(first.time) & (first.time > 0)).all(axis=1)
    print(f"{closed.sum()} of {options.grasps} grasps have a part between their pads")

    # Pressed by a twentieth of a millimetre, a pad touches wherever it lies on.
    poses = pressed(paths, first.time, 5e-5)
    contacts = rc.collide(pad, part, poses.reshape(-1, 4, 4), max_contacts_per_pair=4)
    cones = rc.wrench_cone(
        contacts.point_b, contacts.normal, options.friction, edges=6, origin=part.mass.centre, length=part.radius
    )
    ranks = np.zeros(options.grasps)
    for grasp in np.flatnonzero(closed):
        ranks[grasp] = quality(cones[contacts.pair // 2 == grasp].reshape(-1, 6))
    order = np.argsort(-ranks)
    print(f"{(ranks > 0).sum()} of them hold it against any small force and torque")
    for grasp in order[:3]:
        opening = 1e3 * np.linalg.norm(poses[grasp, 0, :3, 3] - poses[grasp, 1, :3, 3]) - 1e3 * PAD[0]
        print(f"grasp {grasp}: {ranks[grasp]:.3f} N of 1 N, {opening:.1f} mm wide")

    if options.page:
        scene = rc.Scene()
        ids = scene.add([part, pad, pad], np.concatenate((np.eye(4)[None], poses[order[0]])))
        scene.find_contacts()
        rc.show(scene, out=options.page, static=ids[1:])


if __name__ == "__main__":
    main()
