# SPDX-License-Identifier: Apache-2.0
"""view_in_browser.py CHROMIUM RAYCONTACT [RECORDING]: opens the view of a recording as a person would.

Prints frames a second while it plays at 640 x 400 pixels; asserted is what it draws at the times of a clock of its own."""

import json
import os
import re
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser  # noqa: E402

STATE = "document.documentElement?.dataset.state"


def data(browser, name):
    return float(browser.value(f"document.documentElement.dataset.{name}"))


def click(browser, name):
    browser.value(f"document.getElementById('{name}').click()")


def open_page(browser, page, fragment=""):
    browser.open(page, fragment)
    browser.wait_for(STATE)
    assert browser.value(STATE) == "ready", browser.value("document.getElementById('problem').textContent")


def colours(browser):
    """How many different colours the picture has, of a grid of its pixels."""
    return browser.value("""(() => {
        const stage = document.getElementById('stage'), copy = document.createElement('canvas');
        copy.width = 64; copy.height = 40;
        return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => {
            const flat = copy.getContext('2d');
            flat.drawImage(stage, 0, 0, 64, 40);
            const bytes = flat.getImageData(0, 0, 64, 40).data, seen = new Set();
            for (let i = 0; i < bytes.length; i += 4) seen.add(bytes[i] << 16 | bytes[i + 1] << 8 | bytes[i + 2]);
            done(seen.size);
        })));
    })()""")


def main(chromium, raycontact, recording=None):
    with tempfile.TemporaryDirectory() as folder:
        if recording is None:
            recording = os.path.join(folder, "run.glb")
            subprocess.run([raycontact, "run", "avalanche", "--bodies", "48", "--steps", "240", "--record", recording,
                            "--json"], check=True, capture_output=True)
        page = os.path.join(folder, "view.html")
        subprocess.run([raycontact, "view", recording, "--out", page, "--method", "predictive", "--json"], check=True,
                       capture_output=True)
        browser = Browser(chromium)
        try:
            check(browser, page)
            check_legend(browser, raycontact, folder)
            check_clashes(browser, raycontact, folder)
        finally:
            browser.close()


CUBE = """v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"""


def check_legend(browser, raycontact, folder):
    """Two cubes that begin a metre deep in each other, and then all rest within millimetres."""
    with open(os.path.join(folder, "cube.obj"), "w") as file:
        file.write(CUBE)
    bodies = [{"mesh": "cube", "position": [x, 0, 1]} for x in (0, 1, 4, 7)]
    bodies[0]["static"] = True
    with open(os.path.join(folder, "deep.json"), "w") as file:
        json.dump({"steps": 120, "ground": {"slab": 30}, "meshes": {"cube": {"file": "cube.obj"}}, "bodies": bodies},
                  file)
    recording, page = os.path.join(folder, "deep.glb"), os.path.join(folder, "deep.html")
    subprocess.run([raycontact, "run", os.path.join(folder, "deep.json"), "--record", recording, "--json"], check=True,
                   capture_output=True)
    subprocess.run([raycontact, "view", recording, "--out", page, "--layers-every", "119", "--json"], check=True,
                   capture_output=True)
    browser.size(1280, 800)
    open_page(browser, page, "#step=119&layers=contacts")
    browser.wait_for("+document.documentElement.dataset.marks > 0")
    legend = browser.value("document.getElementById('legend').textContent")
    assert re.search(r"[1-9][0-9.]* mm.*deeper, up to 1 m in step 0$", legend), legend
    about = browser.value("document.getElementById('about').textContent")
    assert "3 moving bodies, 2 standing still" in about, about


def check_clashes(browser, raycontact, folder):
    """Three cubes in a row, of which the second meets both others, and one that is away."""
    names = []
    for i, x in enumerate((0, 1.75, 3.25, 9)):
        names.append(f"part{i}.obj")
        rows = [line.split() for line in CUBE.splitlines()]
        with open(os.path.join(folder, names[-1]), "w") as file:
            file.writelines(f"v {float(w[1]) + x} {w[2]} {w[3]}\n" if w[0] == "v" else " ".join(w) + "\n" for w in rows)
    subprocess.run([raycontact, "clash", *names, "--out", "red.glb"], cwd=folder, check=True, capture_output=True)
    subprocess.run([raycontact, "view", "red.glb", "--json"], cwd=folder, check=True, capture_output=True)
    browser.size(1280, 800)
    page = os.path.join(folder, "red.html")
    open_page(browser, page)
    browser.wait_for("+document.documentElement.dataset.marks === 2")
    assert data(browser, "triangles") == 4 * 12
    assert "4 parts, 2 clashes" in browser.value("document.getElementById('about').textContent")
    for hidden in ("play", "time", "layers"):
        assert browser.value(f"document.getElementById('{hidden}').offsetParent === null"), hidden
    options = browser.value("[...document.getElementById('clash').options].map(o => o.textContent).join('; ')")
    assert options == ("all: 2 clashes; 1. part1.obj x part2.obj: overlapping, 0.5 deep; "
                       "2. part0.obj x part1.obj: overlapping, 0.25 deep"), options
    open_page(browser, page, "#clash=2")
    browser.wait_for("+document.documentElement.dataset.marks === 1")
    said = browser.value("document.getElementById('said').textContent")
    assert re.match(r"at (0\.[7-9]|1,)", said), said
    browser.value("(list => { list.value = 0; list.onchange(); })(document.getElementById('clash'))")
    browser.wait_for("document.getElementById('said').textContent.startsWith('at 2')")
    assert not browser.problems, browser.problems


