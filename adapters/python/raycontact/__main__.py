# SPDX-License-Identifier: Apache-2.0
"""`python -m raycontact`: the queries of the program `raycontact`, without its simulations and reports."""

from __future__ import annotations

import argparse
import csv
import json
import sys
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

import raycontact as rc

from .clash import ClearanceLike


def _mesh(options: argparse.Namespace) -> int:
    good = True
    for file in options.files:
        report = rc.Shape(rc.Mesh(file, scale=options.scale)).report
        print(report.to_json() if options.json else f"{file}: {report.verdict}\n{report}")
        good &= report.good
    return 0 if good or not options.check else 3


def _pose_of(numbers: list[float]) -> np.ndarray:
    return rc.pose(numbers[:3]) if len(numbers) == 3 else np.reshape(numbers, (4, 4))


def _collide(options: argparse.Namespace) -> int:
    if options.pose is not None and len(options.pose) not in (3, 16):
        raise rc.InputError(f"--pose: {len(options.pose)} numbers given; give x y z, or the 16 of a matrix by rows")
    a, b = (rc.Shape(rc.Mesh(file, scale=options.scale)) for file in (options.a, options.b))
    pose = None if options.pose is None else _pose_of(options.pose)
    contacts = rc.collide(a, b, pose_b=pose, direction=options.direction, features=options.features)
    apart = rc.distance(a, b, pose_b=pose)
    if options.json:
        rows = zip(contacts.point_a, contacts.point_b, contacts.normal, contacts.depth, contacts.kind, strict=True)
        for point_a, point_b, normal, depth, kind in rows:
            line = {"point_a": point_a.tolist(), "point_b": point_b.tolist(), "normal": normal.tolist()}
            print(json.dumps({**line, "depth": float(depth), "kind": rc.FeatureKind(kind).name.lower()}))
    elif len(contacts):
        deepest = contacts.deepest()
        print(f"{len(contacts)} contacts, the deepest {deepest.depth[0]:.6g} m at {deepest.point_a[0].tolist()}")
    elif apart.distance == 0:
        print(f"they share the point {apart.point_a.tolist()}, without a contact")
    else:
        print(f"apart by {apart.distance:.6g} m, from {apart.point_a.tolist()} to {apart.point_b.tolist()}")
    return 3 if options.check and apart.distance == 0 else 0


def _excluded(given: str) -> list[str | tuple[str, str]]:
    """A file has two names a line, as CSV; empty lines and those that begin with # say nothing."""
    if given == "parent-child":
        return [given]
    try:
        with open(given, encoding="utf-8-sig") as file:
            lines = file.read().split("\n")
    except (OSError, UnicodeDecodeError) as error:
        raise rc.InputError(
            f"--exclude {given}: cannot be read ({error}); give a file of pairs of names, or parent-child"
        ) from None
    pairs: list[str | tuple[str, str]] = []
    for number, line in enumerate(lines, 1):
        if not line or line.startswith("#"):
            continue
        try:
            names = next(csv.reader([line], strict=True))
        except csv.Error:  # a quote that does not end
            names = []
        if len(names) != 2 or not all(names):
            words = "is not two names with a comma between; put names with a comma in quotes"
            raise rc.InputError(f"{given}:{number}: {words}")
        pairs.append((names[0], names[1]))
    return pairs


def _clearances(given: list[str]) -> tuple[float, list[ClearanceLike]]:
    """LENGTH is of all pairs, LENGTH:SET and LENGTH:SET:SET of some."""
    plain = 0.0
    some: list[ClearanceLike] = []
    for word in given:
        length, *names = word.split(":", 2)
        try:
            metres = float(length)
        except ValueError:
            metres = -1.0
        if not metres >= 0:
            raise rc.InputError(f"--clearance {word}: begins with no length; give LENGTH, LENGTH:SET or LENGTH:SET:SET")
        if names:
            some.append((metres, names[0], names[1] if len(names) > 1 else "*"))
        else:
            plain = max(plain, metres)
    return plain, some


