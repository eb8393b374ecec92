# SPDX-License-Identifier: Apache-2.0
"""Meshes, shapes and assemblies from Python: what is given arrives."""

import collections
import concurrent.futures
import copy
import multiprocessing
import pickle
import zipfile

import brute_force
import helpers
import meshes
import numpy as np
import pytest
import raycontact as rc

RNG = np.random.default_rng(47)


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
    try:
        parts = rc.load_assembly(tmp_path / "two.3mf", weld=1e-6)
    except rc.InputError as error:
        if "RAYCONTACT_3MF is off" not in str(error):
            raise
        pytest.skip(str(error))
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


def test_meshes_are_pickled_and_shapes_are_shared_by_copies(torus):
    mesh = rc.Mesh(*meshes.bracket(), name="L")
    again = pickle.loads(pickle.dumps(mesh))
    assert np.array_equal(again.vertices, mesh.vertices) and np.array_equal(again.triangles, mesh.triangles)
    assert again.name == "L" and copy.deepcopy([torus])[0] is torus and copy.copy(torus) is torus


def shapes_of_many_kinds():
    vertices, faces = meshes.torus()
    two = (np.concatenate([vertices, vertices + [0.3, 0.1, 0.05]]), np.concatenate([faces, faces + len(vertices)]))
    far = vertices + [1e6 / 3, -7.7, 1 / 3]  # in float32 about their middle they are others
    yield "plain", rc.Shape(rc.Mesh(vertices, faces, name="ring"))
    yield "far", rc.Shape(rc.Mesh(far, faces))
    yield "holed", rc.Shape(rc.Mesh(vertices, np.delete(faces, [3, 200], axis=0)))
    yield "united", rc.Shape(rc.Mesh(*two))
    yield "crossing", rc.Shape(rc.Mesh(*two), overlaps="leave")
    yield "inward", rc.Shape(rc.Mesh(vertices, faces[:, ::-1]), repair=False)
    yield "sheet", rc.Shape(rc.Mesh(vertices, faces[::3]))
    yield "welded", rc.Shape(rc.Mesh(*loose(vertices, faces, 1e-9), weld=1e-6))


@pytest.mark.parametrize(("kind", "shape"), [pytest.param(*both, id=both[0]) for both in shapes_of_many_kinds()])
def test_a_pickled_shape_is_the_same_to_the_bit(kind, shape, bracket):
    again = pickle.loads(pickle.dumps(shape))
    for name in ("vertices", "triangles", "vertex_index", "triangle_index", "vertex_normals", "vertex_areas",
                 "exit_distances", "box"):  # fmt: skip
        assert getattr(again, name).tobytes() == getattr(shape, name).tobytes(), name
    for name in ("name", "has_inside", "radius", "longest_edge"):
        assert getattr(again, name) == getattr(shape, name)
    fields = [name for name in dir(shape.report) if not name.startswith("_") and name != "to_json"]
    assert len(fields) > 18 and shape.report.to_json() == again.report.to_json()
    for name in fields:
        assert getattr(again.report, name) == getattr(shape.report, name), name
    poses = helpers.random_poses(30, 1.5)
    poses[:, :3, 3] += shape.box.mean(axis=0) * (kind == "far")
    found = rc.collide(shape, bracket, pose_b=poses)
    assert len(found) and helpers.same(rc.collide(again, bracket, pose_b=poses), found)
    assert np.array_equal(rc.intersects(again, bracket, pose_b=poses), rc.intersects(shape, bracket, pose_b=poses))
    assert pickle.loads(pickle.dumps(again.report)).repairs == shape.report.repairs


def test_shapes_cross_to_other_processes(torus, bracket):
    poses = helpers.random_poses(20, 1.2)
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=context) as pool:
        theirs = pool.submit(rc.intersects, torus, bracket, pose_b=poses).result()
    assert np.array_equal(theirs, rc.intersects(torus, bracket, pose_b=poses)) and theirs.any()


def test_a_damaged_pickle_is_refused(torus):
    make, (data,) = torus.__reduce__()
    with pytest.raises(rc.InputError, match="damaged"):
        make(data[:-1])
    with pytest.raises(rc.InputError, match="another version"):
        rc.MeshReport.__new__(rc.MeshReport).__setstate__(torus.report.__getstate__()[1:])


