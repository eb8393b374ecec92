#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Arms before a cluttered shelf: how long a planner waits for the answer whether a configuration collides.

    pip download --no-deps pybullet   # and unzip it in a folder
    PYTHONPATH=build/python python bench/python/planning.py FOLDER/pybullet_data

Needs trimesh, and python-fcl and coal for their rows. The arms are Franka's Panda (11 links) and Kuka's iiwa (8), with
their meshes for collisions. 300 configurations, drawn at random from the joints' ranges; 40 concave things stand on the
shelf. Links that meet in each of 100 other configurations, and neighbours, may touch. Microseconds a configuration, the
least of five rounds, on one thread; all rows must agree on every configuration.
"""

from __future__ import annotations

import argparse
import itertools
import timeit
import xml.etree.ElementTree as ET
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import raycontact as rc
import trimesh
from raycontact.collision import CollisionManager

ARMS = {"Panda": "franka_panda/panda.urdf", "iiwa": "kuka_iiwa/model.urdf"}


class Joint(NamedTuple):
    parent: str
    child: str
    origin: np.ndarray
    kind: str
    axis: np.ndarray
    range: tuple[float, float]


def origin_of(element):
    """The pose of an element's `origin`; roll, pitch and yaw as URDF has them."""
    origin = element.find("origin") if element is not None else None
    given = {} if origin is None else origin.attrib
    roll, pitch, yaw = (float(x) for x in given.get("rpy", "0 0 0").split())
    turn = trimesh.transformations.euler_matrix(roll, pitch, yaw, "sxyz")
    turn[:3, 3] = [float(x) for x in given.get("xyz", "0 0 0").split()]
    return turn


class Arm:
    """A URDF's links with meshes for collisions."""

    def __init__(self, file):
        root = ET.parse(file).getroot()
        self.meshes, self.places = {}, {}
        for link in root.iter("link"):
            mesh = link.find("collision/geometry/mesh")
            if mesh is None:
                continue
            path = file.parent / mesh.get("filename").removeprefix("package://")
            self.meshes[link.get("name")] = trimesh.load(path, force="mesh", process=False)
            self.places[link.get("name")] = origin_of(link.find("collision"))
        self.joints = []
        for joint in root.iter("joint"):
            limit, axis = joint.find("limit"), joint.find("axis")
            self.joints.append(
                Joint(
                    joint.find("parent").get("link"),
                    joint.find("child").get("link"),
                    origin_of(joint),
                    joint.get("type"),
                    np.array([float(x) for x in axis.get("xyz").split()]) if axis is not None else np.eye(3)[0],
                    (float(limit.get("lower", 0)), float(limit.get("upper", 0))) if limit is not None else (0.0, 0.0),
                )
            )

    def poses(self, rng):
        """(links, 4, 4): a configuration at random."""
        known = {}
        waiting = list(self.joints)
        roots = {joint.parent for joint in waiting} - {joint.child for joint in waiting}
        known.update({root: np.eye(4) for root in roots})
        while waiting:
            joint = next(joint for joint in waiting if joint.parent in known)
            waiting.remove(joint)
            value, move = rng.uniform(*joint.range), np.eye(4)
            if joint.kind in ("revolute", "continuous"):
                move = trimesh.transformations.rotation_matrix(value, joint.axis)
            elif joint.kind == "prismatic":
                move[:3, 3] = value * joint.axis
            known[joint.child] = known[joint.parent] @ joint.origin @ move
        return np.array([known[name] @ self.places[name] for name in self.meshes])

    def allowed(self, rng):
        """Pairs of names that may touch."""
        shapes = [rc.Shape(mesh) for mesh in self.meshes.values()]
        poses = np.array([self.poses(rng) for _ in range(100)])
        pairs = {frozenset((joint.parent, joint.child)) for joint in self.joints}
        for (i, one), (k, other) in itertools.combinations(enumerate(self.meshes), 2):
            if rc.intersects(shapes[i], shapes[k], poses[:, i], poses[:, k]).all():
                pairs.add(frozenset((one, other)))
        names = set(self.meshes)
        return {pair for pair in pairs if pair <= names}


def shelf():
    """Names, meshes and poses: boards, and concave things on them, within reach of an arm in the origin."""
    rng = np.random.default_rng(66)
    samples = [trimesh.Trimesh(mesh.vertices, mesh.faces, process=False) for mesh in rc.samples().values()]
    made = []
    for level in range(4):
        board = trimesh.creation.box((0.4, 1.2, 0.02))
        made.append((f"board {level}", board, rc.pose([0.65, 0, 0.05 + 0.35 * level])))
        for i in range(10):
            place = rc.pose_from_quaternion(
                [0.65 + rng.uniform(-0.15, 0.15), -0.5 + i / 9, 0.16 + 0.35 * level], rng.normal(size=4)
            )
            made.append((f"thing {level} {i}", samples[i % len(samples)], place))
    return made


