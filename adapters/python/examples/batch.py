# SPDX-License-Identifier: Apache-2.0
"""Ten thousand pairs of concave meshes in one call each: intersects, distance and collide.

python batch.py [--pairs N] [--picture depths.png]
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import parts
import picture
import raycontact as rc


def poses(count: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """(count, 4, 4) of a and of b: turned at random, their middles up to 0.2 m apart."""
    random = np.random.default_rng(seed)
    places = random.uniform(-0.1, 0.1, (2, count, 3))
    return tuple(rc.pose_from_quaternion(places[i], random.normal(size=(count, 4))) for i in (0, 1))


def meshes() -> tuple[rc.Mesh, rc.Mesh]:
    return parts.knot(along=48, around=6), parts.gear()


def main() -> None:
    parser = picture.options(__doc__)
    parser.add_argument("--pairs", type=int, default=10_000)
    options = parser.parse_args()
    a, b = (rc.Shape(mesh) for mesh in meshes())
    print(f"{options.pairs} pairs of {a.name} ({a.report.triangles} triangles) and {b.name} ({b.report.triangles})")
    pose_a, pose_b = poses(options.pairs)

    def timed(ask: Callable[..., Any]) -> Any:
        began = time.perf_counter()
        answer = ask(a, b, pose_a, pose_b)
        print(f"{ask.__name__:<10} {1e6 * (time.perf_counter() - began) / options.pairs:7.1f} microseconds a pair")
        return answer

    meet = timed(rc.intersects)
    gaps = timed(rc.distance).distance
    contacts = timed(rc.collide)

    # The deepest contact of each pair: contacts come pair by pair.
    deepest = np.zeros(options.pairs)
    np.maximum.at(deepest, contacts.pair, contacts.depth)
    touching = (deepest > 0).sum()
    print(f"{meet.sum()} intersect, {(gaps == 0).sum()} have distance 0, {touching} have {len(contacts)} contacts")
    if not meet.all():
        print(f"distance of others: {1e3 * gaps[~meet].mean():.3f} mm on average, {1e3 * gaps.max():.3f} mm at most")
    counts, edges = np.histogram(1e3 * deepest[deepest > 0], bins=8)
    for count, low, high in zip(counts, edges, edges[1:]):
        print(f"  deepest {low:6.2f} to {high:6.2f} mm: {count:5d} {'#' * (40 * count // max(counts.max(), 1))}")
    if options.picture:
        picture.save(options.picture, picture.bars(np.histogram(deepest[deepest > 0], bins=40)[0]))
    if options.page:
        scene = rc.Scene()
        shown = min(options.pairs, 24)
        grid = rc.pose(np.stack((np.arange(shown) % 6 * 0.5, np.arange(shown) // 6 * 0.5, np.zeros(shown)), axis=-1))
        scene.add([a, b] * shown, np.stack((grid @ pose_a[:shown], grid @ pose_b[:shown]), axis=1).reshape(-1, 4, 4))
        scene.find_contacts()
        rc.show(scene, out=options.page)


if __name__ == "__main__":
    main()
