# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C in the midst of calls that would take minutes, and what goes on afterwards."""

import os
import signal
import threading
import time

import helpers
import meshes
import numpy as np
import pytest
import raycontact as rc

LATEST = 20  # seconds after Ctrl-C; each call takes far longer if nobody ends it


def ended_by_ctrl_c(call, after=0.5, latest=LATEST):
    """Whether the call raises KeyboardInterrupt soon after a real SIGINT."""
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    pressed = []

    def press():
        pressed.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, press)
    timer.start()
    try:
        call()
    except KeyboardInterrupt:
        return bool(pressed) and time.monotonic() - pressed[0] < latest
    finally:
        timer.join()
    return False


def slivers(n):
    """Long thin triangles side by side, askew: each one's box touches all others'."""
    along, aside = np.array([1.0, 1.0, 1.0]), np.linspace(0, 0.01, n)[:, None] * np.array([1.0, -1.0, 0.0])
    low, high = aside, aside + along
    vertices = np.stack([low, high, high + 1e-9 * np.array([1.0, 1.0, -2.0]) * np.sqrt(n)], 1).reshape(-1, 3)
    return vertices, np.arange(3 * n).reshape(-1, 3)


@pytest.fixture(scope="module")
def ring():
    return rc.Shape(rc.Mesh(*meshes.torus(around=96, across=48)))


def crowd(ring, count, **settings):
    """All in each other."""
    scene = rc.Scene(devices="cpu", **settings)
    scene.add(ring, helpers.random_poses(count, 0.5))
    return scene


@pytest.mark.parametrize("threads", [1, 3])
def test_a_step(ring, threads):
    scene = crowd(ring, 1500, threads=threads)
    assert ended_by_ctrl_c(scene.find_contacts)
    assert len(scene.contacts) == 0
    scene.remove(scene.ids[2:])  # and goes on with what is left
    fresh = rc.Scene(devices="cpu", threads=threads)
    fresh.add(ring, scene.poses(scene.ids))
    expected = fresh.find_contacts()
    assert len(expected) > 0 and helpers.same(scene.find_contacts(), expected)


def test_the_preparation_of_a_mesh():
    mesh = rc.Mesh(*slivers(60_000))
    assert ended_by_ctrl_c(lambda: rc.Shape(mesh))


def test_clashes(ring):
    vertices, faces = meshes.torus(around=96, across=48)
    poses = helpers.random_poses(1500, 0.5)
    parts = [(f"part {i}", rc.Mesh(vertices, faces), pose) for i, pose in enumerate(poses)]
    assert ended_by_ctrl_c(lambda: rc.clash(parts))


def test_a_batch(ring):
    poses = rc.pose(np.random.default_rng(1).uniform(0, 1, (1_000_000, 3)))
    assert ended_by_ctrl_c(lambda: rc.distance(ring, ring, pose_b=poses))
    assert rc.intersects(ring, ring)


@pytest.mark.parametrize("threads", [0, 1])
def test_contacts_of_many_dense_pairs(threads):
    dense = rc.Shape(rc.Mesh(*meshes.torus(around=192, across=96)))
    poses = helpers.random_poses(8000, 0.5)
    assert ended_by_ctrl_c(lambda: rc.collide(dense, dense, pose_b=poses, threads=threads), latest=2)
    assert len(rc.collide(dense, dense, pose_b=poses[0])) > 0


def test_contacts_of_a_million_pairs():
    """As soon as of a few: what is made for all of them can be ended, too."""
    small = rc.Shape(rc.Mesh(*meshes.torus(around=8, across=4)))
    poses = rc.pose(np.random.default_rng(1).uniform(0, 1, (1_500_000, 3)))
    assert ended_by_ctrl_c(lambda: rc.collide(small, small, pose_b=poses), 1.5, latest=2)


def test_overlaps_of_a_scene(ring):
    scene = crowd(ring, 300)
    poses = helpers.random_poses(200_000, 0.5)
    assert ended_by_ctrl_c(lambda: scene.overlaps(ring, poses), 1.0, latest=2)

    def ask_of_none():
        while True:  # one takes a second, more or less
            scene.overlaps_any(ring, poses, wanted=[])

    assert ended_by_ctrl_c(ask_of_none, 1.0)
    assert scene.overlaps_any(ring)


def test_what_comes_before_and_after(ring):
    def pressed():
        os.kill(os.getpid(), signal.SIGINT)
        rc.distance(ring, ring)

    with pytest.raises(KeyboardInterrupt):
        pressed()
    assert rc.distance(ring, ring).distance == 0
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_handler_of_the_users_goes_on(ring):
    heard = []
    before = signal.signal(signal.SIGINT, lambda *_: heard.append(1))
    try:
        timer = threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        scene = crowd(ring, 60)
        while not heard:  # a step is never ended by it
            assert len(scene.find_contacts()) > 0
        timer.join()
    finally:
        signal.signal(signal.SIGINT, before)


def test_other_threads_go_on(ring):
    counts = []

    def work():
        scene = crowd(ring, 60)
        for _ in range(5):
            counts.append(len(scene.find_contacts()))

    thread = threading.Thread(target=work)
    thread.start()
    scene = crowd(ring, 1500)
    assert ended_by_ctrl_c(scene.find_contacts, 0.1)
    thread.join()
    assert len(counts) == 5 and min(counts) > 0
