# SPDX-License-Identifier: Apache-2.0
"""A robot arm that reaches into a shelf: what each link meets on its way, a way that is free, and how much room it has.

python arm.py [--tries N] [--picture arm.png] [--page arm.html]
"""

from __future__ import annotations

import numpy as np
import parts
import picture
import raycontact as rc

LINKS = ("turret", "upper arm", "forearm", "hand")
LENGTHS = (0.3, 0.5, 0.4)
"""Metres from each joint to the next: floor to shoulder, to elbow, to wrist."""
START = np.radians((-100.0, 20.0, 70.0, 30.0))
GOAL = np.radians((0.0, 68.0, 34.0, -12.0))
LIMITS = np.radians([(-170, -60, -20, -110), (170, 110, 150, 110)])
MARGIN = 0.002
"""Metres that links keep from everything."""


def links() -> list[rc.Mesh]:
    """Along z, from the joint that each turns about."""
    up = rc.turn((1, 0, 0), np.pi / 2)  # a bracket opens towards +y, the hand towards +z
    hand = parts.bracket(width=0.1, height=0.14, wall=0.012, thick=0.05)
    made = [
        parts.ring(0.03, 0.09, 0.2),
        parts.bracket(width=0.09, height=0.06, wall=0.01, thick=0.5),
        parts.ring(0.022, 0.035, 0.4),
        rc.Mesh(hand.vertices @ up[:3, :3].T, hand.triangles),
    ]
    middles = (0.1, 0.25, 0.2, 0.03)
    return [
        rc.Mesh(mesh.vertices + (0, -0.03 * (name == "upper arm"), z), mesh.triangles, name=name)
        for name, mesh, z in zip(LINKS, made, middles)
    ]


def link_poses(joints: np.ndarray) -> np.ndarray:
    """(links, ..., 4, 4) of joint angles (..., 4), radians: the turret turns about z, the others about y."""
    at = rc.turn((0, 0, 1), joints[..., 0])
    poses = [at]
    for k, length in enumerate(LENGTHS, 1):
        at = at @ rc.slide((0, 0, 1), length) @ rc.turn((0, 1, 0), joints[..., k])
        poses.append(at)
    return np.stack(poses)


def shelf() -> list[rc.AssemblyPart]:
    """Two sides, a back and four boards, half a metre before the arm."""
    sizes = {"left side": (0.4, 0.02, 1.6), "right side": (0.4, 0.02, 1.6), "back": (0.02, 0.96, 1.6)}
    places = {"left side": (0.85, 0.47, 0.8), "right side": (0.85, -0.47, 0.8), "back": (1.07, 0, 0.8)}
    for k in range(4):
        sizes[f"board {k + 1}"], places[f"board {k + 1}"] = (0.4, 0.92, 0.02), (0.85, 0, 0.1 + 0.45 * k)
    return [rc.AssemblyPart(name, rc.box(size), rc.pose(places[name])) for name, size in sizes.items()]


def path(start: np.ndarray, end: np.ndarray, steps: int = 96) -> np.ndarray:
    """(..., steps + 1, 4): joint angles in proportion.

    Between two poses a link goes by a screw, not by its joints: with so many steps less than half the MARGIN beside."""
    return np.moveaxis(np.linspace(start, end, steps + 1), 0, -2)


