# SPDX-License-Identifier: Apache-2.0
"""Clashes of an assembly from Python."""

import base64
import json

import meshes
import numpy as np
import pytest
import raycontact as rc
from raycontact.__main__ import main

BOX = rc.Mesh(*meshes.box(), name="box")


def row(*places):
    return [(f"part {i}", BOX, rc.pose([x, 0, 0])) for i, x in enumerate(places)]


def test_depths_touches_and_gaps():
    found = rc.clash(row(0, 0.75, 1.75, 5))
    assert [(one.a, one.b) for one in found] == [("part 0", "part 1"), ("part 1", "part 2")]
    assert found[0].depth == pytest.approx(0.25, abs=1e-5) and found[1].depth == 0
    assert np.allclose(found[0].normal, [1, 0, 0]) and found[1].normal is None
    assert 0.25 - 1e-5 <= found[0].point[0] <= 0.5 + 1e-5 and found[1].point[0] == pytest.approx(1.25)
    assert found.parts == [f"part {i}" for i in range(4)] and found.pairs == 2 and not found.faults and not found.open
    assert len(rc.clash(row(0, 0.75, 1.75, 5), ignore_touching=0)) == 1
    assert len(rc.clash(row(0, 0.75, 1.75, 5), ignore_touching=0.3)) == 0
    assert "touching" in str(found) and "0.25 m" in str(found)


def test_duplicates_and_parts_inside_others():
    small = rc.Mesh(*meshes.box((0.2, 0.2, 0.2)), name="small")
    found = rc.clash([*row(0, 0), ("small", small, None)])
    assert found[0].duplicate and {(one.a, one.b) for one in found} == {
        ("part 0", "part 1"), ("part 0", "small"), ("part 1", "small"),
    }  # fmt: skip
    assert all(one.depth > 0 for one in found)


def test_kinds_boxes_and_volumes():
    pipe = rc.Mesh(*meshes.box((3, 0.25, 0.25)), name="pipe")
    utm = np.array([691234.5, 5334567.25, 512.125])
    parts = [("wall", BOX, rc.pose(utm)), ("pipe", pipe, rc.pose(utm)), ("off", BOX, rc.pose(utm + [0, 1.125, 0]))]
    found = rc.clash(parts, clearance=0.125, volumes=True)
    assert [one.kind for one in found] == ["piercing", "near"] and found[0].volume == pytest.approx(1 / 16)
    assert np.allclose(found[0].box - utm, [[-0.5, -0.125, -0.125], [0.5, 0.125, 0.125]], atol=1e-5)
    near = found[1]
    assert (near.a, near.b, near.distance, near.depth) == ("wall", "off", 0.125, -0.125)
    assert near.point_a[1] == utm[1] + 0.5 and near.point_b[1] == utm[1] + 0.625 and near.box is None
    assert "one through the other" in str(found) and "0.125 m apart" in str(found) and near.open == (False, False)
    assert rc.clash(parts, clearance=0.125, ignore_touching=9)[0].kind == "near"
    assert [one.kind for one in rc.clash(row(0, 0.999, 2.0), tolerance=0.0011)] == ["touching"] * 2


def tree(file, places):
    """Writes a glTF file of boxes of 1 m under nodes: places by path, "hall/pipe 1"."""
    vertices, faces = meshes.box()
    data = np.asarray(vertices, np.float32).tobytes() + np.asarray(faces, np.uint32).tobytes()
    nodes, numbers = [], {}
    for path, place in places.items():
        names = path.split("/")
        for depth in range(1, len(names) + 1):
            own = "/".join(names[:depth])
            if own not in numbers:
                numbers[own] = len(nodes)
                nodes.append({"name": names[depth - 1]})
                if depth > 1:
                    nodes[numbers["/".join(names[: depth - 1])]].setdefault("children", []).append(numbers[own])
        nodes[numbers[path]] |= {"mesh": 0, "translation": [place, 0, 0]}
    views = [{"buffer": 0, "byteOffset": start, "byteLength": size} for start, size in
             ((0, 12 * len(vertices)), (12 * len(vertices), 12 * len(faces)))]  # fmt: skip
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3"},
        {"bufferView": 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"},
    ]
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    roots = [numbers[path] for path in numbers if "/" not in path]
    primitive = {"attributes": {"POSITION": 0}, "indices": 1}
    file.write_text(json.dumps({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": roots}], "nodes": nodes, "accessors": accessors,
        "meshes": [{"primitives": [primitive]}], "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": uri}],
    }))  # fmt: skip
    return file