def least(question, configurations):
    """Microseconds a configuration, and the answers."""
    answers = []

    def ask():
        answers[:] = question(configurations)

    return 1e6 * min(timeit.repeat(ask, number=1, repeat=5)) / len(configurations), np.array(answers, bool)


def by_manager(manager, arm, things, itself, allowed):
    """A loop over configurations as users of trimesh write it."""
    links, shelf_of = manager(), manager()
    for name, mesh in arm.meshes.items():
        links.add_object(name, mesh)
    for name, mesh, pose in things:
        shelf_of.add_object(name, mesh, pose)
    names = list(arm.meshes)
    skips = hasattr(links, "allow_collision")
    if itself and skips:
        for pair in allowed:
            links.allow_collision(*pair)

    def meets_itself():
        if skips:
            return links.in_collision_internal()
        found = links.in_collision_internal(return_names=True)[1]
        return any(frozenset(pair) not in allowed for pair in found)

    def ask(configurations):
        for poses in configurations:
            for name, pose in zip(names, poses):
                links.set_transform(name, pose)
            yield links.in_collision_other(shelf_of) or (itself and meets_itself())

    return ask


def by_scene(arm, things, at_once):
    """The shelf as a scene, and the links as a list of shapes; configuration by configuration, or all in one call."""
    scene = rc.Scene(threads=1)
    for _, mesh, pose in things:
        scene.add(rc.Shape(mesh), pose)
    links = [rc.Shape(mesh) for mesh in arm.meshes.values()]
    if at_once:
        return lambda configurations: scene.overlaps_any(links, configurations)
    return lambda configurations: [scene.overlaps_any(links, poses) for poses in configurations]


def by_coal(arm, things):
    """Coal's trees of boxes, and its sweep of the bodies."""
    import coal

    def made(mesh):
        model = coal.BVHModelOBBRSS()
        model.beginModel(len(mesh.faces), len(mesh.vertices))
        model.addVertices(np.asarray(mesh.vertices))
        model.addTriangles(np.asarray(mesh.faces, np.int64))
        model.endModel()
        return model

    def placed(model, pose):
        return coal.CollisionObject(model, coal.Transform3s(pose[:3, :3], pose[:3, 3]))

    shelf_of = coal.DynamicAABBTreeCollisionManager()
    kept = [placed(made(mesh), pose) for _, mesh, pose in things]
    for item in kept:
        shelf_of.registerObject(item)
    shelf_of.setup()
    links = [placed(made(mesh), np.eye(4)) for mesh in arm.meshes.values()]

    def ask(configurations):
        for poses in configurations:
            meets = False
            for link, pose in zip(links, poses):
                link.setTransform(coal.Transform3s(pose[:3, :3], pose[:3, 3]))
                link.computeAABB()
                callback = coal.CollisionCallBackDefault()
                shelf_of.collide(link, callback)
                meets = callback.data.result.isCollision()
                if meets:
                    break
            yield meets

    return ask


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="pybullet_data")
    options = parser.parse_args()
    things = shelf()
    fcl = trimesh.collision.CollisionManager
    print("arm | asked | by | us | kHz | collide, of 300\n---|---|---|---|---|---")
    for name, file in ARMS.items():
        arm = Arm(options.folder / file)
        allowed = arm.allowed(np.random.default_rng(1))
        rng = np.random.default_rng(2)
        configurations = np.array([arm.poses(rng) for _ in range(300)])
        rows = {
            "the shelf": {
                "Scene.overlaps_any, all at once": partial(by_scene, arm, things, True),
                "Scene.overlaps_any": partial(by_scene, arm, things, False),
                "CollisionManager": partial(by_manager, CollisionManager, arm, things, False, allowed),
                "trimesh with FCL": partial(by_manager, fcl, arm, things, False, allowed),
                "coal": partial(by_coal, arm, things),
            },
            "the shelf and itself": {
                "CollisionManager": partial(by_manager, CollisionManager, arm, things, True, allowed),
                "trimesh with FCL": partial(by_manager, fcl, arm, things, True, allowed),
            },
        }
        for asked, ways in rows.items():
            right = None
            for way, make in ways.items():
                try:
                    question = make()
                except (ImportError, ValueError) as error:
                    print(f"{name} | {asked} | {way} | - | - | {str(error).splitlines()[0]}", flush=True)
                    continue
                time, found = least(question, configurations)
                right = found if right is None else right
                differs = int((found != right).sum())
                note = f", {differs} differ" if differs else ""
                row = f"{time:.1f} | {1e3 / time:.1f} | {found.sum()}{note}"
                print(f"{name}, {len(arm.meshes)} links | {asked} | {way} | {row}", flush=True)


if __name__ == "__main__":
    main()
