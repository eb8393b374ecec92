# SPDX-License-Identifier: Apache-2.0
"""What speculative contacts add to a step of fine meshes that fit: a nut that turns on its bolt.

    PYTHONPATH=build/python python bench/python/threads.py NUT BOLT [--height 0.0139] [--pitch 0.002]

Of Factory (Narang et al. 2022): the loose M16 nut and bolt. The nut turns by 0.3 degrees a step, down its thread: free
in its play, and pressed 0.1 mm into one flank. Milliseconds a step, the median of 300, one thread.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
import raycontact as rc


def steps(nut: rc.Shape, bolt: rc.Shape, height: float, pitch: float, **settings) -> tuple[float, int]:
    """The median step, milliseconds, and the contacts of the last."""
    scene = rc.Scene(threads=1, devices="cpu", **settings)
    scene.add(bolt)
    body = scene.add(nut)
    took = []
    for step in range(300):
        angle = np.radians(-0.3 * step)
        pose = np.eye(4)
        pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        pose[2, 3] = height + pitch * angle / (2 * np.pi)
        scene.set_poses(body, pose)
        begin = time.perf_counter()
        contacts = scene.find_contacts()
        took.append(time.perf_counter() - begin)
    return 1e3 * float(np.median(took)), len(contacts)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("nut")
    parser.add_argument("bolt")
    parser.add_argument("--height", type=float, default=0.0139, help="of the nut on its bolt, in its play, metres")
    parser.add_argument("--pitch", type=float, default=0.002, help="metres a turn")
    parsed = parser.parse_args()
    nut, bolt = rc.Shape(parsed.nut), rc.Shape(parsed.bolt)
    kept = {"all contacts": {}, "40, refined": {"direction": "refined", "max_contacts_per_pair": 40}}
    print(f"{'':30}{'touching':>10}{'and near':>10}{'ratio':>8}")
    for place, lift in (("free", 0), ("pressed", -1e-4)):
        for name, settings in kept.items():
            touching, _ = steps(nut, bolt, parsed.height + lift, parsed.pitch, **settings)
            near, count = steps(nut, bolt, parsed.height + lift, parsed.pitch, speculative=True, **settings)
            label = f"{place}, {name} ({count})"
            print(f"{label:30}{touching:10.2f}{near:10.2f}{near / touching:8.2f}")


if __name__ == "__main__":
    main()