def test_paths_of_nodes_are_told_and_match(tmp_path):
    hall = tree(
        tmp_path / "hall.gltf", {"hall/pipes/pipe": 0, "hall/pipes/valve": 0.75, "hall/wall": 1.5, "post": 2.25}
    )
    found = rc.clash(hall)
    assert found.paths == ["hall/pipes/pipe", "hall/pipes/valve", "hall/wall", "post"]
    assert found.parts == ["pipe", "valve", "wall", "post"] and len(found) == 3
    assert "hall/pipes/pipe  x  hall/pipes/valve" in str(found)

    def pairs(**options):
        return [(one.a, one.b) for one in rc.clash(hall, **options)]

    assert pairs(against="pipes/*") == [("valve", "wall")] and pairs(against="hall/*") == [("wall", "post")]
    assert pairs(exclude=[("pipes/*", "hall/*")]) == [("wall", "post")]
    assert pairs(against="pipes/*", components=True) == [("valve", "wall")]
    assert rc.clash([("a/b", BOX, None), ("c", BOX, None)], against="a/*").paths == ["a/b", "c"]


def test_separations_part_what_clashes():
    found = rc.clash(row(0, 0.75, 1.75), separations=True)
    parted = found[0].separation
    assert parted.distance == pytest.approx(-0.25, abs=1e-4) and np.allclose(parted.normal, [1, 0, 0])
    away = rc.pose([0.75 - parted.distance * parted.normal[0], 0, 0])
    assert not rc.intersects(BOX, BOX, None, away) and parted.point_a[0] == pytest.approx(0.5)
    assert found[1].kind == "touching" and found[1].separation is None
    assert rc.clash(row(0, 0.75))[0].separation is None


def test_pairs_are_chosen():
    parts = row(0, 0.75, 1.5, 2.25)

    def pairs(**options):
        return {(one.index_a, one.index_b) for one in rc.clash(parts, **options)}

    assert pairs() == {(0, 1), (1, 2), (2, 3)}
    assert pairs(against="part 0") == {(0, 1)} and pairs(against=["part [0]", "*2"][1:]) == {(1, 2), (2, 3)}
    assert pairs(exclude=[("part ?", "part 2"), "parent-child"]) == {(0, 1)}
    bad = [{"against": "no*"}, {"exclude": [("part 0", "no")]}, {"exclude": [("part 0",)]}, {"clearance": -1}]
    for options in [*bad, {"tolerance": float("nan")}]:
        with pytest.raises(rc.InputError):
            pairs(**options)


def test_some_pairs_have_another_clearance():
    parts = row(0, 1.02, 2.04, 3.1)

    def pairs(*clearances, clearance=0.0):
        found = rc.clash(parts, clearance=clearance, clearances=clearances)
        return {(one.index_a, one.index_b) for one in found}

    assert pairs((0.03, "part 0")) == {(0, 1)} and pairs((0.03, "*")) == {(0, 1), (1, 2)} == pairs(clearance=0.03)
    assert pairs((0.07, "part 3", "part 2"), (0.03, "part 1", "part 3")) == {(2, 3)}
    assert pairs((0.01, "*"), clearance=0.03) == {(0, 1), (1, 2)}
    near = rc.clash_along(parts, "part 3", rc.slide((0, 0, 1), [0, 1]), clearances=[(0.07, "part 2")])
    assert [(one.other, one.meet) for one in near] == [("part 2", False)]
    for bad in [(0.1,), ("part 0", 0.1), 0.1, (0.1, ""), (0.1, "no"), (-1, "*"), (0.1, "*", "*", "*")]:
        with pytest.raises(rc.InputError):
            pairs(bad)


def test_clearances_from_the_shell(tmp_path, capsys):
    hall = tree(tmp_path / "hall.gltf", {"pipe": 0, "wall": 1.02, "post": 2.04})

    def near(*words):
        status, out, err = in_shell(
            capsys, hall, "--json", *[word for given in words for word in ("--clearance", given)]
        )
        return [(one["a"], one["b"]) for one in map(json.loads, out.splitlines())] if status == 0 else err

    assert near("0.03:pipe") == [("pipe", "wall")] and near("0.03:post:wall", "0.01") == [("wall", "post")]
    assert near("0.01", "0.03:pipe:post") == [] and len(near("0.01", "0.03")) == 2
    for bad in ("x", "-1", "nan", "0.03:", "0.03:no"):
        assert "clearance" in near(bad)


