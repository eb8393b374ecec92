# SPDX-License-Identifier: Apache-2.0
"""Meshes that are made by formula are what they say."""

import brute_force
import helpers
import numpy as np
import pytest
import raycontact as rc

SAMPLES = rc.samples()


@pytest.mark.parametrize("name", SAMPLES)
def test_samples_are_solids_good_for_contacts(name):
    mesh = SAMPLES[name]
    shape = rc.Shape(mesh)
    assert mesh.name == name and shape.report.good and shape.report.kind == "solid", shape.report
    assert shape.report.components == 1 and shape.has_inside
    if name != "mug":
        assert shape.report.repairs == [] and rc.Shape(mesh, repair=False).report.good
    assert 0.005 < np.ptp(shape.box, axis=0).min() and np.ptp(shape.box, axis=0).max() < 0.15
    faces = brute_force.triangles_of(shape)
    normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    above = np.max(normals @ shape.vertices.T - np.sum(normals * faces[:, 0], axis=1)[:, None], axis=1)
    assert (above / np.linalg.norm(normals, axis=1)).max() > 0.0005, "it is convex"
    points = np.random.default_rng(1).uniform(*shape.box, (60, 3))
    inside = brute_force.winding(points, faces) > 0.5
    assert inside.any() and not inside.all() and np.array_equal(rc.contains(shape, points), inside)


def test_samples_are_all_there():
    assert list(SAMPLES) == ["torus", "mug", "knot", "gear", "bolt", "nut"]
    assert rc.Shape(SAMPLES["torus"]).mass.volume == pytest.approx(2 * np.pi**2 * 0.05 * 0.02**2, rel=0.02)
    mug = rc.Shape(SAMPLES["mug"])
    assert not rc.contains(mug, [0, 0, 0.05]) and rc.contains(mug, [0, 0, 0.002]), "it holds something"
    assert rc.contains(mug, [0.068, 0, 0.0475]) and not rc.contains(mug, [0.052, 0, 0.0475]), "its handle is open"
    assert mug.report.volume < sum(s.report.volume for s in (rc.Shape(m) for m in halves(SAMPLES["mug"])))


def halves(mug):
    """Cup and handle."""
    faces = mug.triangles
    cup = faces.max(axis=1) < 4 * 48 + 2
    return rc.Mesh(mug.vertices, faces[cup]), rc.Mesh(mug.vertices, faces[~cup])


def test_the_nut_turns_on_the_bolt():
    bolt, nut = rc.Shape(SAMPLES["bolt"]), rc.Shape(SAMPLES["nut"])
    turns = np.linspace(0, 10, 41)
    angle = 2 * np.pi * turns
    turned = rc.pose_from_quaternion(
        np.c_[np.zeros((41, 2)), 0.0015 * turns], np.c_[np.cos(angle / 2), np.zeros((41, 2)), np.sin(angle / 2)]
    )
    apart = rc.distance(bolt, nut, pose_b=turned).distance
    assert (apart > 1e-5).all() and (apart < 6e-5).all(), "some play"
    # Their threads where they are nearest, by trying everything.
    near = rc.distance(bolt, nut, pose_b=turned[3])
    a, b = brute_force.triangles_of(bolt), brute_force.triangles_of(nut, turned[3])
    a, b = (x[np.linalg.norm(x - near.point_a, axis=2).min(axis=1) < 0.0015] for x in (a, b))
    assert near.distance == pytest.approx(brute_force.distance(a, b), abs=1e-12) and not brute_force.meet(a, b)
    for stuck in (rc.pose([0, 0, 0.00075]), rc.pose([0.0003, 0, 0]), rc.pose([0, 0, 11 * 0.0015])):
        assert rc.intersects(bolt, nut, pose_b=stuck), "neither between the turns, nor aside, nor in the head"


