# SPDX-License-Identifier: Apache-2.0
"""Arrays of a CUDA device in and out, by __cuda_array_interface__, on a driver that only copies (tests/device/cuda)."""

import ctypes
import os
from types import SimpleNamespace

import numpy as np
import pytest
import raycontact
from meshes import box
from raycontact import InputError, Mesh, Scene, Shape

needs_driver = pytest.mark.skipif("RAYCONTACT_FAKE_CUDA" not in os.environ, reason="needs the test's libcuda.so.1")

TYPES = {
    "bodies": ("i8", 2),
    "slots": ("u4", 2),
    "key": ("u8", 0),
    "kind": ("u1", 0),
    "source": ("u1", 0),
    "indices": ("u4", 2),
    "is_new": ("?", 0),
    "point_a": ("f8", 3),
    "point_b": ("f4", 3),
    "normal": ("f4", 3),
    "depth": ("f4", 0),
    "ray_length": ("f4", 0),
    "weight": ("f4", 0),
}


def columns(rows, make):
    return {name: make((rows, width) if width else (rows,), code) for name, (code, width) in TYPES.items()}


def heap(settings=None):
    scene = Scene(**(settings or {}))
    ids = scene.add(Shape(Mesh(*box())), _poses(0))
    scene.find_contacts()
    assert len(scene.contacts) > 20
    return scene, ids


def _poses(step):
    poses = np.tile(np.eye(4), (27, 1, 1))
    poses[:, :3, 3] = 0.9 * np.stack(np.meshgrid(*3 * [np.arange(3)]), -1).reshape(-1, 3)
    poses[:, 0, 3] += 0.01 * step * np.arange(27)
    return poses


def expect_columns(scene, written, count, numbers=np.asarray):
    assert count == len(scene.contacts)
    for name, array in written.items():
        column = getattr(scene.contacts, name)
        np.testing.assert_array_equal(numbers(array)[:count], column.astype(numbers(array).dtype), name)


def test_columns_are_written_into_arrays():
    scene, _ = heap()
    arrays = columns(len(scene.contacts) + 5, np.zeros)
    expect_columns(scene, arrays, scene.write_contacts(**arrays))
    assert not arrays["depth"][len(scene.contacts) :].any()
    signed = {"slots": np.zeros((1000, 2), "i4"), "key": np.zeros(1000, "i8"), "is_new": np.zeros(1000, "u1")}
    expect_columns(scene, signed, scene.write_contacts(**signed))
    assert scene.write_contacts() == len(scene.contacts)


@pytest.mark.parametrize(
    ("name", "array", "message"),
    [
        ("depths", np.zeros(500, "f4"), "no column 'depths'"),
        ("depth", np.zeros(500), "depth: holds float64; give float32"),
        ("depth", np.zeros((500, 1), "f4"), r"depth: has shape \(500, 1\); give \(rows,\)"),
        ("normal", np.zeros((3, 500), "f4"), r"normal: has shape \(3, 500\); give \(rows, 3\)"),
        ("normal", np.zeros((500, 6), "f4")[:, ::2], "normal: is not contiguous"),
        ("depth", np.zeros(3, "f4"), "depth has room for 3 contacts, and there are"),
        ("depth", [0.0], "depth: is no NumPy array"),
        ("depth", np.broadcast_to(np.zeros(1, "f4"), 1), "depth: is read-only"),
    ],
)
def test_what_is_wrong_with_a_column_is_said(name, array, message):
    scene, _ = heap()
    with pytest.raises(InputError, match=message):
        scene.write_contacts(**{name: array})


