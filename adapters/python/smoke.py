# SPDX-License-Identifier: Apache-2.0
"""A wheel works where there is nothing but NumPy: each kind of call once, with answers that are known."""

import pickle
import sys

import numpy as np
import raycontact as rc

CORNERS = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
FACES = [
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
]  # fmt: skip


def main() -> None:
    cube = rc.Shape(rc.Mesh(CORNERS, FACES, name="cube"))
    assert cube.report.good and cube.mass.volume == 1, cube.report
    beside = rc.pose([[0.75, 0.25, 0.125], [3, 0, 0]])
    assert rc.intersects(cube, cube, pose_b=beside).tolist() == [True, False]
    assert rc.distance(cube, cube, pose_b=beside).distance.tolist() == [0, 2]
    contacts = rc.collide(cube, cube, pose_b=beside[0])
    assert len(contacts) and abs(contacts.depth.max() - 0.25) < 1e-6, contacts
    assert np.allclose(contacts.point_a - contacts.point_b, contacts.depth[:, None] * contacts.normal, atol=1e-6)
    scene = rc.Scene(threads=2)
    ids = scene.add(cube, beside)
    for step in range(3):
        scene.set_poses(ids, rc.pose([[0.5 * step, 0, 0], [2, 0, 0]]))
        scene.find_contacts()
    assert len(scene.contacts) == 0 and scene.raycast([5, 0.5, 0.5], [-1, 0, 0]).distance == 2
    try:
        rc.Mesh(CORNERS, [[0, 1, 8]])
    except ValueError as error:
        assert "8" in str(error)
    else:
        raise AssertionError("a vertex that does not exist was taken")
    nut, bolt = (rc.Shape(rc.samples()[name]) for name in ("nut", "bolt"))
    assert nut.report.good and 0 < rc.distance(bolt, pickle.loads(pickle.dumps(nut))).distance < 1e-4
    assert scene.overlaps_any([cube, cube], beside) is True
    devices = ", ".join(device.id for device in rc.list_devices() if device.usable)
    versions = f"Python {sys.version.split()[0]}, NumPy {np.__version__}"
    print(f"raycontact {rc.__version__} works on {versions}; devices: {devices}")


main()
