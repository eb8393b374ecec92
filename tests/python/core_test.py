# SPDX-License-Identifier: Apache-2.0
"""Meshes, shapes, scenes and queries from Python: what goes in arrives, what comes out is true."""

import collections
import copy
import fractions
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import zipfile

import meshes
import numpy as np
import pytest
import raycontact as rc

RNG = np.random.default_rng(47)


@pytest.fixture(scope="module")
def torus():
    return rc.Shape(rc.Mesh(*meshes.torus(), name="torus"))


@pytest.fixture(scope="module")
def bracket():
    return rc.Shape(rc.Mesh(*meshes.bracket(), name="bracket"))


def random_poses(n, spread):
    return rc.pose(RNG.uniform(-spread, spread, (n, 3)), meshes.random_rotations(n, RNG))


def same(a, b):
    """Bit by bit, but for the bytes between the fields."""
    return len(a) == len(b) and all(np.array_equal(x, y) for x, y in zip(a.columns().values(), b.columns().values()))


def placed(points, pose):
    return points @ pose[:3, :3].T + pose[:3, 3]


# Meshes


def test_a_mesh_keeps_what_it_is_given():
    vertices, faces = meshes.bracket()
    mesh = rc.Mesh(vertices, faces, name="L")
    assert np.array_equal(mesh.vertices, vertices) and np.array_equal(mesh.triangles, faces) and mesh.name == "L"
    vertices[:] = 0
    assert mesh.vertices.any(), "it has a copy"


def test_a_mesh_is_read_from_files_bytes_and_other_libraries(tmp_path):
    vertices, faces = meshes.torus()
    data = meshes.ascii_stl(vertices, faces)
    (tmp_path / "ring.stl").write_bytes(data)
    for mesh in (
        rc.Mesh(tmp_path / "ring.stl"),
        rc.Mesh(str(tmp_path / "ring.stl")),
        rc.Mesh.from_bytes(data, "stl", "r"),
    ):
        assert len(mesh.triangles) == len(faces)
        assert np.array_equal(mesh.vertices[mesh.triangles].reshape(-1, 3), vertices[faces].reshape(-1, 3))
    trimesh = pytest.importorskip("trimesh")
    other = trimesh.Trimesh(vertices, faces, process=False)
    assert np.array_equal(rc.Mesh(other).vertices, vertices)
    assert rc.Shape(other).report.volume == pytest.approx(other.volume)


def test_a_scale_turns_millimetres_into_metres(tmp_path):
    vertices, faces = meshes.box((1000, 2000, 500))
    (tmp_path / "box.stl").write_bytes(meshes.ascii_stl(vertices, faces))
    for mesh in (rc.Mesh(tmp_path / "box.stl", scale=0.001), rc.Mesh(vertices, faces, scale=0.001)):
        assert rc.Shape(mesh).mass.volume == pytest.approx(1.0)
    assert rc.Mesh(tmp_path / "box.stl", scale=0.001).name == "box.stl"


def loose(vertices, faces, noise):
    """Three corners for each triangle, which differ in their last digits."""
    corners = vertices[faces].reshape(-1, 3)
    return corners + RNG.uniform(-noise, noise, corners.shape), np.arange(len(corners)).reshape(-1, 3)


def test_corners_that_differ_in_their_last_digits_are_welded():
    corners, faces = loose(*meshes.box(), 5e-8)
    assert not rc.Shape(rc.Mesh(corners, faces)).report.closed
    mesh = rc.Mesh(corners * 1000, faces, scale=0.001, weld=1e-6)
    assert len(mesh.vertices) == 36 and mesh.repairs[0].startswith("welded 28 vertices")
    assert np.linalg.norm(mesh.vertices - corners, axis=1).max() < 1e-6
    report = rc.Shape(pickle.loads(pickle.dumps(mesh))).report
    assert report.good and report.vertices == 8 and report.repairs == mesh.repairs
    assert rc.Mesh(mesh, scale=2).repairs == mesh.repairs
    with pytest.raises(rc.InputError, match="cannot be welded by 0 m"):
        rc.Mesh(corners, faces, weld=0)