class Driver:
    """A program that uses CUDA itself: memory by the driver's own functions."""

    def __init__(self):
        self.library = ctypes.CDLL("libcuda.so.1")
        self.context = ctypes.c_void_p()
        self.call("cuInit", 0)
        self.call("cuDevicePrimaryCtxRetain", ctypes.byref(self.context), 0)

    def call(self, name, *arguments):
        assert getattr(self.library, name)(*arguments) == 0, name

    def make(self, shape, code, stream=None):
        """What torch or CuPy would give; `content` shows what lies in the device's memory."""
        dtype = np.dtype(code)
        size = max(1, int(np.prod(shape))) * dtype.itemsize
        address = ctypes.c_uint64()
        self.call("cuCtxPushCurrent_v2", self.context)
        self.call("cuMemAlloc_v2", ctypes.byref(address), ctypes.c_size_t(size))
        self.call("cuCtxPopCurrent_v2", ctypes.byref(self.context))
        content = np.frombuffer((ctypes.c_uint8 * size).from_address(address.value), dtype)[: int(np.prod(shape))]
        array = SimpleNamespace(content=content.reshape(shape))
        array.__cuda_array_interface__ = {
            "shape": tuple(shape),
            "typestr": dtype.str,
            "data": (address.value, False),
            "version": 3,
            "stream": stream,
        }
        return array


@pytest.fixture(scope="module")
def driver():
    return Driver()


@needs_driver
def test_a_scene_steps_through_a_devices_memory(driver):
    scene, ids = heap({"devices": "cpu"})
    poses = driver.make((27, 4, 4), "f8")
    arrays = columns(1000, driver.make)
    for step in range(1, 4):
        poses.content[:] = _poses(step)
        scene.set_poses(ids, poses)
        np.testing.assert_array_equal(scene.poses(ids), _poses(step))
        scene.find_contacts()
        expect_columns(scene, arrays, scene.write_contacts(**arrays), lambda array: array.content)


@needs_driver
def test_every_argument_may_be_on_a_device(driver):
    points, triangles = box()
    vertices, corners = driver.make(points.shape, "f4"), driver.make(triangles.shape, "i4")
    vertices.content[:], corners.content[:] = points, triangles
    shape = Shape(Mesh(vertices, corners))
    assert shape.box[1].tolist() == [0.5, 0.5, 0.5]
    ends = driver.make((2, 3), "f4")
    ends.content[:] = [(0, 0, 3), (0, 0, -3)]
    assert raycontact.closest_point(shape, ends).distance == pytest.approx([2.5, 2.5])
    assert raycontact.closest_point(shape, driver.make((0, 3), "f4")).distance.shape == (0,)


class Tensor:
    """As torch has it: the attribute is there for tensors of every memory, and is refused for most."""

    def __init__(self, error):
        self.error = error

    def __array__(self, dtype=None, copy=None):
        return np.eye(4)

    @property
    def __cuda_array_interface__(self):
        raise self.error


def test_a_tensor_in_the_hosts_memory_is_none_of_a_device():
    scene, ids = heap()
    scene.set_poses(ids[:1], Tensor(AttributeError("not on CUDA")))
    with pytest.raises(InputError, match="poses: detach it first"):
        scene.set_poses(ids[:1], Tensor(RuntimeError("detach it first")))


@needs_driver
def test_what_is_wrong_with_an_array_of_a_device_is_said(driver):
    scene, ids = heap({"devices": "cpu"})
    poses = driver.make((27, 4, 4), "f8")
    poses.__cuda_array_interface__["strides"] = (128, 8, 32)
    with pytest.raises(InputError, match="poses: is not contiguous"):
        scene.set_poses(ids, poses)
    poses.__cuda_array_interface__["strides"] = (128, 32, 8)
    poses.content[:] = _poses(0)
    scene.set_poses(ids, poses)
    depth = driver.make((1000,), "f4")
    depth.__cuda_array_interface__["data"] = (depth.__cuda_array_interface__["data"][0], True)
    with pytest.raises(InputError, match="depth: is read-only"):
        scene.write_contacts(depth=depth)
    depth.__cuda_array_interface__["data"] = (depth.content.size, False)
    with pytest.raises(InputError, match="is none of a device"):
        scene.write_contacts(depth=depth)
