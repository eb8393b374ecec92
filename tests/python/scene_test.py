# SPDX-License-Identifier: Apache-2.0
"""Scenes, their contacts and recordings from Python."""

import fractions
import json
import os
import pickle
import subprocess

import brute_force
import helpers
import meshes
import numpy as np
import pytest
import raycontact as rc


def test_a_scene_finds_what_collide_finds(torus, bracket):
    scene = rc.Scene()
    poses = helpers.random_poses(12, 2)
    ids = scene.add([torus, bracket] * 6, poses)
    contacts = scene.find_contacts()
    assert len(contacts) and scene.stats.contacts == len(contacts)
    for a, b in scene.pairs:
        one = rc.collide(scene.shape(a), scene.shape(b), poses[a], poses[b])
        mine = contacts[(contacts.bodies == (a, b)).all(axis=1)]
        assert np.array_equal(one.key, mine.key) and np.array_equal(one.depth, mine.depth)
    assert np.array_equal(scene.poses(), poses) and np.array_equal(scene.ids, ids)
    assert helpers.same(scene.find_contacts(scene.pairs[::-1, ::-1]), scene.contacts)


def test_contacts_outlive_later_steps_and_the_scene(torus):
    scene, ids = helpers.ring_scene(torus)
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
    scene, ids = helpers.ring_scene(torus)
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
    scene, ids = helpers.ring_scene(torus)
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
    scene, ids = helpers.ring_scene(torus, method=method, direction=direction)
    for step in range(5):
        scene.set_poses(ids, rc.pose(np.c_[np.arange(8) * (2.5 - step / 100), np.zeros(8), np.zeros(8)]))
        contacts = scene.find_contacts()
    assert len(contacts) and (contacts.depth > 0).all()
    assert (contacts.weight < 1).all() if direction == "weighted" else (contacts.weight == 1).all()


def test_all_devices_find_the_same(torus):
    poses = [helpers.random_poses(8, 2) for _ in range(4)]

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
        assert all(helpers.same(a, b) for a, b in zip(found, expected)), devices


def test_speculative_contacts_come_before_bodies_touch(torus):
    scene, ids = helpers.ring_scene(torus, speculative=True, speculative_margin=0.2)
    scene.set_poses(ids, rc.pose(np.c_[np.arange(8) * 2.8, np.zeros(8), np.zeros(8)]))
    contacts = scene.find_contacts()
    assert len(contacts) and (contacts.depth <= 0).all() and len(contacts.touching) == 0
    assert scene.stats.contacts == 0 and scene.stats.contacts_speculative == len(contacts)


def test_filters_limits_and_queries_of_a_scene(torus):
    scene, ids = helpers.ring_scene(torus, max_contacts_per_pair=3)
    contacts = scene.find_contacts()
    assert np.unique(contacts.bodies, axis=0, return_counts=True)[1].max() <= 3 and scene.stats.contacts_reduced > 0
    scene.set_filter(ids, 1, 2)
    assert len(scene.find_contacts()) == 0
    hit = scene.raycast([[-9, 1, 0], [0, 99, 0]], [1, 0, 0])
    assert hit.body.tolist() == [ids[0], -1] and hit.distance[1] == np.inf
    assert scene.closest_point([40, 0, 0]).body == ids[-1]
    assert scene.overlaps(torus, rc.pose([1.2, 0, 0])).tolist() == [0, 1]


@pytest.fixture(scope="module")
def ring():
    return rc.Shape(rc.Mesh(*meshes.torus(around=10, across=6)))


@pytest.fixture(scope="module")
def shelf(ring, bracket):
    """A scene of bodies, their ids, and corners of their triangles."""
    scene = rc.Scene(threads=2)
    shapes, poses = [ring, bracket] * 6, helpers.random_poses(12, 5)
    ids = scene.add(shapes, poses)
    scene.remove(ids[3])
    ids[3] = scene.add(shapes[3], poses[3])  # another slot or generation
    return scene, ids, [brute_force.triangles_of(shape, pose) for shape, pose in zip(shapes, poses)]


def meets(a, b):
    """Surfaces cross, or one lies in the other."""
    if (a.min(axis=(0, 1)) > b.max(axis=(0, 1))).any() or (b.min(axis=(0, 1)) > a.max(axis=(0, 1))).any():
        return False
    return brute_force.meet(a, b) or any(brute_force.winding(x[:1, 0], y)[0] > 0.5 for x, y in ((a, b), (b, a)))