def test_a_3mf_file_is_an_assembly_in_metres(tmp_path):
    corners, faces = loose(*meshes.box((1000, 1000, 1000)), 5e-5)
    model = (
        '<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
        '<object id="1" name="cube"><mesh><vertices>'
        + "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in corners)
        + "</vertices><triangles>"
        + "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)
        + '</triangles></mesh></object></resources><build><item objectid="1"/>'
        '<item objectid="1" transform="1 0 0 0 1 0 0 0 1 2000 0 0"/></build></model>'
    )
    kind = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    with zipfile.ZipFile(tmp_path / "two.3mf", "w", zipfile.ZIP_DEFLATED) as package:
        package.writestr(
            "_rels/.rels", f'<Relationships><Relationship Type="{kind}" Target="/a.model"/></Relationships>'
        )
        package.writestr("a.model", model)
    parts = rc.load_assembly(tmp_path / "two.3mf", weld=1e-6)
    assert [part.name for part in parts] == ["cube", "cube"] and parts[0].mesh is parts[1].mesh
    assert parts[1].pose[:3, 3] == pytest.approx([2, 0, 0])
    assert rc.Shape(parts[0].mesh).report.volume == pytest.approx(1, abs=1e-6)
    whole = rc.Mesh.from_bytes((tmp_path / "two.3mf").read_bytes(), "3mf")
    assert len(whole.vertices) == 72 and whole.vertices[:, 0].max() == pytest.approx(2.5)


def test_an_assembly_shares_its_meshes(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box(), node_name="part 0", geom_name="box")
    for i in (1, 2):
        scene.graph.update(f"part {i}", geometry="box", matrix=rc.pose([2 * i, 0, 0]))
    scene.export(tmp_path / "three.glb")
    parts = rc.load_assembly(tmp_path / "three.glb")
    assert sorted(part.name for part in parts) == ["part 0", "part 1", "part 2"]
    assert parts[0].mesh is parts[1].mesh is parts[2].mesh
    assert sorted(part.pose[0, 3] for part in parts) == [0, 2, 4]


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: rc.Mesh("no/such/file.stl"), "no/such/file.stl"),
        (lambda: rc.Mesh(np.zeros((3, 2)), [[0, 1, 2]]), r"vertices: has shape \(3, 2\)"),
        (lambda: rc.Mesh(np.eye(3), [[0, 1, 2, 0]]), r"triangles: has shape \(1, 4\)"),
        (lambda: rc.Mesh(np.eye(3), [[0, 1, 2.5]]), "whole numbers"),
        (lambda: rc.Mesh(np.eye(3), [[0, 1, -1]]), "triangle 0"),
        (lambda: rc.Mesh(np.eye(3), [[0, 1, 2**32]]), "triangle 0"),
        (lambda: rc.Mesh(np.eye(3), [[0, 1, 3]]), "3"),
        (lambda: rc.Mesh(np.eye(3) * np.nan, [[0, 1, 2]]), "finite"),
        (lambda: rc.Mesh(np.eye(3), np.empty((0, 3), int)), "no triangles"),
        (lambda: rc.Mesh(["a", "b", "c"], [[0, 1, 2]]), "not numbers"),
        (lambda: rc.Mesh(3), "int"),
        (lambda: rc.Mesh.from_bytes(b"nothing", "abc"), "abc"),
        (lambda: rc.Mesh.from_bytes(b"nothing", "glb"), "glTF"),
        (lambda: rc.Shape(rc.Mesh(np.zeros((3, 3)), [[0, 1, 2]])), "area"),
        (lambda: rc.Shape(rc.Mesh(*meshes.box()), nesting="other"), "other"),
    ],
)
def test_bad_meshes_are_value_errors_that_say_what_is_wrong(make, says):
    with pytest.raises(ValueError, match=says) as caught:
        make()
    assert isinstance(caught.value, rc.InputError)


