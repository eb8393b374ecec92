#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What Python costs: a recording replayed by `raycontact replay`, in C++, and through set_poses and find_contacts here.

`raycontact run avalanche --record FILE.glb` makes one; all bodies must be there from the first step on. Both find the
same contacts of the same pairs with the same threads; their numbers are compared. Runs alternate. Prints the median
step of each, milliseconds: poses set and contacts found, nothing else.
"""

import argparse
import json
import statistics
import subprocess
import time

import numpy as np
import raycontact as rc


def in_cpp(program, file, threads):
    arguments = [program, "replay", file, "--json", "--threads", str(threads)]
    found = json.loads(subprocess.run(arguments, check=True, capture_output=True, text=True).stdout)
    return found["step_ms"]["median"], found["contacts"]


def in_python(file, threads):
    recording = rc.Recording(file)
    if not recording[0].present.all():
        raise SystemExit("bodies come after the first step: this benchmark takes none of that")
    # As `raycontact replay` does: no speculative contacts.
    scene = rc.Scene(**{**recording.settings, "threads": threads, "speculative": False, "speculative_margin": None})
    shapes = recording.shapes
    for shape in shapes:
        shape.prepare()
    ids = scene.add([shapes[i] for i in recording.shape_of], recording[0].poses)
    times, contacts = [], 0
    for step in range(len(recording)):
        poses, _, pairs = recording[step]
        pairs = ids[pairs]
        start = time.perf_counter()
        scene.set_poses(ids, poses)
        scene.find_contacts(pairs)
        times.append(1000 * (time.perf_counter() - start))
        contacts += scene.stats.contacts
    return statistics.median(times), contacts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", help="a recording")
    parser.add_argument("--program", default="build/bin/raycontact", help="the raycontact of the same build")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()

    cpp, python = [], []
    for _ in range(options.runs):
        ms, contacts = in_cpp(options.program, options.file, options.threads)
        cpp.append(ms)
        ms, same = in_python(options.file, options.threads)
        python.append(ms)
        if contacts != same:
            raise SystemExit(f"the contacts are not the same: {contacts} and {same}")
    ratio = np.median(np.array(python) / np.array(cpp))
    print(f"C++ {np.median(cpp):.3f} ms a step, Python {np.median(python):.3f}; ratio {ratio:.3f}")


if __name__ == "__main__":
    main()
