# SPDX-License-Identifier: Apache-2.0
"""Random arguments: an answer or a clear exception, never a crash. RAYCONTACT_FUZZ: examples of each call (200)."""

import os

import meshes
import numpy as np
import pytest
import raycontact as rc
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

CLEAR = (ValueError, TypeError)
SHAPE = rc.Shape(rc.Mesh(*meshes.bracket()))
TORUS = rc.Shape(rc.Mesh(*meshes.torus(around=9, across=6)))

floats = st.one_of(
    st.floats(-3, 3), st.sampled_from([0.0, -0.0, np.inf, -np.inf, np.nan, 1e308, -1e308, 5e-324, 1e30, 1e-36, 1e16])
)
whole = st.one_of(st.integers(-3, 12), st.sampled_from([2**31, 2**32 - 1, 2**32, -(2**63), 2**63 - 1]))
dtypes = st.sampled_from([np.float64, np.float32, np.float16, np.int64, np.uint8, np.bool_, np.complex128])
any_shape = nps.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5)
arrays = dtypes.flatmap(lambda dtype: nps.arrays(dtype, any_shape))
points = nps.arrays(np.float64, st.sampled_from([(3,), (1, 3), (4, 3), (0, 3)]), elements=floats)
matrices = nps.arrays(np.float64, st.sampled_from([(4, 4), (2, 4, 4), (0, 4, 4)]), elements=floats)
rigid = st.builds(
    lambda q, t: rc.pose_from_quaternion(t, q),
    st.sampled_from([(1, 0, 0, 0), (0, 1, 0, 0), (1, 1, 0, 0), (1, 2, 3, 4)]),
    st.tuples(*[st.one_of(st.floats(-3, 3), st.sampled_from([1e16, 1e300, -1e-300]))] * 3),
)
junk = st.sampled_from([None, "x", b"x", 3, 2.5, [], [[]], {}, object(), [1, [2]], np.array("a"), np.array([None])])
poses = st.one_of(rigid, rigid, st.lists(rigid, min_size=2, max_size=2).map(np.stack), matrices, arrays, junk)
places = st.one_of(points, points, arrays, junk)
shapes = st.one_of(st.sampled_from([SHAPE, TORUS]), st.lists(st.sampled_from([SHAPE, TORUS]), max_size=4), junk)
lengths = st.one_of(floats, whole, junk)
ids = st.one_of(whole, nps.arrays(np.int64, st.integers(0, 4), elements=st.integers(-2, 12)), arrays, junk)
words = st.sampled_from(["standard", "ray", "edges", "cpu", "", "x" * 1000, "\0", "\ud800", None, 7])

fuzz = settings(
    max_examples=int(os.environ.get("RAYCONTACT_FUZZ", "200")), deadline=None, derandomize=True, database=None,
    suppress_health_check=list(HealthCheck),
)  # fmt: skip


def answer(call, *arguments, **named):
    try:
        return call(*arguments, **named)
    except CLEAR as error:
        assert str(error), "an exception without words"
        return None


@fuzz
@given(shapes, shapes, poses, poses, lengths, whole)
def test_pairs(a, b, pose_a, pose_b, max, threads):
    answer(rc.intersects, a, b, pose_a, pose_b)
    answer(rc.common_point, a, b, pose_a, pose_b)
    answer(rc.distance, a, b, pose_a, pose_b, max=max)
    contacts = answer(rc.collide, a, b, pose_a, pose_b)
    if contacts is not None:
        assert np.isfinite(contacts.depth).all() and np.isfinite(contacts.point_a).all()
    if not isinstance(threads, int) or threads < 0 or threads >= 2**32:
        assert answer(rc.intersects, SHAPE, SHAPE, threads=threads) is None


@fuzz
@given(shapes, places, places, poses, lengths)
def test_points_and_rays(shape, at, along, pose, max):
    answer(rc.contains, shape, at, pose)
    answer(rc.closest_point, shape, at, pose, max=max)
    answer(rc.raycast, shape, at, along, pose, max=max)
    answer(rc.raycast_any, shape, at, along, pose, max=max)


@fuzz
@given(st.one_of(arrays, points, junk), st.one_of(arrays, nps.arrays(np.int64, (4, 3), elements=whole), junk), lengths)
def test_meshes(vertices, triangles, scale):
    mesh = answer(rc.Mesh, vertices, triangles, scale=scale)
    if mesh is not None:
        answer(rc.Shape, mesh)


@fuzz
@given(st.binary(max_size=300), st.sampled_from(["obj", "stl", "ply", "off", "gltf", "glb", "x", ""]))
def test_bytes(data, format):
    answer(rc.Mesh.from_bytes, data, format)
    answer(rc.Mesh.from_bytes, {"ply": b"ply\n", "off": b"OFF\n", "glb": b"glTF"}.get(format, b"") + data, format)


@fuzz
@given(st.dictionaries(st.sampled_from(sorted(rc.Scene().settings)), st.one_of(words, lengths, st.booleans())))
def test_settings(given):
    given.pop("threads", None)  # thousands of them are made if wanted
    answer(rc.Scene, **given)
    scene = rc.Scene(devices="cpu")
    answer(scene.set_settings, **given)
    scene.find_contacts()


@fuzz
@given(st.lists(st.tuples(st.integers(0, 9), shapes, ids, ids, poses, places, lengths), max_size=8))
def test_scenes(calls):
    scene = rc.Scene(devices="cpu", threads=1, speculative=True)
    scene.add([SHAPE, TORUS, SHAPE], rc.pose([[0, 0, 0], [1, 0, 0], [0, 1, 0]]))
    kept = []
    for which, shape, one, other, pose, place, length in calls:
        if which == 0:
            answer(scene.add, shape, pose)
        elif which == 1:
            answer(scene.remove, one)
        elif which == 2:
            answer(scene.set_poses, one, pose)
            answer(scene.set_next_poses, one, pose)
        elif which == 3:
            kept.append(scene.find_contacts())
        elif which == 4:
            answer(scene.find_contacts, [one, other])
            answer(scene.find_contacts, one)
        elif which == 5:
            answer(scene.poses, one)
            answer(scene.shape, one)
            answer(scene.__contains__, one)
        elif which == 6:
            answer(scene.raycast, place, place, length)
            answer(scene.closest_point, place, length)
        elif which == 7:
            answer(scene.overlaps, shape, pose)
        elif which == 8:
            answer(scene.set_filter, one, other, length)
            answer(scene.set_speculative_margin, one, length)
        else:
            kept.append(scene.contacts)
            repr(scene), scene.lost_contacts, scene.pairs, scene.stats
    scene.find_contacts()
    for contacts in kept:
        assert np.isfinite(contacts.depth).all() and repr(contacts)


@fuzz
@given(poses, places, arrays)
def test_poses(pose, place, other):
    answer(rc.nearest_rigid, pose)
    answer(rc.pose, place, other)
    answer(rc.pose_from_quaternion, place, other)


@pytest.mark.parametrize(
    "name", sorted(name for name in dir(rc._core) if callable(getattr(rc._core, name)) and name[0] != "_")
)
def test_the_inner_half_refuses_other_types(name):
    for arguments in (
        (),
        (None,),
        (1,),
        ("x", "y"),
        (object(),) * 5,
        (None,) * 4,
        (np.zeros(3),) * 6,
        ([None], np.zeros((1, 4, 4))) * 2,
    ):
        try:
            getattr(rc._core, name)(*arguments)
        except (TypeError, ValueError):
            pass
