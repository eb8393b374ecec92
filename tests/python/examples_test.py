# SPDX-License-Identifier: Apache-2.0
"""The examples run with NumPy alone, and what they print is what trying everything finds."""

import importlib
import os
import re
import subprocess
import sys
import zlib
from pathlib import Path

import brute_force
import numpy as np
import pytest
import raycontact as rc

FOLDER = Path(__file__).resolve().parents[2] / "adapters" / "python" / "examples"


def run(name, *words):
    """What an example prints."""
    done = subprocess.run([sys.executable, FOLDER / f"{name}.py", *map(str, words)], capture_output=True, text=True,
                          env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"})  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def number(text, pattern):
    """The one that stands where the pattern has (#)."""
    found = re.search(pattern.replace("#", r"-?[\d.]+(?:e-?\d+)?"), text)
    assert found, f"{pattern} is not in\n{text}"
    return float(found[1])


@pytest.fixture(scope="module")
def example():
    """Modules of the examples, by name."""
    sys.path.insert(0, str(FOLDER))
    yield importlib.import_module
    sys.path.remove(str(FOLDER))


def assert_picture(file):
    data = Path(file).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    size = int.from_bytes(data[33:37], "big")
    assert data[37:41] == b"IDAT" and len(set(zlib.decompress(data[41 : 41 + size]))) > 2, "one colour"


def test_parts_are_closed_outward_and_concave(example):
    parts = example("parts")
    for make in (parts.knot, parts.gear, parts.bracket, parts.pad, lambda: parts.ring(0.1, 0.2, 0.1)):
        shape = rc.Shape(make())
        assert shape.report.good and not shape.report.repairs, shape.report
        faces = brute_force.triangles_of(shape)
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        above = np.max(normals @ shape.vertices.T - np.sum(normals * faces[:, 0], axis=1)[:, None])
        assert above > 0.01, f"{shape.name} is convex"


def test_pair(example, tmp_path):
    pair = example("pair")
    text = run("pair", "--picture", tmp_path / "pair.png")
    gear, knot = pair.meshes()
    a = brute_force.triangles_of(gear)
    assert "intersect: True" in text and brute_force.meet(a, brute_force.triangles_of(knot, pair.BESIDE))
    true = brute_force.distance(a, brute_force.triangles_of(knot, pair.APART))
    assert number(text, r"distance: (#) mm") == pytest.approx(1e3 * true, abs=1e-6)
    # The deepest witness point of the gear lies in the knot, no farther from its surface than the contact is deep.
    point = 1e-3 * np.array([[float(x) for x in re.search(r"mm at \((.*)\) mm", text)[1].split(",")]])
    b = brute_force.triangles_of(knot, pair.BESIDE)
    assert brute_force.winding(point, b)[0] == pytest.approx(1, abs=1e-6)
    assert brute_force.to_triangles(point, b)[0] <= 1e-3 * number(text, r"deepest: (#) mm") + 1e-6
    assert number(text, r"depth x normal to (#) m") < 1e-8
    assert_picture(tmp_path / "pair.png")


def test_pair_of_files(tmp_path):
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(1, 2, 4), (1, 4, 3), (5, 7, 8), (5, 8, 6), (1, 5, 6), (1, 6, 2),
             (3, 4, 8), (3, 8, 7), (1, 3, 7), (1, 7, 5), (2, 6, 8), (2, 8, 4)]  # fmt: skip
    for name, shift in (("a", 0), ("b", 1.25)):
        lines = [f"v {x + shift} {y} {z}" for x, y, z in corners] + [f"f {i} {j} {k}" for i, j, k in faces]
        (tmp_path / f"{name}.obj").write_text("\n".join(lines))
    text = run("pair", tmp_path / "a.obj", tmp_path / "b.obj")
    assert "intersect: False, 0 contacts" in text and number(text, r"distance: (#) mm") == 250


def test_batch(example, tmp_path):
    batch = example("batch")
    text = run("batch", "--pairs", 400, "--picture", tmp_path / "batch.png")
    meeting, none_apart = number(text, r"(#) intersect"), number(text, r"(#) have distance 0")
    assert meeting == none_apart == number(text, r"(#) have # contacts")
    assert sum(int(n) for n in re.findall(r"mm: +(\d+)", text)) == meeting
    # Of the first pairs each answer is that of trying everything.
    a, b = batch.meshes()
    pose_a, pose_b = (poses[:40] for poses in batch.poses(400))
    found = rc.intersects(rc.Shape(a), rc.Shape(b), pose_a, pose_b)
    gaps = rc.distance(rc.Shape(a), rc.Shape(b), pose_a, pose_b).distance
    placed = [(brute_force.triangles_of(a, p), brute_force.triangles_of(b, q)) for p, q in zip(pose_a, pose_b)]
    assert found.tolist() == [brute_force.meet(*pair) for pair in placed]
    for i in np.flatnonzero(~found)[:5]:
        assert gaps[i] == pytest.approx(brute_force.distance(*placed[i]), rel=1e-9)
    assert_picture(tmp_path / "batch.png")


