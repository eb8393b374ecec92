# SPDX-License-Identifier: Apache-2.0
"""raycontact.collision: the collision manager of trimesh."""

import gc
import threading
import tracemalloc
import weakref
from collections import namedtuple

import numpy as np
import pytest
import raycontact as rc
from raycontact import _shared_shapes, collision
from raycontact.collision import CollisionManager, ContactData, DistanceData, scene_to_collision

Given = namedtuple("Given", "vertices faces")


class Solid:
    """A mesh of another library, as far as we look at it."""

    def __init__(self, vertices, faces):
        self.vertices = np.array(vertices, float)
        self.faces = np.array(faces)


QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box(x=1.0, y=1.0, z=1.0):
    """About the origin."""
    corners = [(i - 0.5, j - 0.5, k - 0.5) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    faces = [[q[0], q[i], q[i + 1]] for q in QUADS for i in (1, 2)]
    return Solid(np.array(corners) * (x, y, z), faces)


def ring(around=16, across=8, large=1.0, small=0.3, wave=0.0):
    """Concave: a torus, with waves along it."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / across
    r = small * (1 + wave * np.cos(5 * a))
    points = np.stack([(large + r * np.cos(b)) * np.cos(a), (large + r * np.cos(b)) * np.sin(a), r * np.sin(b)], -1)
    corners = [((u + i) % around) * across + (v + j) % across for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    faces = np.concatenate([np.stack([corners[k] for k in t], -1).reshape(-1, 3) for t in ((0, 1, 2), (0, 2, 3))])
    return Solid(points.reshape(-1, 3), faces)


def trough():
    """Concave: three plates, as one U of a single closed mesh."""
    outline = [(0, 0), (2, 0), (2, 1.5), (1.8, 1.5), (1.8, 0.2), (0.2, 0.2), (0.2, 1.5), (0, 1.5)]
    points = np.array([(x - 1, y - 0.75, z) for z in (-0.6, 0.6) for x, y in outline])
    caps = [(0, 1, 4), (1, 2, 3), (1, 3, 4), (0, 4, 5), (0, 5, 6), (0, 6, 7)]
    faces = [[c, b, a] for a, b, c in caps] + [[a + 8, b + 8, c + 8] for a, b, c in caps]
    for i in range(8):
        j = (i + 1) % 8
        faces += [[i, j, j + 8], [i, j + 8, i + 8]]
    return Solid(points, faces)


def sheet(n=3):
    """Open: a square of 1 m in z = 0."""
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, n + 1), np.linspace(-0.5, 0.5, n + 1), indexing="ij")
    faces = []
    for i in range(n):
        for j in range(n):
            a, b = i * (n + 1) + j, (i + 1) * (n + 1) + j
            faces += [[a, b, b + 1], [a, b + 1, a + 1]]
    return Solid(np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], -1), faces)


def at(x=0.0, y=0.0, z=0.0):
    return rc.pose((x, y, z))


def anywhere(rng, reach):
    return rc.pose_from_quaternion(rng.uniform(-reach, reach, 3), rng.normal(size=4))


def distance_to_face(solid, pose, index, point):
    """Metres from a point to one face of a placed mesh."""
    alone = Solid(solid.vertices, solid.faces[[index]])
    return rc.closest_point(rc.Shape(alone, repair=False), point, pose).distance


def modules():
    """Ours, and trimesh's where it works."""
    yield pytest.param(collision, id="raycontact")
    try:
        import scipy  # noqa: F401  trimesh asks it whether a mesh is convex
        import trimesh.collision

        trimesh.collision.CollisionManager()
    except (ImportError, ValueError) as error:
        yield pytest.param(None, id="trimesh", marks=pytest.mark.skip(f"no collision manager of trimesh here: {error}"))
    else:
        yield pytest.param(trimesh.collision, id="trimesh")


def cube_for(module):
    if module is collision:
        return box()
    import trimesh

    return trimesh.creation.box((1, 1, 1))


# What code written for trimesh's manager relies on: the same lines run with either.


@pytest.mark.parametrize("module", list(modules()))
class TestBoth:
    def test_a_mesh_against_objects(self, module):
        cube = cube_for(module)
        manager = module.CollisionManager()
        manager.add_object("near", cube)
        manager.add_object("far", cube, at(5))
        assert manager.in_collision_single(cube, at(0.3)) is True
        assert manager.in_collision_single(cube, at(-5)) is False
        assert manager.in_collision_single(cube, at(5.2), return_names=True) == (True, {"far"})
        assert manager.in_collision_single(cube, at(-5), return_names=True) == (False, set())
        hit, names, data = manager.in_collision_single(cube, at(5.2, 0.1), return_names=True, return_data=True)
        assert hit is True and names == {"far"} and len(data) > 0
        for contact in data:
            assert contact.names == {"far", "__external"}
            assert contact.point.shape == contact.normal.shape == (3,)
            assert np.linalg.norm(contact.normal) == pytest.approx(1)
            assert contact.depth > 0
        hit, data = manager.in_collision_single(cube, at(-5), return_data=True)
        assert hit is False and data == []

    def test_objects_come_go_and_move(self, module):
        cube = cube_for(module)
        manager = module.CollisionManager()
        manager.add_object("a", cube)
        manager.add_object("b", cube, at(5))
        assert manager.in_collision_internal() is False
        manager.add_object("c", cube, at(5.1, 0.1))
        hit, names = manager.in_collision_internal(return_names=True)
        assert hit is True and names == {("b", "c")}
        manager.set_transform("c", at(-5))
        assert manager.in_collision_internal(return_names=True) == (False, set())
        manager.set_transform("c", at(0.1, 0.1))
        hit, names, data = manager.in_collision_internal(return_names=True, return_data=True)
        assert hit is True and names == {("a", "c")}
        assert {frozenset(contact.names) for contact in data} == {frozenset("ac")}
        manager.remove_object("c")
        hit, data = manager.in_collision_internal(return_data=True)
        assert hit is False and data == []

    def test_two_managers(self, module):
        cube = cube_for(module)
        one, other = module.CollisionManager(), module.CollisionManager()
        one.add_object("z", cube)
        one.add_object("y", cube, at(5))
        other.add_object("a", cube, at(-5))
        assert one.in_collision_other(other) is False
        other.add_object("b", cube, at(5.2, 0.1))
        assert one.in_collision_other(other) is True
        assert one.in_collision_other(other, return_names=True) == (True, {("y", "b")})
        assert other.in_collision_other(one, return_names=True) == (True, {("b", "y")})
        _, names, data = one.in_collision_other(other, return_names=True, return_data=True)
        assert names == {("y", "b")} and {frozenset(contact.names) for contact in data} == {frozenset("yb")}

    def test_distances_and_names(self, module):
        cube = cube_for(module)
        manager = module.CollisionManager()
        manager.add_object("right", cube, at(5))
        assert manager.min_distance_single(cube) == pytest.approx(4)
        manager.add_object("left", cube, at(-5))
        least = manager.min_distance_internal()
        assert isinstance(least, float) and least == pytest.approx(9)
        assert manager.min_distance_internal(return_names=True)[1] == ("left", "right")
        least, name = manager.min_distance_single(cube, at(-2), return_name=True)
        assert least == pytest.approx(2) and name == "left"
        manager.add_object("middle", cube, at(1))
        least, names, data = manager.min_distance_internal(return_names=True, return_data=True)
        assert least == pytest.approx(3) and names == ("middle", "right") and data.names == {"middle", "right"}
        assert data.distance == least
        assert data.point("middle")[0] == pytest.approx(1.5) and data.point("right")[0] == pytest.approx(4.5)
        assert manager.min_distance_internal("left", return_names=True)[1] == ("left", "middle")
        other = module.CollisionManager()
        other.add_object("away", cube, at(5.25, 4, 0.125))
        least, names = manager.min_distance_other(other, return_names=True)
        assert least == pytest.approx(3) and names == ("right", "away")
        least, data = other.min_distance_other(manager, return_data=True)
        assert least == pytest.approx(3) and data.names == {"right", "away"}
        assert data.point("away")[1] == pytest.approx(3.5) and data.point("right")[1] == pytest.approx(0.5)

    def test_unknown_names_are_value_errors(self, module):
        manager = module.CollisionManager()
        manager.add_object("there", cube_for(module))
        with pytest.raises(ValueError):
            manager.remove_object("nowhere")
        with pytest.raises(ValueError):
            manager.set_transform("nowhere", np.eye(4))
        with pytest.raises(ValueError):
            manager.min_distance_internal("nowhere")
        with pytest.raises(ValueError):
            manager.add_object("flat", cube_for(module), np.eye(3))


class TestForms:
    """Every combination of flags has its own form."""

    @pytest.fixture
    def manager(self):
        manager = CollisionManager()
        for name, x in (("a", 0.0), ("b", 0.8), ("c", 4.0)):
            manager.add_object(name, box(), at(x))
        return manager

    def test_of_collisions(self, manager):
        other = CollisionManager()
        other.add_object("d", box(), at(4.5))
        for ask, names in (
            (lambda **k: manager.in_collision_single(box(), at(4.5), **k), {"c"}),
            (manager.in_collision_internal, {("a", "b")}),
            (lambda **k: manager.in_collision_other(other, **k), {("c", "d")}),
        ):
            assert ask() is True
            assert ask(return_names=True) == (True, names)
            hit, data = ask(return_data=True)
            assert hit is True and all(isinstance(contact, ContactData) for contact in data) and data
            hit, found, data = ask(return_names=True, return_data=True)
            assert hit is True and found == names and data

    def test_of_distances(self, manager):
        manager.remove_object("a")
        other = CollisionManager()
        other.add_object("d", box(), at(7))
        for ask, word, names in (
            (lambda **k: manager.min_distance_single(box(), at(7), **k), "return_name", "c"),
            (manager.min_distance_internal, "return_names", ("b", "c")),
            (lambda **k: manager.min_distance_other(other, **k), "return_names", ("c", "d")),
        ):
            least = ask()
            assert isinstance(least, float) and least > 0
            assert ask(**{word: True}) == (least, names)
            again, data = ask(return_data=True)
            assert again == least and isinstance(data, DistanceData) and data.distance == least
            again, found, data = ask(**{word: True, "return_data": True})
            assert again == least and found == names

    def test_without_objects(self):
        empty, other = CollisionManager(), CollisionManager()
        other.add_object("a", box())
        assert empty.in_collision_internal() is False
        assert empty.in_collision_internal(return_names=True, return_data=True) == (False, set(), [])
        assert empty.in_collision_single(box(), None, True, True) == (False, set(), [])
        assert empty.in_collision_other(other, True, True) == other.in_collision_other(empty, True, True)
        assert other.in_collision_internal(True, True) == (False, set(), [])
        assert empty.min_distance_single(box(), None, True, True) == (np.inf, None, None)
        assert empty.min_distance_internal(None, True, True) == (np.inf, None, None)
        assert other.min_distance_internal("a", True, True) == (np.inf, None, None)
        assert empty.min_distance_other(other) == np.inf


class TestContacts:
    def test_normals_lead_from_the_first_of_the_pair_to_the_second(self):
        manager = CollisionManager()
        manager.add_object("z", box())
        manager.add_object("a", box(), at(0.9, 0.2, 0.1))
        other = CollisionManager()
        other.add_object("m", box(), at(0.9, 0.2, 0.1))
        manager_of_one = CollisionManager()
        manager_of_one.add_object("z", box())
        for data, pair, x in (
            (manager.in_collision_internal(return_data=True)[1], ("a", "z"), -1),
            (manager_of_one.in_collision_other(other, return_data=True)[1], ("z", "m"), 1),
            (other.in_collision_other(manager_of_one, return_data=True)[1], ("m", "z"), -1),
            (manager_of_one.in_collision_single(box(), at(0.9, 0.2, 0.1), return_data=True)[1], ("z", "__external"), 1),
        ):
            assert data
            for contact in data:
                assert contact.pair == pair and contact.names == set(pair)
                assert contact.normal == pytest.approx((x, 0, 0), abs=1e-6)
                assert contact.depth == pytest.approx(0.1, abs=1e-6)
                assert contact.point[0] == pytest.approx(0.45, abs=1e-6)

    def test_they_are_those_of_collide(self):
        a, b = rc.Shape(ring(wave=0.4)), rc.Shape(trough())
        pose_a, pose_b = at(0.1, 0.2, 0.3), anywhere(np.random.default_rng(5), 0.4)
        manager = CollisionManager()
        manager.add_object("a", a, pose_a)
        manager.add_object("b", b, pose_b)
        found = rc.collide(a, b, pose_a, pose_b)
        data = manager.in_collision_internal(return_data=True)[1]
        assert len(data) == len(found) > 10
        assert [contact.depth for contact in data] == found.depth.tolist()
        points = np.array([contact.point for contact in data])
        half = np.array([contact.depth / 2 * contact.normal for contact in data])
        assert points + half == pytest.approx(found.point_a, abs=1e-6)
        assert points - half == pytest.approx(found.point_b, abs=1e-6)

    def test_faces_are_near_the_points(self):
        solids = {"box": box(0.9, 0.9, 3), "ring": ring(wave=0.3), "trough": trough()}
        rng = np.random.default_rng(2)
        poses = {name: anywhere(rng, 0.3) for name in solids}
        for a, b in (("box", "ring"), ("box", "trough"), ("ring", "trough")):
            manager = CollisionManager()
            manager.add_object(a, solids[a], poses[a])
            manager.add_object(b, solids[b], poses[b])
            data = manager.in_collision_internal(return_data=True)[1]
            found = rc.collide(solids[a], solids[b], poses[a], poses[b])
            assert len(data) == len(found) > 2
            for contact, row in zip(data, found):
                if row["ray_length"] == row["depth"]:
                    continue  # edges saw it: by planes of faces, which may end before
                for name in (a, b):
                    # The ray from the vertex meets the face; the point is half a depth from that vertex.
                    away = distance_to_face(solids[name], poses[name], contact.index(name), contact.point)
                    assert away <= row["ray_length"] + contact.depth / 2 + 1e-6
            with pytest.raises(KeyError):
                data[0].index("another")

    def test_a_vertex_or_an_edge_lies_on_its_face(self):
        solid = box()
        manager = CollisionManager()
        manager.add_object("a", solid, rc.pose_from_quaternion((0, 0, 0), (1, 0.3, 0.2, 0.1)))
        manager.add_object("b", box(4, 4, 4), at(0, 0, 2.55))
        a, b = (manager._objects[name] for name in "ab")
        found = rc.collide(a.shape, b.shape, a.pose, b.pose)
        data = manager.in_collision_internal(return_data=True)[1]
        assert len(data) == len(found)
        for contact, row in zip(data, found):
            if row["kind"] == rc.FeatureKind.EDGES or row["source"] == 0:
                assert distance_to_face(solid, a.pose, contact.index("a"), row["point_a"]) < 1e-6

    def test_a_body_wholly_inside_another_collides(self):
        manager = CollisionManager()
        manager.add_object("out", box(2, 2, 2))
        manager.add_object("in", ring(large=0.2, small=0.05), at(0.1))
        hit, names, data = manager.in_collision_internal(return_names=True, return_data=True)
        assert hit and names == {("in", "out")} and len(data) >= 1
        assert max(contact.depth for contact in data) > 0.5
        least, data = manager.min_distance_internal(return_data=True)
        assert least == 0 and data.distance == 0 and data.point("in") == pytest.approx(data.point("out"))
        assert 0 <= data.index("out") < 12 and 0 <= data.index("in")

    def test_a_hollow_is_outside(self):
        shell, hollow = box(2, 2, 2), box(1.5, 1.5, 1.5)
        both = Solid(np.concatenate([shell.vertices, hollow.vertices]),
                     np.concatenate([shell.faces, hollow.faces[:, ::-1] + 8]))  # fmt: skip
        manager = CollisionManager()
        manager.add_object("shell", both)
        assert manager.in_collision_single(box()) is False
        assert manager.min_distance_single(box()) == pytest.approx(0.25)

    @pytest.mark.parametrize("pose", [at(1), at(1, 1), at(1, 1, 1), at(-1, 0.3, 0.4)])
    def test_what_touches_exactly_collides_with_depth_0(self, pose):
        manager = CollisionManager()
        manager.add_object("a", box())
        manager.add_object("b", box(), pose)
        hit, names, data = manager.in_collision_internal(return_names=True, return_data=True)
        assert hit is True and names == {("a", "b")} and len(data) == 1
        (contact,) = data
        assert contact.depth == 0 and np.isnan(contact.normal).all() and contact.names == {"a", "b"}
        for name, place in (("a", None), ("b", pose)):
            assert distance_to_face(box(), place, contact.index(name), contact.point) < 1e-9
        assert manager.min_distance_internal() == 0
        away = pose.copy()
        away[0, 3] *= 1 + 2**-52
        manager.set_transform("b", away)
        assert manager.in_collision_internal() is False

    def test_open_meshes_have_a_contact_each(self):
        manager = CollisionManager()
        manager.add_object("flat", sheet())
        manager.add_object("upright", sheet(), rc.pose((0.1, 0.05, 0.1), [[1, 0, 0], [0, 0, -1], [0, 1, 0]]))
        manager.add_object("floating in a box", sheet(), at(0, 0, 9))
        manager.add_object("box", box(3, 3, 3), at(0, 0, 9.2))
        _, names, data = manager.in_collision_internal(return_names=True, return_data=True)
        assert names == {("flat", "upright"), ("box", "floating in a box")}
        assert {contact.pair for contact in data} == names
        for contact in data:
            assert all(contact.index(name) >= 0 for name in contact.pair)
            assert np.isfinite(contact.point).all()

    def test_every_pair_has_its_own(self):
        manager = CollisionManager()
        for i in range(40):
            manager.add_object(i, box(), at(0.9 * i))
            manager.add_object(-1 - i, box(), at(-10 - i))  # these touch their neighbours exactly
        _, names, data = manager.in_collision_internal(return_names=True, return_data=True)
        assert len(names) == 78
        assert {contact.pair for contact in data} == names
        assert sum(contact.depth == 0 for contact in data) == 39
        firsts = [contact.pair for contact in data]
        assert len([i for i in range(1, len(firsts)) if firsts[i] != firsts[i - 1]]) == 77  # those of a pair together


class TestNames:
    def test_the_same_name_replaces(self):
        # trimesh promises it too, and keeps the old object as well (5.2).
        cube, manager = box(), CollisionManager()
        manager.add_object("a", cube)
        manager.add_object("b", cube)
        assert manager.in_collision_internal()
        manager.add_object("b", cube, at(3))
        assert not manager.in_collision_internal()
        assert manager.min_distance_internal() == pytest.approx(2)

    def test_anything_hashable(self):
        manager = CollisionManager()
        manager.add_object(("arm", 3), box())
        manager.add_object(7, box(), at(0.5))
        manager.add_object(frozenset("x"), box(), at(9))
        _, names, data = manager.in_collision_internal(return_names=True, return_data=True)
        assert names == {(("arm", 3), 7)}  # these do not compare: in the order in which they were added
        assert data[0].index(7) >= 0 and data[0].index(("arm", 3)) >= 0
        assert manager.min_distance_internal(frozenset("x"), return_names=True)[1] == (7, frozenset("x"))
        manager.set_transform(7, at(9, 0.5))
        assert manager.in_collision_internal(return_names=True)[1] == {(7, frozenset("x"))}
        manager.remove_object(("arm", 3))
        assert manager.in_collision_internal(return_names=True)[1] == {(7, frozenset("x"))}

    def test_numbers_sort_as_numbers(self):
        manager = CollisionManager()
        manager.add_object(10, box())
        manager.add_object(9, box(), at(0.5))
        assert manager.in_collision_internal(return_names=True)[1] == {(9, 10)}
        assert manager.min_distance_internal(10, return_names=True)[1] == (9, 10)

    def test_two_managers_with_the_same_name(self):
        one, other = CollisionManager(), CollisionManager()
        one.add_object("a", box())
        other.add_object("a", box(), at(0.9))
        _, names, data = one.in_collision_other(other, return_names=True, return_data=True)
        assert names == {("a", "a")} and data[0].pair == ("a", "a")
        assert data[0].normal[0] == pytest.approx(1)

    def test_a_manager_against_itself(self):
        manager = CollisionManager()
        manager.add_object("a", box())
        manager.add_object("b", box(), at(3))
        assert manager.in_collision_other(manager, return_names=True)[1] == {("a", "a"), ("b", "b")}
        assert manager.min_distance_other(manager) == 0


class TestErrors:
    def test_name_the_object_and_what_to_do(self):
        manager = CollisionManager()
        manager.add_object("a", box())
        with pytest.raises(rc.InputError, match="object 'b': is not in the manager; add it"):
            manager.remove_object("b")
        with pytest.raises(rc.InputError, match="object 'b'"):
            manager.set_transform("b", np.eye(4))
        with pytest.raises(rc.InputError, match="object 'b'"):
            manager.min_distance_internal("b")
        with pytest.raises(rc.InputError, match="object 'm': .*no file name and has no vertices"):
            manager.add_object("m", 3)
        with pytest.raises(rc.InputError, match="object 'm': "):
            manager.add_object("m", "there is no such file.obj")
        with pytest.raises(rc.InputError, match="other_manager: is a builtins.str; give a raycontact.CollisionManager"):
            manager.in_collision_other("a")
        with pytest.raises(rc.InputError, match="mesh: "):
            manager.min_distance_single(Given(np.zeros((2, 2)), np.zeros((1, 3), int)))

    @pytest.mark.parametrize(
        "transform, why",
        [
            (np.eye(3), r"shape \(3, 3\)"),
            (np.eye(4)[None], r"shape \(1, 4, 4\); give one"),
            (np.diag([2, 2, 2, 1]), "scaled"),
            (np.diag([1, 1, -1, 1]), "mirrored"),
            (np.full((4, 4), np.nan), "transform"),
            (at(np.inf), "not a finite"),
            (at(5).T, "last row"),
            ("identity", "array|numbers"),
        ],
    )
    def test_transforms(self, transform, why):
        manager = CollisionManager()
        manager.add_object("a", box())
        for ask in (
            lambda: manager.add_object("a", box(), transform),
            lambda: manager.set_transform("a", transform),
            lambda: manager.in_collision_single(box(), transform),
            lambda: manager.min_distance_single(box(), transform),
        ):
            with pytest.raises(rc.InputError, match=why):
                ask()
        assert manager.in_collision_single(box(), at(0.5)) is True  # nothing was changed

    def test_of_a_mesh_leave_the_object(self):
        manager = CollisionManager()
        manager.add_object("a", box())
        with pytest.raises(rc.InputError):
            manager.add_object("a", Given(np.zeros((3, 3)), np.array([[0, 1, 2]])))
        assert manager.in_collision_single(box()) is True

    def test_the_users_matrix_may_change(self):
        pose = at(3)
        manager = CollisionManager()
        manager.add_object("a", box(), pose)
        pose[0, 3] = 0
        assert manager.in_collision_single(box()) is False


class TestShapes:
    def test_one_for_a_mesh_that_is_added_often(self):
        manager = CollisionManager()
        cube = box()
        shapes = {id(manager.add_object(i, cube, at(3 * i))) for i in range(50)}
        assert len(shapes) == 1
        other = CollisionManager()
        assert other.add_object("b", cube) is manager.add_object("c", cube)
        assert other.add_object("d", box()) is manager.add_object("c", cube)  # holds the same

    def test_a_shape_is_taken_as_it_is(self):
        shape = rc.Shape(box())
        assert CollisionManager().add_object("a", shape) is shape

    def test_a_mesh_that_changes_later_does_not_matter(self):
        manager = CollisionManager()
        cube = box()
        manager.add_object("a", cube)
        cube.vertices *= 10
        assert manager.in_collision_single(box(), at(3)) is False
        manager.add_object("b", cube, at(0, 0, 20))  # another shape
        assert manager.min_distance_internal() == pytest.approx(14.5)
        assert manager.in_collision_single(cube) is True

    def test_meshes_of_trimesh_that_change(self):
        trimesh = pytest.importorskip("trimesh")
        cube, manager = trimesh.creation.box((1, 1, 1)), CollisionManager()
        first = manager.add_object("a", cube)
        assert manager.add_object("b", cube, at(5)) is first and manager.add_object("c", cube.copy(), at(10)) is first
        cube.vertices[:, 0] *= 4  # in place
        assert manager.add_object("d", cube, at(0, 3)) is not first
        assert manager.min_distance_single(cube, at(7.5, 0, 2)) == 1
        cube.apply_scale(2)
        assert manager.in_collision_single(cube, at(7.5, 0, 1.5)) is True
        cube.faces = cube.faces[:6]
        assert not manager.add_object("e", cube, at(0, 9)).has_inside

    def test_questions_about_a_mesh_keep_its_shape(self, monkeypatch):
        made = []
        manager, cube = CollisionManager(), Solid(box().vertices * 1.25, box().faces)
        manager.add_object("far", rc.Shape(box()), at(5))
        make = rc._core.make_shape
        monkeypatch.setattr(rc._core, "make_shape", lambda *given: made.append(given) or make(*given))
        for _ in range(5):
            manager.in_collision_single(cube)
            manager.min_distance_single(cube)
        assert len(made) == 1

    def test_it_goes_with_the_mesh(self):
        manager, cube = CollisionManager(), Solid(box().vertices * 1.5, box().faces)
        gone = weakref.ref(manager.add_object("a", cube))
        manager.remove_object("a")
        assert gone() is not None and id(cube) in _shared_shapes._of_mesh
        number = id(cube)
        del cube
        gc.collect()
        assert gone() is None and number not in _shared_shapes._of_mesh

    @pytest.mark.parametrize("kind", ["Mesh", "tuple", "lists", "float32", "file", "Shape"])
    def test_all_kinds_of_meshes(self, kind, tmp_path):
        cube = box()
        if kind == "file":
            lines = [f"v {x} {y} {z}" for x, y, z in cube.vertices] + [f"f {a} {b} {c}" for a, b, c in cube.faces + 1]
            mesh = tmp_path / "cube.obj"
            mesh.write_text("\n".join(lines))
        else:
            mesh = {
                "Mesh": lambda: rc.Mesh(cube),
                "tuple": lambda: Given(cube.vertices, cube.faces),
                "lists": lambda: Given(cube.vertices.tolist(), cube.faces.tolist()),
                "float32": lambda: Given(cube.vertices.astype(np.float32), cube.faces.astype(np.uint16)),
                "Shape": lambda: rc.Shape(cube),
            }[kind]()
        manager = CollisionManager()
        assert manager.add_object("a", mesh) is manager.add_object("b", mesh, at(1))
        assert manager.in_collision_internal(return_names=True)[1] == {("a", "b")}
        assert manager.min_distance_single(mesh, at(3)) == 1


class TestScenes:
    class Scene:
        """As far as we look at a scene of trimesh."""

        def __init__(self, geometry, nodes):
            self.geometry = geometry
            self.graph = self
            self.nodes = nodes

        @property
        def nodes_geometry(self):
            return list(self.nodes)

        def __getitem__(self, node):
            return self.nodes[node]

    def test_nodes_are_objects(self):
        scene = self.Scene(
            {"cube": box(), "ring": ring()},
            {"left": (at(), "cube"), "right": (at(0.5), "cube"), "far": (at(9), "ring")},
        )
        manager, shapes = scene_to_collision(scene)
        assert isinstance(manager, CollisionManager) and list(shapes) == ["left", "right", "far"]
        assert shapes["left"] is shapes["right"] and shapes["far"] is not shapes["left"]
        assert manager.in_collision_internal(return_names=True) == (True, {("left", "right")})
        assert manager.min_distance_internal("far") == pytest.approx(9 - 1.3 - 1)

    @pytest.mark.parametrize("stretch", [(2, 2, 2), (2, 3, 4), (-1, 1, 1), (-2, -3, 0.5)])
    def test_a_stretched_node(self, stretch):
        turn = anywhere(np.random.default_rng(3), 1)
        scene = self.Scene({"a": trough()}, {"a": (turn @ np.diag([*stretch, 1]), "a")})
        manager, shapes = scene_to_collision(scene)
        assert shapes["a"].has_inside and shapes["a"].report.verdict == rc.Shape(trough()).report.verdict
        assert shapes["a"].mass.volume == pytest.approx(rc.Shape(trough()).mass.volume * abs(np.prod(stretch)))
        object_ = manager._objects["a"]
        placed = object_.shape.vertices @ object_.pose[:3, :3].T + object_.pose[:3, 3]
        wanted = (trough().vertices * stretch) @ turn[:3, :3].T + turn[:3, 3]
        assert np.sort(placed.round(9), axis=0) == pytest.approx(np.sort(wanted.round(9), axis=0))

    def test_errors_name_the_node(self):
        for transform, geometry, why in (
            (np.diag([1, 1, 0, 1]), box(), "flat"),
            (at(np.nan), box(), "not a finite number"),
            (np.eye(4), object(), "has no vertices and faces"),
        ):
            with pytest.raises(rc.InputError, match=f"object 'n': .*{why}"):
                scene_to_collision(self.Scene({"g": geometry}, {"n": (transform, "g")}))

    def test_of_trimesh(self):
        trimesh = pytest.importorskip("trimesh")
        rng = np.random.default_rng(4)
        balls = []
        for _ in range(100):
            ball = trimesh.creation.icosphere(subdivisions=1, radius=rng.uniform(0.2, 1))
            balls.append(ball.apply_translation(rng.uniform(0, 10, 3)))
        scene = trimesh.Scene(balls)
        scene.add_geometry(trimesh.creation.box((1, 1, 1)), node_name="large", transform=np.diag([3, 3, 3, 1]))
        manager, shapes = scene_to_collision(scene)
        assert len(shapes) == 101 and manager.in_collision_internal() is True
        assert shapes["large"].mass.volume == pytest.approx(27)
        names = manager.in_collision_internal(return_names=True)[1]
        assert names == brute_names(manager)


# Against all pairs, one by one.


def brute_names(manager):
    items = list(manager._objects.items())
    pairs = [(i, j) for i in range(len(items)) for j in range(i)]
    if not pairs:
        return set()
    a, b = ([items[p[k]][1] for p in pairs] for k in (0, 1))
    hit = rc.intersects(
        [x.shape for x in a], [x.shape for x in b], np.stack([x.pose for x in a]), np.stack([x.pose for x in b])
    )
    return {tuple(sorted((items[i][0], items[j][0]))) for (i, j), yes in zip(pairs, hit) if yes}


SOLIDS = box(), box(3, 0.2, 0.2), ring(), ring(10, 6, 0.5, 0.2, 0.4), trough(), sheet(), box(4, 4, 4)
SHAPES = [rc.Shape(solid) for solid in SOLIDS]


@pytest.mark.parametrize("seed", range(300))
def test_random_managers(seed):
    rng = np.random.default_rng(seed)
    reach = rng.choice([1.0, 3.0, 6.0, 20.0])
    on_grid = seed % 5 == 0  # so that many touch exactly
    one, other = CollisionManager(), CollisionManager()
    for k in range(rng.integers(2, 14)):
        pose = at(*rng.integers(-3, 4, 3)) if on_grid else anywhere(rng, reach)
        shape = SHAPES[0] if on_grid else SHAPES[rng.integers(len(SHAPES))]
        (one if rng.random() < 0.7 else other).add_object(f"{k % 7}-{k}", shape, pose)
    single, pose = SHAPES[rng.integers(len(SHAPES))], anywhere(rng, reach)

    def all_pairs(mine, theirs):
        found = {}
        for name, x in mine.items():
            for second, y in theirs.items():
                if not (mine is theirs and name >= second):
                    found[name, second] = rc.distance(x.shape, y.shape, x.pose, y.pose).distance
        return found

    external = collision._Object(single, pose)
    for distances, collide, nearest in (
        (all_pairs(one._objects, one._objects), one.in_collision_internal, one.min_distance_internal),
        (
            all_pairs(one._objects, other._objects),
            lambda *flags: one.in_collision_other(other, *flags),
            lambda **flags: one.min_distance_other(other, **flags),
        ),
        (
            all_pairs(one._objects, {"__external": external}),
            lambda *flags: one.in_collision_single(single, pose, *flags),
            None,
        ),
    ):
        hits = {pair for pair, least in distances.items() if least == 0}
        hit, names, data = collide(True, True)
        assert collide() is hit is bool(hits)
        assert names == (hits if nearest else {name for name, _ in hits})
        assert {contact.pair for contact in data} == hits
        for contact in data:
            assert contact.depth >= 0 and np.isfinite(contact.point).all()
            assert np.isnan(contact.normal).all() == (contact.depth == 0)
            assert all(contact.index(name) >= 0 for name in contact.pair)
        if nearest:
            least, pair, data = nearest(return_names=True, return_data=True)
        else:
            least, name, data = one.min_distance_single(single, pose, True, True)
            pair = name if name is None else (name, "__external")
        # Which mesh comes first may change a last bit; whether it is 0 is exact.
        assert least == pytest.approx(min(distances.values(), default=np.inf), rel=1e-12, abs=1e-14)
        assert (least == 0) is bool(hits)
        if distances:
            assert distances[pair] == pytest.approx(least, rel=1e-12, abs=1e-14)
            assert data.pair == pair and data.distance == least
            apart = np.linalg.norm(data.point(pair[0]) - data.point(pair[1]))
            assert apart == pytest.approx(least, abs=1e-9)
    assert one.in_collision_internal(return_names=True)[1] == brute_names(one)
    for name in list(one._objects)[:2]:
        others = [least for pair, least in all_pairs(one._objects, one._objects).items() if name in pair]
        assert one.min_distance_internal(name) == pytest.approx(min(others, default=np.inf), rel=1e-12, abs=1e-14)


class TestBroadPhase:
    def test_boxes_meet_and_are_apart_as_all_pairs_say(self):
        """Boxes as objects on a coarse lattice: many begin at one place, many touch."""
        rng = np.random.default_rng(0)
        cubes = {size: rc.Shape(box(*size)) for size in [(1, 1, 1), (3, 1, 1), (1, 3, 2), (2, 2, 2)]}

        def some(n):
            """The manager; boxes as (2, n, 3)."""
            manager, low, high = CollisionManager(), [], []
            for i in range(n):
                size = list(cubes)[rng.integers(4)]
                corner = rng.integers(0, 14, 3).astype(float)
                manager.add_object(i, cubes[size], at(*(corner + np.array(size) / 2)))
                low.append(corner)
                high.append(corner + size)
            return manager, np.array(low).reshape(-1, 3), np.array(high).reshape(-1, 3)

        for _ in range(25):
            one, two = some(rng.integers(0, 40)), some(rng.integers(0, 30))
            for first, second in ((one, one), (one, two)):
                apart = np.maximum(second[1][None] - first[2][:, None], first[1][:, None] - second[2][None])
                between = np.linalg.norm(np.maximum(apart, 0), axis=2)
                if second is first:
                    between[np.tril_indices(len(between))] = np.inf
                    found = first[0].in_collision_internal(return_names=True)
                    any_meets, least = first[0].in_collision_internal(), first[0].min_distance_internal()
                else:
                    found = first[0].in_collision_other(second[0], return_names=True)
                    any_meets, least = first[0].in_collision_other(second[0]), first[0].min_distance_other(second[0])
                wanted = {tuple(pair) for pair in np.argwhere(between == 0).tolist()}
                assert found == (bool(wanted), wanted) and any_meets is bool(wanted)
                assert least == pytest.approx(between.min(initial=np.inf), abs=1e-12)

    def test_objects_keep_their_places_as_others_come_and_go(self):
        manager, cube = CollisionManager(), rc.Shape(box())
        for i in range(5):
            manager.add_object(i, cube, at(10 * i, 0, 0))
        assert not manager.in_collision_internal()
        manager.set_transform(0, at(30.5, 0, 0))
        manager.remove_object(1)
        assert manager.in_collision_internal(return_names=True)[1] == {(0, 3)}
        manager.set_transform(3, at(19.5, 0, 0).astype(np.float32))
        manager.add_object(5, cube, at(30, 0.5, 0))
        assert manager.in_collision_internal(return_names=True)[1] == {(2, 3), (0, 5)}
        with pytest.raises(ValueError, match="object 2: transform: is not rigid"):
            manager.set_transform(2, np.diag([2.0, 2, 2, 1]))
        with pytest.raises(ValueError, match="object 2: transform: is None"):
            manager.set_transform(2, None)
        with pytest.raises(ValueError, match="object 9: is not in the manager"):
            manager.set_transform(9, np.eye(4))
        assert manager.in_collision_internal(return_names=True)[1] == {(2, 3), (0, 5)}

    def test_allowed_pairs_are_left_out_of_distances_too(self):
        manager, cube = CollisionManager(), rc.Shape(box())
        for i, x in enumerate((0, 1, 2.5, 6)):  # the first two touch
            manager.add_object(i, cube, at(x, 0, 0))
        assert manager.min_distance_internal(return_names=True) == (0, (0, 1))
        manager.allow_collision(0, 1)
        assert manager.min_distance_internal(return_names=True) == (0.5, (1, 2))
        assert manager.min_distance_internal(0, return_names=True) == (1.5, (0, 2))
        manager.allow_collision(1, 2)
        assert manager.min_distance_internal(1, return_names=True) == (4, (1, 3))
        manager.allow_collision(0, 1, False)
        assert manager.min_distance_internal(1, return_names=True) == (0, (0, 1))

    def test_two_threads_may_ask_one_manager(self):
        """Each question sorts along another axis."""
        rng = np.random.default_rng(3)
        managers, cube = [], rc.Shape(box())
        for spread in ((60, 1, 1), (1, 60, 1), (1, 1, 60)):
            managers.append(CollisionManager())
            for i in range(300):
                managers[-1].add_object(i, cube, at(*(rng.uniform(0, 1, 3) * spread)))
        small = CollisionManager()
        for i in range(40):
            small.add_object(i, cube, at(*rng.uniform(0, 30, 3)))
        wanted = [small.in_collision_other(other, return_names=True) for other in managers]
        faults = []

        def ask(k):
            for _ in range(60):
                if small.in_collision_other(managers[k], return_names=True) != wanted[k]:
                    faults.append(k)

        threads = [threading.Thread(target=ask, args=(k,)) for k in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert not faults

    def test_thousands_of_objects_take_no_square_of_memory(self):
        rng = np.random.default_rng(0)
        manager, cube = CollisionManager(), rc.Shape(box())
        for i in range(6000):
            manager.add_object(i, cube, at(*rng.uniform(0, 60, 3)))
        tracemalloc.start()
        hit, names = manager.in_collision_internal(return_names=True)
        manager.remove_object(next(iter(names))[0])
        manager.min_distance_internal()
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert hit and len(names) > 100
        assert peak < 8 * 6000**2 / 3  # a third of one matrix of distances

    def test_far_pairs_are_not_asked_for_their_distance(self):
        rng = np.random.default_rng(0)
        manager, solid = CollisionManager(), rc.Shape(ring())
        grid = [at(4 * x, 4 * y, 4 * z) for x in range(10) for y in range(10) for z in range(10)]
        for i, place in enumerate(grid):
            manager.add_object(i, solid, place @ anywhere(rng, 0.4))
        manager.min_distance_internal()
        placed = manager._list().placed
        assert 0 < placed.asked < 3000  # of 499 500 pairs: boxes of turned rings overlap
        manager.min_distance_single(solid, at(1, 2, -9))
        assert 0 < placed.asked < 50  # of 1000


# Against trimesh's own manager, whose answers FCL finds.


def test_fcl_agrees_on_concave_meshes():
    fcl = pytest.importorskip("fcl", reason="python-fcl is not installed: no comparison with it")
    pytest.importorskip("scipy", reason="SciPy is not installed: trimesh cannot ask whether a mesh is convex")
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    from trimesh.collision import CollisionManager as Theirs

    assert fcl is not None
    rng = np.random.default_rng(11)
    # Thin, so that none can lie inside another: FCL sees surfaces alone.
    solids = [ring(), ring(20, 10, 0.8, 0.15, 0.3), trough(), sheet()]
    meshes = [trimesh.Trimesh(s.vertices, s.faces, process=False) for s in solids]
    collided = apart = 0
    for _ in range(400):
        a, b = rng.integers(len(solids), size=2)
        # trimesh rounds transforms to float32, and so do we here.
        pose_a, pose_b = (anywhere(rng, 1.2).astype(np.float32).astype(float) for _ in range(2))
        ours, theirs = CollisionManager(), Theirs()
        for manager in (ours, theirs):
            manager.add_object("a", meshes[a], pose_a)
            manager.add_object("b", meshes[b], pose_b)
        hit = ours.in_collision_internal()
        assert hit == theirs.in_collision_internal()
        collided += hit
        if not hit:
            apart += 1
            least, names, data = ours.min_distance_internal(return_names=True, return_data=True)
            wanted, same, _ = theirs.min_distance_internal(return_names=True, return_data=True)
            assert least == pytest.approx(wanted, abs=1e-6) and names == same
            assert np.linalg.norm(data.point("a") - data.point("b")) == pytest.approx(wanted, abs=1e-6)
    assert collided > 100 and apart > 50


def test_fcl_agrees_on_names_of_many():
    pytest.importorskip("fcl", reason="python-fcl is not installed: no comparison with it")
    pytest.importorskip("scipy", reason="SciPy is not installed: trimesh cannot ask whether a mesh is convex")
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    from trimesh.collision import CollisionManager as Theirs

    solids = [ring(), trough(), ring(20, 10, 0.8, 0.15, 0.3)]
    meshes = [trimesh.Trimesh(s.vertices, s.faces, process=False) for s in solids]
    for seed in range(10):
        rng = np.random.default_rng(seed)
        ours, theirs = CollisionManager(), Theirs()
        for i in range(30):
            pose = anywhere(rng, 4).astype(np.float32).astype(float)
            for manager in (ours, theirs):
                manager.add_object(f"{i:02}", meshes[i % 3], pose)
        assert ours.in_collision_internal(return_names=True) == theirs.in_collision_internal(return_names=True)
        pose = anywhere(rng, 4).astype(np.float32).astype(float)
        assert ours.in_collision_single(meshes[1], pose, True) == theirs.in_collision_single(meshes[1], pose, True)
        mine = ours.in_collision_internal(return_data=True)[1]
        their = theirs.in_collision_internal(return_data=True)[1]
        assert {frozenset(c.names) for c in mine} == {frozenset(c.names) for c in their}


def test_allowed_pairs_are_not_asked():
    manager = CollisionManager()
    for i in range(4):
        manager.add_object(f"link{i}", box(), rc.pose([0.9 * i, 0, 0]))
    pairs = {(f"link{i}", f"link{i + 1}") for i in range(3)}
    assert manager.in_collision_internal(return_names=True) == (True, pairs)
    manager.allow_collision("link0", "link1")
    manager.allow_collision("link3", "link2")
    assert manager.in_collision_internal(return_names=True) == (True, {("link1", "link2")})
    manager.set_transform("link1", rc.pose([0.9, 5, 0]))
    assert not manager.in_collision_internal()
    manager.set_transform("link1", [[1, 0, 0, 0.9], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])  # ints, as a list
    assert manager.in_collision_internal()
    manager.allow_collision("link1", "link2")
    assert not manager.in_collision_internal()
    manager.allow_collision("link2", "link1", allowed=False)
    assert manager.in_collision_internal()
    manager.remove_object("link1")
    manager.add_object("link1", box(), rc.pose([0.9, 0, 0]))  # a new one is asked
    assert manager.in_collision_internal(return_names=True) == (True, {("link0", "link1"), ("link1", "link2")})
    with pytest.raises(rc.InputError, match="link9"):
        manager.allow_collision("link0", "link9")
    with pytest.raises(rc.InputError, match="link1"):
        manager.set_transform("link1", np.diag([1.0, 1, 3, 1]))
    assert manager.in_collision_internal()
