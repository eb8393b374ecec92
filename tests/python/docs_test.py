# SPDX-License-Identifier: Apache-2.0
"""Each Python program of README and docs runs as it stands, beside the program's samples."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAM = os.environ.get("RAYCONTACT_PROGRAM")


def programs():
    for page in ("README.md", "docs/python.md", "docs/planning.md"):
        for i, text in enumerate(re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), re.M | re.S)):
            yield pytest.param(text, id=f"{page}-{i}")


@pytest.fixture(scope="module")
def samples(tmp_path_factory):
    if not PROGRAM:
        pytest.skip("RAYCONTACT_PROGRAM does not name the program, which makes the samples")
    folder = tmp_path_factory.mktemp("docs")
    subprocess.run([PROGRAM, "samples"], cwd=folder, check=True, capture_output=True)
    return folder


@pytest.mark.parametrize("text", list(programs()))
def test_it_runs(text, samples):
    if "from ompl" in text:
        pytest.importorskip("ompl", reason="OMPL is not installed")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    run = subprocess.run([sys.executable, "-c", text], cwd=samples, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr


def test_the_shell_has_the_programs_queries(samples):
    """`python -m raycontact` and the program agree on the clashes of the sample assembly, JSON line by JSON line."""
    import json

    ours = [sys.executable, "-m", "raycontact", "clash", "samples/assembly.glb", "--json"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    mine = subprocess.run(ours, cwd=samples, env=environment, capture_output=True, text=True, check=True).stdout
    theirs = subprocess.run(
        [PROGRAM, "clash", "samples/assembly.glb", "--json"], cwd=samples, capture_output=True, text=True, check=True
    ).stdout
    lines = [json.loads(line) for line in mine.splitlines()]
    assert lines and lines == [json.loads(line) for line in theirs.splitlines()]
    for arguments, status in (
        (["mesh", "samples/hare.obj", "--check"], 0),
        (["mesh", "samples/none.obj"], 2),
        (["collide", "samples/hare.obj", "samples/hare.obj", "--check"], 3),
        (["collide", "samples/hare.obj", "samples/hare.obj", "--pose", "9", "0", "0", "--check"], 0),
        (["collide", "samples/hare.obj", "samples/hare.obj", "--pose", "9"], 2),
        (["clash", "samples/assembly.glb", "--check"], 3),
        (["clash", "samples/hare.obj"], 2),
        (["devices"], 0),
        (["nothing"], 2),
    ):
        run = subprocess.run(
            [sys.executable, "-m", "raycontact", *arguments],
            cwd=samples,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert run.returncode == status, (arguments, run.stdout, run.stderr)
        assert status != 2 or run.stderr.strip()
