# SPDX-License-Identifier: Apache-2.0
"""Queries from Python, of one and of many: answers are true, and batches have those of each."""

import warnings

import helpers
import meshes
import numpy as np
import pytest
import raycontact as rc

RNG = np.random.default_rng(47)


def test_contacts_of_two_boxes_are_where_they_overlap():
    box = rc.Shape(rc.Mesh(*meshes.box()))
    contacts = rc.collide(box, box, pose_b=rc.pose([0.9, 0.05, 0.02]))
    assert len(contacts) and contacts.depth.max() == pytest.approx(0.1, abs=1e-6)
    deepest = contacts.deepest()
    assert len(deepest) == 1 and np.allclose(contacts.normal, [1, 0, 0])
    assert np.allclose(contacts.point_a - contacts.point_b, contacts.depth[:, None] * contacts.normal, atol=1e-6)
    assert (contacts.pair == 0).all() and len(np.unique(contacts.key)) == len(contacts)


def test_a_body_inside_another_is_found():
    big, small = (rc.Shape(rc.Mesh(*meshes.box(size))) for size in ((4, 4, 4), (1, 1, 1)))
    assert rc.intersects(big, small) and rc.distance(big, small).distance == 0
    contacts = rc.collide(big, small)
    assert len(contacts) and (contacts.depth >= 1.5 - 1e-6).any()


def test_many_questions_have_the_answers_of_each(torus, bracket):
    n = 60
    pose_a, pose_b = helpers.random_poses(n, 1.2), helpers.random_poses(n, 1.2)
    shapes = [(torus, bracket)[i % 2] for i in range(n)]
    hits = rc.intersects(shapes, torus, pose_a, pose_b)
    far = rc.distance(shapes, torus, pose_a, pose_b)
    points = rc.common_point(shapes, torus, pose_a, pose_b)
    found = rc.collide(shapes, torus, pose_a, pose_b)
    assert 5 < hits.sum() < n - 5, "a test of both answers"
    for i in range(n):
        one = (shapes[i], torus, pose_a[i], pose_b[i])
        assert rc.intersects(*one) == hits[i] == (far.distance[i] == 0) == np.isfinite(points[i]).all()
        single = rc.distance(*one)
        assert single.distance == far.distance[i] and np.array_equal(single.point_b, far.point_b[i])
        assert np.linalg.norm(far.point_a[i] - far.point_b[i]) == pytest.approx(far.distance[i], abs=1e-12)
        contacts, mine = rc.collide(*one), found[found.pair == i]
        assert np.array_equal(contacts.key, mine.key) and np.array_equal(contacts.depth, mine.depth)
        assert np.array_equal(contacts.point_a, mine.point_a)
        assert bool(len(mine)) == hits[i], "no closed meshes intersect unnoticed"


def test_distances_are_those_of_points_on_the_triangles(torus, bracket):
    """No point of one mesh is nearer to the other than the distance; the witness points lie on the named triangles."""
    for pose in helpers.random_poses(20, 3):
        found = rc.distance(torus, bracket, pose_b=pose)
        if found.distance == 0:
            continue
        corners = helpers.placed(bracket.vertices, pose)
        near = rc.closest_point(torus, corners)
        assert found.distance <= near.distance.min() + 1e-12
        mesh_a, mesh_b = meshes.torus(), meshes.bracket()
        for point, triangle, (vertices, faces), place in (
            (found.point_a, found.triangle_a, mesh_a, np.eye(4)),
            (found.point_b, found.triangle_b, mesh_b, pose),
        ):
            a, b, c = helpers.placed(vertices[faces[triangle]], place)
            share = np.linalg.lstsq(np.c_[b - a, c - a], point - a, rcond=None)[0]
            assert np.allclose(a + share[0] * (b - a) + share[1] * (c - a), point, atol=1e-9)
            assert (share >= -1e-9).all() and share.sum() <= 1 + 1e-9


