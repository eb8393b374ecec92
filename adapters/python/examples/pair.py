# SPDX-License-Identifier: Apache-2.0
"""Two concave meshes: their contacts, how deep they are, and how far apart the meshes are once one is moved.

python pair.py [A B] [--picture pair.png] [--page pair.html]
"""

from __future__ import annotations

import numpy as np
import parts
import picture
import raycontact as rc

BESIDE = rc.pose((0.15, 0.0, 0.0))
APART = rc.pose((0.28, 0.02, 0.01))


def meshes() -> list[rc.Mesh]:
    return [parts.gear(), parts.knot()]


def main() -> None:
    parser = picture.options(__doc__)
    parser.add_argument("files", nargs="*", help="two meshes in metres instead of a gear and a knot")
    options = parser.parse_args()
    if len(options.files) not in (0, 2):
        parser.error("give two files, or none")
    a, b = shapes = [rc.Shape(mesh) for mesh in options.files or meshes()]
    for shape in shapes:
        print(f"{shape.name}: {shape.report.triangles} triangles, {shape.report.verdict}")
    place = np.eye(4) if options.files else BESIDE

    contacts = rc.collide(a, b, pose_b=place)
    print(f"intersect: {rc.intersects(a, b, pose_b=place)}, {len(contacts)} contacts")
    if len(contacts):
        deepest = contacts[[np.argmax(contacts.depth)]]
        print(f"deepest: {1e3 * deepest.depth[0]:.4f} mm at {_row(1e3 * deepest.point_a[0])} mm")
        print(f"normal from {a.name} to {b.name}: {_row(deepest.normal[0])}")
        # Depth is measured between two witness points.
        wrong = contacts.point_a - contacts.point_b - contacts.depth[:, None] * contacts.normal
        print(f"point_a - point_b is depth x normal to {np.abs(wrong).max():.0e} m")

    apart = place if options.files else APART
    near = rc.distance(a, b, pose_b=apart)
    print(f"distance: {1e3 * near.distance:.6f} mm, from {_row(1e3 * near.point_a)} to {_row(1e3 * near.point_b)} mm")

    scene = rc.Scene()
    scene.add(shapes, np.stack((np.eye(4), place)))
    scene.find_contacts()
    if options.picture:
        picture.save(options.picture, picture.draw(scene, *picture.look(scene), np.arange(2)))
    if options.page:
        rc.show(scene, out=options.page)


def _row(numbers: np.ndarray) -> str:
    return "(" + ", ".join(f"{x:.3f}" for x in numbers) + ")"


if __name__ == "__main__":
    main()