@pytest.mark.parametrize("size", [1, 0.3, (1, 2, 3), np.array([0.1, 5, 1 / 3])])
def test_a_box(size):
    shape, whole = rc.Shape(rc.box(size)), np.broadcast_to(size, 3).astype(float)
    assert shape.report.good and shape.mass.volume == pytest.approx(whole.prod())
    assert np.array_equal(shape.box, [-whole / 2, whole / 2]) and len(rc.box(size).triangles) == 12


@pytest.mark.parametrize(("rows", "columns", "cell"), [(2, 2, 1), (7, 4, 0.5), (3, 9, (0.25, 2))])
def test_a_heightfield_is_the_solid_below(rows, columns, cell):
    rng = np.random.default_rng(rows)
    heights, (x, y) = rng.uniform(0, 1, (rows, columns)), np.broadcast_to(cell, 2)
    mesh = rc.heightfield(heights, cell, -0.5)
    shape = rc.Shape(mesh, repair=False)
    assert shape.report.good and shape.report.kind == "solid"
    assert np.array_equal(shape.box[0], [0, 0, -0.5])
    assert shape.box[1] == pytest.approx([(rows - 1) * x, (columns - 1) * y, heights.max()])
    grid = mesh.vertices[: rows * columns].reshape(rows, columns, 3)
    assert np.array_equal(grid[..., 2], heights) and np.array_equal(grid[1, 0], [x, 0, heights[1, 0]])
    # A triangle's prism has its area times the mean of its heights.
    corners = heights[:-1, :-1], heights[1:, :-1], heights[1:, 1:], heights[:-1, 1:]
    mean = (2 * corners[0] + corners[1] + 2 * corners[2] + corners[3]) / 6 + 0.5
    assert shape.mass.volume == pytest.approx(mean.sum() * x * y)
    # Straight down at a place: as the two triangles of its cell have it.
    i, j = rng.integers(rows - 1, size=50), rng.integers(columns - 1, size=50)
    u, v = rng.uniform(0, 1, (2, 50))
    a, b, c, d = (corner[i, j] for corner in corners)
    z = np.where(u > v, a + u * (b - a) + v * (c - b), a + u * (c - d) + v * (d - a))
    hit = rc.raycast(shape, np.c_[(i + u) * x, (j + v) * y, np.full(50, 9.0)], [0, 0, -1])
    assert hit.point[:, 2] == pytest.approx(z, abs=1e-12)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: rc.box(0), "size: 0 is not finite and above 0"),
        (lambda: rc.box([1, 2]), r"size: has shape \(2,\); give one, or 3"),
        (lambda: rc.box("big"), "size"),
        (lambda: rc.box((1, -1, 1)), "above 0"),
        (lambda: rc.heightfield([1, 2], 1, 0), r"heights: has shape \(2,\)"),
        (lambda: rc.heightfield([[1, 2]], 1, 0), "at least 2"),
        (lambda: rc.heightfield([[1, 2], [3, np.nan]], 1, 0), "finite"),
        (lambda: rc.heightfield([[1, 2], [3, 0]], 1, 0), "not above the floor at 0"),
        (lambda: rc.heightfield([[1, 2], [3, 4]], 0, 0), "cell"),
        (lambda: rc.heightfield([[1, 2], [3, 4]], (1, 2, 3), 0), "cell"),
        (lambda: rc.heightfield([[1, 2], [3, 4]], 1, "low"), "floor"),
    ],
)
def test_sizes_that_make_no_sense_are_told(make, says):
    with pytest.raises(rc.InputError, match=says):
        make()


def test_samples_meet_each_other():
    gear, torus = rc.Shape(SAMPLES["gear"]), rc.Shape(SAMPLES["torus"])
    for pose in helpers.random_poses(6, 0.08):
        true = brute_force.meet(brute_force.triangles_of(gear), brute_force.triangles_of(torus, pose))
        assert rc.intersects(gear, torus, pose_b=pose) == true == (len(rc.collide(gear, torus, pose_b=pose)) > 0)
