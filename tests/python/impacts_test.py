# SPDX-License-Identifier: Apache-2.0
"""When moving meshes meet: of one, of many, along paths, and among the bodies of a scene."""

import helpers
import numpy as np
import pytest
import raycontact as rc

RNG = np.random.default_rng(67)


@pytest.fixture(scope="module")
def box():
    return rc.Shape(rc.box((1, 1, 1)))


def test_a_fall_is_met_where_it_should(box):
    floor = rc.Shape(rc.box((10, 10, 1)))
    met = rc.time_of_impact(box, floor, [rc.pose([0, 0, 3]), rc.pose([0, 0, -1])])
    assert isinstance(met.time, float) and isinstance(met.triangle_a, int)
    assert met.time == pytest.approx(0.5, abs=1e-6) and met.time <= 0.5
    assert np.allclose(met.normal, [0, 0, -1]) and 0 < met.distance < 1e-6
    assert met.point_a[2] == pytest.approx(0.5, abs=1e-6) and met.point_b[2] == pytest.approx(0.5, abs=1e-9)
    near = rc.time_of_impact(box, floor, [rc.pose([0, 0, 3]), rc.pose([0, 0, -1])], distance=0.25, tolerance=1e-3)
    assert 0.436 < near.time <= 0.4375 and 0.25 <= near.distance <= 0.251
    # Both move; a path of three poses, a unit of time each.
    path = [rc.pose([0, 0, 3]), rc.pose([5, 0, 3]), rc.pose([5, 0, 1])]
    rising = [rc.pose([0, 0, 0]), rc.pose([0, 0, 0]), rc.pose([0, 0, 2])]
    assert rc.time_of_impact(box, floor, path, rising).time == pytest.approx(1.5, abs=1e-6)
    apart = rc.time_of_impact(box, floor, path[:2])
    assert apart.time == np.inf and np.isnan(apart.point_a).all() and apart.triangle_b == -1


def test_many_have_the_answers_of_each(torus, bracket):
    n = 60
    paths = np.stack([helpers.random_poses(n, 3) for _ in range(3)], axis=1)
    shapes = [(torus, bracket)[i % 2] for i in range(n)]
    place = helpers.random_poses(n, 1)[:, None]
    many = rc.time_of_impact(shapes, torus, paths, place)
    assert many.time.shape == (n,) and many.point_a.shape == (n, 3)
    assert 5 < np.isfinite(many.time).sum() < n, "a test of both answers"
    for i in range(n):
        one = rc.time_of_impact(shapes[i], torus, paths[i], place[i])
        assert all(np.array_equal(x, y[i], equal_nan=True) for x, y in zip(one, many))
        assert np.array_equal(one.time, rc.time_of_impact(shapes[i], torus, paths[i], place[i, 0]).time)
        if not np.isfinite(one.time):
            continue
        assert one.distance <= 1e-6 and (one.time > 0) == (one.distance > 0)
        assert one.time > 0 or rc.intersects(shapes[i], torus, paths[i, 0], place[i, 0])
    grid = rc.time_of_impact(torus, bracket, paths.reshape(6, 10, 3, 4, 4))
    assert grid.time.shape == (6, 10) and grid.normal.shape == (6, 10, 3)


def test_the_least_distance_on_a_way(torus, bracket):
    n = 12
    paths = np.stack([helpers.random_poses(n, 4) for _ in range(3)], axis=1)
    many = rc.path_clearance(torus, bracket, paths, tolerance=1e-5)
    met = np.isfinite(rc.time_of_impact(torus, bracket, paths).time)
    assert 0 < met.sum() < n and ((many.distance < 1e-6) == met).all() and (many.meet == met).all()
    for i in np.flatnonzero(~met):
        poses = rc.distance(torus, bracket, paths[i])
        assert many.distance[i] <= poses.distance.min() + 1e-9
        one = rc.path_clearance(torus, bracket, paths[i], tolerance=1e-5)
        assert one.distance == many.distance[i] and one.time == many.time[i] and isinstance(one.time, float)
        assert one.meet is False
        assert np.isinf(rc.path_clearance(torus, bracket, paths[i], max=0.9 * one.distance).time)


def test_a_quarter_turn_is_no_short_cut(box):
    """The screw of two poses turns about the hinge; a bar at the end of a chord is not met, one on the arc is."""
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    door = [rc.pose([5, 0, 0]), rc.pose([0, 5, 0], quarter)]
    chord, arc = 5 * np.array([0.5, 0.5, 0]), 5 * np.array([0.5**0.5, 0.5**0.5, 0])
    bar = rc.Shape(rc.box((0.1, 0.1, 3)))
    assert rc.time_of_impact(box, bar, door, rc.pose(chord)).time == np.inf
    met = rc.time_of_impact(box, bar, door, rc.pose(arc))
    assert 0.3 < met.time < 0.5


def test_a_sweep_meets_what_is_first(box):
    scene = rc.Scene()
    ids = scene.add(box, rc.pose([[4, 0, 0], [8, 0, 0], [0, 9, 0], [20, 0, 0]]))
    begin, end = rc.pose([0, 0, 0]), rc.pose([10, 0.2, 0])
    first = scene.sweep(box, begin, end)
    assert first.body == ids[0] and first.time == pytest.approx(0.3, abs=1e-6)
    assert np.allclose(first.normal, [1, 0, 0]) and first.body_point[0] == pytest.approx(3.5)
    every = scene.sweep_all(box, begin, end)
    assert list(every.body) == [ids[0], ids[1]] and np.allclose(every.time, [0.3, 0.7], atol=1e-6)
    assert scene.sweep(box, begin, end, wanted=ids[1:]).body == ids[1]
    far = scene.sweep(box, begin, end, wanted=ids[2:])
    assert far.body == -1 and far.time == np.inf and len(scene.sweep_all(box, begin, end, wanted=ids[2:]).body) == 0
    assert scene.sweep(box, begin, end, distance=0.5).time == pytest.approx(0.25, abs=1e-6)
    many = scene.sweep([box, box], np.stack([begin, begin]), end)
    assert many.time.shape == (2,) and (many.body == ids[0]).all()


@pytest.mark.parametrize(
    "ask, words",
    [
        (lambda b: rc.time_of_impact(b, b, np.zeros((2, 4, 4))), "path_a"),
        (lambda b: rc.time_of_impact(b, b, [np.eye(4)] * 2, [np.eye(4)] * 3), "2 poses and path_b 3"),
        (lambda b: rc.time_of_impact(b, b, np.zeros((0, 4, 4))), "no pose"),
        (lambda b: rc.time_of_impact(b, b, distance=-1), "distance"),
        (lambda b: rc.time_of_impact(b, b, tolerance=np.inf), "tolerance"),
        (lambda b: rc.path_clearance(b, b, max=-1), "distance"),
        (lambda b: rc.time_of_impact([b] * 2, b, [[np.eye(4)] * 2] * 3), "fit together"),
        (lambda b: rc.Scene().sweep(b, np.eye(3), np.eye(4)), "begin"),
        (lambda b: rc.Scene().sweep(b, np.eye(4), np.eye(4), wanted=[3]), "3"),
        (lambda b: rc.Scene().sweep_all(b, np.eye(4), [np.eye(4)] * 2), "end"),
    ],
)
def test_what_is_not_sound_is_refused(box, ask, words):
    with pytest.raises(rc.InputError, match=words):
        ask(box)
