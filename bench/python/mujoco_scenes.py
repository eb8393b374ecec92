# SPDX-License-Identifier: Apache-2.0
"""Concave meshes in MuJoCo: their hulls, CoACD's parts, MuJoCo's signed distance fields, and meshes as drawn.

    PYTHONPATH=build/mujoco/4.0.0:build/python python bench/python/mujoco_scenes.py [--only tori] [--limit 60]
        [--factory FOLDER] [--hand FOLDER/dm_control/third_party/kinova/jaco_hand.xml]

Needs `raycontact.mujoco` (docs/mujoco.md), and coacd of PyPI for its rows. One thread. Each row is one run: whether the
scene does what it does in the world, simulated steps a second of the thread's own time (contacts alone are what
differs), how deep the meshes as drawn lie in each other at most at 20 instants (pairs with a free body: vertices that
contacts of RayContact are of, to the surface; edges by direction "refined"), and the most contacts at a time. A row
that takes longer than --limit ends there, and tells how far it came.
"""

from __future__ import annotations

import argparse
import hashlib
import multiprocessing
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, Optional

import mujoco
import numpy as np
import raycontact as rc
import raycontact.mujoco as rm

METHODS = {
    "hulls": "hulls",
    "coacd": "CoACD's parts",
    "mujoco-sdf": "MuJoCo's SDF",
    "drawn": "as drawn",
    "drawn-sdf": 'as drawn, `type="sdf"`',
}


class Scene(NamedTuple):
    """meshes: by name. world: MJCF, of the meshes by name. works: at the end. meanwhile: before each twentieth of the
    time. turned: the body whose turn about z follows the control. hand: MJCF of a hand, placed in the origin with
    hand_turn; its names are after "hand/", its joints follow the controls.
    """

    name: str
    seconds: float
    meshes: dict[str, rc.Shape]
    world: str
    works: Callable[[mujoco.MjModel, mujoco.MjData], bool]
    meanwhile: Callable[[mujoco.MjModel, mujoco.MjData], None] = lambda model, data: None
    timestep: float = 0.002
    surface: str = 'friction="0.5"'
    turned: str = ""
    hand: Optional[Path] = None
    hand_turn: tuple[float, ...] = ()


class Row(NamedTuple):
    works: str
    rate: float
    deepest: float
    contacts: int


def geom(mesh):
    return f'<geom type="mesh" mesh="{mesh}"/>'


def body(mesh, pos, name="", euler="0 0 0"):
    return f'<body name="{name or mesh}" pos="{pos}" euler="{euler}"><freejoint/>{geom(mesh)}</body>'


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


def mug(loop=0.025):
    wall = turned([(0.036, -0.05), (0.04, -0.05), (0.04, 0.05), (0.036, 0.05)])
    bottom = turned([(0.001, -0.05), (0.038, -0.05), (0.038, -0.044), (0.001, -0.044)])
    v, f = torus(loop, 0.005)
    handle = (v @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]).T + [0.05, 0, 0], f)
    return joined(wall, bottom, handle)


def lean(data, name):
    """Of a body's z axis, degrees."""
    return np.degrees(np.arccos(np.clip(data.body(name).xmat[8], -1, 1)))


def turn(data, name):
    """Of a body about z, degrees within 180."""
    return np.degrees(np.arctan2(data.body(name).xmat[3], data.body(name).xmat[0]))


def height(data, name):
    return data.body(name).xpos[2]


def scenes(factory, hand):
    yield from household()
    if factory is not None:
        yield from assembly(factory)
    if hand is not None:
        yield from grasps(hand)


def household():
    ring = rc.Shape(rc.Mesh(*torus(0.1, 0.02)))
    yield Scene(
        "a torus in another",
        6,
        {"ring": ring},
        f'<body euler="90 0 0">{geom("ring")}</body>' + body("ring", "0 0 -0.14", "lower", "90 90 0"),
        lambda m, d: abs(height(d, "lower") + 0.16) < 0.01,
    )
    hook = rc.Shape(rc.Mesh(*torus(0.03, 0.004)))
    yield Scene(
        "a mug on a hook",
        10,
        {"mug": mug(), "hook": hook},
        f'<body euler="90 0 0">{geom("hook")}</body>' + body("mug", "0 -0.05 -0.044", euler="0 0 90"),
        lambda m, d: -0.3 < height(d, "mug") < 0,
    )
    rng = np.random.default_rng(66)
    small = rc.Shape(rc.Mesh(*torus(0.05, 0.012, 24, 12)))
    items = "".join(
        body(
            ("small", "mug")[i % 2],
            f"{0.15 * (i % 4 - 1.5)} {0.15 * (i // 4 % 4 - 1.5)} {0.1 + 0.16 * (i // 16)}",
            f"item {i}",
            f"{a:.0f} {b:.0f} 0",
        )
        for i, (a, b) in enumerate(rng.uniform(0, 360, (50, 2)))
    )
    walls = "".join(
        f'<body euler="0 0 {turn}"><geom type="box" size="0.02 0.34 1" pos="0.34 0 1"/></body>'
        for turn in (0, 90, 180, 270)
    )

    def at_rest_inside(model, data):
        place, speed = data.qpos.reshape(-1, 7)[:, :3], data.qvel.reshape(-1, 6)[:, :3]
        return bool((place[:, 2] > 0).all() and (abs(place[:, :2]) < 0.32).all() and abs(speed).max() < 0.5)

    yield Scene(
        "50 in a bin",
        2,
        {"small": small, "mug": mug()},
        '<geom type="plane" size="1 1 0.1"/>' + walls + items,
        at_rest_inside,
        timestep=0.001,
        surface='friction="0.5" solref="0.004 1"',
    )


