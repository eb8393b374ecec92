# SPDX-License-Identifier: Apache-2.0
"""pages_in_browser.py CHROMIUM RAYCONTACT: the report of a run and the page of a reproduction, on a desk and on a phone."""

import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser  # noqa: E402


def check(browser, page, expected):
    for width, height in ((1280, 900), (400, 800)):
        browser.size(width, height)
        browser.open(page)
        browser.wait_for("document.readyState === 'complete' && document.images.length >= 0")
        text = browser.value("document.body.textContent")
        for words in expected:
            assert words in text, f"{page}: \"{words}\" is missing"
        wide = browser.value("document.documentElement.scrollWidth")
        assert wide <= width, f"{page} at {width} pixels scrolls sideways: {wide}"
        browser.wait_for("[...document.images].every(i => i.complete)")
        broken = browser.value("[...document.images].filter(i => i.src && !i.naturalWidth).length")
        assert broken == 0, f"{page}: {broken} pictures cannot be shown"
    assert not browser.problems, browser.problems
    assert not browser.outside_requests(), browser.outside_requests()


def check_view_of_run(browser, page):
    """It plays on its own to the end, and the wheel is the page's until someone clicks into it."""
    browser.size(1280, 900)
    browser.open(page)
    browser.wait_for("document.readyState === 'complete'")
    view = "document.querySelector('iframe').contentDocument"
    browser.wait_for(f"{view}.documentElement.dataset.state")
    state = browser.value(f"{view}.documentElement.dataset.state")
    assert state == "ready", state
    browser.wait_for(f"{view}.documentElement.dataset.step === '79'")
    said = browser.value(f"{view}.getElementById('said').textContent")
    assert said.startswith("step 79 of 80") and "contact" in said, said
    browser.value(f"{view}.getElementById('layer-contacts').click()")
    browser.wait_for(f"+{view}.documentElement.dataset.marks > 0")

    def wheel():
        """Whether the view took it."""
        return browser.value(f"""(() => {{
            const turn = new WheelEvent('wheel', {{deltaY: 100, cancelable: true}});
            return !{view}.getElementById('stage').dispatchEvent(turn);
        }})()""")

    assert not wheel(), "the view takes the wheel of a reader who passes"
    browser.value("document.querySelector('iframe').focus()")
    browser.wait_for(f"{view}.hasFocus()")
    assert wheel(), "the view does not zoom"
    assert not browser.problems, browser.problems
    assert not browser.outside_requests(), browser.outside_requests()


def main(chromium, raycontact):
    with tempfile.TemporaryDirectory() as folder:
        run, paper = os.path.join(folder, "run"), os.path.join(folder, "paper")
        subprocess.run([raycontact, "run", "avalanche", "--bodies", "12", "--steps", "80", "--out", run, "--json"],
                       check=True, capture_output=True)
        subprocess.run([raycontact, "reproduce", "fig9", "--quick", "--out", paper], check=True, capture_output=True)
        browser = Browser(chromium)
        try:
            check(browser, os.path.join(run, "report.html"), ["Avalanche: 12 meshes", "Beside Bullet's GImpact"])
            check_view_of_run(browser, os.path.join(run, "report.html"))
            page = os.path.join(paper, "report.html")
            check(browser, page, ["The paper, reproduced", "wrong_rays.avalanche", "Short version"])
            # The 3D view inside it.
            browser.size(1280, 900)
            browser.open(page)
            browser.wait_for("document.readyState === 'complete'")
            browser.value("document.querySelector('button[data-view]').click()")
            browser.wait_for("document.querySelector('iframe')?.contentDocument?.documentElement?.dataset.state")
            state = browser.value("document.querySelector('iframe').contentDocument.documentElement.dataset.state")
            assert state == "ready", state
            assert not browser.problems, browser.problems
        finally:
            browser.close()


main(*sys.argv[1:])
