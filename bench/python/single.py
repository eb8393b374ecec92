# SPDX-License-Identifier: Apache-2.0
"""What single questions cost from Python, and trimesh's collision manager with ours and with FCL.

    PYTHONPATH=build/python python bench/python/single.py

Needs trimesh, and python-fcl for its rows. Microseconds, the least of five rounds; the loop is of nine links of 300
triangles, placed anew 300 times among 40 boxes, each time asked whether any two links meet, or a link and a box. The
scene has those boxes, and is asked about 11 links.
"""

from __future__ import annotations

import timeit

import numpy as np
import raycontact as rc
import trimesh
from raycontact.collision import CollisionManager
from trimesh.transformations import random_rotation_matrix, translation_matrix


def least(question, count: int) -> float:
    return 1e6 * min(timeit.repeat(question, number=count, repeat=5)) / count


def configuration(manager) -> tuple[float, int]:
    """Microseconds, and how many of 300 configurations collide."""
    random = np.random.default_rng(66)
    arm, shelf = manager(), manager()
    link = trimesh.creation.capsule(height=0.3, radius=0.06, count=(12, 14))
    for i in range(9):
        arm.add_object(f"link{i}", link)
    for k in range(40):
        place = translation_matrix([1 + 0.3 * (k % 5), 0.3 * (k // 5) - 1, 0.2 * (k % 7)])
        shelf.add_object(f"box{k}", trimesh.creation.box((0.2, 0.2, 0.05)), place)
    poses = [
        [translation_matrix(3 * random.random(3) - 1) @ random_rotation_matrix(random.random(3)) for _ in range(9)]
        for _ in range(300)
    ]
    found = 0

    def loop() -> None:
        nonlocal found
        found = 0
        for places in poses:
            for i, place in enumerate(places):
                arm.set_transform(f"link{i}", place)
            found += arm.in_collision_internal() or arm.in_collision_other(shelf)

    return least(loop, 1) / len(poses), found


def scene_of_boxes() -> list[tuple[str, float]]:
    """Microseconds of single calls of a scene."""
    random = np.random.default_rng(66)
    link = rc.Shape(trimesh.creation.capsule(height=0.3, radius=0.06, count=(12, 14)))
    scene = rc.Scene()
    box = rc.Shape(rc.box((0.2, 0.2, 0.05)))
    ids = scene.add(box, rc.pose([[1 + 0.3 * (k % 5), 0.3 * (k // 5) - 1, 0.2 * (k % 7)] for k in range(40)]))
    body, links = int(ids[7]), [link] * 11
    turns = [random_rotation_matrix(random.random(3))[:3, :3] for _ in range(11)]
    clear = rc.pose(np.c_[np.linspace(0.2, 0.7, 11), np.zeros((11, 2))], np.array(turns))
    hit = clear.copy()
    hit[5, :3, 3] = scene.poses(body)[:3, 3]
    many, place = np.stack([clear, hit] * 500), scene.poses(body)
    assert not scene.overlaps_any(links, clear) and scene.overlaps_any(links, hit)
    return [
        ("scene.overlaps, apart", least(lambda: scene.overlaps(link, clear[0]), 1000)),
        ("scene.overlaps, one", least(lambda: scene.overlaps(link, hit[5]), 1000)),
        ("scene.overlaps_any of 11 links, apart", least(lambda: scene.overlaps_any(links, clear), 1000)),
        ("scene.overlaps_any of 11 links, the sixth meets", least(lambda: scene.overlaps_any(links, hit), 1000)),
        ("of 11 links in 1000 configurations, each", least(lambda: scene.overlaps_any(links, many), 2) / 1000),
        ("scene.set_poses, one body", least(lambda: scene.set_poses(body, place), 1000)),
        (
            "scene.set_poses and overlaps",
            least(lambda: (scene.set_poses(body, place), scene.overlaps(link, place)), 500),
        ),
    ]


def main() -> None:
    mesh = trimesh.creation.torus(1, 0.4, major_sections=64, minor_sections=32)
    shape = rc.Shape(mesh)
    here, apart, near = np.eye(4), rc.pose([3, 0, 0]), rc.pose([0.5, 0, 0])
    point = np.array([3.0, 0, 0])
    print(f"two tori of {len(mesh.faces)} triangles | us\n---|---")
    for name, question in (
        ("intersects, apart", lambda: rc.intersects(shape, shape, here, apart)),
        ("intersects, they do", lambda: rc.intersects(shape, shape, here, near)),
        ("distance", lambda: rc.distance(shape, shape, here, apart)),
        ("closest_point", lambda: rc.closest_point(shape, point, here)),
        ("contains", lambda: rc.contains(shape, point, here)),
        ("raycast", lambda: rc.raycast(shape, point, [-1, 0.1, 0.03], here)),
        ("signed_distance", lambda: rc.signed_distance(shape, point, here)),
        ("collide, apart", lambda: rc.collide(shape, shape, here, apart)),
    ):
        print(f"{name} | {least(question, 1000):.1f}", flush=True)
    for name, time in scene_of_boxes():
        print(f"{name} | {time:.1f}", flush=True)
    for name, manager in (("raycontact", CollisionManager), ("trimesh with FCL", trimesh.collision.CollisionManager)):
        try:
            time, found = configuration(manager)
            print(f"a configuration, {name} | {time:.1f} ({found} of 300 collide)", flush=True)
        except ValueError as error:  # trimesh without FCL
            print(f"a configuration, {name} | - ({error})")


if __name__ == "__main__":
    main()
