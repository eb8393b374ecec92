# SPDX-License-Identifier: Apache-2.0
"""Pages hold the bodies and contacts of a scene, and of each picture of a recording; a browser draws them."""

import base64
import importlib
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import urllib.request
from pathlib import Path

import meshes
import numpy as np
import pytest
import raycontact as rc

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "browser"))
module = importlib.import_module("raycontact.show")
viser = pytest.importorskip("viser")


def decoded(page):
    """Messages of a page as viser's client reads them, with arrays in place: [(seconds, message)], and its length."""
    import msgspec
    import zstandard

    data = base64.b64decode(re.search(r'__VISER_EMBED_DATA__="([^"]*)"', Path(page).read_text(encoding="utf-8"))[1])
    size = int.from_bytes(data[:8], "little")
    plain = zstandard.ZstdDecompressor().decompress(data[8:], max_output_size=size)
    head = int.from_bytes(plain[:8], "little")
    content = msgspec.msgpack.decode(plain[8 : 8 + head], strict=False)
    buffers, at = [], 8 + head
    for length in content["binaryBufferLengths"]:
        at = -(-at // 8) * 8
        buffers.append(plain[at : at + length])
        at += length

    def filled(value):
        if isinstance(value, dict) and "__binary_index" in value:
            return np.frombuffer(buffers[value["__binary_index"]], value["dtype"])
        if isinstance(value, dict):
            return {key: filled(item) for key, item in value.items()}
        return value

    return [(when, filled(message)) for when, message in content["messages"]], content["durationSeconds"]


@pytest.fixture
def scene():
    """Two tori and a bracket that overlap, and a torus of its own; far from the world's origin."""
    scene = rc.Scene()
    torus = rc.Shape(rc.Mesh(*meshes.torus(), name="torus"))
    bracket = rc.Shape(rc.Mesh(*meshes.bracket(), name="a/bracket"))
    turned = meshes.random_rotations(4, np.random.default_rng(5))
    places = np.add([(0, 0, 0), (0.9, 0.2, 0.1), (1.5, 0, 0), (4, 0, 0)], 1e6)
    scene.add([torus, torus, bracket, torus], rc.pose(places, turned))
    scene.find_contacts()
    return scene


@pytest.fixture
def recording(tmp_path):
    """A torus that falls into a bracket, one that comes later, and one that goes; and its scene's poses by step."""
    scene, steps = rc.Scene(), []
    torus = rc.Shape(rc.Mesh(*meshes.torus(), name="torus"))
    ground = scene.add(rc.Shape(rc.Mesh(*meshes.bracket(), name="L")), rc.pose((0, 0, -1)))
    falling, gone = scene.add([torus, torus], rc.pose([(0.5, 0.5, 0.6), (5, 0, 0)]))
    with rc.Recorder(tmp_path / "run.glb", scene, dt=0.02) as recorder:
        for step in range(31):
            turn = (np.cos(0.05 * step), np.sin(0.05 * step), 0, 0)
            scene.set_poses(falling, rc.pose_from_quaternion((0.5, 0.5, 0.6 - 0.02 * step), turn))
            if step == 10:
                late = scene.add(torus, rc.pose((0.5, 0.5, -0.4)))
                scene.remove(gone)
            contacts = scene.find_contacts()
            recorder.record()
            steps.append((scene.poses(falling), len(contacts)))
    assert ground == 0 and late not in (falling, gone)
    return tmp_path / "run.glb", steps


class Player:
    """What viser's client has on its screen at a time of a page."""

    def __init__(self, page, until=np.inf):
        self.messages, self.seconds = decoded(page)
        self.nodes, self.visible, self.position = {}, {}, {}
        for when, message in self.messages:
            if when > until:
                break
            if "props" in message:
                self.nodes[message["name"]] = dict(message["props"], kind=message["type"])
            elif message["type"] == "SceneNodeUpdateMessage":
                self.nodes[message["name"]].update(message["updates"])
            elif message["type"] == "SetSceneNodeVisibilityMessage":
                self.visible[message["name"]] = message["visible"]
            elif message["type"] == "SetPositionMessage":
                self.position[message["name"]] = np.array(message["position"])

    def batches(self):
        return [(name, node) for name, node in self.nodes.items() if node["kind"] == "BatchedMeshesMessage"]

    def poses(self, name):
        node = self.nodes[name]
        places = node["batched_positions"].reshape(-1, 3) + self.position[name]
        return rc.pose_from_quaternion(places, node["batched_wxyzs"].reshape(-1, 4))

    def contacts(self):
        """Points, ends of their normals, colours."""
        points, normals = self.nodes["/contacts/points"], self.nodes["/contacts/normals"]
        if not self.visible["/contacts/points"]:
            return np.empty((0, 3)), np.empty((0, 2, 3)), np.empty((0, 3))
        middle = self.position["/contacts/points"]
        ends = normals["points"].reshape(-1, 2, 3) + self.position["/contacts/normals"]
        return points["points"].reshape(-1, 3) + middle, ends, points["colors"].reshape(-1, 3)


def test_a_page_holds_the_bodies_and_contacts_of_a_scene(scene, tmp_path):
    assert rc.show(scene, out=tmp_path / "page.html", static=[2]) is None
    player = Player(tmp_path / "page.html")
    assert player.seconds == 0
    (torus_name, torus), (bracket_name, bracket) = player.batches()
    assert "torus" in torus_name and bracket_name == "/bodies/1 a bracket"
    shape = scene.shape(0)
    assert np.array_equal(torus["vertices"].reshape(-1, 3), shape.vertices.astype(np.float32))
    assert np.array_equal(torus["faces"].reshape(-1, 3), shape.triangles)
    poses = scene.poses()
    assert np.allclose(player.poses(torus_name), poses[[0, 1, 3]], atol=1e-6)
    assert np.allclose(player.poses(bracket_name), poses[[2]], atol=1e-6)
    colours = torus["batched_colors"].reshape(-1, 3)
    assert len(np.unique(colours, axis=0)) == 3 and np.ptp(colours, axis=1).min() > 20
    assert np.ptp(bracket["batched_colors"]) < 20, "grey"
    assert torus["opacity"] < 1

    found = scene.contacts
    points, ends, rgb = player.contacts()
    assert len(found) > 20 and np.allclose(points, found.point_a, atol=1e-6)
    along = ends[:, 1] - ends[:, 0]
    assert np.allclose(along / np.linalg.norm(along, axis=1, keepdims=True), found.normal, atol=1e-5)
    green = rgb[np.argsort(found.depth), 1].astype(int)
    assert (np.diff(green) <= 0).all() and green[0] > 150 and green[-1] == 0, "yellow to red, the deeper the redder"


def test_speculative_contacts_are_blue(tmp_path):
    scene = rc.Scene(speculative=True, speculative_margin=0.01)
    torus = rc.Shape(rc.Mesh(*meshes.torus()))
    scene.add(torus, rc.pose([(0, 0, 0), (0, 0, 0.705)]))
    contacts = scene.find_contacts()
    assert len(contacts) and (contacts.depth <= 0).all()
    rc.show(scene, out=tmp_path / "page.html")
    rgb = Player(tmp_path / "page.html").contacts()[2]
    assert len(rgb) == len(contacts) and (rgb[:, 2] > rgb[:, 0]).all()


def test_without_contacts_bodies_are_opaque(scene, tmp_path):
    rc.show(scene, out=tmp_path / "page.html", contacts=False)
    player = Player(tmp_path / "page.html")
    assert not [name for name in player.nodes if name.startswith("/contacts")]
    assert all(node["opacity"] is None for _, node in player.batches())


def test_a_shape_or_a_mesh_is_a_page(scene, tmp_path):
    shape = scene.shape(0)
    for what in (shape, rc.Mesh(shape.vertices, shape.triangles)):
        rc.show(what, out=tmp_path / "page.html")
        ((_, body),) = Player(tmp_path / "page.html").batches()
        assert np.array_equal(body["vertices"].reshape(-1, 3), shape.vertices.astype(np.float32))
        assert np.array_equal(body["faces"].reshape(-1, 3), shape.triangles)


def test_an_empty_scene_is_a_page(tmp_path):
    rc.show(rc.Scene(), out=tmp_path / "page.html")
    assert Player(tmp_path / "page.html").batches() == []


def test_a_page_plays_a_recording(recording, tmp_path):
    file, steps = recording
    rc.show(file, out=tmp_path / "page.html", fps=1000)  # every step
    end = Player(tmp_path / "page.html")
    assert end.seconds == pytest.approx(0.6 + 0.5, abs=1e-5)  # 30 steps, and a rest
    assert sorted({round(when / 0.02, 3) for when, _ in end.messages}) == list(range(31))
    (ground, _), (tori, _) = end.batches()
    for step in (0, 5, 17, 30):
        now = Player(tmp_path / "page.html", 0.02 * step + 1e-4)
        pose, contacts = steps[step]
        assert np.allclose(now.poses(tori)[0], pose, atol=1e-6)
        assert np.allclose(now.poses(ground)[0], rc.pose((0, 0, -1)))
        assert now.nodes[tori]["batched_scales"].tolist() == [1, step < 10, step >= 10]
        assert len(now.contacts()[0]) == contacts, step
    assert steps[0][1] == 0 < steps[5][1]
    assert np.ptp(end.nodes[ground]["batched_colors"]) < 20, "what never moves is grey"


def test_fps_leaves_out_steps_but_not_the_last(recording, tmp_path):
    rc.show(recording[0], out=tmp_path / "page.html", fps=12.5, contacts=False)
    messages, seconds = decoded(tmp_path / "page.html")
    assert sorted({round(when / 0.02, 3) for when, _ in messages}) == [0, 4, 8, 12, 16, 20, 24, 28, 30]
    assert seconds == pytest.approx(1.1, abs=1e-5)


@pytest.mark.skipif("RAYCONTACT_PROGRAM" not in os.environ, reason="RAYCONTACT_PROGRAM does not name the program")
def test_a_recording_of_the_program(tmp_path):
    file = tmp_path / "run.glb"
    words = ["run", "avalanche", "--bodies", "8", "--steps", "60", "--record", file]
    subprocess.run([os.environ["RAYCONTACT_PROGRAM"], *words], check=True, capture_output=True)
    rc.show(file, out=tmp_path / "page.html")
    assert sum(len(node["batched_scales"]) for _, node in Player(tmp_path / "page.html").batches()) == 9


def test_refuses_what_it_cannot_show(scene, recording, tmp_path):
    page = tmp_path / "page.html"
    wrong = ((tmp_path / "none.glb", "none.glb"), (3, "no Scene, Shape or Mesh"), (__file__, "show_test.py"))
    for what, words in wrong:
        with pytest.raises(rc.InputError, match=words):
            rc.show(what, out=page)
    (tmp_path / "cut.glb").write_bytes(recording[0].read_bytes()[:-40])
    with pytest.raises(rc.InputError, match="cut.glb"):
        rc.show(tmp_path / "cut.glb", out=page)
    wrong = (({"fps": 0}, "fps"), ({"fps": np.nan}, "fps"), ({"static": [77]}, "body 77"), ({"port": -1}, "port"))
    for options, words in wrong:
        with pytest.raises(rc.InputError, match=words):
            rc.show(scene, block=False, **options)
    assert not page.exists()
    unfinished = rc.Recorder(tmp_path / "unfinished.glb", scene)
    scene.find_contacts()
    unfinished.record()
    rc.show(tmp_path / "unfinished.glb", out=page)
    assert len(Player(page).batches()) == 2, "it is shown as far as it was written"


def test_damaged_recordings_raise_and_nothing_else(recording, tmp_path):
    data, rng = recording[0].read_bytes(), np.random.default_rng(8)
    refused = 0
    for _ in range(300):
        damaged = bytearray(data[: rng.integers(len(data))] if rng.random() < 0.3 else data)
        for at in rng.integers(0, len(damaged), rng.integers(1, 8)):
            damaged[at] = rng.integers(256)
        (tmp_path / "damaged.glb").write_bytes(damaged)
        try:
            list(rc.Recording(tmp_path / "damaged.glb"))
        except rc.InputError:
            refused += 1
    assert refused > 100


def test_without_viser_it_says_what_to_install(scene, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(ImportError, match="pip install viser"):
        rc.show(scene, block=False)


def test_importing_raycontact_does_not_import_viser():
    code = "import sys, raycontact; sys.exit('viser' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_ctrl_c_ends_it(recording):
    code = "import sys, raycontact as rc; rc.show(sys.argv[1], port=0); print('over')"
    with subprocess.Popen([sys.executable, "-c", code, recording[0]], stdout=subprocess.PIPE, text=True) as process:
        assert "http://127.0.0.1:" in process.stdout.readline()
        process.send_signal(signal.SIGINT)
        assert "over" in process.stdout.read()
    assert process.returncode == 0


def test_serves_until_it_is_stopped(recording, capsys):
    server = rc.show(recording[0], block=False, port=0)
    try:
        address = re.search(r"http://127\.0\.0\.1:\d+", capsys.readouterr().out)[0]
        assert b"<html" in urllib.request.urlopen(address).read()[:500].lower()
        batch = server.scene.get_handle_by_name("/bodies/1 torus")
        assert len(batch.batched_positions) == 3
        before, deadline = batch.batched_positions.copy(), time.monotonic() + 60
        while np.array_equal(before, batch.batched_positions):
            assert time.monotonic() < deadline, "it does not play"
            time.sleep(0.02)
    finally:
        server.stop()
    deadline = time.monotonic() + 60
    while any(thread.name == "raycontact.show" for thread in threading.enumerate()):
        assert time.monotonic() < deadline, "it plays on"
        time.sleep(0.02)


@pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium to draw the page")
def test_a_browser_draws_the_page(scene, tmp_path):
    from browser import Browser

    rc.show(scene, out=tmp_path / "page.html", contacts=False)
    browser = Browser(shutil.which("chromium"))
    try:
        browser.size(900, 600)
        browser.open(tmp_path / "page.html")
        deadline, colours = time.monotonic() + 300, {}
        # Three tori in three colours and a bracket, once the page has faded in.
        while not {"red", "blue", "white"} <= {name for name, count in colours.items() if count > 200}:
            assert time.monotonic() < deadline, f"the page shows {colours}; {browser.problems}"
            time.sleep(1)
            colours = seen(browser, browser.call("Page.captureScreenshot", format="png")["data"])
        assert not browser.problems and not browser.outside_requests()
    finally:
        browser.close()


def seen(browser, png):
    """How many pixels of a picture are reddish, bluish and white; the left third is of notices."""
    return browser.value(
        """new Promise(done => {
        const picture = new Image();
        picture.onload = () => {
            const flat = document.createElement('canvas').getContext('2d');
            flat.canvas.width = picture.width; flat.canvas.height = picture.height;
            flat.drawImage(picture, 0, 0);
            const left = Math.ceil(picture.width / 3), count = {red: 0, blue: 0, white: 0};
            const bytes = flat.getImageData(left, 0, picture.width - left, picture.height).data;
            for (let i = 0; i < bytes.length; i += 4) {
                if (bytes[i] > bytes[i + 2] + 40) ++count.red;
                else if (bytes[i + 2] > bytes[i] + 20) ++count.blue;
                else if (bytes[i] > 250) ++count.white;
            }
            done(count);
        };
        picture.src = 'data:image/png;base64,%s';
    })"""
        % png
    )
