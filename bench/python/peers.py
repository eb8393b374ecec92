#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""raycontact beside python-fcl and coal, from Python: shallow pairs of concave meshes, one thread each.

Needs `pip install raycontact python-fcl coal`; peers that are not there are left out. Every engine gets the same meshes
and poses and is called as its documentation does it; making trees and moving data to Python's side is not counted,
calls are. Prints one table: microseconds a pair, the median of the runs, and how many times as long as raycontact.
"""

import argparse
import statistics
import time

import numpy as np
import raycontact as rc


def knot(p, q, around=75, across=6, tube=0.28):
    """Vertices and triangles of a torus knot, some 2 in size; concave."""
    t = np.arange(around) * 2 * np.pi / around

    def curve(t):
        r = np.cos(q * t) * 0.4 + 1
        return np.stack([r * np.cos(p * t), r * np.sin(p * t), -0.4 * np.sin(q * t)], axis=-1)

    centre, ahead = curve(t), curve(t + 1e-3)
    tangent = (ahead - centre) / np.linalg.norm(ahead - centre, axis=1, keepdims=True)
    side = np.cross(tangent, centre + ahead)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(tangent, side)
    angle = np.arange(across) * 2 * np.pi / across
    offsets = np.cos(angle)[None, :, None] * side[:, None] + np.sin(angle)[None, :, None] * up[:, None]
    vertices = (centre[:, None] + tube * offsets).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return vertices, faces


def sized(mesh):
    """Vertices and triangles, as a knot is: some 2 in size, about the origin."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    return (mesh.vertices - (low + high) / 2) * (2 / (high - low).max()), mesh.triangles


def shallow_poses(a, b, n, rng, depth):
    """Poses of b that reach into a by about `depth`: it comes from a random side until they touch, then goes on."""
    q = rng.normal(size=(n, 4))
    towards = rng.normal(size=(n, 3))
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    at = -5 * towards
    for _ in range(60):
        gap = rc.distance(a, b, pose_b=rc.pose_from_quaternion(at, q)).distance
        at += gap[:, None] * towards
    return rc.pose_from_quaternion(at + depth * towards, q)


class Fcl:
    name = "python-fcl"

    def __init__(self, meshes, poses):
        import fcl

        self.fcl, models = fcl, []
        for vertices, faces in meshes:
            model = fcl.BVHModel()
            model.beginModel(len(vertices), len(faces))
            model.addSubModel(vertices, faces)
            model.endModel()
            models.append(model)
        self.a = fcl.CollisionObject(models[0], fcl.Transform())
        self.b = fcl.CollisionObject(models[1], fcl.Transform())
        self.poses = [(np.ascontiguousarray(pose[:3, :3]), pose[:3, 3].copy()) for pose in poses]

    def _each(self, ask):
        for rotation, translation in self.poses:
            self.b.setTransform(self.fcl.Transform(rotation, translation))
            yield ask()

    def contacts(self):
        request = self.fcl.CollisionRequest(num_max_contacts=1_000_000, enable_contact=True)

        def ask():
            result = self.fcl.CollisionResult()
            self.fcl.collide(self.a, self.b, request, result)
            return len(result.contacts)

        return list(self._each(ask))

    def intersects(self):
        request = self.fcl.CollisionRequest()
        return [
            n > 0 for n in self._each(lambda: self.fcl.collide(self.a, self.b, request, self.fcl.CollisionResult()))
        ]

    def distance(self):
        request = self.fcl.DistanceRequest()
        return list(self._each(lambda: self.fcl.distance(self.a, self.b, request, self.fcl.DistanceResult())))