def test_overlaps_of_batches_are_those_of_trying_everything(shelf, ring, bracket):
    scene, ids, placed = shelf
    links, n = [bracket, ring, bracket], 12
    poses = helpers.random_poses(n * 3, 6).reshape(n, 3, 4, 4)
    truth = np.array(
        [[[meets(brute_force.triangles_of(link, pose), body) for body in placed] for link, pose in zip(links, row)]
         for row in poses]
    )  # fmt: skip
    assert truth.any() and not truth.any(axis=2).all() and not truth.any(axis=(1, 2)).all()
    by_slot = np.argsort(ids % 2**32)

    found = scene.overlaps(links, poses)
    assert type(found) is rc.BodyOverlaps and (np.diff(found.item) >= 0).all()
    expected = [(i, ids[k]) for i, row in enumerate(truth.reshape(-1, len(ids))) for k in by_slot if row[k]]
    assert list(zip(found.item, found.body)) == expected
    assert np.array_equal(scene.overlaps_any(links, poses), truth.any(axis=(1, 2)))
    assert np.array_equal(scene.overlaps_any(links, poses, each=True), truth.any(axis=2))
    assert np.array_equal(scene.overlaps_any(bracket, poses[:, 0]), truth[:, 0].any(axis=1))
    assert np.array_equal(scene.overlaps_any(bracket, poses[:, [0, 2]]), truth[:, [0, 2]].any(axis=2))
    for i in range(n):
        for forms in (poses[i], poses[i].tolist(), list(poses[i])):
            any_of = scene.overlaps_any(links, forms)
            assert type(any_of) is bool and any_of == truth[i].any()
        assert np.array_equal(scene.overlaps(bracket, poses[i, 0]), ids[by_slot][truth[i, 0][by_slot]])
        assert np.array_equal(scene.overlaps(bracket, poses[i, 0].tolist()), ids[by_slot][truth[i, 0][by_slot]])
        one = scene.overlaps_any(links[1], poses[i, 1])
        assert type(one) is bool and one == truth[i, 1].any()

    wanted = ids[::2]
    kept = truth[..., ::2]
    some = scene.overlaps(links, poses, wanted=wanted)
    assert list(zip(some.item, some.body)) == [pair for pair in expected if pair[1] in wanted]
    assert np.array_equal(scene.overlaps_any(links, poses, wanted=wanted), kept.any(axis=(1, 2)))
    assert np.array_equal(scene.overlaps_any(links, poses, each=True, wanted=wanted), kept.any(axis=2))
    assert not scene.overlaps_any(links, poses, wanted=[]).any() and not len(scene.overlaps(ring, wanted=[]))


def test_a_list_of_links_has_a_pose_for_each(shelf, torus):
    scene, poses = shelf[0], helpers.random_poses(5, 1)
    for links in ([torus], [torus, torus]):
        with pytest.raises(ValueError, match=f"give poses .*{len(links)}, 4, 4|do not fit"):
            scene.overlaps_any(links, poses)


def test_overlaps_of_nothing(shelf, torus):
    scene = shelf[0]
    assert scene.overlaps_any([], None) is False and len(scene.overlaps([]).item) == 0
    assert scene.overlaps_any([torus], np.empty((0, 1, 4, 4))).shape == (0,)
    assert scene.overlaps_any(torus, np.empty((0, 4, 4))).shape == (0,)
    assert rc.Scene().overlaps_any([torus, torus]) is False and rc.Scene().overlaps_any(torus) is False