def test_clashes_are_grouped(tmp_path):
    bolts = {f"hall/joint/bolt {i}": 0.8 + 0.01 * i for i in range(3)}
    hall = tree(tmp_path / "hall.gltf", {"hall/flange": 0, **bolts, "post": -0.9})
    found = rc.clash(hall, exclude=[("bolt*", "bolt*")])
    (flange,) = found.groups()
    assert (flange.a, flange.b, len(flange.clashes)) == ("hall/flange", None, 4) and flange.clashes == list(found)
    assert np.allclose(flange.box[:, 0], [-0.5, 0.5], atol=1e-4)
    groups = {(group.a, group.b): len(group.clashes) for group in found.groups("assembly")}
    assert groups == {("hall", "hall/joint"): 3, ("hall", "post"): 1}
    assert {(group.a, group.b) for group in found.groups(1)} == {("hall", "hall"), ("hall", "post")}
    (pair,) = rc.clash(row(0, 0.5)).groups()
    assert (pair.a, pair.b) == ("part 0", "part 1") and not rc.clash(row(0, 5)).groups("assembly")
    near = rc.clash(row(0, 1.5), clearance=1).groups()[0]
    assert np.allclose(near.box[:, 0], [0.5, 1])
    for bad in ("parts", 0, -1, None):
        with pytest.raises(rc.InputError):
            found.groups(bad)


def test_corners_that_differ_in_their_last_digits_are_welded():
    vertices, faces = meshes.box()
    loose = np.asarray(vertices)[np.asarray(faces)].reshape(-1, 3)
    loose = loose + np.random.default_rng(1).uniform(-1e-8, 1e-8, loose.shape)
    soup = rc.Mesh(loose, np.arange(len(loose)).reshape(-1, 3), name="soup")
    utm = np.array([691234567.25, 5334567890.5, 512125])  # millimetres
    parts = [("a", soup, None), ("b", soup, rc.pose([0.75, 0, 0]))]
    assert rc.clash(parts).open == ["a", "b"]
    found = rc.clash(parts, weld=1e-6)
    assert not found.open and found[0].depth == pytest.approx(0.25, abs=1e-5)
    assert not rc.clash(parts, scale=1000, weld=1e-3).open
    metre = rc.Mesh(1000 * loose + utm, np.arange(len(loose)).reshape(-1, 3))
    found = rc.clash([metre, ("b", metre, rc.pose([750, 0, 0]))], weld=1e-3)
    assert not found.open and found[0].depth == pytest.approx(250, abs=1e-2)
    for weld in [0, 2e9, float("nan")]:
        with pytest.raises(rc.InputError):
            rc.clash(parts, weld=weld)
    with pytest.raises(rc.InputError, match="no digits below"):
        rc.clash([metre, metre], weld=1e-7)


def test_parts_are_split_into_their_components(tmp_path, capsys):
    vertices, faces = (np.asarray(half) for half in meshes.box())
    both = np.vstack([vertices, vertices + [0.75, 0, 0]]), np.vstack([faces, faces + len(vertices)])
    file = tmp_path / "two.stl"
    file.write_bytes(meshes.ascii_stl(*both))
    parts = rc.load_assembly(file, components=True)
    assert [part.name for part in parts] == ["two.stl #1", "two.stl #2"]
    assert [len(part.mesh.triangles) for part in parts] == [len(faces)] * 2
    for assembly in (file, [("two.stl", rc.Mesh(*both), None)]):
        (found,) = rc.clash(assembly, components=True)
        assert (found.a, found.b) == ("two.stl #1", "two.stl #2") and found.depth == pytest.approx(0.25, abs=1e-5)
    with pytest.raises(rc.InputError, match="components=True splits parts further"):
        rc.clash(file)
    assert in_shell(capsys, file, "--components", "--check")[0] == 3
    # After scale and weld.
    loose = both[0][both[1]].reshape(-1, 3)
    loose = loose + np.random.default_rng(1).uniform(-1e-8, 1e-8, loose.shape)
    soup = rc.Mesh(1000 * loose, np.arange(len(loose)).reshape(-1, 3), name="soup")
    (found,) = rc.clash([soup], scale=0.001, weld=1e-6, components=True)
    assert (found.a, found.b) == ("soup #1", "soup #2") and found.depth == pytest.approx(0.25, abs=1e-5)


