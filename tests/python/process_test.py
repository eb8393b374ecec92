# SPDX-License-Identifier: Apache-2.0
"""Python's threads, signals, forks and end while the library computes."""

import os
import signal
import subprocess
import sys
import threading

import helpers
import numpy as np
import pytest
import raycontact as rc


def test_a_second_thread_is_told_that_the_scene_is_in_use(torus):
    scene = rc.Scene()
    scene.add(torus, helpers.random_poses(60, 1))  # all overlap: a step takes a while
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
        scene, ids = helpers.ring_scene(torus, threads=1)
        for step in range(10):
            scene.set_poses(ids, rc.pose(np.c_[np.arange(8) * (2.5 - step / 100), np.zeros(8), np.zeros(8)]))
            results[i] = scene.find_contacts()

    threads = [threading.Thread(target=run, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(helpers.same(result, results[0]) for result in results)


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