def test_a_shape_is_saved_and_loaded_with_what_was_prepared(bracket):
    shape = rc.Shape(rc.Mesh(*meshes.torus(), name="ring"))
    assert not rc.Shape.load(shape.save()).is_prepared
    shape.prepare()
    data = shape.save()
    again = rc.Shape.load(bytearray(data))
    assert isinstance(data, bytes) and again.is_prepared and again.save() == data
    assert pickle.loads(pickle.dumps(shape)).is_prepared
    poses = helpers.random_poses(30, 1.5)
    found = rc.collide(shape, bracket, pose_b=poses)
    assert len(found) and helpers.same(rc.collide(again, bracket, pose_b=poses), found)
    for wrong, why in ((b"", "no shape"), (data[:-1], "damaged"), (data + b"0", "damaged"), ("text", "is a str")):
        with pytest.raises(rc.InputError, match=why):
            rc.Shape.load(wrong)
    ball = rc.Shape.load(rc.ball(0.5).save())
    assert ball.round.radius == 0.5 and rc.distance(ball, ball, pose_b=rc.pose((2, 0, 0))).distance == 1


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
    for bad in (0, np.nan, np.inf, "big", [1, 0, 1], [1, 2], (1, 2, np.inf), [[1, 1, 1]], [], None):
        with pytest.raises(rc.InputError, match="scale"):
            rc.Shape(trimesh.creation.box(), scale=bad)
    for bad in (0, -1, np.nan, [1, 1, 1]):
        with pytest.raises(rc.InputError, match="scale"):
            rc.clash([trimesh.creation.box()] * 2, scale=bad)
        with pytest.raises(rc.InputError, match="scale"):
            rc.load_assembly(tmp_path / "mm.glb", scale=bad)


@pytest.mark.parametrize(
    "scale", [2, -1, (2, 3, 0.5), [-2, 3, 0.5], (-1, -3, 1), np.array([-1.5, -1, -1]), (1, 1, -0.001), -0.25]
)
def test_three_factors_stretch_and_mirror(scale, tmp_path):
    vertices, faces = meshes.bracket()
    (tmp_path / "L.stl").write_bytes(meshes.ascii_stl(vertices, faces))
    factors = np.broadcast_to(scale, 3)
    mesh = rc.Mesh(vertices, faces, scale=scale)
    assert np.array_equal(mesh.vertices, vertices * factors)
    assert [sorted(t) for t in mesh.triangles.tolist()] == [sorted(t) for t in faces.tolist()]
    for made in (mesh, rc.Mesh(tmp_path / "L.stl", scale=scale), rc.Mesh(rc.Mesh(vertices, faces), scale=scale)):
        shape = rc.Shape(made, repair=False)
        assert shape.report.good and shape.report.volume == pytest.approx(3 * abs(np.prod(factors)))
    shape = rc.Shape(rc.Mesh(vertices, faces), scale=scale)
    points = RNG.uniform(-0.5, 2.5, (200, 3))
    inside = brute_force.winding(points, vertices[faces]) > 0.5
    assert inside.any() and np.array_equal(rc.contains(shape, points * factors), inside)


def test_no_scale_changes_nothing():
    mesh = rc.Mesh(*meshes.torus(), name="ring")
    for one in (1, 1.0, (1, 1, 1), np.ones(3), np.float32(1)):
        assert np.array_equal(rc.Mesh(mesh, scale=one).triangles, mesh.triangles)
        assert rc.Shape(mesh, scale=one).name == "ring"


def test_collada_files_are_read_by_others(tmp_path):
    (tmp_path / "part.DAE").write_text("<COLLADA/>")
    with pytest.raises(rc.InputError, match=r'part.DAE.*trimesh.load\(file, force="mesh"\)'):
        rc.Mesh(tmp_path / "part.DAE")
    with pytest.raises(rc.InputError, match="unknown ending"):
        rc.Shape(tmp_path.joinpath("part.stp").write_text("ISO") and tmp_path / "part.stp")


def doubled(vertices, faces):
    return vertices, np.concatenate([faces, faces[:, ::-1]])


@pytest.mark.parametrize("repair", [True, False])
@pytest.mark.parametrize("shift", [0, 1e5])
def test_report_and_mass_agree_about_volumes(repair, shift):
    vertices, faces = meshes.torus()
    vertices = vertices + shift
    true = 2 * np.pi**2 * 0.35**2
    inner = vertices.mean(axis=0) + (vertices - vertices.mean(axis=0)) * 0.5
    cases = {
        "closed": (vertices, faces),
        "holed": (vertices, np.delete(faces, [3, 200], axis=0)),
        "inward": (vertices, faces[:, ::-1]),
        "open": (vertices, faces[::2]),
        "doubled": doubled(vertices, faces[:200]),
        "twice": (vertices, np.concatenate([faces, faces])),
        "badly wound": (vertices, np.concatenate([faces[:100, ::-1], faces[100:]])),
        "crossing": (np.concatenate([vertices, inner]), np.concatenate([faces, faces + len(vertices)])),
        "flat": ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
    }
    for name, mesh in cases.items():
        shape = rc.Shape(rc.Mesh(*mesh), repair=repair)
        assert shape.mass.volume == shape.report.volume, name
        if shape.report.volume == 0:
            assert not shape.mass.centre.any() and not shape.mass.inertia.any(), name
        else:
            assert (shape.mass.volume > 0) == (np.diag(shape.mass.inertia) > 0).all(), name
        if name in ("closed", "holed", "inward") and (repair or name != "holed"):
            sign = -1 if name == "inward" and not repair else 1
            assert shape.mass.volume == pytest.approx(sign * true, rel=0.08)
            assert shape.mass.centre == pytest.approx(np.full(3, shift), abs=1e-2)