def test_clashes(example, tmp_path):
    clashes = example("clashes")
    text = run("clashes", "--picture", tmp_path / "clashes.png")
    assert "8 parts, 28 pairs: 3 clash, 1 touch" in text
    assert number(text, r"plate - bracket 1 +clash, (#) mm") == 2.0
    # The shaft's corners are 1.5 mm outside the bore's; both are polygons.
    assert 1.3 < number(text, r"gear 2 - shaft 2 +clash, (#) mm") <= 1.5
    # Tips lie at 0.1 m cos(0.35 x 7.5 degrees) from either axis.
    tips = 200 * np.cos(np.radians(0.35 * 7.5)) - 197
    assert number(text, r"gear 1 - gear 2 +clash, (#) mm") == pytest.approx(tips, abs=1e-3)
    assert re.search(r"plate - bracket 2 +touch", text)
    pieces = {piece.name: brute_force.triangles_of(piece.mesh, piece.pose) for piece in clashes.assembly()}
    for a, b, gap in re.findall(r"  (\S.*) - (\S.*?) +([\d.]+) mm apart", text):
        assert not brute_force.meet(pieces[a], pieces[b])
        assert float(gap) == pytest.approx(1e3 * brute_force.distance(pieces[a], pieces[b]), abs=6e-4)
    assert_picture(tmp_path / "clashes.png")


def test_clashes_of_a_file(example, tmp_path):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene()
    for name, mesh, pose in example("clashes").assembly():
        scene.add_geometry(trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False), name, name, transform=pose)
    (tmp_path / "gearbox.glb").write_bytes(scene.export(file_type="glb"))
    text = run("clashes", tmp_path / "gearbox.glb")
    # A .glb has float32 coordinates: what touched to the last bit may miss.
    assert "8 parts, 28 pairs: 3 clash" in text
    assert number(text, r"plate - bracket 1 +clash, (#) mm") == pytest.approx(2, abs=2e-3)


def test_gripper(example, tmp_path):
    gripper = example("gripper")
    text = run("gripper", "--cells", 40, "--picture", tmp_path / "field.png")
    parts = example("parts")
    part = parts.knot()
    shape, faces = rc.Shape(part), brute_force.triangles_of(part)
    points = gripper.grid(shape, 40).reshape(-1, 3)
    field = rc.signed_distance(shape, points).distance
    assert 1e3 * field.min() == pytest.approx(number(text, r": (#) to # mm"), abs=1e-3)
    some = np.random.default_rng(2).choice(len(points), 200, replace=False)
    inside = brute_force.winding(points[some], faces) > 0.5
    true = np.where(inside, -1, 1) * brute_force.to_triangles(points[some], faces)
    assert inside.any() and np.allclose(field[some], true, atol=1e-12)
    # Half a micrometre wider the pads are free, two micrometres narrower one goes in.
    opening = 1e-3 * number(text, r"closed to (#) mm")
    pad = brute_force.triangles_of(parts.pad(), np.eye(4))

    def pads(width):
        return [pad @ pose[:3, :3].T + pose[:3, 3] for pose in gripper.fingers(width)]

    assert min(brute_force.distance(one, faces) for one in pads(opening + 1e-6)) > 0
    assert not any(brute_force.meet(one, faces) for one in pads(opening + 1e-6))
    assert any(brute_force.meet(one, faces) for one in pads(opening - 8e-6))
    assert number(text, r"other pad is (#) mm") == pytest.approx(
        1e3 * max(brute_force.distance(one, faces) for one in pads(opening)), abs=2e-3)  # fmt: skip
    assert_picture(tmp_path / "field.png")


def test_grasps(example):
    pytest.importorskip("scipy")
    grasps = example("grasps")
    text = run("grasps", "--grasps", 300)
    part, pad = rc.Shape(rc.samples()["mug"]), rc.Shape(rc.box(grasps.PAD))
    paths = grasps.closing(part, 300, np.random.default_rng(1))
    first = rc.time_of_impact(pad, part, paths)
    closed = (np.isfinite(first.time) & (first.time > 0)).all(axis=1)
    assert number(text, r"(#) of 300 grasps") == closed.sum() and 100 < closed.sum() < 300
    assert number(text, r"(#) of them hold it") > 0
    # Where pads stop they touch nothing yet; pressed further they do.
    poses = grasps.pressed(paths, first.time, 0)[closed].reshape(-1, 4, 4)
    gaps = rc.distance(pad, part, poses).distance
    assert (gaps > 0).all() and gaps.max() < 1e-6
    assert rc.intersects(pad, part, grasps.pressed(paths, first.time, 5e-5)[closed].reshape(-1, 4, 4)).all()