def test_rays_and_points_of_a_torus(torus):
    angles = RNG.uniform(0, 2 * np.pi, 200)
    inside = np.c_[np.cos(angles), np.sin(angles), np.zeros(200)]
    assert rc.contains(torus, inside * 0.99).all() and not rc.contains(torus, inside * 0.2).any()
    pose = helpers.random_poses(1, 5)[0]
    assert rc.contains(torus, helpers.placed(inside * 0.99, pose), pose).all()
    hit = rc.raycast(torus, [0, 0, 0], inside)
    assert np.allclose(hit.distance, 0.65, atol=0.02) and (hit.triangle >= 0).all()
    assert (np.einsum("ij,ij->i", hit.normal, inside) < 0).all(), "it meets the faces from outside"
    assert rc.raycast_any(torus, [0, 0, 0], inside).all() and not rc.raycast_any(torus, [0, 0, 0], [0, 0, 1])
    miss = rc.raycast(torus, [0, 0, 0], [0, 0, 1])
    assert miss.distance == np.inf and miss.triangle == -1 and np.isnan(miss.point).all()
    assert rc.closest_point(torus, [0, 0, 0], max=0.1).distance == np.inf


def test_what_overlaps_is_parted(torus, bracket):
    n = 40
    poses = helpers.random_poses(n, 1.5)
    found = rc.separation(torus, bracket, pose_b=poses)
    touching = rc.intersects(torus, bracket, pose_b=poses)
    assert 5 < touching.sum() < n and np.array_equal(found.distance < 0, touching)
    assert np.allclose(np.linalg.norm(found.normal, axis=1), 1)
    apart = rc.distance(torus, bracket, pose_b=poses).distance
    assert np.array_equal(found.distance[~touching], apart[~touching])
    away = poses.copy()
    away[:, :3, 3] += np.maximum(-found.distance, 0)[:, None] * found.normal
    assert not rc.intersects(torus, bracket, pose_b=away).any()
    one = rc.separation(torus, bracket, pose_b=poses[3])
    assert isinstance(one.distance, float) and one.distance == found.distance[3]
    # Its gradient: one step further, and the least way out of a box is through its nearest side.
    box = rc.Shape(rc.box((2, 2, 2)))
    deep = rc.separation(box, box, pose_b=rc.pose([1.7, 0.2, 0.1]))
    assert deep.distance == pytest.approx(-0.3, abs=1e-5) and np.allclose(deep.normal, [1, 0, 0], atol=1e-9)
    assert deep.point_a[0] == pytest.approx(1) and deep.point_b[0] == pytest.approx(0.7)


def test_signed_distances_and_grids(torus):
    points = RNG.uniform(-1.5, 1.5, (2000, 3))
    found = rc.signed_distance(torus, points)
    near = rc.closest_point(torus, points)
    assert np.array_equal(np.abs(found.distance), near.distance) and np.array_equal(found.triangle, near.triangle)
    assert np.array_equal(found.distance < 0, rc.contains(torus, points)) and (found.distance < 0).any()
    assert np.allclose(points - found.distance[:, None] * found.gradient, found.point, atol=1e-12)
    # Over batches, of one point, placed.
    assert np.array_equal(rc.signed_distance(torus, points.reshape(20, 100, 3)).distance.ravel(), found.distance)
    assert rc.signed_distance(torus, points[7]).distance == found.distance[7]
    poses = helpers.random_poses(2000, 6)
    placed = np.einsum("nij,nj->ni", poses[:, :3, :3], points) + poses[:, :3, 3]
    assert np.allclose(rc.signed_distance(torus, placed, poses).distance, found.distance, atol=1e-12)

    grid = rc.distance_grid(torus, (12, 10, 7))
    assert grid.shape == (12, 10, 7)
    low, high = torus.box
    corner = [low[0], high[1], low[2] + (high[2] - low[2]) * 3 / 6]
    assert np.isclose(grid[0, -1, 3], rc.signed_distance(torus, corner).distance, atol=1e-12)
    assert rc.distance_grid(torus, (1, 1, 2), low=[0, 0, 0], high=[0, 0, 1])[0, 0, 0] > 0
    with pytest.raises(rc.InputError, match="counts"):
        rc.distance_grid(torus, (0, 2, 2))


