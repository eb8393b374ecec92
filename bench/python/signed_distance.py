#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Signed distances beside libigl's, of the solids among the mesh files of folders.

Needs `pip install raycontact libigl`. Both get the same triangles: those of the prepared mesh, with those that span its
holes. Half of the points are anywhere in the box, enlarged by a fifth, half of them near the surface: 1e-8 to 1e-1 of
the diagonal from a random point of it. One thread each, processor time; building trees is not counted.

igl has two signs that fit closed meshes. The pseudonormal (Baerentzen and Aanaes 2005) is right where every edge has
two triangles and nothing crosses; the winding number needs no more than a closed mesh, and takes longer. Where a sign
differs farther than 1e-6 of the diagonal from the surface, the solid angles of all triangles decide who is right. Of
the point whose values differ most in a file, rational numbers tell how far each is off.
"""

import argparse
import math
import os
import time
from fractions import Fraction
from pathlib import Path

os.environ["IGL_NUM_THREADS"] = "1"

import igl  # noqa: E402 - reads the variable
import numpy as np  # noqa: E402
import raycontact as rc  # noqa: E402
from real_meshes import files_of, load, print_table  # noqa: E402

SIGNS = {
    "pseudonormal": igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL,
    "winding": igl.SIGNED_DISTANCE_TYPE_WINDING_NUMBER,
}


def points_about(shape, count, rng):
    low, high = shape.box
    anywhere = (low + high) / 2 + rng.uniform(-0.6, 0.6, (count - count // 2, 3)) * (high - low)
    corners = shape.vertices[shape.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    weights = rng.exponential(size=(count // 2, 3))
    weights /= weights.sum(axis=1, keepdims=True)
    on = np.einsum("ij,ijk->ik", weights, corners[rng.choice(len(areas), count // 2, p=areas / areas.sum())])
    ways = rng.normal(size=on.shape)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    return np.concatenate([anywhere, on + np.linalg.norm(high - low) * 10 ** rng.uniform(-8, -1, (len(on), 1)) * ways])


def windings(shape, points):
    """Sums of solid angles (Van Oosterom and Strackee 1983), rounded to whole turns."""
    found = []
    for point in points:
        a, b, c = np.moveaxis(shape.vertices[shape.triangles] - point, 1, 0)
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        dots = [(v * w).sum(axis=1) for v, w in ((a, b), (b, c), (c, a))]
        below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
        found.append(round(np.arctan2((a * np.cross(b, c)).sum(axis=1), below).sum() / (2 * np.pi)))
    return np.array(found)


def squared_distance(point, corners):
    """Of a point from a triangle, in rational numbers."""

    def cross(v, w):
        return [v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3] for k in range(3)]

    p, *t = (np.array([Fraction(x) for x in v.tolist()]) for v in (point, *corners))
    edges = [(t[k], t[(k + 1) % 3] - t[k]) for k in range(3)]
    normal = np.array(cross(edges[0][1], edges[1][1]))
    size = normal @ normal
    if size > 0 and all(cross(along, p - a) @ normal >= 0 for a, along in edges):
        return (normal @ (p - t[0])) ** 2 / size
    squares = []
    for a, along in edges:
        length = along @ along
        part = min(max((p - a) @ along / length, 0), 1) if length else 0
        off = p - a - part * along
        squares.append(off @ off)
    return min(squares)


def error_of(distance, square):
    """Of a distance whose exact square is known."""
    value = abs(Fraction(distance))
    return abs(float(value**2 - square)) / (float(value) + math.sqrt(square)) if square else float(value)


def timed(function, *arguments, **options):
    begin = time.process_time()
    result = function(*arguments, **options)
    return time.process_time() - begin, result


class Counts:
    """Of one folder."""

    def __init__(self):
        self.files = self.points = self.wrong = 0
        self.off = {"raycontact": 0.0, "igl": 0.0}  # as a part of the diagonal
        self.signs = dict.fromkeys(SIGNS, 0)
        self.seconds = dict.fromkeys(["raycontact", *SIGNS], 0.0)

    def add(self, shape, file, options):
        """Asks both, and names the file where they differ."""
        points = points_about(shape, options.points, np.random.default_rng([options.seed, self.files]))
        vertices, triangles = np.array(shape.vertices), shape.triangles.astype(np.int64)
        size = np.linalg.norm(np.ptp(shape.box, axis=0))
        seconds, ours = timed(rc.signed_distance, shape, points, threads=1)
        self.files += 1
        self.points += len(points)
        self.seconds["raycontact"] += seconds
        for name, sign in SIGNS.items():
            build, _ = timed(igl.signed_distance, points[:1], vertices, triangles, sign)
            seconds, (theirs, faces, *_) = timed(igl.signed_distance, points, vertices, triangles, sign)
            self.seconds[name] += seconds - build
            if name == "pseudonormal":  # the other sign is a factor 1 - 2 w, which is rounded
                i = int(np.abs(np.abs(ours.distance) - np.abs(theirs)).argmax())
                near = [faces[i], *np.flatnonzero(shape.triangle_index == ours.triangle[i])]
                square = min(squared_distance(points[i], vertices[triangles[t]]) for t in near)
                for who, found in (("raycontact", ours.distance), ("igl", theirs)):
                    off = error_of(float(found[i]), square) / size
                    self.off[who] = max(self.off[who], off)
                    if off > options.tell:
                        print(f"  {who} is {off:.1e} of the diagonal off: {file}", flush=True)
            differ = np.flatnonzero(((ours.distance < 0) != (theirs < 0)) & (np.abs(ours.distance) > 1e-6 * size))
            if not len(differ):
                continue
            inside = windings(shape, points[differ]) != 0
            wrong = int((inside != (ours.distance[differ] < 0)).sum())
            self.signs[name] += len(differ)
            self.wrong += wrong
            print(f"  {name}: {len(differ)} signs differ, raycontact wrong {wrong}: {file}", flush=True)
            print(f"    {shape.report.verdict}; manifold: {shape.report.manifold}", flush=True)

    def cells(self):
        off = [f"{worst:.0e}" for worst in self.off.values()]
        us = [f"{1e6 * seconds / max(self.points, 1):.1f}" for seconds in self.seconds.values()]
        return [self.files, self.points, *off, *self.signs.values(), self.wrong, *us]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="one for each package")
    parser.add_argument("--files", type=int, default=60, help="of each folder, at random; 0: all (%(default)s)")
    parser.add_argument("--points", type=int, default=5000, help="of each file (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of files and points (%(default)s)")
    parser.add_argument("--slow", type=float, default=5, help="seconds; slower files are named (%(default)s)")
    parser.add_argument("--tell", type=float, default=1e-12, help="of the diagonal; names worse files (%(default)s)")
    options = parser.parse_args()
    rows = []
    for folder in options.folders:
        counts = Counts()
        for file in files_of(folder, options):
            shape = load(file, options.slow)
            if shape and shape.has_inside:
                counts.add(shape, file, options)
        rows.append([folder.name, *counts.cells()])
    names = ["package", "solids", "points", "off", "igl off", "pseudonormal differs", "winding differs", "we are wrong"]
    print_table([*names, "us", "us pseudonormal", "us winding"], rows)


if __name__ == "__main__":
    main()
