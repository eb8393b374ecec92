# SPDX-License-Identifier: Apache-2.0
"""Which parts of an assembly clash, how deep, and how much room the others have.

python clashes.py [ASSEMBLY.glb] [--room METRES] [--picture clashes.png] [--page clashes.html]
"""

from __future__ import annotations

import numpy as np
import parts
import picture
import raycontact as rc

TOUCH = 1e-6  # metres: what is less deep than this only touches


def assembly() -> list[rc.AssemblyPart]:
    """A gearbox with three faults: gears too close, a thick shaft, a bracket that is 2 mm too deep in the plate."""
    bracket, gear = parts.bracket(thick=1 / 32), parts.gear()
    placed = {
        "plate": (rc.box((0.5, 0.3, 1 / 64)), (0.1, 0, -5 / 64)),
        "bracket 1": (bracket, (0.28, 0, -7 / 128 - 0.002)),
        "bracket 2": (bracket, (-0.08, 0, -7 / 128)),  # stands on the plate, to the last bit
        "gear 1": (gear, (0, 0, 0)),
        "gear 2": (gear, (0.197, 0.001, 0.002)),  # tip on tip, 2.79 mm too close
        "shaft 1": (parts.ring(0.01, 0.0385, 0.15), (0, 0, 0.045)),
        "shaft 2": (parts.ring(0.01, 0.0415, 0.15), (0.197, 0.001, 0.045)),
        "knot": (parts.knot(), (0.05, 0, 0.173)),
    }
    return [rc.AssemblyPart(name, mesh, rc.pose(place)) for name, (mesh, place) in placed.items()]


def main() -> None:
    parser = picture.options(__doc__)
    parser.add_argument("assembly", nargs="?", help="a glTF file in metres instead of the example's own gearbox")
    parser.add_argument("--room", type=float, default=0.005, help="also lists pairs closer than this (metres)")
    options = parser.parse_args()
    pieces = rc.load_assembly(options.assembly) if options.assembly else assembly()
    made = {id(piece.mesh): rc.Shape(piece.mesh) for piece in pieces}
    shapes = [made[id(piece.mesh)] for piece in pieces]
    poses = np.stack([piece.pose for piece in pieces])

    # Every pair, in one call each; far ones cost next to nothing with `max`.
    a, b = np.triu_indices(len(pieces), 1)
    pairs = [shapes[i] for i in a], [shapes[i] for i in b], poses[a], poses[b]
    meet = rc.intersects(*pairs)
    gap = rc.distance(*pairs, max=options.room).distance
    contacts = rc.collide(*pairs)
    depth = np.zeros(len(a))
    np.maximum.at(depth, contacts.pair, contacts.depth)

    clashing = meet & (depth > TOUCH)
    print(f"{len(pieces)} parts, {len(a)} pairs: {clashing.sum()} clash, {(meet & ~clashing).sum()} touch")
    for pair in np.lexsort((gap, -depth)):
        names = f"{pieces[a[pair]].name} - {pieces[b[pair]].name}"
        if clashing[pair]:
            print(f"  {names:<24} clash, {1e3 * depth[pair]:.3f} mm deep")
        elif meet[pair]:
            print(f"  {names:<24} touch")
        elif np.isfinite(gap[pair]):
            print(f"  {names:<24} {1e3 * gap[pair]:.3f} mm apart")

    scene = rc.Scene()
    scene.add(shapes, poses)
    scene.find_contacts()
    if options.picture:
        hit = np.isin(np.arange(len(pieces)), np.r_[a[clashing], b[clashing]])
        colours = np.where(hit, np.arange(len(pieces)) % picture.GREY, picture.GREY)
        picture.save(options.picture, picture.draw(scene, *picture.look(scene), colours))
    if options.page:
        rc.show(scene, out=options.page)


if __name__ == "__main__":
    main()