def test_holes_are_spanned_where_the_mesh_is_a_solid():
    vertices, faces = meshes.torus()
    holed = np.delete(faces, [3, 200], axis=0)
    shape = rc.Shape(rc.Mesh(vertices, holed))
    assert shape.has_inside and shape.report.holes == 2 and shape.report.spanning == 2
    assert shape.triangle_index[-1] == len(holed) + 1
    assert not rc.Shape(rc.Mesh(vertices, holed), holes="none").has_inside
    two = (np.concatenate([vertices, vertices + [0.3, 0.1, 0.05]]), np.concatenate([faces, faces + len(vertices)]))
    united, left = rc.Shape(rc.Mesh(*two)), rc.Shape(rc.Mesh(*two), overlaps="leave")
    assert united.report.outward and left.report.self_intersecting and len(left.triangles) == 2 * len(faces)
    half = faces[vertices[faces][:, :, 2].max(axis=1) > 0]
    assert not rc.Shape(rc.Mesh(vertices, half)).has_inside
    with pytest.raises(rc.InputError, match="of_solids, of_all or none"):
        rc.Shape(rc.Mesh(vertices, faces), holes="all")


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda s: rc.intersects(s, [s, s], pose_b=np.tile(np.eye(4), (3, 1, 1))), "give as many, or one"),
        (lambda s: rc.intersects([s, None], s), r"a\[1\]"),
        (lambda s: rc.intersects(s, s, pose_b=np.eye(3)), r"pose_b: has shape \(3, 3\)"),
        (lambda s: rc.intersects(s, s, pose_b=np.diag([2, 2, 2, 1.0])), "rigid"),
        (lambda s: rc.intersects(s, s, pose_b=np.diag([-1, 1, 1, 1.0])), "mirrored"),
        (lambda s: rc.intersects(s, s, pose_b=np.eye(4).T + np.eye(4)[::-1] * 3), "last row"),
        (lambda s: rc.collide(s, s, pose_b=rc.pose([[0, 0, 0], [np.nan, 0, 0]])), r"pose_b\[1\]"),
        (lambda s: rc.distance(s, s, max=-1), "max|greatest"),
        (lambda s: rc.distance(s, s, max="far"), "max"),
        (lambda s: rc.distance(s, s, threads=-1), "threads"),
        (lambda s: rc.raycast(s, [0, 0, 0], [0, 0, 0]), "direction"),
        (lambda s: rc.raycast(s, [[0, 0, 0]] * 2, [[0, 0, 1]] * 3), "give as many, or one"),
        (lambda s: rc.intersects([s, s], s, np.tile(np.eye(4), (2, 3, 1, 1))), r"a \(2,\), pose_a \(2, 3\) do not fit"),
        (
            lambda s: rc.intersects(s, s, np.tile(np.eye(4) * [[1], [1], [np.nan], [1]], (2, 3, 1, 1))),
            r"pose_a\[0, 0\]",
        ),
        (lambda s: rc.contains(s, [[0, 0, 0], [0, np.inf, 0]]), "point 1"),
        (lambda s: rc.contains(s, "here"), "points"),
        (lambda s: rc.collide(s, s, direction="sideways"), "sideways"),
        (lambda s: rc.collide(s, s, devices="abacus"), "abacus"),
    ],
)
def test_bad_questions_are_value_errors_that_say_what_is_wrong(torus, ask, says):
    with pytest.raises(ValueError, match=says):
        ask(torus)