class Coal:
    name = "coal"

    def __init__(self, meshes, poses):
        import coal

        self.coal, self.models = coal, []
        for vertices, faces in meshes:
            model = coal.BVHModelOBBRSS()
            model.beginModel(len(faces), len(vertices))
            model.addVertices(vertices)
            model.addTriangles(faces.astype(np.int64))
            model.endModel()
            self.models.append(model)
        self.still = coal.Transform3s()
        self.poses = [coal.Transform3s(pose[:3, :3], pose[:3, 3]) for pose in poses]

    def _each(self, request, count):
        found = []
        for pose in self.poses:
            result = self.coal.CollisionResult()
            self.coal.collide(self.models[0], self.still, self.models[1], pose, request, result)
            found.append(count(result))
        return found

    def contacts(self):
        request = self.coal.CollisionRequest(self.coal.CollisionRequestFlag.CONTACT, 1_000_000)
        return self._each(request, lambda result: result.numContacts())

    def intersects(self):
        request = self.coal.CollisionRequest(self.coal.CollisionRequestFlag.NO_REQUEST, 1)
        return self._each(request, lambda result: result.isCollision())

    def distance(self):
        request, found = self.coal.DistanceRequest(), []
        for pose in self.poses:
            result = self.coal.DistanceResult()
            found.append(self.coal.distance(self.models[0], self.still, self.models[1], pose, request, result))
        return found


def median_time(call, runs):
    times = []
    for _ in range(runs):
        begin = time.perf_counter()
        answer = call()
        times.append(time.perf_counter() - begin)
    return statistics.median(times), answer


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=10_000)
    parser.add_argument("--peer-pairs", type=int, default=500, help="of these, as many for peers, which take longer")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument(
        "--depth", type=float, default=0.03, help="how far they reach into each other, of a size of 2 to 3"
    )
    parser.add_argument("--mesh", help="a file: pairs of it, its box 2 wide; else two torus knots of 900 triangles")
    parser.add_argument("--threads", type=int, default=1, help="of raycontact; 0: one per core")
    options = parser.parse_args()

    meshes = 2 * [sized(rc.Mesh(options.mesh))] if options.mesh else [knot(2, 3), knot(3, 4)]
    a, b = (rc.Shape(rc.Mesh(*mesh)) for mesh in meshes)
    rng = np.random.default_rng(20)
    touching = shallow_poses(a, b, options.pairs, rng, options.depth)
    apart = shallow_poses(a, b, options.pairs, rng, -0.1)
    a.prepare(), b.prepare()
    half = np.concatenate([touching[::2], apart[::2]])
    rng.shuffle(half)

    few = options.peer_pairs
    peers, peers_half, peers_apart = [], {}, {}
    for peer in (Fcl, Coal):
        try:
            peers.append(peer(meshes, touching[:few]))
            peers_half[peer.name], peers_apart[peer.name] = peer(meshes, half[:few]), peer(meshes, apart[:few])
        except ImportError:
            print(f"{peer.name} is not installed")

    how = {"threads": options.threads}
    jobs = [
        ("all contacts, edges", lambda: rc.collide(a, b, pose_b=touching, **how), "contacts"),
        (
            "all contacts, the paper's rule",
            lambda: rc.collide(a, b, pose_b=touching, features="vertices", **how),
            "contacts",
        ),
        ("intersects, half of them", lambda: rc.intersects(a, b, pose_b=half, **how), "intersects"),
        ("distance, all apart", lambda: rc.distance(a, b, pose_b=apart, **how).distance, "distance"),
    ]
    triangles = len(meshes[0][1])
    print(f"{options.pairs} pairs of {triangles} triangles, {few} of them for peers; median of {options.runs} runs")
    print(f"{'':32} {'raycontact':>14}" + "".join(f"{peer.name:>24}" for peer in peers))
    for name, ours, question in jobs:
        seconds, answer = median_time(ours, options.runs)
        mine = seconds / options.pairs * 1e6
        line = f"{name:32} {mine:11.2f} us"
        for peer in peers:
            asked = {"contacts": peer, "intersects": peers_half[peer.name], "distance": peers_apart[peer.name]}[
                question
            ]
            theirs, found = median_time(getattr(asked, question), options.runs)
            theirs = theirs / few * 1e6
            line += f"{theirs:13.1f} us {theirs / mine:6.1f}x"
            if question == "intersects":
                assert np.array_equal(found, answer[:few]), f"{peer.name} and raycontact disagree on what intersects"
            if question == "distance":
                assert np.allclose(found, answer[:few], atol=1e-6), f"{peer.name} and raycontact disagree on distances"
        print(line, flush=True)
        if question == "contacts":
            some = len(np.unique(answer.pair))
            print(f"{'':6}{len(answer) / options.pairs:.1f} contacts a pair; {some} pairs have some")


main()
