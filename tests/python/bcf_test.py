# SPDX-License-Identifier: Apache-2.0
"""What `clash --bcf` writes, against the published schemas of BCF 2.1 (as bcf-api-xml has them)."""

import json
import os
import pathlib
import subprocess
import zipfile

import bcf_api_xml
import meshes
import numpy as np
import pytest
from lxml import etree

pytestmark = pytest.mark.skipif(
    "RAYCONTACT_PROGRAM" not in os.environ, reason="RAYCONTACT_PROGRAM does not name the program"
)
SCHEMAS = pathlib.Path(bcf_api_xml.__file__).parent / "Schemas"
NAMES = ["a <&>\"'.obj", "zwölf ½.obj", "c.obj", "d.obj"]


def write(folder, name, centre, size=1.0):
    vertices, faces = meshes.box((size, size, size))
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in (vertices + centre).tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    (folder / name).write_text("\n".join(lines) + "\n")


def run(folder, *words):
    return subprocess.run([os.environ["RAYCONTACT_PROGRAM"], "clash", *words], cwd=folder, capture_output=True)


@pytest.mark.parametrize("unit, metres", [("m", 1.0), ("mm", 0.001)])
def test_topics_are_valid_and_cameras_look_at_their_points(tmp_path, unit, metres):
    origin = np.array([691234.5, 5334567.25, 512.125]) / metres
    for name, x in zip(NAMES, (0, 0.75, 1.75, 2.875), strict=True):
        write(tmp_path, name, origin + np.array([x, 0, 0]) / metres, 1 / metres)
    done = run(tmp_path, *NAMES, "--bcf", "out.bcfzip", "--json", "--unit", unit, "--clearance", str(0.2 / metres))
    assert done.returncode == 0, done.stderr
    found = [json.loads(line) for line in done.stdout.splitlines()]
    assert [one["kind"] for one in found] == ["overlapping", "touching", "near"]

    with zipfile.ZipFile(tmp_path / "out.bcfzip") as archive:
        assert archive.testzip() is None
        texts = {name: archive.read(name) for name in archive.namelist()}
    assert len(texts) == 1 + 2 * len(found)
    schema = {end: etree.XMLSchema(file=str(SCHEMAS / f"{file}.xsd"))
              for end, file in (("version", "version"), ("bcf", "markup"), ("bcfv", "visinfo"))}  # fmt: skip
    roots = {}
    for name, text in texts.items():
        roots[name] = etree.fromstring(text)
        schema[name.rsplit(".", 1)[1]].assertValid(roots[name])
    topics = {int(root.findtext("Topic/Index")): (name, root) for name, root in roots.items() if root.tag == "Markup"}
    for i, clash in enumerate(found):
        name, root = topics[i]
        assert root.findtext("Topic/Title") == f"{clash['a']} x {clash['b']}"
        assert root.findtext("Topic/Labels") == clash["kind"]
        folder = root.find("Topic").get("Guid")
        assert name == f"{folder}/markup.bcf"
        view = roots[f"{folder}/{root.findtext('Viewpoints/Viewpoint')}"]
        assert view.get("Guid") == root.find("Viewpoints").get("Guid")
        camera = {part.tag: np.array([float(axis.text) for axis in part]) for part in view.find("PerspectiveCamera")
                  if len(part)}  # fmt: skip
        way = np.array(clash["point"]) * metres - camera["CameraViewPoint"]
        direction, up = camera["CameraDirection"], camera["CameraUpVector"]
        assert np.allclose(way / np.linalg.norm(way), direction, atol=1e-6) and 0.1 < np.linalg.norm(way) < 10
        assert np.linalg.norm(direction) == pytest.approx(1) and direction @ up == pytest.approx(0, abs=1e-12)

    again = run(tmp_path, *NAMES, "--bcf", "again.bcfzip", "--unit", unit, "--clearance", str(0.2 / metres))
    assert again.returncode == 0
    with zipfile.ZipFile(tmp_path / "again.bcfzip") as archive:
        assert set(archive.namelist()) == set(texts), "the same topics from run to run"


def test_topics_have_their_groups_as_labels(tmp_path):
    for name, x in zip(NAMES, (0, 0.75, -0.75, 1.6), strict=True):
        write(tmp_path, name, np.array([x, 0, 0]))
    done = run(tmp_path, *NAMES, "--bcf", "out.bcfzip", "--unit", "m", "--group", "part", "--json")
    groups = [json.loads(line) for line in done.stdout.splitlines()]
    assert [group["count"] for group in groups] == [2, 1]
    with zipfile.ZipFile(tmp_path / "out.bcfzip") as archive:
        roots = [etree.fromstring(archive.read(name)) for name in archive.namelist() if name.endswith(".bcf")]
    schema = etree.XMLSchema(file=str(SCHEMAS / "markup.xsd"))
    labels = {}
    for root in roots:
        schema.assertValid(root)
        labels[root.findtext("Topic/Title")] = [label.text for label in root.findall("Topic/Labels")]
    for group in groups:
        words = group["a"] if group["b"] is None else f"{group['a']} x {group['b']}"
        for one in group["clashes"]:
            assert labels[f"{one['a']} x {one['b']}"] == [one["kind"], words]


def test_names_that_xml_does_not_have_are_replaced(tmp_path):
    write(tmp_path, "a\x01b.obj", np.zeros(3))
    name = os.fsdecode(b"\xff\xc0\x80.obj")
    write(tmp_path, name, np.array([0.5, 0, 0]))
    assert run(tmp_path, "a\x01b.obj", name, "--bcf", "out.bcfzip", "--unit", "m").returncode == 0
    with zipfile.ZipFile(tmp_path / "out.bcfzip") as archive:
        (markup,) = [archive.read(entry) for entry in archive.namelist() if entry.endswith(".bcf")]
    title = etree.fromstring(markup).findtext("Topic/Title")
    assert title.endswith("b.obj x \ufffd\ufffd\ufffd.obj") or "\\x" in title, title