def test_links_in_many_poses_have_the_answers_of_each(torus, bracket):
    links, n = [torus, bracket], 7
    offsets = rc.pose([[0, 0, 0], [0.5, 0, 0.2]])
    poses = helpers.random_poses(n, 0.9)[:, None] @ offsets
    hits = rc.intersects(links, torus, poses)
    assert hits.shape == (n, 2) and hits.any() and not hits.all()
    apart = rc.distance(links, torus, poses)
    assert apart.distance.shape == (n, 2) and apart.point_a.shape == (n, 2, 3)
    contacts = rc.collide(links, torus, poses)
    touching = np.zeros((n, 2), bool)
    touching[np.unravel_index(contacts.pair, (n, 2))] = True
    for i in range(n):
        for k, link in enumerate(links):
            assert hits[i, k] == rc.intersects(link, torus, poses[i, k])
            assert apart.distance[i, k] == rc.distance(link, torus, poses[i, k]).distance
            assert touching[i, k] == (len(rc.collide(link, torus, poses[i, k])) > 0)
    points = RNG.uniform(-1, 1, (5, 1, 3))
    near = rc.closest_point(torus, points, poses[:, 0])
    assert near.point.shape == (5, n, 3)
    assert near.distance[3, 2] == rc.closest_point(torus, points[3, 0], poses[2, 0]).distance
    assert rc.contains(torus, points, poses[:, 0]).shape == (5, n)
    assert rc.raycast_any(torus, points, [0, 0, 1]).shape == (5, 1)
    assert rc.intersects(links, torus, np.empty((0, 2, 4, 4))).shape == (0, 2)


def test_no_items_have_no_answers(torus):
    none = np.empty((0, 4, 4))
    assert len(rc.intersects(torus, torus, pose_b=none)) == 0
    assert rc.distance(torus, torus, pose_b=none).point_a.shape == (0, 3)
    assert len(rc.collide(torus, torus, pose_b=none)) == 0
    assert rc.contains(torus, np.empty((0, 3))).shape == (0,)
    assert len(rc.Scene().find_contacts()) == 0 and len(rc.Scene().add(torus, none)) == 0


def test_a_closest_point_at_the_greatest_distance_counts(torus):
    points = RNG.normal(size=(3000, 3)) * 3
    pose = helpers.random_poses(1, 5)[0]
    far = rc.closest_point(torus, points, pose).distance
    again = [rc.closest_point(torus, point, pose, max=most).distance for point, most in zip(points, far)]
    assert np.array_equal(again, far)


def test_poses_are_made_and_mended():
    q = RNG.normal(size=(50, 4))
    poses = rc.pose_from_quaternion(RNG.normal(size=(50, 3)), q)
    assert np.allclose(np.einsum("nij,nkj->nik", poses[:, :3, :3], poses[:, :3, :3]), np.eye(3))
    bent = poses.copy()
    bent[:, :3, :3] *= 1.02
    assert np.allclose(rc.nearest_rigid(bent), poses)
    assert rc.pose([1, 2, 3]).tolist() == [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]
    assert rc.pose(np.zeros((5, 3)), np.eye(3)).shape == (5, 4, 4)
    for bad in (
        lambda: rc.pose([1, 2]),
        lambda: rc.pose(rotation=np.eye(4)),
        lambda: rc.pose(np.zeros((2, 3)), np.zeros((3, 3, 3))),
        lambda: rc.pose_from_quaternion([0, 0, 0], [0, 0, 0, 0]),
        lambda: rc.nearest_rigid(np.diag([1, 1, -1, 1])),
    ):
        with pytest.raises(rc.InputError):
            bad()