def assembly(factory):
    """Parts of Factory, all of which fit with play: the loose ones. Their surface is that of MuJoCo's nut and bolt."""
    stiff = 'friction="0.1" solref="0.01 1" solimp="0.95 0.99 0.0001"'

    def push(model, data):
        """A peg that has gone in is pushed aside at its top by half its weight."""
        if data.time > 0.49:
            load = model.body("peg").mass[0] * 9.81 / 2
            lever = data.body("peg").xmat.reshape(3, 3) @ [0, 0, 0.05 - model.body("peg").ipos[2]]
            data.body("peg").xfrc_applied = [load, 0, 0, *np.cross(lever, [load, 0, 0])]

    for form, size in (("round", "8mm"), ("round", "4mm"), ("rectangular", "8mm"), ("rectangular", "4mm")):
        kind = "_subdiv_3x" if form == "rectangular" else ""
        peg = rc.Shape(factory / f"factory_{form}_peg_{size}_loose{kind}.obj")
        hole = rc.Shape(factory / f"factory_{form}_hole_{size}_subdiv_3x.obj")
        yield Scene(
            f"a {form} peg, {size}",
            1,
            {"peg": peg, "hole": hole},
            '<geom type="plane" size="1 1 0.1"/>' + geom("hole") + body("peg", "0 0 0.01"),
            lambda m, d: abs(height(d, "peg")) < 0.001 and lean(d, "peg") < 3,
            push,
            timestep=0.001,
            surface=stiff,
        )

    def drive(model, data):
        """One gear is turned by 45 degrees, once both lie on the base."""
        data.ctrl[0] = np.radians(45) * np.clip((data.time - 0.2) / 0.6, 0, 1)

    def geared(model, data):
        on_posts = all(  # they are drawn there
            np.linalg.norm(data.body(gear).xipos - model.body(gear).ipos) < 0.001 and lean(data, gear) < 3
            for gear in ("medium", "small")
        )
        return on_posts and abs(turn(data, "medium") - 45) < 5 and abs(turn(data, "small") + 90) < 10

    gears = {"base": "base_loose_space_5e-4_subdiv_4x", "medium": "medium_space_5e-4", "small": "small_space_5e-4"}
    yield Scene(
        "two gears on their posts",
        1,
        {name: rc.Shape(factory / f"factory_gear_{file}.obj") for name, file in gears.items()},
        geom("base") + body("medium", "0 0 0.001") + body("small", "0 0 0.001"),
        geared,
        drive,
        timestep=0.001,
        surface=stiff,
        turned="medium",
    )
    nut = rc.Shape(factory / "factory_nut_m16_loose_subdiv_3x.obj")
    bolt = rc.Shape(factory / "factory_bolt_m16_loose.obj")
    pitch, start = 0.002, 0.0139

    def screw(model, data):
        """The nut is turned by a quarter, clockwise from above."""
        data.ctrl[0] = np.radians(-90) * np.clip((data.time - 0.1) / 0.3, 0, 1)

    yield Scene(
        "a nut screwed down its bolt",
        0.5,
        {"nut": nut, "bolt": bolt},
        geom("bolt") + body("nut", f"0 0 {start}"),
        lambda m, d: abs(turn(d, "nut") + 90) < 5 and abs(start - height(d, "nut") - pitch / 4) < pitch / 8,
        screw,
        timestep=0.001,
        surface=stiff,
        turned="nut",
    )