class Cell:
    """The arm and what it may meet: the shelf, and links that are no neighbours."""

    def __init__(self) -> None:
        self.links = [rc.Shape(mesh) for mesh in links()]
        self.shelf = shelf()
        boards = [rc.Shape(board.mesh) for board in self.shelf]
        self.names = [(link, board.name) for link in LINKS for board in self.shelf]
        self.a = [link for link in self.links for _ in boards]
        self.b = boards * len(self.links)
        self.own = [(i, k) for i in range(len(LINKS)) for k in range(i + 2, len(LINKS))]
        self.names += [(LINKS[k], LINKS[i]) for i, k in self.own]
        self.a += [self.links[k] for _, k in self.own]
        self.b += [self.links[i] for i, _ in self.own]

    def of_link(self, link: str) -> np.ndarray:
        """(pairs,) bool: whether the pair is of that link."""
        return np.array([name == link for name, _ in self.names])

    def ways(self, joints: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of angles (..., n, 4) the poses of all pairs, (..., pairs, n, 4, 4)."""
        of_links = np.moveaxis(link_poses(joints), 0, -4)
        of_shelf = np.stack([board.pose for board in self.shelf])[:, np.newaxis]
        first = np.repeat(of_links, len(self.shelf), axis=-4)
        second = np.broadcast_to(np.concatenate([of_shelf] * len(LINKS)), first.shape)
        near, far = (of_links[..., [pair[side] for pair in self.own], :, :, :] for side in (0, 1))
        return np.concatenate((first, far), axis=-4), np.concatenate((second, near), axis=-4)

    def impact(self, joints: np.ndarray) -> rc.Impact:
        """When each pair comes as near as the margin first, in steps; (..., pairs) of angles (..., n, 4).

        A planner asks for its minimum: an edge is free where that is inf, and else as far as told."""
        return rc.time_of_impact(self.a, self.b, *self.ways(joints), distance=MARGIN)

    def clearance(self, joints: np.ndarray) -> rc.PathClearance:
        """The least distance of each pair on the way, to a tenth of a millimetre."""
        return rc.path_clearance(self.a, self.b, *self.ways(joints), tolerance=1e-4)


def joints_at(joints: np.ndarray, time: float) -> np.ndarray:
    """Of a path (n, 4), at a time from 0 to n - 1."""
    return np.array([np.interp(time, range(len(joints)), joint) for joint in joints.T])


def degrees(joints: np.ndarray) -> str:
    return " ".join(f"{angle:6.1f}" for angle in np.degrees(joints))


def main() -> None:
    parser = picture.options(__doc__)
    parser.add_argument("--tries", type=int, default=64, help="configurations that a way may lead through")
    options = parser.parse_args()
    cell = Cell()

    straight = path(START, GOAL)
    met = cell.impact(straight)
    share = min(met.time.min() / (len(straight) - 1), 1)
    print(f"straight from start to goal: free for {100 * share:.1f} % of the way")
    for link in LINKS:
        pair = int(np.argmin(np.where(cell.of_link(link), met.time, np.inf)))
        where = f"meets {cell.names[pair][1]:<10} with joints at {degrees(joints_at(straight, met.time[pair]))} deg"
        print(f"  {link:<10} {where if np.isfinite(met.time[pair]) else 'meets nothing'}")

    # Ways through a random configuration: both halves of all of them in one call.
    rng = np.random.default_rng(3)
    through = rng.uniform(*LIMITS, (options.tries, 4))
    halves = np.stack((path(START, through), path(through, GOAL)))
    free = np.isinf(cell.impact(halves).time).all(axis=(0, -1))
    print(f"{free.sum()} of {options.tries} ways through a random configuration are free")
    if not free.any():
        return

    # Of these the shortest; then how much room it leaves, link by link.
    turns = np.abs(np.diff(halves, axis=-2)).max(axis=-1).sum(axis=(0, -1))
    best = int(np.argmin(np.where(free, turns, np.inf)))
    way = np.concatenate((halves[0, best], halves[1, best, 1:]))
    room = cell.clearance(way)
    print(f"the shortest of them, through joints at {degrees(through[best])} deg:")
    least = [int(np.argmin(np.where(cell.of_link(link), room.distance, np.inf))) for link in LINKS]
    for link, pair in zip(LINKS, least):
        where = f"{1e3 * room.distance[pair]:6.1f} mm from {cell.names[pair][1]:<10}"
        print(f"  {link:<10} {where} with joints at {degrees(joints_at(way, room.time[pair]))} deg")

    some = [0, len(way) // 4, len(way) // 2, len(way) - 1]
    scene = rc.Scene()
    static = scene.add([rc.Shape(board.mesh) for board in cell.shelf[3:]], [board.pose for board in cell.shelf[3:]])
    for joints in way[some]:
        scene.add(cell.links, link_poses(joints))
    scene.find_contacts(np.empty((0, 2), int))  # arms at several times at once
    if options.picture:
        colours = [picture.GREY] * len(static) + [k for k in range(len(some)) for _ in LINKS]
        picture.save(
            options.picture, picture.draw(scene, np.array((-0.9, -2.2, 1.6)), np.array((0.5, 0, 0.75)), colours)
        )
    if options.page:
        rc.show(scene, out=options.page, static=static)


if __name__ == "__main__":
    main()