def test_turns_and_slides_are_about_axes_and_along_ways():
    point, axis = np.array([1.0, 2, 3]), np.array([0.0, 0, 5])
    turns = rc.turn(axis, np.linspace(0, np.pi, 5), point)
    assert turns.shape == (5, 4, 4) and np.allclose(turns[0], np.eye(4))
    assert np.allclose(helpers.placed(np.array([[2.0, 2, 3]]), turns[2]), [[1, 3, 3]])
    for pose in rc.turn(RNG.normal(size=(9, 3)), RNG.normal(size=9), point):
        assert np.allclose(helpers.placed(point[None], pose), point) and np.linalg.det(pose) == pytest.approx(1)
    assert rc.turn((1, 0, 0), 0.5, np.zeros((4, 3))).shape == (4, 4, 4) and rc.turn((1, 0, 0), 0.5).shape == (4, 4)
    assert np.array_equal(rc.slide((0, 2, 0), [1, 3]), rc.pose([[0, 1, 0], [0, 3, 0]]))
    assert np.array_equal(rc.slide((0, 0, 1), -2), rc.pose([0, 0, -2]))
    for bad in (
        lambda: rc.turn((0, 0, 0), 1),
        lambda: rc.turn((0, 0, 1), np.nan),
        lambda: rc.turn((0, 0, 1), 1, (0, np.inf, 0)),
        lambda: rc.slide((0, 0), 1),
        lambda: rc.slide([(0, 0, 1), (0, 0, 0)], 1),
    ):
        with pytest.raises(rc.InputError):
            bad()


def test_poses_that_are_no_poses_are_named_as_they_were_given(torus):
    good = rc.pose(np.zeros((4, 3)))
    lost, drifted = good.copy(), good.copy()
    lost[2] = np.nan
    drifted[3, :3, :3] *= 1.001
    with pytest.raises(rc.InputError, match=r"pose_b\[2\]: an entry is not a finite number"):
        rc.distance(torus, torus, pose_b=lost)
    with pytest.raises(rc.InputError, match=r"pose_a\[3\]: not rigid.*nearest_rigid"):
        rc.collide(torus, torus, pose_a=drifted)
    assert (
        "576 triangles" in repr(torus.report)
        and "pairs" in repr(rc.Scene().stats)
        and "cpu" in repr(rc.list_devices()[0])
    )


def given_otherwise(poses):
    """The same poses in each form that is taken."""
    r, t = poses[..., :3, :3], poses[..., :3, 3]
    yield r, t
    yield r.tolist(), t.tolist()
    transform = pytest.importorskip("scipy.spatial.transform")
    if r.ndim <= 3:
        yield transform.Rotation.from_matrix(r), t
    if hasattr(transform, "RigidTransform") and r.ndim <= 3:
        yield transform.RigidTransform.from_matrix(poses)


@pytest.mark.parametrize("lead", [(), (6,), (3, 2)])
def test_rotations_and_translations_are_poses(lead, torus, bracket):
    poses = helpers.random_poses(6, 1.2).reshape(3, 2, 4, 4)[(0, 0) if not lead else ...].reshape(*lead, 4, 4)
    points = RNG.uniform(-1, 1, (*lead, 3))
    hits, inside = rc.intersects(torus, bracket, pose_b=poses), rc.contains(torus, points, poses)
    far, contacts = rc.distance(torus, bracket, poses), rc.collide(torus, bracket, poses)
    scene = rc.Scene()
    ids = scene.add(torus, poses.reshape(-1, 4, 4))
    for given in given_otherwise(poses):
        assert np.allclose(rc.distance(torus, bracket, given).distance, far.distance, atol=1e-12)
        assert np.array_equal(rc.intersects(torus, bracket, pose_b=given), hits)
        assert np.array_equal(rc.contains(torus, points, given), inside)
        assert np.allclose(rc.collide(torus, bracket, given).depth, contacts.depth, atol=1e-6)
        assert np.allclose(rc.nearest_rigid(given), poses)
        if len(lead) < 2:
            scene.set_poses(ids, np.eye(4))
            scene.set_poses(ids if lead else int(ids[0]), given)
            assert np.allclose(scene.poses(), poses)
            scene.set_next_poses(ids, given)
            assert np.allclose(scene.poses(scene.add(torus, given)), poses)
            scene.remove(scene.ids[len(ids) :])
        if not lead:
            assert np.array_equal(scene.overlaps(bracket, given), scene.overlaps(bracket, poses))
            manager = rc.CollisionManager()
            manager.add_object("torus", torus, given)
            manager.set_transform("torus", given)
            assert manager.min_distance_single(bracket) == pytest.approx(far.distance, abs=1e-12)
    # One rotation for all, and the other way about.
    if lead == (6,):
        r, t = poses[0, :3, :3], poses[:, :3, 3]
        assert np.array_equal(rc.intersects(torus, bracket, (r, t)), rc.intersects(torus, bracket, rc.pose(t, r)))
        assert np.array_equal(rc.intersects(torus, bracket, (poses[:, :3, :3], t[0])),
                              rc.intersects(torus, bracket, rc.pose(t[0], poses[:, :3, :3])))  # fmt: skip


