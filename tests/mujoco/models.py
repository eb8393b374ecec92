# SPDX-License-Identifier: Apache-2.0
"""Models of concave meshes, as MJCF."""

import mujoco
import numpy as np


def torus(major=0.1, minor=0.02, around=32, across=16):
    """Vertices and faces of a torus about z."""
    turn = 2 * np.pi * np.arange(around)[:, None] / around
    tube = 2 * np.pi * np.arange(across)[None, :] / across
    radius = major + minor * np.cos(tube)
    vertices = np.stack([radius * np.cos(turn), radius * np.sin(turn), minor * np.sin(tube) + 0 * turn], -1)

    def at(i, j):
        return (i % around) * across + j % across

    faces = [
        face
        for i in range(around)
        for j in range(across)
        for face in ((at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))
    ]
    return vertices.reshape(-1, 3), np.array(faces)


def box(half):
    """Vertices and faces of a box."""
    vertices = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * half
    quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return vertices, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def asset(name, mesh, more=""):
    """MJCF of a mesh."""
    vertices, faces = mesh
    return (
        f'<mesh name="{name}" inertia="exact" vertex="{" ".join(f"{x:.9g}" for x in np.ravel(vertices))}" '
        f'face="{" ".join(str(i) for i in np.ravel(faces))}" {more}/>'
    )


def model(assets, bodies, options='timestep="0.002"', more=""):
    """A compiled model."""
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><option {options}/><asset>{assets}</asset><worldbody>{bodies}</worldbody>{more}</mujoco>"
    )


def linked_tori(kind="mesh", more=""):
    """One torus hangs in another."""
    return model(
        asset("torus", torus()),
        f'<geom name="fixed" type="{kind}" mesh="torus" euler="90 0 0"/><body pos="0 0 -0.14" euler="90 90 0">'
        f'<freejoint/><geom name="hung" type="{kind}" mesh="torus"/></body>',
        more=more,
    )


def steps(model, seconds):
    """Simulates; gives the data and the deepest contact on the way."""
    data = mujoco.MjData(model)
    deepest = 0.0
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
        if data.ncon:
            deepest = min(deepest, data.contact.dist.min())
    return data, deepest


def touching(shape_a, shape_b, pos_b, options="", euler="0 0 0", more=""):
    """A model of a fixed geom and a movable one, its data at the first instant."""
    made = model(
        asset("torus", torus()) + asset("block", box((0.2, 0.2, 0.1))),
        f'<geom name="a" {shape_a}/><body pos="{pos_b}" euler="{euler}"><freejoint/>'
        f'<geom name="b" mass="1" {shape_b}/></body>',
        options=options or 'timestep="0.002"',
        more=more,
    )
    data = mujoco.MjData(made)
    mujoco.mj_forward(made, data)
    return made, data