def grasps(hand):
    """The Jaco hand of dm_control. It closes round a mug, and the table under it goes; one finger carries a mug by its
    handle."""
    spec = mujoco.MjSpec.from_file(str(hand))
    folder = Path(spec.modelfiledir) / spec.meshdir
    meshes = {f"hand/{mesh.name}": rc.Shape(folder / mesh.file) for mesh in spec.meshes}

    def bent(data, *angles):
        for finger, angle in enumerate(angles, 1):
            data.joint(f"hand/finger_{finger}").qpos[0] = angle

    def close(model, data):
        if data.time == 0:
            bent(data, 0.2, 0.2, 0.2)
        data.ctrl[:] = 1.2
        if data.time > 0.99:
            data.mocap_pos[0, 2] = -10

    yield Scene(
        "a hand round a mug",
        4,
        {"mug": mug(), **meshes},
        '<body name="table" mocap="true" pos="0.2 0 -0.07"><geom type="box" size="0.1 0.1 0.02"/></body>'
        + body("mug", "0.165 0 0"),
        lambda m, d: abs(height(d, "mug")) < 0.01,
        close,
        hand=hand,
        hand_turn=(0.5, 0.5, 0.5, 0.5),
    )

    def hook(model, data):
        if data.time == 0:
            bent(data, 1.2, 0.2, 0.2)
        data.ctrl[:] = 1.2, 0.2, 0.2

    start = (0.175, -0.0485, -0.0235)
    yield Scene(
        "a mug by its handle on a finger",
        3,
        {"mug": mug(loop=0.032), **meshes},
        body("mug", " ".join(map(str, start)), euler="0 0 90"),
        lambda m, d: np.linalg.norm(d.body("mug").xpos - start) < 0.1,
        hook,
        hand=hand,
        hand_turn=(0.5**0.5, 0, 0.5**0.5, 0),
    )


def decompose(vertices, faces, file):
    import coacd

    coacd.set_log_level("error")
    parts = coacd.run_coacd(coacd.Mesh(vertices, faces), seed=0)
    np.savez(file, *(array for part in parts for array in part))


def parts_of(shape, limits):
    """CoACD's, which take seconds to minutes: in a process that can be ended."""
    import coacd  # noqa: F401, here is told that it is missing

    vertices, faces = np.asarray(shape.vertices), np.asarray(shape.triangles)
    file = limits.parts / f"{hashlib.sha256(vertices.tobytes() + faces.tobytes()).hexdigest()[:16]}.npz"
    if not file.exists():
        limits.parts.mkdir(exist_ok=True)
        child = multiprocessing.get_context("spawn").Process(target=decompose, args=(vertices, faces, file))
        child.start()
        child.join(limits.coacd)
        child.kill()
        if not file.exists():
            raise TimeoutError(f"no parts in {limits.coacd:.0f} s")
    arrays = list(np.load(file).values())
    return list(zip(arrays[::2], arrays[1::2]))


def compiled(scene, method, limits):
    spec = mujoco.MjSpec.from_string(
        f'<mujoco><option timestep="{scene.timestep}" integrator="implicitfast"/>'
        f'<default><geom {scene.surface} density="1000"/></default>'
        f'<worldbody><site name="world" size="0.001"/>{scene.world}</worldbody></mujoco>'
    )
    if scene.turned:
        spec.body(scene.turned).add_site(name="turned")
        drive = spec.add_actuator(target="turned", refsite="world", trntype=mujoco.mjtTrn.mjTRN_SITE)
        drive.gear = [0, 0, 0, 0, 0, 1]
        drive.set_to_position(kp=0.05, kv=0.001)
    if scene.hand:
        hand = mujoco.MjSpec.from_file(str(scene.hand))
        spec.copy_during_attach = True
        spec.attach(hand, frame=spec.worldbody.add_frame(quat=scene.hand_turn), prefix="hand/")
        for joint in [joint for joint in spec.joints if joint.name.startswith("hand/")]:
            drive = spec.add_actuator(target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT, forcerange=[-0.6, 0.6])
            drive.set_to_position(kp=5)
    for mesh in list(spec.meshes):
        spec.delete(mesh)
    parts, inertia = {}, mujoco.mjtMeshInertia
    for name, shape in scene.meshes.items():
        pieces = parts_of(shape, limits) if method == "coacd" else [(shape.vertices, shape.triangles)]
        parts[name] = [f"{name}_{i}" for i in range(len(pieces))]
        for part, (vertices, faces) in zip(parts[name], pieces):
            mesh = spec.add_mesh(name=part, uservert=np.ravel(vertices), userface=np.ravel(faces))
            mesh.inertia = inertia.mjMESH_INERTIA_CONVEX if method == "coacd" else inertia.mjMESH_INERTIA_EXACT
    for geom in [geom for geom in spec.geoms if geom.meshname]:
        first, *others = parts[geom.meshname]
        geom.meshname = first
        geom.mass /= 1 + len(others)  # not a number: by its density
        if method.endswith("sdf"):
            geom.type = mujoco.mjtGeom.mjGEOM_SDF
        for i, part in enumerate(others):
            other = geom.parent.add_geom(meshname=part, type=geom.type)
            for field in ("pos", "quat", "contype", "conaffinity", "condim", "friction", "mass", "density", "material"):
                setattr(other, field, getattr(geom, field))
    return spec.compile()