# The page's clock, moved by hand: tick(milliseconds) draws the frame that is due then.
CLOCK = """
    let waiting = [], clock = 1000;
    window.requestAnimationFrame = draw => waiting.push(draw);
    performance.now = () => clock;
    window.tick = async ms => {
        const next = async () => { while (!waiting.length) await new Promise(go => setTimeout(go)); };
        await next();
        clock += ms;
        const due = waiting;
        waiting = [];
        for (const draw of due) draw(clock);
        await next();
    };
"""


def tick(browser, times, ms):
    browser.value(f"(async () => {{ for (let i = 0; i < {times}; ++i) await tick({ms}); }})()")


def check_pace(browser, page):
    """Real time at any pace of frames; less detail where they are slow, and all of it when the picture stands."""
    script = browser.call("Page.addScriptToEvaluateOnNewDocument", source=CLOCK)["identifier"]
    browser.open(page)
    browser.wait_for("!!window.tick")
    tick(browser, 2, 16)
    whole = data(browser, "triangles")
    click(browser, "play")
    tick(browser, 1, 16)
    for times, ms in ((60, 1000 / 60), (10, 100), (4, 250)):
        before, step = data(browser, "frames"), data(browser, "step")
        tick(browser, times, ms)
        assert data(browser, "frames") == before + times, "a frame was not drawn"
        assert abs(data(browser, "step") - step - 60 * times * ms / 1000) <= 1, "steps do not follow the clock"
    assert data(browser, "detail") < 0.2, "slow frames have all detail"
    assert data(browser, "triangles") < whole
    click(browser, "play")  # and now it stands
    tick(browser, 10, 100)
    assert data(browser, "detail") == 1
    assert data(browser, "triangles") >= whole / 2  # bodies have moved
    drawn = data(browser, "frames")
    tick(browser, 20, 100)
    assert data(browser, "frames") == drawn, "it draws though nothing changes"
    browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier=script)


def check(browser, page):
    for width, height in ((1280, 800), (400, 700)):
        browser.size(width, height)
        open_page(browser, page)
        wide = browser.value("document.documentElement.scrollWidth")
        assert wide <= width, f"at {width} pixels the page scrolls sideways: {wide}"
        low = browser.value("document.getElementById('controls').getBoundingClientRect().bottom")
        assert low <= height + 1, f"at {width} x {height} the controls end at {low}"

    # Layers, by the address and by hand.
    browser.size(1280, 800)
    open_page(browser, page, "#step=100&layers=contacts,rays&clear")
    browser.wait_for("+document.documentElement.dataset.step === 100")
    browser.wait_for("+document.documentElement.dataset.marks > 0")
    marks = data(browser, "marks")
    click(browser, "layer-predictions")
    browser.wait_for(f"+document.documentElement.dataset.marks > {marks}")
    said = browser.value("document.getElementById('said').textContent")
    assert "step 100 of" in said and "contacts" in said, said
    assert not browser.value("document.getElementById('legend').hidden")

    # Step by step, and a drag of the pointer.
    click(browser, "forward")
    browser.wait_for("+document.documentElement.dataset.step === 101")
    click(browser, "back")
    browser.wait_for("+document.documentElement.dataset.step === 100")
    frames = data(browser, "frames")
    for kind, x in (("mousePressed", 300), ("mouseMoved", 420), ("mouseReleased", 420)):
        browser.call("Input.dispatchMouseEvent", type=kind, x=x, y=250, button="left", buttons=1, clickCount=1)
    browser.wait_for(f"+document.documentElement.dataset.frames > {frames}")

    # How it plays on this machine, at 640 x 400: the panel below takes the rest of the height.
    browser.size(640, 400)
    open_page(browser, page)
    panel = browser.value("document.getElementById('controls').offsetHeight")
    browser.size(640, 400 + panel)
    canvas = "document.getElementById('stage').width + 'x' + document.getElementById('stage').height"
    browser.wait_for(f"['640x400', '640x401'].includes({canvas})")  # the panel's height is no whole number
    click(browser, "play")
    browser.wait_for("document.documentElement.dataset.step > 20")
    assert colours(browser) > 8, "the picture is empty"
    start, frames, step = time.monotonic(), data(browser, "frames"), data(browser, "step")
    time.sleep(2)
    seconds = time.monotonic() - start
    rate = (data(browser, "frames") - frames) / seconds
    moved = (data(browser, "step") - step) / seconds
    print(f"{rate:.1f} frames a second, {data(browser, 'triangles'):.0f} triangles, {moved:.0f} steps a second")
    check_pace(browser, page)

    assert not browser.problems, browser.problems
    assert not browser.outside_requests(), browser.outside_requests()


main(*sys.argv[1:])
