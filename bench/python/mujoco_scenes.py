# SPDX-License-Identifier: Apache-2.0
"""Concave meshes in MuJoCo: their hulls, CoACD's parts, MuJoCo's signed distance fields, and meshes as drawn.

    PYTHONPATH=build/mujoco/4.0.0:build/python python bench/python/mujoco_scenes.py [--only tori] [--factory FOLDER]

Needs `raycontact.mujoco` (docs/mujoco.md), and coacd of PyPI for its rows. One thread. Each row is one run: whether the
scene does what it does in the world, simulated steps a second (contacts alone are what differs), the deepest overlap at
20 instants by `raycontact.collide` with direction "refined" of the meshes as drawn, and the most contacts at a time.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
import raycontact as rc
import raycontact.mujoco as rm

METHODS = ("hulls", "coacd", "mujoco sdf", "as drawn", "as drawn, sdf")


class Scene(NamedTuple):
    """meshes: by name. bodies: MJCF with {kind}, {geom:NAME} for a geom of a mesh. works: of the data at the end."""

    name: str
    seconds: float
    meshes: dict[str, rc.Shape]
    bodies: str
    works: Callable[[mujoco.MjData], bool]
    options: str = 'timestep="0.002"'


def turned(profile, around=32):
    """A closed curve (r, z), turned about z."""
    n = len(profile)
    angles = 2 * np.pi * np.arange(around)[:, None] / around
    r, z = np.asarray(profile).T
    vertices = np.stack([r * np.cos(angles), r * np.sin(angles), z + 0 * angles], -1).reshape(-1, 3)
    faces = []
    for i in range(around):
        for k in range(n):
            a, b = i * n + k, i * n + (k + 1) % n
            c, d = (a + n) % (around * n), (b + n) % (around * n)
            faces += [(a, c, d), (a, d, b)]
    return vertices, np.array(faces)


def torus(major, minor, around=32, across=16):
    turn = 2 * np.pi * np.arange(across) / across
    return turned(np.stack([major + minor * np.cos(turn), minor * np.sin(turn)], -1), around)


def joined(*parts):
    """One shape of parts that cross: they are united."""
    vertices, faces, at = [], [], 0
    for v, f in parts:
        vertices.append(v)
        faces.append(np.asarray(f) + at)
        at += len(v)
    return rc.Shape(rc.Mesh(np.concatenate(vertices), np.concatenate(faces)))


def mug():
    wall = turned([(0.036, 0.0), (0.04, 0.0), (0.04, 0.1), (0.036, 0.1)])
    bottom = turned([(0.001, 0.0), (0.038, 0.0), (0.038, 0.006), (0.001, 0.006)])
    v, f = torus(0.025, 0.005)
    handle = (v @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]).T + [0.05, 0, 0.05], f)
    return joined(wall, bottom, handle)


def scenes(factory):
    ring = rc.Shape(rc.Mesh(*torus(0.1, 0.02)))
    yield Scene(
        "tori",
        6,
        {"ring": ring},
        '{geom:ring|euler="90 0 0"}<body pos="0 0 -0.14" euler="90 90 0"><freejoint/>{geom:ring}</body>',
        lambda d: abs(d.qpos[2] + 0.16) < 0.01,
    )
    hook = rc.Shape(rc.Mesh(*torus(0.03, 0.004)))
    yield Scene(
        "mug on a hook",
        10,
        {"mug": mug(), "hook": hook},
        '{geom:hook|euler="90 0 0"}<body pos="0 -0.05 -0.094" euler="0 0 90"><freejoint/>{geom:mug}</body>',
        lambda d: -0.3 < d.qpos[2] < 0,
    )
    rng = np.random.default_rng(66)
    small = rc.Shape(rc.Mesh(*torus(0.05, 0.012, 24, 12)))
    items = "".join(
        f'<body pos="{x:.3f} {y:.3f} {0.15 + 0.14 * i:.3f}" euler="{a:.0f} {b:.0f} 0"><freejoint/>'
        f"{{geom:{('small', 'mug')[i % 2]}}}</body>"
        for i, (x, y, a, b) in enumerate(rng.uniform([-0.08, -0.08, 0, 0], [0.08, 0.08, 360, 360], (50, 4)))
    )
    walls = "".join(
        f'<geom type="box" size="{sx} {sy} 4" pos="{x} {y} 4"/>'
        for x, y, sx, sy in ((0.2, 0, 0.02, 0.2), (-0.2, 0, 0.02, 0.2), (0, 0.2, 0.2, 0.02), (0, -0.2, 0.2, 0.02))
    )
    yield Scene(
        "50 in a bin",
        5,
        {"small": small, "mug": mug()},
        '<geom type="plane" size="1 1 0.1"/>' + walls + items,
        lambda d: bool((d.qpos.reshape(-1, 7)[:, 2] > 0).all() and (abs(d.qpos.reshape(-1, 7)[:, :2]) < 0.2).all()),
    )
    if factory is None:
        return
    for size, height in (("8mm", 0.03), ("4mm", 0.03)):
        peg = rc.Shape(factory / f"factory_round_peg_{size}_loose.obj")
        hole = rc.Shape(factory / f"factory_round_hole_{size}_subdiv_3x.obj")
        yield Scene(
            f"peg {size}",
            0.5,
            {"peg": peg, "hole": hole},
            f'{{geom:hole}}<body pos="0 0 {height}"><freejoint/>{{geom:peg}}</body>',
            lambda d: d.qpos[2] < 0.01 and abs(d.qpos[0]) < 0.002,
            'timestep="0.001"',
        )
    nut = rc.Shape(factory / "factory_nut_m16_loose_subdiv_3x.obj")
    bolt = rc.Shape(factory / "factory_bolt_m16_loose.obj")
    yield Scene(
        "nut on its bolt",
        0.3,
        {"nut": nut, "bolt": bolt},
        '{geom:bolt}<body pos="0 0 0.0145"><freejoint/>{geom:nut}</body>',
        lambda d: abs(d.qpos[2] - 0.0145) < 0.002,
        'timestep="0.001"',
    )


def asset(name, mesh):
    vertices, faces = mesh
    numbers = " ".join(f"{x:.9g}" for x in np.ravel(vertices))
    return (
        f'<mesh name="{name}" inertia="{{inertia}}" vertex="{numbers}" face="{" ".join(map(str, np.ravel(faces)))}"/>'
    )


def compiled(scene, method):
    """The model; a mesh's name by geom where it collides as drawn."""
    kind = "sdf" if method.endswith("sdf") else "mesh"
    assets, parts = "", {}
    for name, shape in scene.meshes.items():
        pieces = [(shape.vertices, shape.triangles)]
        if method == "coacd":
            import coacd

            coacd.set_log_level("error")
            pieces = coacd.run_coacd(coacd.Mesh(np.asarray(shape.vertices), np.asarray(shape.triangles)))
        parts[name] = [f"{name}_{i}" for i in range(len(pieces))]
        for part, piece in zip(parts[name], pieces):
            assets += asset(part, piece).format(inertia="convex" if method == "coacd" else "exact")
    text, out = scene.bodies, ""
    while "{geom:" in text:
        before, rest = text.split("{geom:", 1)
        inner, text = rest.split("}", 1)
        name, _, more = inner.partition("|")
        out += before + "".join(f'<geom type="{kind}" mesh="{part}" {more}/>' for part in parts[name])
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option {scene.options}/><default><geom friction="0.5" density="1000"/></default>'
        f"<asset>{assets}</asset><worldbody>{out}{text}</worldbody></mujoco>"
    )