def _clash(options: argparse.Namespace) -> int:
    exclude = [pair for given in options.exclude for pair in _excluded(given)]
    clearance, clearances = _clearances(options.clearance)
    found = rc.clash(
        options.files, scale=options.scale, weld=options.weld, components=options.components,
        against=options.against, exclude=exclude,
        clearance=clearance, clearances=clearances, tolerance=options.tolerance,
        ignore_touching=options.ignore_touching, separations=options.separation, progress=sys.stderr.isatty(),
    )  # fmt: skip
    for fault in found.faults:
        print(f"not checked: {fault.name}: {fault.why}", file=sys.stderr)
    if options.json:
        for one in found:
            normal = None if one.normal is None else one.normal.tolist()
            line: dict[str, Any] = {"a": one.a, "b": one.b}
            line |= {"path_a": found.paths[one.index_a], "path_b": found.paths[one.index_b]}
            line |= {"depth": one.depth, "point": one.point.tolist(), "contacts": one.contacts}
            line |= {"duplicate": one.duplicate, "normal": normal, "kind": one.kind, "distance": one.distance}
            line |= {"point_a": one.point_a.tolist(), "point_b": one.point_b.tolist()}
            line["open"] = [name for name, is_open in zip("ab", one.open, strict=True) if is_open]
            line["box"] = None if one.box is None else one.box.tolist()
            if options.separation:
                parted = one.separation
                line["separation"] = parted and {
                    name: value if name == "distance" else value.tolist() for name, value in parted._asdict().items()
                }
            print(json.dumps(line))
    else:
        print(found)
    if options.check and not found and found.faults:
        return 1
    return 3 if options.check and found else 0


def _devices(options: argparse.Namespace) -> int:
    for device in rc.list_devices():
        print(f"{device.id:12} {device.name}" + ("" if device.usable else f"  ({device.why_not})"))
    return 0


def main(arguments: list[str] | None = None) -> int:
    """Exit status: 0 fine, 1 the run failed, 2 bad usage or input, 3 found something (--check)."""
    parser = argparse.ArgumentParser(prog="python -m raycontact", description=__doc__)
    parser.add_argument("--version", action="version", version=rc.__version__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(
        name: str, run: Callable[[argparse.Namespace], int], text: str, checks: bool = True
    ) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=text)
        sub.set_defaults(run=run)
        if checks:
            sub.add_argument("--json", action="store_true", help="JSON on stdout")
            sub.add_argument("--check", action="store_true", help="exit status 3 where there is something to report")
        return sub

    mesh = command("mesh", _mesh, "Say what a mesh is, and whether it is good for contacts")
    mesh.add_argument("files", nargs="+", metavar="FILE")
    collide = command("collide", _collide, "Find the contacts of two meshes, or how far they are apart")
    collide.add_argument("a", metavar="A")
    collide.add_argument("b", metavar="B")
    collide.add_argument("--pose", nargs="+", type=float, metavar="X", help="of B: x y z, or a 4 x 4 matrix by rows")
    collide.add_argument("--direction", default="reprojected", choices=["ray", "weighted", "reprojected", "refined"])
    collide.add_argument("--features", default="edges", choices=["vertices", "edges"])
    clash = command("clash", _clash, "Find the parts of an assembly that intersect")
    for sub in (mesh, collide, clash):
        sub.add_argument("--scale", type=float, default=1.0, help="multiplies coordinates; 0.001 for millimetres")
    words = "parts are nodes of glTF, objects or groups of OBJ, solids of STL"
    clash.add_argument("files", nargs="+", metavar="FILE", help=words)
    clash.add_argument("--against", action="append", metavar="SET", help="test these (* and ?) against all others")
    words = "leave out: a file of two such names a line, as CSV; or parent-child, of the nodes of glTF"
    clash.add_argument("--exclude", action="append", default=[], metavar="PAIRS", help=words)
    clash.add_argument("--weld", type=float, metavar="LENGTH", help="join vertices nearer than this, after --scale")
    clash.add_argument("--components", action="store_true", help="split parts into their connected components")
    words = "also find those so near; LENGTH:SET or LENGTH:SET:SET: of such names; may be given again"
    clash.add_argument("--clearance", action="append", default=[], metavar="LENGTH", help=words)
    clash.add_argument("--tolerance", type=float, default=0.0, metavar="LENGTH", help="up to this they are touching")
    clash.add_argument("--separation", action="store_true", help="also find the translation that parts two (slow)")
    clash.add_argument("--ignore-touching", type=float, metavar="LENGTH", help="leave out clashes no deeper, metres")
    command("devices", _devices, "List the devices that contacts can be found on", checks=False)

    options = parser.parse_args(arguments)
    try:
        return int(options.run(options))
    except rc.InputError as error:
        print(f"raycontact: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    warnings.formatwarning = lambda message, *where, **more: f"raycontact: {message}\n"
    sys.exit(main())