def test_arrays_of_a_shape_show_its_memory_and_keep_it():
    vertices, faces = meshes.box((1, 2, 4))
    shape = rc.Shape(rc.Mesh(vertices, faces))
    views = [shape.vertices, shape.triangles, shape.vertex_normals, shape.vertex_areas, shape.exit_distances]
    copies = [view.copy() for view in views]
    for view in views:
        with pytest.raises(ValueError, match="read-only"):
            view[0] = 1
    assert shape.mass.volume == pytest.approx(8) and shape.report.good and shape.has_inside
    assert shape.box.tolist() == [[-0.5, -1, -2], [0.5, 1, 2]]
    assert shape.vertex_areas.sum() == pytest.approx(shape.report.area)
    del shape
    assert all(np.array_equal(view, copy) for view, copy in zip(views, copies))


# One question


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
    pose_a, pose_b = random_poses(n, 1.2), random_poses(n, 1.2)
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
    for pose in random_poses(20, 3):
        found = rc.distance(torus, bracket, pose_b=pose)
        if found.distance == 0:
            continue
        corners = placed(bracket.vertices, pose)
        near = rc.closest_point(torus, corners)
        assert found.distance <= near.distance.min() + 1e-12
        mesh_a, mesh_b = meshes.torus(), meshes.bracket()
        for point, triangle, (vertices, faces), place in (
            (found.point_a, found.triangle_a, mesh_a, np.eye(4)),
            (found.point_b, found.triangle_b, mesh_b, pose),
        ):
            a, b, c = placed(vertices[faces[triangle]], place)
            share = np.linalg.lstsq(np.c_[b - a, c - a], point - a, rcond=None)[0]
            assert np.allclose(a + share[0] * (b - a) + share[1] * (c - a), point, atol=1e-9)
            assert (share >= -1e-9).all() and share.sum() <= 1 + 1e-9


def test_rays_and_points_of_a_torus(torus):
    angles = RNG.uniform(0, 2 * np.pi, 200)
    inside = np.c_[np.cos(angles), np.sin(angles), np.zeros(200)]
    assert rc.contains(torus, inside * 0.99).all() and not rc.contains(torus, inside * 0.2).any()
    pose = random_poses(1, 5)[0]
    assert rc.contains(torus, placed(inside * 0.99, pose), pose).all()
    hit = rc.raycast(torus, [0, 0, 0], inside)
    assert np.allclose(hit.distance, 0.65, atol=0.02) and (hit.triangle >= 0).all()
    assert (np.einsum("ij,ij->i", hit.normal, inside) < 0).all(), "it meets the faces from outside"
    assert rc.raycast_any(torus, [0, 0, 0], inside).all() and not rc.raycast_any(torus, [0, 0, 0], [0, 0, 1])
    miss = rc.raycast(torus, [0, 0, 0], [0, 0, 1])
    assert miss.distance == np.inf and miss.triangle == -1 and np.isnan(miss.point).all()
    assert rc.closest_point(torus, [0, 0, 0], max=0.1).distance == np.inf


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
    poses = random_poses(n, 0.9)[:, None] @ offsets
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


# Scenes


def ring_scene(torus, **settings):
    scene = rc.Scene(**settings)
    ids = scene.add(torus, rc.pose(np.c_[np.arange(8) * 2.5, np.zeros(8), np.zeros(8)]))
    return scene, ids


def test_a_scene_finds_what_collide_finds(torus, bracket):
    scene = rc.Scene()
    poses = random_poses(12, 2)
    ids = scene.add([torus, bracket] * 6, poses)
    contacts = scene.find_contacts()
    assert len(contacts) and scene.stats.contacts == len(contacts)
    for a, b in scene.pairs:
        one = rc.collide(scene.shape(a), scene.shape(b), poses[a], poses[b])
        mine = contacts[(contacts.bodies == (a, b)).all(axis=1)]
        assert np.array_equal(one.key, mine.key) and np.array_equal(one.depth, mine.depth)
    assert np.array_equal(scene.poses(), poses) and np.array_equal(scene.ids, ids)
    assert same(scene.find_contacts(scene.pairs[::-1, ::-1]), scene.contacts)


def test_contacts_outlive_later_steps_and_the_scene(torus):
    scene, ids = ring_scene(torus)
    first = scene.find_contacts()
    depth, before = first.depth, {name: column.copy() for name, column in first.columns().items()}
    for step in range(20):
        scene.set_poses(ids, rc.pose(np.c_[np.arange(8) * (2.5 - step / 20), np.zeros(8), np.zeros(8)]))
        scene.find_contacts()
    assert len(scene.contacts) != len(first)
    del scene
    assert all(np.array_equal(column, before[name]) for name, column in first.columns().items())
    del first
    assert np.array_equal(depth, before["depth"])