def deepest(scene, model, data):
    """The deepest overlap of the meshes as drawn where MuJoCo has them, of pairs with a free body; metres."""
    space, free, seen = rc.Scene(direction="refined", threads=1), [], set()
    for g in range(model.ngeom):
        mesh, body = model.geom_dataid[g], model.geom_bodyid[g]
        name = model.mesh(mesh).name.rpartition("_")[0] if mesh >= 0 else ""
        if mesh < 0 or (body, name) in seen:
            continue
        seen.add((body, name))
        turn = np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.mesh_quat[mesh])
        pose = np.eye(4)
        pose[:3, :3] = data.geom_xmat[g].reshape(3, 3) @ turn.reshape(3, 3).T
        pose[:3, 3] = data.geom_xpos[g] - pose[:3, :3] @ model.mesh_pos[mesh]
        one = space.add(scene.meshes[name], rc.nearest_rigid(pose))
        joint = model.body_jntadr[body]
        if joint >= 0 and model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE:
            free.append(one)
    found = space.find_contacts()
    found = found[np.isin(found.bodies, free).any(axis=1)]
    depth = np.array(found.depth)
    # The way out by which a contact tells its depth need not be the nearest: that is what counts here.
    for (*pair, side), of in groups(np.column_stack([found.bodies, found.source])):
        of = of[found.kind[of] == rc.FeatureKind.VERTEX]
        other = pair[1 - side]
        inside = rc.signed_distance(space.shape(other), (found.point_a, found.point_b)[side][of], space.poses(other))
        depth[of] = np.minimum(depth[of], -inside.distance)
    return float(depth.max(initial=0))


def groups(rows):
    """Each row that there is, and where."""
    kinds, which = np.unique(rows, axis=0, return_inverse=True)
    for i, kind in enumerate(kinds):
        yield kind, np.flatnonzero(which.ravel() == i)


def run(scene, method, limits):
    (rm.install if method.startswith("drawn") else rm.uninstall)()
    model = compiled(scene, method, limits)
    data = mujoco.MjData(model)
    steps, most, deep, spent, done = round(scene.seconds / scene.timestep), 0, 0.0, 0.0, 0
    while done < steps and spent < limits.limit:
        scene.meanwhile(model, data)
        start = time.thread_time()  # others may work beside
        for _ in range(steps // 20):
            mujoco.mj_step(model, data)
            most = max(most, data.ncon)
            done += 1
            if done % 10 == 0 and spent + time.thread_time() - start > limits.limit:
                break
        spent += time.thread_time() - start
        deep = max(deep, deepest(scene, model, data))
    works = "yes" if scene.works(model, data) else "no"
    return Row(works if done == steps else f"{data.time:.3f} s of it", done / spent, deep, most)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", help="scenes whose names have this in them")
    parser.add_argument("--methods", nargs="*", default=list(METHODS), choices=METHODS)
    parser.add_argument("--limit", type=float, default=np.inf, help="of a row, seconds of the thread's own time")
    parser.add_argument("--factory", type=Path, help="folder of the meshes of IsaacGymEnvs' Factory")
    parser.add_argument("--hand", type=Path, help="jaco_hand.xml of dm_control of PyPI")
    parser.add_argument("--parts", type=Path, default="coacd-parts", help="folder that keeps CoACD's parts")
    parser.add_argument("--coacd", type=float, default=600, help="limit of finding a mesh's parts, seconds")
    options = parser.parse_args()
    print(f"MuJoCo {mujoco.__version__}, one thread\n")
    print("scene | method | works | steps/s | deepest, mm | contacts\n---|---|---|---|---|---")
    for scene in scenes(options.factory, options.hand):
        if options.only and options.only not in scene.name:
            continue
        for method in options.methods:
            title = f"{scene.name}, {scene.seconds:g} s" if method == options.methods[0] else "|"
            try:
                row = run(scene, method, options)
                told = f"{row.works} | {row.rate:.0f} | {1e3 * row.deepest:.2f} | {row.contacts}"
            except (ImportError, ValueError, TimeoutError, mujoco.FatalError) as error:
                told = f"- | {str(error).splitlines()[0]} | |"
            print(f"{title} | {METHODS[method]} | {told}", flush=True)
    rm.install()


if __name__ == "__main__":
    main()
