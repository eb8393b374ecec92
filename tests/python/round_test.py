# SPDX-License-Identifier: Apache-2.0
"""Balls and capsules in queries and scenes: closed forms, and answers in batches."""

import copy
import pickle

import helpers
import numpy as np
import pytest
import raycontact as rc
from raycontact.collision import CollisionManager


def test_round_shapes_say_what_they_are():
    ball, capsule, plane = rc.ball(0.5), rc.capsule(0.25, 1), rc.plane()
    assert ball.round.radius == 0.5 and np.array_equal(ball.round.start, ball.round.end)
    assert capsule.round.end.tolist() == [0, 0, 1] and rc.Shape(rc.box()).round is None and plane.round is None
    assert capsule.box.tolist() == [[-0.25, -0.25, -1.25], [0.25, 0.25, 1.25]] and capsule.radius == 1.25
    assert ball.mass.volume == pytest.approx(4 / 3 * np.pi * 0.125, rel=1e-14)
    assert ball.mass.inertia == pytest.approx(0.1 * ball.mass.volume * np.eye(3), rel=1e-14)
    assert capsule.report.volume < capsule.mass.volume, "its mesh is a picture"
    assert plane.box.tolist() == [[-1000, -1000, -10], [1000, 1000, 0]]
    for made in (pickle.loads(pickle.dumps(capsule)), copy.deepcopy(capsule)):
        assert made.round.radius == 0.25 and np.array_equal(made.vertices, capsule.vertices)


def test_queries_of_round_shapes_are_closed_forms():
    ball, capsule = rc.ball(0.5), rc.capsule(0.25, 1)
    poses = helpers.random_poses(200, 2)
    off = poses[:, :3, 3]
    found = rc.distance(ball, capsule, pose_b=poses)
    ends = off[:, None] + poses[:, None, :3, 2] * np.array([-1, 1])[None, :, None]
    along = np.clip(np.einsum("ij,ij->i", -ends[:, 0], poses[:, :3, 2]), 0, 2)
    gap = np.linalg.norm(ends[:, 0] + along[:, None] * poses[:, :3, 2], axis=1) - 0.75
    assert (gap < 0).any() and (gap > 0).any()
    assert np.allclose(found.distance, np.maximum(gap, 0), atol=1e-14)
    assert (found.triangle_a == -1).all() and (found.triangle_b == -1).all()
    assert np.array_equal(rc.intersects(ball, capsule, pose_b=poses), found.distance == 0)
    points = 2 * np.random.default_rng(3).normal(size=(100, 3))
    metres = np.linalg.norm(points, axis=1) - 0.5
    assert np.allclose(rc.signed_distance(ball, points).distance, metres)
    assert np.array_equal(rc.contains(ball, points), metres <= 0)
    assert np.allclose(rc.closest_point(ball, points).distance, np.abs(metres))
    hits = rc.raycast(ball, points, -points)
    assert np.allclose(hits.distance, np.where(metres > 0, metres, 1 + metres)) and (hits.triangle == -1).all()
    one = rc.raycast(ball, [0, 0, 3], [0, 0, -1])
    assert one.distance == 2.5 and one.triangle == -1
    parting = rc.separation(ball, rc.box(2), pose_b=rc.pose([1.25, 0, 0]))
    assert parting.distance == pytest.approx(-0.25, abs=1e-5) and parting.normal == pytest.approx([1, 0, 0], abs=1e-5)
    with pytest.raises(rc.InputError, match="round"):
        rc.contact_patches(ball, rc.box())


def test_round_bodies_have_contacts():
    ball, capsule = rc.ball(0.25), rc.capsule(0.1, 0.5)
    lying = rc.pose([1, 0, 0.09], [[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    scene = rc.Scene(speculative=False)
    ground = scene.add(rc.plane())
    one, other = scene.add(ball, rc.pose([0, 0, 0.24])), scene.add(capsule, lying)
    contacts = scene.find_contacts()
    assert (contacts.kind == rc.FeatureKind.ROUND).all()
    assert contacts.depth == pytest.approx(0.01, abs=1e-6) and contacts.normal == pytest.approx(
        np.tile([0, 0, 1], (3, 1)), abs=1e-6
    )
    assert contacts.bodies.tolist() == [[ground, one], [ground, other], [ground, other]]
    assert sorted(contacts.point_b[1:, 0].tolist()) == pytest.approx([0.5, 1.5])
    assert (contacts.indices[1:, 1] // 27).tolist() == [0, 1], "an end of the axis each"
    assert len(rc.collide(ball, ball, pose_b=rc.pose([0, 0.31, 0.4]))) == 0
    of_two = rc.collide(ball, ball, pose_b=rc.pose([0, 0.24, 0.32]))
    assert of_two.depth == pytest.approx([0.1], abs=1e-6) and of_two.normal[0] == pytest.approx([0, 0.6, 0.8], abs=1e-6)
    assert of_two.indices.tolist() == [[2, 2**32 - 1]]


def test_collision_managers_take_round_shapes():
    manager = CollisionManager()
    manager.add_object("ball", rc.ball(0.5))
    manager.add_object("other", rc.ball(0.5), rc.pose([0.9, 0, 0]))
    manager.add_object("box", rc.Shape(rc.box(1)), rc.pose([0, 0, -0.95]))
    hit, contacts = manager.in_collision_internal(return_data=True)
    assert hit and len(contacts) == 2
    faces = {tuple(sorted(one.names)): one for one in contacts}
    assert faces["ball", "other"].index("ball") == faces["ball", "other"].index("other") == -1
    assert faces["ball", "box"].index("ball") == -1 and 0 <= faces["ball", "box"].index("box") < 12


def test_scenes_answer_with_round_shapes():
    scene = rc.Scene()
    ground, block = scene.add(rc.plane()), scene.add(rc.box(1), rc.pose([3, 0, 0.4]))
    ball = rc.ball(0.25)
    assert scene.overlaps(ball, rc.pose([0, 0, 0.3])).tolist() == []
    assert scene.overlaps(ball, rc.pose([2.4, 0, 0.2])).tolist() == [ground, block]
    met = scene.sweep(ball, rc.pose([0, 0, 0.5]), rc.pose([4, 0, 0.5]))
    assert met.body == block and met.time == pytest.approx((2.5 - 0.25) / 4, abs=1e-6)


@pytest.mark.parametrize(
    "make", [lambda: rc.ball(0), lambda: rc.ball(np.nan), lambda: rc.ball("big"), lambda: rc.capsule(1, -1),
             lambda: rc.plane(1, 0)]
)  # fmt: skip
def test_bad_measures_are_refused(make):
    with pytest.raises(rc.InputError, match="radius|half|thickness"):
        make()


def test_what_takes_meshes_alone_refuses_round_shapes():
    ball = rc.ball(0.1)
    for ask in (
        lambda: rc.clash([ball, ball]),
        lambda: rc.clash_along([ball, ball], "*", np.eye(4)[None]),
        lambda: rc.Shape(ball),
        lambda: rc.Shape(ball, scale=2),
    ):
        with pytest.raises(rc.InputError, match="round"):
            ask()
    assert len(rc.Mesh(ball).faces) > 100, "a picture, by name"