def in_shell(capsys, *words):
    status = main(["clash", *[str(word) for word in words]])
    told = capsys.readouterr()
    return status, told.out, told.err


def test_pairs_are_excluded_and_parts_welded_from_the_shell(tmp_path, capsys):
    vertices, faces = meshes.box()
    groups = []
    for i in range(3):
        groups += [f"o box {i}"] + [f"v {x + 0.75 * i} {y} {z}" for x, y, z in vertices]
        groups += ["f " + " ".join(str(v + 1 + len(vertices) * i) for v in face) for face in faces]
    file, pairs = tmp_path / "row.obj", tmp_path / "pairs.csv"
    file.write_text("\n".join(groups) + "\n")

    def clashing(text, *words):
        pairs.write_bytes(text)
        status, out, err = in_shell(capsys, file, "--json", "--exclude", pairs, *words)
        assert status == 0, err
        return [(one["a"], one["b"]) for one in map(json.loads, out.splitlines())]

    assert clashing(b"") == [("box 0", "box 1"), ("box 1", "box 2")]
    assert clashing(b'\xef\xbb\xbf"box 2",box ?\r\n\r\n# not these\r\n') == [("box 0", "box 1")]
    assert clashing(b"box 0,*\n", "--exclude", "parent-child", "--weld", "1e-6") == [("box 1", "box 2")]
    bad = [(b"box 0\n", "pairs.csv:1: is not two names"), (b'#\n"box 0,box 1\n', "pairs.csv:2: is not two names")]
    for text, says in [*bad, (b"box 0,\n", "pairs.csv:1"), (b"box 0,no\n", "no"), (b"\xff,x", "cannot be read")]:
        pairs.write_bytes(text)
        status, out, err = in_shell(capsys, file, "--exclude", pairs)
        assert status == 2 and says in err and not out
    status, _, err = in_shell(capsys, file, "--exclude", tmp_path / "none.csv")
    assert status == 2 and "none.csv: cannot be read" in err and "parent-child" in err
    assert in_shell(capsys, file, "--weld", "0")[0] == 2


def test_clashes_are_the_pairs_that_intersect():
    rng = np.random.default_rng(3)
    parts = []
    for i in range(40):
        vertices, faces = meshes.torus() if i % 2 else meshes.bracket()
        pose = rc.pose(rng.uniform(-4, 4, 3), meshes.random_rotations(1, rng)[0])
        parts.append((f"{i}", rc.Mesh(vertices, faces), pose))
    found = rc.clash(parts)
    shapes, poses = [rc.Shape(mesh) for _, mesh, _ in parts], np.stack([pose for _, _, pose in parts])
    a, b = np.triu_indices(len(parts), 1)
    hits = rc.intersects([shapes[i] for i in a], [shapes[i] for i in b], poses[a], poses[b])
    assert 5 < hits.sum() < len(hits)
    assert {(one.index_a, one.index_b) for one in found} == set(zip(a[hits].tolist(), b[hits].tolist()))


def test_progress_is_told_and_may_end_the_search():
    told = []
    rc.clash(row(0, 0.5, 1), progress=told.append)
    assert told and told == sorted(told) and told[-1] == 1

    def refuse(done):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        rc.clash(row(0, 0.5, 1), progress=refuse)
    assert len(rc.clash(row(0, 0.5, 1), progress=True)) == 3


def door():
    """A door of 1 m about a hinge at (5, 0, 0), a wall that it meets, and a post that it passes."""
    size = {"door": (0.9, 0.04, 2), "wall": (0.8, 0.1, 2), "post": (0.1, 0.1, 2)}
    at = {"door": (5.55, 0, 1), "wall": (4.9, 0.55, 1), "post": (5.25, -0.85, 1)}
    return [(name, rc.box(size[name]), rc.pose(at[name])) for name in size]


