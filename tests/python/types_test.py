# SPDX-License-Identifier: Apache-2.0
"""Types are those of what comes back, checkers agree, and `help` says what everything is."""

import enum
import importlib
import inspect
import os
import re
import subprocess
import sys
import typing
from pathlib import Path

import meshes
import numpy as np
import pytest
import raycontact as rc

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = Path(rc.__file__).parent
MODULES = [rc] + [
    importlib.import_module(f"raycontact.{name}")
    for name in ("collision", "contacts", "mesh", "poses", "queries", "samples", "scene", "shape")
]

# A line that ends in "# wrong" must be reported, and no other.
USER = """
from pathlib import Path
from typing import NamedTuple, Union

import numpy as np
import raycontact as rc
from numpy.typing import NDArray
from raycontact.collision import CollisionManager
from typing_extensions import assert_type

class Other(NamedTuple):
    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]

mesh = rc.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [(0, 1, 2)], name="triangle")
mesh = rc.Mesh(Path("part.stl"), scale=0.001)
mesh = rc.Mesh(mesh.vertices, mesh.faces)
other = Other(np.zeros((3, 3), np.float32), np.zeros((1, 3), np.int32))
rc.Mesh(3.5)  # wrong
rc.Mesh(mesh.vertices)  # wrong
rc.Mesh("part.stl", scale="mm")  # wrong
rc.Mesh("part.stl", scale=(1, -1, 0.5)), rc.Shape("part.stl", scale=np.ones(3)), rc.Mesh(other, scale=[1, 2, 3])
rc.load_assembly("part.glb", scale=(1, 1, 1))  # wrong

part = rc.Shape(mesh, repair=False, nesting="solids")
for made in (rc.Shape("part.stl"), rc.Shape(Path("part.stl")), rc.Shape(other)):
    assert_type(made.vertices, NDArray[np.float64])
    assert_type(made.report.volume, float)
rc.Shape(3.5)  # wrong
rc.Shape(part.vertices)  # wrong
rc.Shape(mesh, repair="yes")  # wrong
rc.Shape(mesh, nesting=3)  # wrong

found = rc.collide(part, [part, mesh, "part.stl"], pose_b=[rc.pose([0, 0, z]) for z in range(3)])
assert_type(found[found.depth > 0.001], rc.PairContacts)
assert_type(found[1:].touching.deepest()[[0]], rc.PairContacts)
assert_type(found[np.argsort(found.depth)].pair, NDArray[np.int64])
assert_type(found.normal, NDArray[np.float32])
found["depth"]  # wrong
rc.collide(part, 3.5)  # wrong
rc.collide(part, part, None, object())  # wrong
rc.collide(part, part, threads="all")  # wrong
assert_type(rc.distance((part, part), part, max=1).point_a, NDArray[np.float64])
near = rc.closest_point(part, (0, 0, 1), np.eye(4)).distance < 0.5
for contact in found:
    print(contact.depth, contact["depth"], contact.bodies)

# A question with one answer, and those that may have many
Bools = Union[bool, NDArray[np.bool_]]
Floats = Union[float, NDArray[np.float64]]
poses: NDArray[np.float64] = rc.pose([[0, 0, 0], [1, 0, 0]])
points: NDArray[np.float64] = poses[:, :3, 3]
d: float = rc.distance(part, part).distance
i: int = rc.distance(part, "part.stl", max=1.0, threads=1).triangle_a
b: bool = rc.intersects(part, part)
c: bool = rc.contains(part, np.zeros(3))
e: bool = rc.contains(part, [0, 0, 1.5]) and rc.raycast_any(part, (0, 0, 1), [0, 0, 1])
f: float = rc.signed_distance(part, (0.0, 0, 1)).distance + rc.closest_point(part, [0, 0, 1]).distance
g: float = rc.raycast(part, np.zeros(3), np.ones(3), max=2).distance
assert_type(rc.distance(part, mesh), rc.OneDistance)
assert_type(rc.distance(part, part, pose_b=poses), rc.Distance)
assert_type(rc.distance([part], part).distance, Floats)
assert_type(rc.intersects(part, part, poses), Bools)
assert_type(rc.intersects(part, part, pose_b=np.eye(4)), Bools)
assert_type(rc.intersects((part, part), part), Bools)
assert_type(rc.contains(part, points), Bools)
assert_type(rc.contains(part, [[0, 0, 1]]), Bools)
assert_type(rc.contains(part, np.zeros(3), poses), Bools)
assert_type(rc.contains(part, np.zeros((2, 3))), Bools)
assert_type(rc.closest_point(part, points), rc.ClosestPoint)
assert_type(rc.closest_point(part, np.zeros(3)), rc.OneClosestPoint)
assert_type(rc.signed_distance(part, points).distance, Floats)
assert_type(rc.raycast(part, points, [0, 0, 1]), rc.RayHit)
assert_type(rc.raycast(part, [0, 0, 1], points), rc.RayHit)
assert_type(rc.raycast(part, [0, 0, 1], [0, 0, 1]), rc.OneRayHit)
assert_type(rc.raycast_any(part, [[0, 0, 1]], [0, 0, 1]), Bools)
wrong: float = rc.distance(part, part, pose_b=poses).distance  # wrong

# Poses in other forms
class Turn:
    def as_matrix(self) -> NDArray[np.float64]:
        return np.eye(4)

rc.collide(part, part, Turn(), (np.eye(3), np.zeros(3)))
rc.intersects(part, part, (Turn(), [0, 0, 1]), pose_b=(poses[:, :3, :3], points))
rc.Scene().add(part, (Turn(), points))
rc.pose([0, 0, 1], Turn())

assert_type(rc.turn((0, 0, 1), [0.5, 1], points[0]), NDArray[np.float64])
for met in rc.clash_along({"a": mesh, "b": other}, "a", rc.slide((0, 0, 1), [0, 1]), at=[0, 50]):
    assert_type(met, rc.PathClash)
    assert_type(met.at, float)
rc.clash_along("part.glb", "a")  # wrong

for name, sample in rc.samples().items():
    assert_type(sample, rc.Mesh)
rc.collide(rc.ball(0.5), rc.capsule(1, 2)), rc.plane(), rc.plane(10, thickness=1)
rc.box(2), rc.box((1, 2, 3)), rc.heightfield(np.zeros((3, 3)), 0.1, -1), rc.heightfield([[1, 2], [3, 4]], (1, 2), 0)
rc.box("big")  # wrong

scene = rc.Scene(method="standard", speculative_margin=None)
one = scene.add(part)
many = scene.add([part, part], rc.pose([[1, 0, 0], [2, 0, 0]]))
assert_type(one, int)
assert_type(many, NDArray[np.int64])
scene.add(other, np.eye(4).tolist())
scene.set_poses(one, np.eye(4))
scene.set_poses(many[:1], rc.pose_from_quaternion([(1, 0, 0)], [1, 0, 0, 0]))
scene.set_poses([0, 1], [rc.pose(), rc.pose()])
for id in scene.ids:
    assert_type(scene.shape(id), rc.Shape)
assert_type(scene.find_contacts([(0, 1)]).touching, rc.Contacts)
assert_type(scene.poses(), NDArray[np.float64])
assert_type(scene.stats.depth_max, float)
scene.raycast([0, 0, 5], [0, 0, -1], max=10).normal.sum()
assert_type(scene.raycast([0, 0, 5], [0, 0, -1], wanted=many), rc.OneBodyRayHit)
assert_type(scene.raycast(points, [0, 0, -1]), rc.BodyRayHits)
assert_type(scene.raycast_any([0, 0, 5], [0, 0, -1]), bool)
assert_type(scene.raycast_any(points, points), Bools)
assert_type(scene.closest_point((0, 0, 5)), rc.OneBodyClosestPoint)
assert_type(scene.closest_point(points, wanted=[0]), rc.BodyClosestPoints)
assert_type(scene.overlaps(part), NDArray[np.int64])
assert_type(scene.overlaps([part, part], poses), rc.BodyOverlaps)
assert_type(scene.overlaps_any(part), bool)
assert_type(scene.overlaps_any([part, part], poses, wanted=many), Bools)
assert_type(scene.distance(one, 1), rc.OneDistance)
assert_type(scene.distance(one, many, max=1), rc.Distance)
scene.step()  # wrong
scene.shape("part")  # wrong
scene.set_filter(one, "walls", 1)  # wrong
rc.Scene(metod="standard")  # wrong

manager = CollisionManager()
assert_type(manager.add_object("part", part, np.eye(4)), rc.Shape)
manager.add_object(("other", 1), other)
hit, names = manager.in_collision_internal(return_names=True)
manager.add_object([], part)  # wrong
manager.set_transform("part")  # wrong
"""