def test_rays_points_and_distances_of_chosen_bodies(shelf):
    scene, ids, placed = shelf
    rng = np.random.default_rng(3)
    origins, directions = rng.uniform(-6, 6, (60, 3)), rng.normal(size=(60, 3))
    shapes = [scene.shape(i) for i in ids]
    poses = scene.poses(ids)
    for wanted in (None, ids, ids[::3], [int(ids[3])], []):
        counts = np.ones(len(ids), bool) if wanted is None else np.isin(ids, wanted)
        each = np.array([rc.raycast(s, origins, directions, p).distance for s, p in zip(shapes, poses)])
        each[~counts] = np.inf
        hits = scene.raycast(origins, directions, wanted=wanted)
        assert np.array_equal(hits.distance, each.min(axis=0))
        hit = np.isfinite(hits.distance)
        assert hit.any() == bool(counts.sum() > 1) or counts.sum() == 1
        assert np.array_equal(hits.body[hit], ids[each.argmin(axis=0)][hit]) and (hits.body[~hit] == -1).all()
        assert np.array_equal(scene.raycast_any(origins, directions, wanted=wanted), hit)
        assert np.array_equal(scene.raycast_any(origins, directions, 3.0, wanted=wanted), hits.distance <= 3)
        near = np.array([brute_force.to_triangles(origins[:20], triangles) for triangles in placed])
        near[~counts] = np.inf
        closest = scene.closest_point(origins[:20], wanted=wanted)
        assert closest.distance == pytest.approx(near.min(axis=0), abs=1e-9)
        assert closest.body.tolist() == (ids[near.argmin(axis=0)].tolist() if counts.any() else [-1] * 20)
    assert (
        scene.raycast_any([0, 0, 99], [0, 0, 1]) is False
        and type(scene.raycast([0, 0, 9], [0, 0, -1])) is rc.OneBodyRayHit
    )
    assert scene.raycast_any([[0, 0, 99]] * 2, [0, 0, 1]).tolist() == [False, False]

    for i, k in ((0, 1), (2, 9), (5, 6), (3, 3)):
        found = scene.distance(int(ids[i]), ids[k])
        assert type(found) is rc.OneDistance
        true = 0 if meets(placed[i], placed[k]) or i == k else brute_force.distance(placed[i], placed[k])
        assert found.distance == pytest.approx(true, abs=1e-9)
    many = scene.distance(ids[:4, None], ids)
    assert many.distance.shape == (4, 12) and many.point_b.shape == (4, 12, 3)
    assert many.distance[2, 9] == scene.distance(ids[2], ids[9]).distance
    assert np.linalg.norm(many.point_a - many.point_b, axis=-1) == pytest.approx(many.distance, abs=1e-9)
    limited = scene.distance(ids[:4, None], ids, max=1.0)
    assert np.array_equal(np.isfinite(limited.distance), many.distance <= 1)
    assert scene.distance([], []).distance.shape == (0,)


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda s, t: s.overlaps(t, np.diag([2, 2, 2, 1.0])), "poses: not rigid"),
        (lambda s, t: s.overlaps_any([t, t], np.tile(np.diag([2, 2, 2, 1.0]), (2, 1, 1))), r"poses\[0\]: not rigid"),
        (lambda s, t: s.overlaps_any([t, t], np.zeros((3, 4, 4)) + np.eye(4)), "do not fit together"),
        (lambda s, t: s.overlaps_any([t, None], None), r"shapes\[1\]"),
        (lambda s, t: s.overlaps(t, wanted=[12345]), "12345|not in"),
        (lambda s, t: s.overlaps_any(t, wanted=[0.5]), "wanted: holds float64, not whole numbers"),
        (lambda s, t: s.raycast([0, 0, 0], [0, 0, 1], wanted=[-1]), "id is empty"),
        (lambda s, t: s.raycast_any([0, 0, 0], [0, 0, 0]), "direction"),
        (lambda s, t: s.raycast_any([[0, 0, 0]] * 2, [[0, 0, 1]] * 3), "fit together"),
        (lambda s, t: s.closest_point([0, 0, 0], wanted=[777]), "777|not in"),
        (lambda s, t: s.distance(0, 999), "999|not in"),
        (lambda s, t: s.distance([0, 1], [0, 1, 2]), "fit together"),
        (lambda s, t: s.distance(0, 1, max=-1), "max|greatest"),
        (lambda s, t: s.distance(0.5, 1), "whole numbers"),
    ],
)
def test_bad_questions_to_a_scene_are_told(shelf, torus, ask, says):
    with pytest.raises(rc.InputError, match=says):
        ask(shelf[0], torus)


