# SPDX-License-Identifier: Apache-2.0
"""The signed distance to a part on a grid, for a gripper that closes around it: how far, and where it touches first.

python gripper.py [PART] [--cells N] [--picture field.png] [--page gripper.html]
"""

from __future__ import annotations

import numpy as np
import parts
import picture
import raycontact as rc


def grid(shape: rc.Shape, cells: int) -> np.ndarray:
    """(cells, cells, 3): points of the plane z = 0 around a shape, first row at the greatest y."""
    half = 1.3 * np.abs(shape.box[:, :2]).max()
    line = np.linspace(-half, half, cells)
    x, y = np.meshgrid(line, line[::-1])
    return np.stack((x, y, np.zeros_like(x)), axis=-1)


def fingers(opening: float) -> np.ndarray:
    """(2, 4, 4): where both fingers are when their pads are `opening` metres apart along x."""
    left = rc.pose((-opening / 2, 0, 0))
    right = rc.pose((opening / 2, 0, 0), np.diag((-1.0, -1.0, 1.0)))  # turned by half a turn
    return np.stack((left, right))


def main() -> None:
    parser = picture.options(__doc__)
    parser.add_argument("part", nargs="?", help="a closed mesh in metres instead of a knot")
    parser.add_argument("--cells", type=int, default=160)
    options = parser.parse_args()
    part = rc.Shape(options.part or parts.knot())
    finger = rc.Shape(parts.pad())
    if not part.has_inside:
        raise SystemExit(f"{part.name}: {part.report.verdict}")

    points = grid(part, options.cells)
    field = rc.signed_distance(part, points).distance
    cell = points[0, 1, 0] - points[0, 0, 0]
    print(f"{field.size} distances to {part.name}: {1e3 * field.min():.3f} to {1e3 * field.max():.3f} mm")
    print(f"inside: {1e4 * (field < 0).sum() * cell**2:.2f} cm^2 of the plane z = 0")

    # Pads that are open wide close until the first one touches.
    wide = 4 * part.radius
    paths = np.stack((fingers(wide), fingers(0.0)), axis=1)
    opening = wide * (1 - rc.time_of_impact(finger, part, paths).time.min())
    near = rc.distance(finger, part, pose_a=fingers(opening))
    side = int(np.argmin(near.distance))
    where = ", ".join(f"{1e3 * x:.3f}" for x in near.point_b[side])
    first, other = ("left", "right")[side], 1e3 * near.distance.max()
    print(f"closed to {1e3 * opening:.3f} mm; the {first} pad touches first, at ({where}) mm")
    print(f"the other pad is {other:.3f} mm away; intersect: {rc.intersects(finger, part, fingers(opening)).any()}")

    if options.picture:
        picture.save(options.picture, picture.heat(field).repeat(3, axis=0).repeat(3, axis=1))
    if options.page:
        scene = rc.Scene(speculative=True, speculative_margin=1e-3)
        ids = scene.add([part, finger, finger], np.concatenate((np.eye(4)[None], fingers(opening))))
        scene.find_contacts()
        rc.show(scene, out=options.page, static=ids[1:])


if __name__ == "__main__":
    main()