TRIMESH = """
import numpy as np
import raycontact as rc
import trimesh
from raycontact.collision import CollisionManager

ball = trimesh.creation.icosphere()
rc.Shape(ball).mass
rc.Mesh(ball.vertices, ball.faces)
rc.collide([ball, ball], rc.Shape(ball))
CollisionManager().add_object("ball", ball, np.eye(4))
rc.Scene().add(ball)
"""


@pytest.fixture(scope="module")
def mypy(tmp_path_factory):
    """Runs it with the project's settings."""
    pytest.importorskip("mypy", reason="mypy is not installed")
    if not (PACKAGE / "_core.pyi").exists():
        pytest.skip("the package has no stub of its C++ half; build raycontact_python_stub")
    cache = tmp_path_factory.mktemp("mypy")

    def run(path):
        return subprocess.run(
            [sys.executable, "-m", "mypy", "--config-file", ROOT / "pyproject.toml", "--cache-dir", cache, path],
            capture_output=True,
            text=True,
            cwd=path.parent,
            env={**os.environ, "MYPYPATH": str(PACKAGE.parent)},
        )

    return run


def test_the_package_has_right_types(mypy):
    done = mypy(PACKAGE)
    assert done.returncode == 0, done.stdout + done.stderr


def test_right_use_passes_and_wrong_use_is_reported(mypy, tmp_path):
    (tmp_path / "user.py").write_text(USER)
    done = mypy(tmp_path / "user.py")
    reported = {int(line) for line in re.findall(r"^user\.py:(\d+): error", done.stdout, re.M)}
    wrong = {i for i, line in enumerate(USER.split("\n"), 1) if line.endswith("# wrong")}
    assert len(wrong) > 10 and reported == wrong, done.stdout + done.stderr