def test_ids_name_one_body_for_ever(torus):
    scene = rc.Scene()
    one = scene.add(torus)
    assert isinstance(one, int) and one == 0 and one in scene
    scene.remove(one)
    assert one not in scene
    other = scene.add(torus)
    assert other != one and other % 2**32 == 0, "the same slot, another generation"
    for use in (
        lambda: scene.set_poses([one], np.eye(4)),
        lambda: scene.poses(one),
        lambda: scene.remove(one),
        lambda: scene.find_contacts([[one, other]]),
        lambda: scene.shape(one),
        lambda: scene.set_filter(one, 1, 1),
    ):
        with pytest.raises(rc.InputError, match="was removed"):
            use()
    for wrong in (-1, 5, 2**40, -(2**62)):
        with pytest.raises(rc.InputError):
            scene.set_poses(wrong, np.eye(4))
    with pytest.raises(rc.InputError, match="whole numbers"):
        scene.set_poses([0.5], np.eye(4))


def test_bulk_changes_are_made_as_a_whole_or_not_at_all(torus):
    scene, ids = ring_scene(torus)
    before = scene.poses()
    poses = before.copy()
    poses[:, 0, 3] += 1
    poses[5, 0, 0] = 3
    with pytest.raises(rc.InputError, match="place 5"):
        scene.set_poses(ids, poses)
    with pytest.raises(rc.InputError):
        scene.add(torus, poses)
    assert np.array_equal(scene.poses(), before) and len(scene) == 8


def test_new_and_lost_contacts(torus):
    scene, ids = ring_scene(torus)
    first = scene.find_contacts()
    assert first.is_new.all()
    assert not scene.find_contacts().is_new.any()
    scene.set_poses(ids[0], rc.pose([-50, 0, 0]))
    scene.find_contacts()
    lost = scene.lost_contacts
    gone = first[(first.bodies == (ids[0], ids[1])).all(axis=1)]
    assert len(gone) and np.array_equal(np.sort(lost.key[(lost.bodies[:, 0] == ids[0])]), gone.key[gone.kind == 0])


def test_settings_come_back(torus):
    scene = rc.Scene(method="predictive", direction="refined", features="vertices", threads=1, confidence=3)
    settings = scene.settings
    assert settings["method"] == "predictive" and settings["confidence"] == 3 and settings["threads"] == 1
    assert rc.Scene(**settings).settings == settings
    scene.set_settings(method="standard", displacement_threshold=0.25)
    assert scene.settings["method"] == "standard" and scene.settings["displacement_threshold"] == 0.25
    for bad in ({"method": "magic"}, {"threads": 2}, {"confidence": 0}, {"speculative": 1}, {"max_contacts": -1}):
        with pytest.raises(rc.InputError):
            scene.set_settings(**bad)
    with pytest.raises(TypeError, match="colour"):
        scene.set_settings(colour="red")
    with pytest.raises(TypeError):
        rc.Scene(colour="red")


@pytest.mark.parametrize("method", ["standard", "certified", "iterative", "predictive"])
@pytest.mark.parametrize("direction", ["ray", "weighted", "reprojected", "refined"])
def test_all_methods_and_directions_step(torus, method, direction):
    scene, ids = ring_scene(torus, method=method, direction=direction)
    for step in range(5):
        scene.set_poses(ids, rc.pose(np.c_[np.arange(8) * (2.5 - step / 100), np.zeros(8), np.zeros(8)]))
        contacts = scene.find_contacts()
    assert len(contacts) and (contacts.depth > 0).all()
    assert (contacts.weight < 1).all() if direction == "weighted" else (contacts.weight == 1).all()