def test_two_poses_in_a_tuple_are_two_poses(torus):
    two = tuple(rc.pose([[0, 0, 0], [9, 0, 0]]))
    assert rc.intersects(torus, torus, pose_b=two).tolist() == [True, False]


@pytest.mark.parametrize(
    ("pose", "says"),
    [
        (np.eye(3), r"pose_b: has shape \(3, 3\), a rotation alone; give \(R, t\)"),
        (np.tile(np.eye(3), (5, 1, 1)), r"pose_b: has shape \(5, 3, 3\), a rotation alone"),
        ((np.eye(3), np.zeros(4)), r"pose_b: translation: has shape \(4,\)"),
        ((np.tile(np.eye(3), (2, 1, 1)), np.zeros((3, 3))), "pose_b: translations .* do not fit"),
        ((np.diag([1, 1, 1.1]), np.zeros(3)), "pose_b: not rigid"),
        ((np.eye(3), [0, np.nan, 0]), "pose_b: an entry is not a finite number"),
        ((np.eye(3), "here"), "pose_b: translation"),
        ([np.eye(3), np.zeros(3)], "pose_b"),
    ],
)
def test_rotations_and_translations_that_are_no_poses_are_told(torus, pose, says):
    with pytest.raises(rc.InputError, match=says):
        rc.intersects(torus, torus, pose_b=pose)


def test_a_rotation_of_scipy_alone_is_no_pose(torus):
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation.identity()
    with pytest.raises(rc.InputError, match="a rotation alone"):
        rc.intersects(torus, torus, rotation)


def test_contacts_are_records(torus):
    contacts = rc.collide(torus, torus, pose_b=rc.pose([[0.5, 0, 0], [0, 0.6, 0]]))
    assert len(contacts) > 2 and len(list(contacts)) == len(contacts)
    for i, one in enumerate(contacts):
        assert one.depth == one["depth"] == contacts.depth[i] and one.kind == contacts.kind[i]
        for name in ("bodies", "point_a", "point_b", "normal", "indices"):
            assert np.array_equal(getattr(one, name), getattr(contacts, name)[i])
            assert np.shares_memory(getattr(one, name), contacts.data)
        with pytest.raises((ValueError, TypeError)):
            one.depth = 7
    assert not list(rc.collide(torus, torus, pose_b=rc.pose([9, 0, 0]))) and not (contacts.depth == 7).any()


def test_single_questions_have_plain_numbers(torus):
    point, pose = np.array([3.0, 0, 0]), rc.pose([0, 0, 0])
    for make, one, many in (
        (lambda p: rc.distance(torus, torus, pose_b=p), rc.OneDistance, rc.Distance),
        (lambda p: rc.closest_point(torus, point, p), rc.OneClosestPoint, rc.ClosestPoint),
        (lambda p: rc.signed_distance(torus, point, p), rc.OneSignedDistance, rc.SignedDistance),
        (lambda p: rc.raycast(torus, point, [-1, 0, 0], p), rc.OneRayHit, rc.RayHit),
    ):
        for given in (None, pose, pose.tolist()):
            found = make(given)
            assert type(found) is one and isinstance(found, many) and type(found.distance) is float
            assert not hasattr(found, "__dict__") and found._fields == many._fields
        assert type(make(pose[None])) is many
    assert type(rc.intersects(torus, torus)) is type(rc.contains(torus, point)) is bool
    assert type(rc.raycast_any(torus, point, point)) is bool