def test_meshes_of_trimesh_fit(mypy, tmp_path):
    pytest.importorskip("trimesh", reason="trimesh is not installed")
    (tmp_path / "user.py").write_text(TRIMESH)
    done = mypy(tmp_path / "user.py")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("command", [["check"], ["format", "--diff"]], ids=" ".join)
def test_ruff_finds_nothing(command):
    pytest.importorskip("ruff", reason="ruff is not installed")
    ours = ["adapters/python", "adapters/mujoco", "tests/python", "tests/mujoco", "bench/python"]
    ours += ["docs/conf.py", "conanfile.py", "test_package"]
    done = subprocess.run(
        [sys.executable, "-m", "ruff", *command, "--no-cache", *ours], capture_output=True, text=True, cwd=ROOT
    )
    assert done.returncode == 0, done.stdout + done.stderr


# What `help` says


def is_public(name):
    return not name.startswith("_")


def classes_and_functions():
    """Everything that has documentation of its own, once."""
    found = {
        "raycontact.StepDetails": type(rc.Scene(threads=1).stats.details),
        "raycontact.DeviceWork": rc._core.DeviceWork,
    }
    for module in MODULES:
        for name in module.__all__:
            thing = getattr(module, name)
            if callable(thing) and not typing.get_origin(thing) and thing not in found.values():
                found[f"{module.__name__}.{name}"] = thing
    return found