def test_all_devices_find_the_same(torus):
    poses = [random_poses(8, 2) for _ in range(4)]

    def run(**settings):
        scene = rc.Scene(**settings)
        ids = scene.add(torus, poses[0])
        found = []
        for pose in poses:
            scene.set_poses(ids, pose)
            found.append(scene.find_contacts())
        return found

    expected = run(threads=1)
    usable = [d.id for d in rc.list_devices() if d.usable and d.exact]
    assert "cpu" in usable
    for devices in [*usable, "cpu/0,cpu/1"]:
        try:
            found = run(devices=devices)
        except rc.InputError as error:
            if "/" in devices:  # of a machine with one core
                continue
            pytest.fail(f"{devices}: {error}")
        assert all(same(a, b) for a, b in zip(found, expected)), devices


def test_speculative_contacts_come_before_bodies_touch(torus):
    scene, ids = ring_scene(torus, speculative=True, speculative_margin=0.2)
    scene.set_poses(ids, rc.pose(np.c_[np.arange(8) * 2.8, np.zeros(8), np.zeros(8)]))
    contacts = scene.find_contacts()
    assert len(contacts) and (contacts.depth <= 0).all() and len(contacts.touching) == 0
    assert scene.stats.contacts == 0 and scene.stats.contacts_speculative == len(contacts)


def test_filters_limits_and_queries_of_a_scene(torus):
    scene, ids = ring_scene(torus, max_contacts_per_pair=3)
    contacts = scene.find_contacts()
    assert np.unique(contacts.bodies, axis=0, return_counts=True)[1].max() <= 3 and scene.stats.contacts_reduced > 0
    scene.set_filter(ids, 1, 2)
    assert len(scene.find_contacts()) == 0
    hit = scene.raycast([[-9, 1, 0], [0, 99, 0]], [1, 0, 0])
    assert hit.body.tolist() == [ids[0], -1] and hit.distance[1] == np.inf
    assert scene.closest_point([40, 0, 0]).body == ids[-1]
    assert scene.overlaps(torus, rc.pose([1.2, 0, 0])).tolist() == [0, 1]


