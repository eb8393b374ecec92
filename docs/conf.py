# SPDX-License-Identifier: Apache-2.0
"""The pages as a site, by Sphinx and MyST (scripts/site). A page that `navigation` lacks fails the build."""

import re
from pathlib import Path

project = "RayContact"
release = re.search(r"VERSION ([\d.]+) LANG", Path(__file__).parents[1].joinpath("CMakeLists.txt").read_text())[1]
extensions = ["myst_parser"]
root_doc = "README"
include_patterns = ["*.md", "docs/**.md", "bench/*.md"]
exclude_patterns = [".*", "build*", "dist", "out"]  # what need not be looked through
myst_heading_anchors = 4
html_theme = "furo"
html_title = f"{project} {release}"
html_copy_source = False
html_use_index = False
html_show_copyright = False

navigation = {
    "Use": "getting-started concepts program clash assembly-motion python planning engine bullet mujoco queries"
    " speculative scene-files",
    "Rely on": "conventions limits performance",
    "How it works": "internals/pipeline internals/shapes internals/certified internals/edges internals/speculative"
    " internals/patches internals/devices internals/dialect internals/recording internals/real-meshes",
    "Measured": "internals/paper-map internals/reproduction internals/factory internals/bullet-measurements"
    " ../bench/README ../bench/log",
    "Project": "../CONTRIBUTING ../SECURITY ../CHANGELOG",
}


def append_navigation(app, page, source):
    """Add the lists of pages to the first page, whose file has none: a repository's host shows that as it is."""
    if page == root_doc:
        for title, pages in navigation.items():
            names = "\n".join(f"docs/{name}" for name in pages.split())
            source[0] += f"\n```{{toctree}}\n:hidden:\n:caption: {title}\n\n{names}\n```\n"


def setup(app):
    app.connect("source-read", append_navigation)