def fields_of(thing):
    """What has no documentation of its own: its class has it."""
    if not inspect.isclass(thing):
        return []
    if issubclass(thing, enum.Enum):
        return list(thing.__members__)
    return [name for name in (*getattr(thing, "_fields", ()), *vars(thing).get("__slots__", ())) if is_public(name)]


def members_of(thing):
    """Methods and properties."""
    if not inspect.isclass(thing):
        return {}
    own = {name: member for name, member in vars(thing).items() if is_public(name) and name not in fields_of(thing)}
    return {name: member for name, member in own.items() if hasattr(member, "__get__") or callable(member)}


THINGS = classes_and_functions()
THINGS |= {f"{key}.{name}": member for key, thing in THINGS.items() for name, member in members_of(thing).items()}


def test_all_of_the_package_is_looked_at():
    names = {key.rpartition(".")[2] for key in THINGS}
    assert set(rc.__all__) - names == {"CONTACT_DTYPE"}, "a constant has no documentation of its own"
    for key in ("Scene.find_contacts", "Contacts.normal", "StepStats.pairs", "collision.ContactData.index"):
        assert f"raycontact.{key}" in THINGS


@pytest.mark.parametrize("key", THINGS)
def test_everything_is_documented(key):
    thing = THINGS[key]
    text = vars(thing).get("__doc__") if inspect.isclass(thing) else inspect.getdoc(thing)
    assert text and text.strip(), f"{key} has no docstring"
    for field in fields_of(thing):
        assert f"{field}: " in text, f"{key} does not say what {field} is"


def function_of(thing):
    return thing.fget if isinstance(thing, property) else getattr(thing, "__func__", thing)


def annotations_of(thing):
    """As they are written."""
    return function_of(thing).__annotations__ if inspect.isfunction(function_of(thing)) else {}


ANNOTATED = {key: thing for key, thing in THINGS.items() if annotations_of(thing)}


@pytest.mark.parametrize("key", ANNOTATED)
def test_arrays_are_documented_with_their_shapes(key):
    text = inspect.getdoc(ANNOTATED[key])
    for name, written in annotations_of(ANNOTATED[key]).items():
        if name != "return" and ("ArrayLike" in written or "PoseLike" in written):
            assert name in text or "Arguments" in text, f"{key} does not say what {name} is"
        if name == "return" and "NDArray" in written and "dict" not in written:
            assert re.search(r"\((n|m|\d|\.\.\.),", text), f"{key} does not say of what shape its answer is"


@pytest.mark.parametrize("key", ANNOTATED)
def test_annotations_name_what_there_is(key):
    assert typing.get_type_hints(function_of(ANNOTATED[key]))


def test_arrays_hold_what_their_annotations_say():
    mesh = rc.Mesh(*meshes.bracket())
    shape, scene = rc.Shape(mesh), rc.Scene(threads=1)
    scene.add(shape, rc.pose([[0, 0, 0], [0.25, 0.25, 0.25]]))
    lists = scene.find_contacts(), rc.collide(shape, shape, pose_b=rc.pose([0.25, 0.25, 0.25])), scene.lost_contacts
    assert len(lists[0]) and len(lists[1])
    rays = [[0.5, 0.5, 9]], [0, 0, -1]
    answers = (
        shape.mass,
        rc.distance([shape], shape),
        rc.closest_point(shape, rays[0]),
        rc.raycast(shape, *rays),
        scene.raycast(*rays),
        scene.closest_point(rays[0]),
    )
    checked = 0
    for thing in (mesh, shape, scene, *lists, *answers):
        written = dict(inspect.get_annotations(type(thing)))
        for cls in type(thing).__mro__[:-1]:
            written |= {name: annotations_of(m).get("return") for name, m in vars(cls).items()}
        for name, text in written.items():
            said = re.search(r"NDArray\[np\.(\w+)\]", str(text))
            if said and is_public(name) and isinstance(getattr(thing, name), np.ndarray):
                assert getattr(thing, name).dtype == getattr(np, said[1]), f"{type(thing).__name__}.{name}"
                checked += 1
    assert checked >= 40
