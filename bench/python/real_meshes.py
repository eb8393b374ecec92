#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes as people have them: what preparation makes of the mesh files of folders, and whether pairs come apart.

Needs `pip install raycontact`. Prints a table of the folders, then one of random pairs of one kind that intersect: how
many have a contact, and how many are apart after at most 12 pushes, each along the deepest contact's normal by its
depth. Meshes are scaled by powers of two to a diagonal of 0.7 to 1.4 m, which changes no digit of a coordinate.
"""

import argparse
import math
import random
import time
from pathlib import Path

import numpy as np
import raycontact as rc

ENDINGS = {".obj", ".stl", ".ply", ".off", ".gltf", ".glb", ".3mf"}
# Columns of repairs: what a repair begins with, and a word in it.
REPAIRS = {
    "dropped": ("dropped", "degenerate|duplicate|back to back"),
    "turned": ("turned", ""),
    "joined": ("joined", "border"),
    "T-junctions": ("split", "T-junction"),
    "spanned": ("spanned", ""),
    "united": ("united", ""),
    "left": ("left", "as they are|as it is"),
}
KINDS = ["closed", "holes", "united", "crossing", "sheet"]


def has_repair(report, column):
    begin, words = REPAIRS[column]
    return any(text.startswith(begin) and any(word in text for word in words.split("|")) for text in report.repairs)


def kind_of(report):
    """What pairs are of; the first that fits."""
    if not report.solid:
        return "sheet"
    if report.self_intersecting or not report.outward:
        return "crossing"
    if report.holes:
        return "holes"
    return "united" if has_repair(report, "united") else "closed"


def files_of(folder, options):
    """The mesh files of a folder, or as many as asked for of them."""
    files = sorted(f for f in folder.rglob("*") if f.suffix.lower() in ENDINGS and f.is_file())
    if options.files and len(files) > options.files:
        files = sorted(random.Random(options.seed).sample(files, options.files))
    return files


def load(file, slow):
    """The shape, or None where the file is refused."""
    begin = time.perf_counter()
    try:
        mesh = rc.Mesh(file)
        size = float(np.linalg.norm(np.ptp(mesh.vertices[np.unique(mesh.triangles)], axis=0)))
        shape = rc.Shape(mesh, scale=2.0 ** -round(math.log2(size)) if size > 0 else 1.0)
    except rc.InputError as error:
        print(f"  refused: {error}", flush=True)
        return None
    if (seconds := time.perf_counter() - begin) > slow:
        print(f"  {seconds:.1f} s: {file}, {shape.report.file_triangles} triangles", flush=True)
    return shape


def table_of(folders, options):
    """Prints a line for each folder; gives the shapes by kind, with their files."""
    by_kind = {kind: [] for kind in KINDS}
    rows = []
    for folder in folders:
        files = files_of(folder, options)
        begin = time.perf_counter()
        loaded = [(shape, file) for file in files if (shape := load(file, options.slow))]
        seconds = time.perf_counter() - begin
        reports = [shape.report for shape, _ in loaded]
        for (shape, file), report in zip(loaded, reports):
            by_kind[kind_of(report)].append((shape, file))
        cells = [len(files), len(files) - len(loaded)]
        inside = [r for r in reports if r.solid]
        holes = sum(r.holes > 0 for r in inside)
        cells += [len(inside) - holes, holes, len(reports) - len(inside)]
        cells += [sum(r.verdict.startswith("good for contacts") for r in reports)]
        cells += [sum(has_repair(r, column) for r in reports) for column in REPAIRS]
        rows.append([folder.name, *cells, f"{seconds:.1f}"])
    print_table(["package", "files", "refused", "solid", "with holes", "sheet", "good", *REPAIRS, "s"], rows)
    return by_kind


def print_table(names, rows):
    print("\n" + " | ".join(names) + "\n" + "|".join(["---"] * len(names)))
    for row in rows:
        print(" | ".join(str(cell) for cell in row))
    print(flush=True)


def poses_of(a, b, rng):
    """A pose of b, turned at random, in which it intersects a; None where 64 tries find none."""
    middle_a, middle_b = a.box.mean(axis=0), b.box.mean(axis=0)
    reach = (np.linalg.norm(np.ptp(a.box, axis=0)) + np.linalg.norm(np.ptp(b.box, axis=0))) / 2
    turns = rc.pose_from_quaternion(np.zeros((64, 3)), rng.normal(size=(64, 4)))
    ways = rng.normal(size=(64, 3))
    ways *= (rng.uniform(0, reach, 64) / np.linalg.norm(ways, axis=1))[:, None]
    turns[:, :3, 3] = middle_a + ways - turns[:, :3, :3] @ middle_b
    meet = np.flatnonzero(rc.intersects(a, b, pose_b=turns))
    return turns[meet[0]] if len(meet) else None


def deepest(a, b, poses):
    """Depth and normal of each pair's deepest contact; depth -1 of those without one."""
    contacts = rc.collide(a, b, pose_b=poses)
    depth, normal = np.full(len(poses), -1.0), np.zeros((len(poses), 3))
    order = np.argsort(contacts.depth, kind="stable")  # the deepest of a pair is written last
    depth[contacts.pair[order]] = contacts.depth[order]
    normal[contacts.pair[order]] = contacts.normal[order]
    return depth, normal


def push(kind, shapes, options, index):
    """Draws pairs, pushes them apart; prints those without a contact, and gives the cells of a line."""
    rng = np.random.default_rng([options.seed, index])
    pairs, poses = [], []
    for _ in range(4 * options.pairs):
        if len(pairs) == options.pairs:
            break
        first, second = (shapes[i] for i in rng.integers(len(shapes), size=2))
        if (pose := poses_of(first[0], second[0], rng)) is not None:
            pairs.append((first, second))
            poses.append(pose)
    if not pairs:
        return None
    poses = np.array(poses)
    begin = time.perf_counter()
    left, silent = np.arange(len(pairs)), []
    for turn in range(12):
        a, b = [pairs[i][0][0] for i in left], [pairs[i][1][0] for i in left]
        depth, normal = deepest(a, b, poses[left])
        if turn == 0:
            silent = left[depth < 0]
        # A little more, so that what is apart to rounding does not touch.
        poses[left, :3, 3] += np.where(depth > 0, depth + 1e-6, 0)[:, None] * normal
        left = left[rc.intersects(a, b, pose_b=poses[left])]
        if not len(left):
            break
    for i in silent:
        print(f"  {kind}: no contact of {pairs[i][0][1]} and {pairs[i][1][1]}, pose of the second\n{poses[i].tolist()}")
    apart = len(pairs) - len(left)
    share = f"{100 * apart / len(pairs):.0f}"
    return [len(pairs), len(silent), apart, share, f"{time.perf_counter() - begin:.1f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="one for each package")
    parser.add_argument("--files", type=int, default=60, help="of each folder, at random; 0: all (%(default)s)")
    parser.add_argument("--pairs", type=int, default=200, help="of each kind (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of files, pairs and poses (%(default)s)")
    parser.add_argument("--slow", type=float, default=5, help="seconds; slower files are named (%(default)s)")
    options = parser.parse_args()
    by_kind = table_of(options.folders, options)
    rows = []
    for index, kind in enumerate(KINDS):
        shapes = by_kind[kind]
        cells = push(kind, shapes, options, index) if shapes else None
        rows.append([kind, len(shapes), *(cells or ["-"] * 5)])
    print_table(["kind", "meshes", "pairs", "no contact", "apart", "of 100", "s"], rows)


if __name__ == "__main__":
    main()