# Sheets

ASKED = {
    "contains": lambda s: rc.contains(s, np.zeros(3)),
    "contains, many": lambda s: rc.contains(s, [[0, 0, 0]]),
    "signed_distance": lambda s: rc.signed_distance(s, [0, 0, 0]),
    "distance": lambda s: rc.distance(s, s),
    "distance, many": lambda s: rc.distance([s, s], s, pose_b=[np.eye(4)]),
    "distance_grid": lambda s: rc.distance_grid(s, (2, 2, 1)),
}


@pytest.mark.parametrize("asked", ASKED)
def test_sheets_are_told_once(asked, torus):
    vertices, faces = meshes.torus()
    sheet = rc.Shape(rc.Mesh(vertices, faces[::3], name="shell"))
    with pytest.warns(rc.SheetWarning, match=r"the mesh 'shell' has no inside.*border edges.*close it") as told:
        ASKED[asked](sheet)
    assert len(told) == 1 and told[0].filename == __file__ and issubclass(rc.SheetWarning, UserWarning)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for ask in ASKED.values():
            ask(sheet)
            ask(torus)
    with pytest.warns(rc.SheetWarning):
        rc.distance(torus, rc.Shape(rc.Mesh(vertices, faces[::3])))


def test_other_questions_say_nothing_of_sheets(torus):
    vertices, faces = meshes.torus()
    sheet, scene = rc.Shape(rc.Mesh(vertices, faces[::3])), rc.Scene()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rc.collide(sheet, torus), rc.intersects(sheet, torus), rc.raycast(sheet, [0, 0, 5], [0, 0, -1])
        rc.closest_point(sheet, [0, 0, 5])
        scene.add([sheet, torus])
        scene.find_contacts(), scene.overlaps(sheet)


def test_rotations_of_scipy_are_taken():
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation.from_euler("z", 90, degrees=True)
    assert np.allclose(rc.pose([1, 2, 3], rotation), rc.pose_from_quaternion([1, 2, 3], [1, 0, 0, 1]))