def test_what_moves_is_told_what_it_meets_and_when():
    angles = np.linspace(0, np.radians(120), 3)
    found = rc.clash_along(door(), "d*r", rc.turn((0, 0, 1), angles, (5, 0, 0)), at=np.degrees(angles))
    (met,) = found
    assert (met.moving, met.other, met.index_moving, met.index_other, met.meet) == ("door", "wall", 0, 1, True)
    angle = np.arctan2(0.5, 0.3) - np.arcsin(0.02 / np.hypot(0.5, 0.3))  # its face comes to the wall's corner
    assert met.at == pytest.approx(np.degrees(angle), abs=1e-3) and met.time == pytest.approx(2 * met.at / 120)
    assert np.allclose(met.point_other[:2], [5.3, 0.5], atol=1e-5) and met.distance < 1e-5
    assert found.nearest.other == "post" and not found.nearest.meet and "meet  at 57." in str(found)
    # The other way it passes the post, which lies beyond its end: the corner of its end comes nearest.
    angles = -angles
    moves = rc.turn((0, 0, 1), angles, (5, 0, 0))
    away = rc.clash_along(door(), ["door"], moves)
    corner, post = np.hypot(1, 0.02), np.hypot(0.2, 0.8)
    assert post < corner and [one.other for one in away] == ["post"], "it does not: it is met"
    far = [*door()[:2], ("post", door()[2][1], rc.pose((5.25, -1.15, 1)))]
    away = rc.clash_along(far, "door", moves, exclude=[("door", "wall")])
    assert not away and not away.nearest.meet and away.nearest.at == away.nearest.time
    assert away.nearest.distance == pytest.approx(np.hypot(0.2, 1.1) - corner, abs=2e-4)
    assert rc.clash_along(far, "door", moves, clearance=0.2)[0].other == "post"
    # A drawer; what stays in its place; all as files in millimetres have it.
    (met,) = rc.clash_along(row(0, 3), "part 0", rc.slide((1, 0, 0), [0, 4]), at=[0, 4])
    assert met.at == pytest.approx(2, abs=1e-5)
    (met,) = rc.clash_along(row(0, 3000), "part 0", rc.slide((1, 0, 0), [0, 4]), scale=0.001)
    assert met.at == pytest.approx((3 - 0.001) / 4, abs=1e-5)
    assert rc.clash_along(row(0, 0.5), "part 0", np.eye(4))[0].time == 0


def test_moves_that_are_none_are_refused():
    moves = rc.slide((1, 0, 0), [0, 4])
    for words in [{"moving": "no*"}, {"moving": []}, {"moving": "*"}, {"moves": np.empty((0, 4, 4))},
                  {"moves": 2 * moves}, {"moves": moves[None]}, {"at": [1]}, {"at": [0, np.nan]},
                  {"clearance": -1}]:  # fmt: skip
        with pytest.raises(rc.InputError):
            rc.clash_along(row(0, 3), **{"moving": "part 0", "moves": moves, **words})

    def refuse(done):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        rc.clash_along(row(0, 3, 6), "part 0", rc.slide((1, 0, 0), [0, 9]), progress=refuse)


def test_a_part_that_cannot_be_checked_is_named():
    flat = rc.Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
    found = rc.clash([*row(0, 0.5), ("flat", flat, None), ("flat", flat, None)])
    assert [(one.part, one.name) for one in found.faults] == [(2, "flat"), (3, "flat")] and len(found) == 1
    assert all("area" in one.why for one in found.faults) and "not checked: flat, flat" in str(found)
    sheet = rc.Mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
    opened = rc.clash([*row(0), ("sheet", sheet, None)])
    assert opened.open == ["sheet"] and len(opened) == 1


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: rc.clash("no/such.glb"), "no/such.glb"),
        (lambda: rc.clash([BOX]), "1 part"),
        (lambda: rc.clash(BOX), "Mesh"),
        (lambda: rc.clash(7), "int"),
        (lambda: rc.clash([BOX, ("b", BOX, np.eye(3))]), "part 1"),
        (lambda: rc.clash([BOX, ("b", BOX, np.diag([2, 2, 2, 1]))]), "rigid"),
        (lambda: rc.clash([BOX, ("b", BOX, np.stack([np.eye(4)] * 2))]), "give one"),
        (lambda: rc.clash([BOX, 7]), "int"),
    ],
)
def test_bad_assemblies_are_value_errors(make, says):
    with pytest.raises(ValueError, match=says):
        make()