def placed(scene, model, data):
    """The shapes as drawn where MuJoCo has them, one for each body, and their poses."""
    shapes, poses, seen = [], [], set()
    for g in range(model.ngeom):
        mesh, body = model.geom_dataid[g], model.geom_bodyid[g]
        if mesh < 0 or (body, name := model.mesh(mesh).name.rsplit("_", 1)[0]) in seen:
            continue
        seen.add((body, name))
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.mesh_quat[mesh])
        pose = np.eye(4)
        pose[:3, :3] = data.geom_xmat[g].reshape(3, 3) @ turn.reshape(3, 3).T
        pose[:3, 3] = data.geom_xpos[g] - pose[:3, :3] @ model.mesh_pos[mesh]
        shapes.append(scene.meshes[name])
        poses.append(pose)
    return shapes, np.array(poses)


def deepest(scene, model, data):
    """The deepest overlap of the meshes as drawn, metres."""
    space = rc.Scene(direction="refined", threads=1)
    for shape, pose in zip(*placed(scene, model, data)):
        space.add(shape, rc.nearest_rigid(pose))
    found = space.find_contacts()
    return float(found.depth.max()) if len(found) else 0.0


def run(scene, method):
    (rm.install if method.startswith("as drawn") else rm.uninstall)()
    model = compiled(scene, method)
    data = mujoco.MjData(model)
    steps, most, deep, spent = round(scene.seconds / model.opt.timestep), 0, 0.0, 0.0
    for block in range(20):
        start = time.perf_counter()
        for _ in range(steps // 20):
            mujoco.mj_step(model, data)
            most = max(most, data.ncon)
        spent += time.perf_counter() - start
        deep = max(deep, deepest(scene, model, data))
    rm.install()
    return scene.works(data), steps / spent, deep, most


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", help="scenes whose names have this in them")
    parser.add_argument("--methods", nargs="*", default=METHODS, choices=METHODS)
    parser.add_argument("--factory", type=Path, help="folder of the meshes of IsaacGymEnvs' Factory")
    options = parser.parse_args()
    print(f"mujoco {mujoco.__version__}, one thread\n")
    print("scene | method | works | steps/s | deepest, mm | contacts\n---|---|---|---|---|---")
    for scene in scenes(options.factory):
        if options.only and options.only not in scene.name:
            continue
        for method in options.methods:
            try:
                works, rate, deep, most = run(scene, method)
                print(
                    f"{scene.name} | {method} | {'yes' if works else 'no'} | {rate:.0f} | {1e3 * deep:.2f} | {most}",
                    flush=True,
                )
            except (ImportError, ValueError) as error:
                print(f"{scene.name} | {method} | - | {str(error).splitlines()[0]}", flush=True)


if __name__ == "__main__":
    main()
