# SPDX-License-Identifier: Apache-2.0
"""Wrenches that contacts can give to a body."""

import numpy as np
import pytest
import raycontact as rc


def test_a_cone_has_its_friction_and_its_torques():
    rng = np.random.default_rng(3)
    points, normals = rng.normal(size=(50, 3)), rng.normal(size=(50, 3))
    unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    cone = rc.wrench_cone(points, normals, 0.3, edges=7, origin=(1, 2, 3), length=0.5)
    assert cone.shape == (50, 7, 6)
    force, torque = cone[..., :3], cone[..., 3:]
    along = np.einsum("nek,nk->ne", force, unit)
    assert np.allclose(along, 1) and np.allclose(force.mean(axis=1), unit)
    assert np.allclose(np.linalg.norm(force - unit[:, None], axis=-1), 0.3)
    assert np.allclose(torque * 0.5, np.cross((points - (1, 2, 3))[:, None], force))
    one = rc.wrench_cone(points[4], normals[4], 0.3, edges=7, origin=(1, 2, 3), length=0.5)
    assert np.array_equal(one, cone[4])
    assert np.allclose(rc.wrench_cone(points, (0, 0, 1), 0.0, edges=3)[:, :, :3], (0, 0, 1))


def test_a_held_box_holds():
    """By faces of pads a box is held in any way; by a point on each side it turns about the line between them."""
    hull = pytest.importorskip("scipy.spatial").ConvexHull
    box, pad = rc.Shape(rc.box((0.1, 0.1, 0.1))), rc.Shape(rc.box((0.02, 0.06, 0.06)))
    poses = rc.pose([[-0.0599, 0, 0], [0.0599, 0, 0]])
    contacts = rc.collide(pad, box, poses, max_contacts_per_pair=4)
    cones = rc.wrench_cone(contacts.point_b, contacts.normal, 0.5, length=0.1)
    assert hull(cones.reshape(-1, 6)).equations[:, -1].max() < -0.05
    points = rc.wrench_cone([[-0.05, 0, 0], [0.05, 0, 0]], [[1, 0, 0], [-1, 0, 0]], 0.5, length=0.1)
    assert np.allclose(points[..., 3], 0), "no torque about the line between the points"


@pytest.mark.parametrize(
    "words, given",
    [
        ("zero", {"normals": (0, 0, 0)}),
        ("zero or not finite", {"normals": (0, np.nan, 1)}),
        ("friction", {"friction": -0.1}),
        ("edges", {"edges": 2}),
        ("length", {"length": 0}),
        ("fit", {"points": np.zeros((2, 3)), "normals": np.ones((3, 3))}),
    ],
)
def test_what_is_not_sound_is_refused(words, given):
    with pytest.raises(rc.InputError, match=words):
        rc.wrench_cone(**{"points": (0, 0, 0), "normals": (0, 0, 1), **given})