def test_arm(example, tmp_path):
    arm = example("arm")
    text = run("arm", "--picture", tmp_path / "arm.png")
    cell, straight = arm.Cell(), arm.path(arm.START, arm.GOAL)
    for shape in cell.links:
        assert shape.report.good and not shape.report.repairs, shape.report
    # Half of the way between two poses a link is not farther beside its joints' than the margin allows for.
    for joints in (straight, arm.path(*arm.LIMITS)):
        poses = arm.link_poses(joints)
        middle, step = poses[:, :-1], np.linalg.inv(poses[:, :-1]) @ poses[:, 1:]
        root = step
        for _ in range(20):  # Newton's: the half of a screw, twice, is the whole
            root = (root + np.linalg.inv(root) @ step) / 2
        true = arm.link_poses((joints[:-1] + joints[1:]) / 2)
        for shape, screws, own in zip(cell.links, middle @ root, true):
            points = np.c_[shape.vertices, np.ones(len(shape.vertices))].T
            assert np.linalg.norm((screws - own) @ points, axis=-2).max() < arm.MARGIN / 2

    def gaps(joints, link):
        """Of each board and link that it is tested against, by trying everything."""
        poses = dict(zip(arm.LINKS, arm.link_poses(joints)))
        placed = {name: brute_force.triangles_of(link, poses[name]) for name, link in zip(arm.LINKS, cell.links)}
        boards = {board.name: brute_force.triangles_of(board.mesh, board.pose) for board in cell.shelf}
        others = [other for name, other in cell.names if name == link]
        return {other: brute_force.distance(placed[link], {**placed, **boards}[other]) for other in others}

    # Where a link is said to meet a board first, it is a margin away from it, and farther from all others.
    lines = re.findall(r"  (\S+|upper arm) +meets (\S+ \S+) +with joints at ([^d]*) deg", text)
    assert {"forearm", "hand"} == {link for link, _, _ in lines}
    for link, other, joints in lines:
        found = gaps(np.radians([float(x) for x in joints.split()]), link)
        assert found[other] == pytest.approx(arm.MARGIN, abs=1.5e-3) and min(found, key=found.get) == other
    # The free way has the room that it is said to have.
    lines = re.findall(r"  (\S+|upper arm) +([\d.]+) mm from (\S.*?) +with joints at ([^d]*) deg", text)
    assert [link for link, _, _, _ in lines] == list(arm.LINKS)
    for link, gap, other, joints in lines:
        found = gaps(np.radians([float(x) for x in joints.split()]), link)
        assert found[other] == pytest.approx(1e-3 * float(gap), abs=1.5e-3) and float(gap) > 1e3 * arm.MARGIN
    way = [float(x) for x in re.search(r"through joints at (.*) deg", text)[1].split()]
    for start, end in ((arm.START, np.radians(way)), (np.radians(way), arm.GOAL)):
        poses = arm.link_poses(arm.path(start, end, 40))
        for link in range(len(arm.LINKS)):
            for board in cell.shelf:
                assert not rc.intersects(cell.links[link], rc.Shape(board.mesh), poses[link], board.pose).any()
    assert_picture(tmp_path / "arm.png")


def test_methods(example, tmp_path):
    methods = example("methods")
    steps = 60
    text = run("methods", "--steps", steps, "--picture", tmp_path / "rays.png")
    lines = re.findall(r"(\w+) +(\d+) +(\d+) +(\d+) +(\d+) +[\d.]+ %", text)
    rows = {method: [int(x) for x in numbers] for method, *numbers in lines}
    assert list(rows) == list(methods.METHODS)
    # `collide` keeps nothing from step to step.
    shapes, path = methods.shapes(), methods.poses(steps)
    every = len(rc.collide(*shapes, pose_b=path, features="vertices"))
    assert rows["standard"][0] == rows["certified"][0] == every
    assert rows["standard"][1:3] == rows["certified"][1:3] == [0, 0]
    for contacts, missed, invented, _ in rows.values():
        assert contacts == every - missed + invented
    assert all(0 < rows[method][3] <= rows["standard"][3] for method in rows)
    assert_picture(tmp_path / "rays.png")


def test_falling(example, tmp_path):
    file = tmp_path / "run.glb"
    text = run("falling", "--bodies", 6, "--seconds", 2.0, "--record", file, "--picture", tmp_path / "run.png")
    assert number(text, r"moves at (#) mm/s") < 60
    # At rest the ground carries what there is.
    assert number(text, r"carries (#) N") == pytest.approx(number(text, r"N of (#) N"), rel=0.1)
    assert number(text, r"at the end (#) mm") < 4
    # The recording agrees: bodies fell, and lie on the ground, whose top is z = 0.
    recording = rc.Recording(file)
    first, last = recording[0].poses, recording[-1].poses
    assert np.array_equal(first[0], last[0]) and len(recording) == 60
    assert (last[1:, 2, 3] < first[1:, 2, 3]).all()
    shapes = recording.shapes
    vertices = [shapes[i].vertices for i in recording.shape_of]
    lowest = [(v @ p[:3, :3].T + p[:3, 3])[:, 2].min() for v, p in zip(vertices, last)]
    assert min(lowest[1:]) > -4e-3 and max(lowest[1:]) < 0.2
    assert_picture(tmp_path / "run.png")