def test_a_recording_is_one_that_the_program_replays(torus, tmp_path):
    scene, ids = ring_scene(torus)
    with rc.Recorder(tmp_path / "rings.glb", scene, dt=0.01, name="rings") as recorder:
        for step in range(6):
            scene.set_poses(ids, rc.pose(np.c_[np.arange(8) * (2.5 - step / 50), np.zeros(8), np.zeros(8)]))
            scene.find_contacts()
            recorder.record()
    read = rc.Recording(tmp_path / "rings.glb")
    assert len(read) == 6 and read.hash == recorder.hash and read.dt == 0.01 and read.name == "rings"
    assert np.array_equal(read.ids, ids) and read.shape_of.tolist() == [0] * 8 and len(read.shapes) == 1
    again = rc.Scene(**read.settings)
    rows = again.add(read.shapes[0], read[0].poses)
    for step in read:
        assert step.present.all()
        again.set_poses(rows, step.poses)
        again.find_contacts(rows[step.pairs])
    assert same(again.contacts, scene.contacts), "to the bit"
    assert np.array_equal(read[-1].poses, scene.poses()) and np.array_equal(read[-1].pairs, scene.pairs)
    with pytest.raises(IndexError, match="has 6"):
        read[6]
    assert recorder.steps == 6 and recorder.bytes == (tmp_path / "rings.glb").stat().st_size
    program = os.environ.get("RAYCONTACT_PROGRAM")
    if not program:
        pytest.skip("RAYCONTACT_PROGRAM does not name the program")
    run = subprocess.run([program, "replay", tmp_path / "rings.glb", "--json"], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert json.loads(run.stdout.splitlines()[-1])["hash"] == recorder.hash


def test_a_recorder_keeps_its_scene(torus, tmp_path):
    scene, _ = ring_scene(torus)
    recorder = rc.Recorder(tmp_path / "a.glb", scene)
    scene.find_contacts()
    del scene
    recorder.record()
    recorder.finish()
    with pytest.raises(rc.InputError, match="nowhere"):
        rc.Recorder(tmp_path / "nowhere" / "a.glb", rc.Scene())
    with pytest.raises(rc.InputError, match="time step"):
        rc.Recorder(tmp_path / "b.glb", rc.Scene(), dt=0)


# Other libraries, threads, signals, processes


class OnlyDlpack:
    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def test_arrays_go_in_and_out_by_dlpack(torus):
    scene, ids = ring_scene(torus)
    poses = rc.pose(np.c_[np.arange(8) * 2.4, np.zeros(8), np.zeros(8)])
    scene.set_poses(OnlyDlpack(ids), OnlyDlpack(poses))
    assert np.array_equal(scene.poses(), poses)
    contacts = scene.find_contacts()
    for name in ("point_a", "normal", "depth", "bodies", "indices", "kind"):
        column = getattr(contacts, name)
        if np.lib.NumpyVersion(np.__version__) < "2.1.0":
            assert np.array_equal(np.from_dlpack(column.copy()), column), "older ones export nothing that is read-only"
            continue
        other = np.from_dlpack(column)
        assert np.array_equal(other, column) and np.shares_memory(other, contacts.data)


def test_numbers_of_other_types_and_orders_are_taken(torus):
    scene, ids = ring_scene(torus)
    poses = rc.pose(np.c_[np.arange(8) * 2, np.zeros(8), np.zeros(8)])
    for given in (poses.astype(np.float32), poses.tolist(), np.asfortranarray(poses), poses.astype(int), poses[::1]):
        scene.set_poses(ids.astype(np.uint8), given)
        assert np.array_equal(scene.poses(), poses)
    vertices, faces = meshes.torus()
    mesh = rc.Mesh(np.asfortranarray(vertices), faces.astype(np.int16)[:, ::-1])
    assert np.array_equal(mesh.triangles, faces[:, ::-1])


def test_a_second_thread_is_told_that_the_scene_is_in_use(torus):
    scene = rc.Scene()
    scene.add(torus, random_poses(60, 1))  # all overlap: a step takes a while
    refused, stop = [], threading.Event()

    def ask():
        while not stop.is_set():
            try:
                _ = scene.stats
            except RuntimeError as error:
                refused.append(str(error))
                return

    other = threading.Thread(target=ask)
    other.start()
    for _ in range(1000):
        try:
            scene.find_contacts()
        except RuntimeError:
            pass  # the other thread was in it
        if refused:
            break
    stop.set()
    other.join()
    assert refused and "another thread" in refused[0]


def test_threads_with_a_scene_each_run_side_by_side(torus):
    results = [None] * 4

    def run(i):
        scene, ids = ring_scene(torus, threads=1)
        for step in range(10):
            scene.set_poses(ids, rc.pose(np.c_[np.arange(8) * (2.5 - step / 100), np.zeros(8), np.zeros(8)]))
            results[i] = scene.find_contacts()

    threads = [threading.Thread(target=run, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(same(result, results[0]) for result in results)


def run_python(code, **options):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        **options,
    )


def test_ctrl_c_ends_a_batch():
    program = run_python(
        "import meshes, numpy as np, raycontact as rc\n"
        "shape = rc.Shape(rc.Mesh(*meshes.torus(around=96, across=48)))\n"
        "poses = rc.pose(np.random.default_rng(1).uniform(2, 9, (3_000_000, 3)))\n"
        "print('begins', flush=True)\n"
        "try:\n"
        "    rc.distance(shape, shape, pose_b=poses)\n"  # hours
        "except KeyboardInterrupt:\n"
        "    print('ended', flush=True)\n"
    )
    assert program.stdout.readline() == "begins\n", program.stderr.read()
    program.send_signal(signal.SIGINT)
    out, err = program.communicate(timeout=600)
    assert out == "ended\n" or "KeyboardInterrupt" in err, err  # in the call, or just before it


def test_a_forked_child_steps(torus):
    program = run_python(
        "import os, meshes, numpy as np, raycontact as rc\n"
        "shape = rc.Shape(rc.Mesh(*meshes.torus()))\n"
        "scene = rc.Scene(devices='cpu')\n"
        "ids = scene.add(shape, rc.pose(np.c_[np.arange(400) * 2.5, np.zeros((400, 2))]))\n"
        "for _ in range(4): expected = scene.find_contacts()\n"
        "rc.intersects(shape, shape, pose_b=scene.poses())\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        "    good = np.array_equal(scene.find_contacts().depth, expected.depth)\n"
        "    good &= rc.intersects(shape, shape, pose_b=scene.poses()).any()\n"
        "    del scene\n"
        "    os._exit(0 if good else 1)\n"
        "print(os.waitpid(child, 0)[1])\n"
    )
    out, err = program.communicate(timeout=600)
    assert out == "0\n", err


def test_what_is_given_may_be_changed_by_others_meanwhile(torus):
    """Values are copied before the GIL is released: a change in between cannot be half seen."""
    points = np.zeros((200_000, 3))
    points[:, 0] = 1
    stop = threading.Event()

    def change():
        while not stop.is_set():
            points[:] = np.nan
            points[:] = (1, 0, 0)

    other = threading.Thread(target=change)
    other.start()
    try:
        for _ in range(5):
            try:
                assert rc.contains(torus, points).all()
                assert len(rc.collide(torus, torus, pose_b=rc.pose(points[:500]))) >= 0
            except rc.InputError as error:
                assert "finite" in str(error)
    finally:
        stop.set()
        other.join()


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


def test_meshes_are_pickled_and_shapes_are_shared_by_copies(torus):
    mesh = rc.Mesh(*meshes.bracket(), name="L")
    again = pickle.loads(pickle.dumps(mesh))
    assert np.array_equal(again.vertices, mesh.vertices) and np.array_equal(again.triangles, mesh.triangles)
    assert again.name == "L" and copy.deepcopy([torus])[0] is torus and copy.copy(torus) is torus
    with pytest.raises(TypeError, match="pickle its Mesh"):
        pickle.dumps(torus)


def test_an_object_with_vertices_and_faces_is_one_mesh_even_if_it_is_a_tuple(torus):
    pair = collections.namedtuple("pair", "vertices faces")(*meshes.bracket())
    assert rc.intersects(pair, pair) is True
    assert rc.Scene().add(pair) == 0


def test_what_a_file_leaves_out_is_told(tmp_path):
    cube = "".join(f"v {x} {y} {z}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1))
    faces = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]
    text = ""
    for k, name in enumerate(("left", "right")):
        text += f"o {name}\n{cube}" + "".join("f" + "".join(f" {v + 8 * k}" for v in face) + "\n" for face in faces)
    (tmp_path / "two.obj").write_text(text + "l 1 2\n")
    said = ["left out 1 line (l)"]
    with pytest.warns(UserWarning, match=r"two.obj: left out 1 line \(l\)"):
        parts = rc.load_assembly(tmp_path / "two.obj")
    assert [part.name for part in parts] == ["left", "right"]
    with pytest.warns(UserWarning, match="left out 1 line"):
        assert [(c.a, c.b) for c in rc.clash(tmp_path / "two.obj")] == [("left", "right")]
    mesh = rc.Mesh(tmp_path / "two.obj")
    assert mesh.repairs == said
    assert pickle.loads(pickle.dumps(mesh)).repairs == said
    assert rc.Mesh(mesh, scale=0.5).repairs == said
    assert rc.Shape(parts[0].mesh).report.repairs == []


def test_scales_reach_files_shapes_assemblies_and_clashes(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box((1000, 1000, 1000)), node_name="a", geom_name="box")
    scene.graph.update("b", geometry="box", matrix=rc.pose([750, 0, 0]))
    scene.export(tmp_path / "mm.glb")
    parts = rc.load_assembly(tmp_path / "mm.glb", scale=0.001)
    assert parts[0].mesh is parts[1].mesh and parts[1].pose[0, 3] == 0.75
    assert rc.Shape(parts[0].mesh).mass.volume == pytest.approx(1)
    for assembly in (tmp_path / "mm.glb", scene):
        found = rc.clash(assembly, scale=0.001)
        assert len(found) == 1 and found[0].depth == pytest.approx(0.25, abs=1e-5), assembly
    assert rc.Shape(trimesh.creation.box((1000, 1000, 1000)), scale=0.001).box.tolist() == [[-0.5] * 3, [0.5] * 3]
    for bad in (0, -1, np.nan, np.inf, "big"):
        with pytest.raises(rc.InputError, match="scale"):
            rc.Shape(trimesh.creation.box(), scale=bad)


def test_columns_are_not_written_by_mistake(torus):
    scene, _ = ring_scene(torus)
    contacts = scene.find_contacts()
    with pytest.raises(ValueError, match="read-only"):
        contacts.depth[:] = 7
    own = contacts.depth.copy()
    own[:] = 7
    assert not (scene.contacts.depth == 7).any()


def test_slots_index_arrays_of_ones_own(torus):
    scene, ids = ring_scene(torus)
    scene.remove(ids[[0, 2]])
    scene.find_contacts()
    new = scene.add(torus, rc.pose([[0.5, 0, 0], [90, 0, 0], [99, 0, 0]]))
    contacts = scene.find_contacts()
    assert (new[:2] >= 2**32).all() and scene.slot_count == 9
    push = np.zeros((scene.slot_count, 3))
    np.add.at(push, contacts.slots[:, 0], -contacts.normal * contacts.depth[:, None])
    assert push.any() and rc.Scene().slot_count == 0


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


def test_rotations_of_scipy_are_taken():
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation.from_euler("z", 90, degrees=True)
    assert np.allclose(rc.pose([1, 2, 3], rotation), rc.pose_from_quaternion([1, 2, 3], [1, 0, 0, 1]))


def test_a_closest_point_at_the_greatest_distance_counts(torus):
    points = RNG.normal(size=(3000, 3)) * 3
    pose = random_poses(1, 5)[0]
    far = rc.closest_point(torus, points, pose).distance
    again = [rc.closest_point(torus, point, pose, max=most).distance for point, most in zip(points, far)]
    assert np.array_equal(again, far)


def test_adding_nothing_or_too_little_is_told(torus):
    scene = rc.Scene()
    for shapes, poses in (([], np.zeros((3, 4, 4)) + np.eye(4)), ([torus] * 2, []), ([torus] * 2, [np.eye(4)] * 3)):
        with pytest.raises(rc.InputError, match="bodies; give one for each"):
            scene.add(shapes, poses)
    with pytest.raises(rc.InputError, match=r"poses\[2\]"):
        scene.add(torus, [np.eye(4), np.eye(4), np.diag([2, 2, 2, 1])])
    assert scene.add(torus) == 0, "what failed used no ids"
    assert scene.add([torus, torus], np.eye(4)[None]).tolist() == [1, 2]


def test_small_mistakes_are_told(torus, tmp_path):
    with pytest.raises(rc.InputError, match="speculative=True"):
        rc.Scene(speculative_margin=0.1)
    with pytest.raises(rc.InputError, match="1025"):
        rc.intersects(torus, torus, threads=1025)
    contacts = rc.collide(torus, torus, pose_b=rc.pose([1, 0, 0]))
    with pytest.raises(TypeError, match="contacts.depth"):
        contacts["depth"]
    assert rc.Shape(rc.Mesh(*meshes.box()), scale=fractions.Fraction(1, 2)).box[1].tolist() == [0.25] * 3
    scene, _ = ring_scene(torus)
    with rc.Recorder(tmp_path / "a.glb", scene) as recorder:
        scene.find_contacts()
        recorder.record()
        recorder.finish()


@pytest.mark.parametrize(
    "work",
    [
        "rc.distance(shape, shape, pose_b=poses)",
        "scene.find_contacts()",
        "rc.Shape(mesh)",
        "rc.raycast(shape, points, [1, 0, 0])",
        "rc.clash([('a', mesh, None), ('b', mesh, None)])",
    ],
)
def test_a_program_ends_while_daemon_threads_compute(work):
    program = run_python(
        "import threading, time, meshes, numpy as np, raycontact as rc\n"
        "mesh = rc.Mesh(*meshes.torus(around=96, across=48))\n"
        "shape, scene = rc.Shape(mesh), rc.Scene()\n"
        "points = np.random.default_rng(1).uniform(-2, 2, (20_000, 3))\n"
        "poses = rc.pose(points + [5, 0, 0])\n"
        "scene.add(shape, poses[:40])\n"
        "def loop():\n"
        f"    while True: {work}\n"
        "threads = [threading.Thread(target=loop, daemon=True)]\n"
        "threads[0].start()\n"
        "time.sleep(0.2)\n"
        "print('end', flush=True)\n"
    )
    out, err = program.communicate(timeout=600)
    assert (program.returncode, out) == (0, "end\n"), err