def test_one_body_is_moved(torus):
    scene, ids = helpers.ring_scene(torus)
    poses = helpers.random_poses(6, 3)
    for pose, given in zip(poses, (int(ids[2]), ids[2], [ids[2]], 2, np.int32(2), int(ids[2]))):
        scene.set_poses(given, pose)
        assert np.array_equal(scene.poses(2), pose)
    scene.set_poses(2, np.eye(4))
    for bad, says in (
        (np.diag([1.0, 1, 2, 1]), "rigid"),
        (np.full((4, 4), np.nan), "finite"),
        (np.eye(3), "rotation"),
        (None, "poses: is None"),
    ):
        with pytest.raises(rc.InputError, match=says):
            scene.set_poses(2, bad)
    with pytest.raises(rc.InputError):
        scene.set_poses(99, np.eye(4))
    assert np.array_equal(scene.poses(2), np.eye(4))
    assert len(scene.find_contacts()) and 2 in scene.find_contacts().bodies


def test_a_recording_is_one_that_the_program_replays(torus, tmp_path):
    scene, ids = helpers.ring_scene(torus)
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
    assert helpers.same(again.contacts, scene.contacts), "to the bit"
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
    scene, _ = helpers.ring_scene(torus)
    recorder = rc.Recorder(tmp_path / "a.glb", scene)
    scene.find_contacts()
    del scene
    recorder.record()
    recorder.finish()
    with pytest.raises(rc.InputError, match="nowhere"):
        rc.Recorder(tmp_path / "nowhere" / "a.glb", rc.Scene())
    with pytest.raises(rc.InputError, match="time step"):
        rc.Recorder(tmp_path / "b.glb", rc.Scene(), dt=0)


class OnlyDlpack:
    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def test_arrays_go_in_and_out_by_dlpack(torus):
    scene, ids = helpers.ring_scene(torus)
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
    scene, ids = helpers.ring_scene(torus)
    poses = rc.pose(np.c_[np.arange(8) * 2, np.zeros(8), np.zeros(8)])
    for given in (poses.astype(np.float32), poses.tolist(), np.asfortranarray(poses), poses.astype(int), poses[::1]):
        scene.set_poses(ids.astype(np.uint8), given)
        assert np.array_equal(scene.poses(), poses)
    vertices, faces = meshes.torus()
    mesh = rc.Mesh(np.asfortranarray(vertices), faces.astype(np.int16)[:, ::-1])
    assert np.array_equal(mesh.triangles, faces[:, ::-1])


def test_columns_are_not_written_by_mistake(torus):
    scene, _ = helpers.ring_scene(torus)
    contacts = scene.find_contacts()
    with pytest.raises(ValueError, match="read-only"):
        contacts.depth[:] = 7
    own = contacts.depth.copy()
    own[:] = 7
    assert not (scene.contacts.depth == 7).any()


def test_slots_index_arrays_of_ones_own(torus):
    scene, ids = helpers.ring_scene(torus)
    scene.remove(ids[[0, 2]])
    scene.find_contacts()
    new = scene.add(torus, rc.pose([[0.5, 0, 0], [90, 0, 0], [99, 0, 0]]))
    contacts = scene.find_contacts()
    assert (new[:2] >= 2**32).all() and scene.slot_count == 9
    push = np.zeros((scene.slot_count, 3))
    np.add.at(push, contacts.slots[:, 0], -contacts.normal * contacts.depth[:, None])
    assert push.any() and rc.Scene().slot_count == 0


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
    scene, _ = helpers.ring_scene(torus)
    with rc.Recorder(tmp_path / "a.glb", scene) as recorder:
        scene.find_contacts()
        recorder.record()
        recorder.finish()


def test_a_scene_tells_which_device_it_chose():
    assert rc.Scene(devices="cpu").device_choice == "cpu: as given"
    scene = rc.Scene(devices="auto")
    assert scene.device_choice == "cpu: not measured yet"
    assert rc.Scene(devices="auto", schedule="counted").device_choice.startswith(
        "cpu: schedule counted goes by no clock"
    )


@pytest.fixture(scope="module")
def box():
    return rc.Shape(rc.box((2, 2, 2)))