def test_patches_and_weighted_contacts_say_how_bodies_press(torus):
    floor = rc.Shape(rc.Mesh(*meshes.box((6, 6, 2)), name="floor"))
    under, over = rc.pose([0, 0, -1]), rc.pose([0.1, 0.2, 0.35 - 0.05])
    patches = rc.contact_patches(floor, [torus, torus], under, np.stack([over, rc.pose([0, 0, 5])]))
    assert set(patches.pair) == {0}
    volume = patches.volume.sum()
    assert volume > 0
    push = (patches.volume[:, None] * patches.normal).sum(axis=0)
    assert push == pytest.approx([0, 0, volume], abs=1e-9)
    assert (patches.centre * patches.volume[:, None]).sum(axis=0)[:2] / volume == pytest.approx([0.1, 0.2], abs=1e-6)
    assert patches.depth == pytest.approx(patches.volume / patches.area)
    assert len(patches.first_corner) == len(patches.pair) + 1 and patches.first_corner[-1] == len(patches.corners)
    for i, normal in enumerate(patches.normal):
        hull, basis = patches.hull(i), patches.wrench_basis(i, [1, 2, 3])
        assert len(hull) >= 3 and (hull - patches.centre[i]) @ normal == pytest.approx(0, abs=1e-9)
        assert (np.cross(np.roll(hull, -1, axis=0) - hull, patches.centre[i] - hull) @ normal > 0).all()
        assert (basis[:, :3] == normal).all()
        assert basis[:, 3:] == pytest.approx(np.cross(hull - [1, 2, 3], normal))
    assert np.array_equal(patches.hull(-1), patches.hull(len(patches.pair) - 1))
    with pytest.raises(IndexError):
        patches.hull(len(patches.pair))
    with pytest.raises(rc.InputError, match="about"):
        patches.wrench_basis(0, [[1, 2, 3]] * 2)
    contacts = rc.collide(floor, torus, under, over, direction="weighted")
    assert set(contacts.kind) == {rc.FeatureKind.FACES}
    assert (contacts.depth * contacts.weight).sum() == pytest.approx(volume, rel=1e-5)
    assert len(set(contacts.key)) == len(contacts)
    sheet = rc.Shape(rc.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    with pytest.raises(rc.InputError, match="no inside"):
        rc.contact_patches(sheet, torus)


# One float64 matrix goes straight to C++; whatever else says the same has the same answer.
def test_plain_arguments_and_others_agree(torus, bracket):
    rng = np.random.default_rng(66)
    for _ in range(20):
        pose, other = helpers.random_poses(2, 1.5)
        point = rng.uniform(-2, 2, 3)
        assert rc.intersects(torus, bracket, pose, other) == rc.intersects(
            torus, bracket, pose.tolist(), other.tolist()
        )
        one, many = rc.distance(torus, bracket, pose, other), rc.distance(torus, bracket, pose.tolist(), other)
        assert one.distance == many.distance and one.triangle_a == many.triangle_a
        assert one.point_a.tolist() == many.point_a.tolist()
        near, listed = rc.closest_point(torus, point, pose), rc.closest_point(torus, point.tolist(), pose)
        assert near.distance == listed.distance and near.point.tolist() == listed.point.tolist()
        forms = (point, point.tolist(), tuple(point), tuple(point.tolist()), point.astype(object).astype(float))
        away = rc.signed_distance(torus, point[None], pose[None])
        hits = rc.raycast(torus, [point, point], [other[0, :3], -other[0, :3]], pose)
        for form in forms:
            assert rc.contains(torus, form, pose) == rc.contains(torus, [form], pose)[0]
            assert rc.closest_point(torus, form, pose).triangle == near.triangle
            signed = rc.signed_distance(torus, form, pose)
            assert [x.tolist() for x in map(np.asarray, signed)] == [x[0].tolist() for x in away]
            for k, along in enumerate((other[0, :3], -other[0, :3])):
                for direction in (along, along.tolist()):
                    hit = rc.raycast(torus, form, direction, pose)
                    assert [repr(x.tolist()) for x in map(np.asarray, hit)] == [repr(x[k].tolist()) for x in hits]
                    assert rc.raycast_any(torus, form, direction, pose) is bool(hit.distance < np.inf)
        assert type(rc.contains(torus, point, pose)) is bool and type(rc.intersects(torus, torus, pose)) is bool
    far = rc.distance(torus, bracket, None, rc.pose([90, 0, 0]), max=1.0)
    assert far.distance == np.inf and np.isnan(far.point_a).all() and far.triangle_a == -1
    assert rc.closest_point(torus, np.array([90.0, 0, 0]), max=1.0).triangle == -1
    for bad, says in ((np.diag([1.0, 1, 2, 1]), "not rigid"), (np.diag([1.0, 1, -1, 1]), "not rigid"),
                      (np.full((4, 4), np.nan), "finite"), (np.eye(4).T + np.eye(4)[::-1], "last row")):  # fmt: skip
        with pytest.raises(rc.InputError, match=says):
            rc.intersects(torus, torus, bad)
    for bad in ([0, 0], (0, 0, "1"), [0, 0, None], [0, 0, np.nan], [0, 0, 10**400], [[0, 0, 1], [0, 0]]):
        for ask in (rc.contains, rc.closest_point, rc.signed_distance, lambda s, p: rc.raycast(s, p, [0, 0, 1]),
                    lambda s, p: rc.raycast_any(s, [0, 0, 1], p)):  # fmt: skip
            with pytest.raises(rc.InputError):
                ask(torus, bad)