def test_touches_begin_and_end(box):
    scene = rc.Scene()
    a, b, c = scene.add(box, np.stack([rc.pose([x, 0, 0]) for x in (0, 1.9, 9)]))
    scene.find_contacts()
    assert scene.begun.bodies.tolist() == [[a, b]] == scene.touching.bodies.tolist()
    assert scene.begun.normal[0] == pytest.approx([1, 0, 0]) and scene.begun.depth[0] == pytest.approx(0.1, abs=1e-6)
    assert scene.begun.point.shape == (1, 3) and scene.begun.sensor.tolist() == [False]
    scene.set_poses(b, rc.pose([2.001, 0, 0]))
    scene.find_contacts()
    assert len(scene.begun.bodies) == len(scene.ended.bodies) == 0, "it trembles"
    scene.set_poses(b, rc.pose([5, 0, 0]))
    scene.find_contacts()
    assert scene.ended.bodies.tolist() == [[a, b]]
    scene.set_poses(c, rc.pose([6.5, 0, 0]))
    scene.set_sensor(c)
    assert scene.is_sensor(c) and not scene.is_sensor(b)
    assert len(scene.find_contacts()) == 0 and scene.begun.sensor.tolist() == [True]
    scene.set_sensor([c], False)
    assert len(scene.find_contacts()) > 0 and len(scene.begun.bodies) == 0


def test_filters_static_bodies_and_a_callback_keep_pairs_apart(box):
    scene = rc.Scene()
    ids = scene.add(box, np.stack([rc.pose([1.9 * i, 0, 0]) for i in range(4)]))
    scene.set_static(ids[:2])
    assert scene.is_static(ids[0]) and not scene.is_static(ids[2])
    scene.find_contacts()
    assert scene.pairs.tolist() == [[ids[1], ids[2]], [ids[2], ids[3]]]
    scene.set_static(ids[:2], False)
    asked = []
    scene.set_pair_filter(lambda a, b: asked.append((a, b)) or a != ids[1])
    scene.find_contacts()
    assert asked == [(ids[i], ids[i + 1]) for i in range(3)]
    assert scene.pairs.tolist() == [[ids[0], ids[1]], [ids[2], ids[3]]]
    scene.set_pair_filter(lambda a, b: scene.clear())
    with pytest.raises(RuntimeError):
        scene.find_contacts()
    scene.set_pair_filter(lambda a, b: None)
    with pytest.raises(rc.InputError, match="None"):
        scene.find_contacts()
    with pytest.raises(rc.InputError, match="called"):
        scene.set_pair_filter(3)
    scene.set_pair_filter(None)
    scene.find_contacts()
    assert len(scene.pairs) == 3
    scene.clear()
    assert len(scene) == 0


def test_all_hits_of_a_ray(box):
    scene = rc.Scene()
    ids = scene.add(box, np.stack([rc.pose([x, 0, 0]) for x in (8, 4, 12)]))
    hits = scene.raycast_all([0, 0.1, 0.2], [2, 0, 0])
    assert hits.body.tolist() == [ids[1], ids[0], ids[2]] and hits.distance == pytest.approx([3, 7, 11])
    assert scene.raycast_all([0, 0, 0], [1, 0, 0], 8, wanted=ids[1:]).body.tolist() == [ids[1]]
    assert len(scene.raycast_all([0, 0, 5], [1, 0, 0]).body) == 0
    with pytest.raises(rc.InputError, match="one ray"):
        scene.raycast_all(np.zeros((2, 3)), [1, 0, 0])


@pytest.mark.parametrize("method", ["certified", "predictive"])
def test_a_state_is_pickled_and_repeats(torus, method):
    def step(scene, i):
        scene.set_poses(scene.ids, np.stack([rc.pose([0.9 * k + 0.01 * i * (k % 3), 0.2, 0]) for k in range(6)]))
        return scene.find_contacts()

    scene = rc.Scene(method=method)
    scene.add([torus] * 6)
    for i in range(5):
        step(scene, i)
    state = pickle.loads(pickle.dumps(scene.save_state()))
    expected = [step(scene, i) for i in range(5, 10)]
    for again in (rc.Scene(method=method), scene):
        again.load_state(state)
        assert all(helpers.same(step(again, i), expected[i - 5]) for i in range(5, 10))
    with pytest.raises(rc.InputError, match="damaged"):
        scene.load_state(state._replace(data=state.data[:-1] + b"?"))
    with pytest.raises(rc.InputError, match="settings"):
        rc.Scene(direction="ray").load_state(state)
    for wrong in (None, b"x", (1, []), (state.data, [3])):
        with pytest.raises(rc.InputError, match="save_state"):
            scene.load_state(wrong)
    assert repr(state).startswith("<SceneState: ")
