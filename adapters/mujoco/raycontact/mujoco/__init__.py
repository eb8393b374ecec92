# SPDX-License-Identifier: Apache-2.0
"""MuJoCo collides meshes as drawn.

    import mujoco, raycontact.mujoco

From the import on, geoms of type `mesh` and `sdf` meet each other, spheres, capsules, ellipsoids, cylinders, boxes and
height fields as the triangles that are drawn, not as their convex hulls: in `mj_step`, the viewer, `rollout`,
dm_control and Gymnasium. Planes stay with MuJoCo. Nothing is compiled differently, so it counts for models that are
there already.

How many contacts a pair has is MuJoCo's: `mj_maxContact`, 4 or 5 of two meshes, `sdf_initpoints` (at most 40) where a
geom is of type `sdf`. More are reduced to those that stand for all; `counts()` tells how many were left out. Contacts
are those of `raycontact.collide` with direction "refined", a function of the model and the poses alone: the same for
any number of threads. A geom's margin and gap are how far apart surfaces have contacts: up to a tenth of the smaller
geom all, beyond it that of the nearest places. So `mj_geomDistance` and its sensors tell the least distance of the
meshes as drawn, and where it is.

Opt out: a custom numeric `raycontact` of 0 leaves a model to MuJoCo; a custom tuple `raycontact` of geoms with prm 0
leaves those, one with prm 1 all others. `uninstall()` leaves all.
"""

from __future__ import annotations

import ctypes
import pathlib
from typing import NamedTuple

import mujoco

_folder = pathlib.Path(__file__).parent


class Counts(NamedTuple):
    """What was found since the import, over all models and threads.

    calls: pairs of geoms that were asked.
    contacts: told to MuJoCo.
    left_out: for which MuJoCo has no slot; others stand for them.
    """

    calls: int
    contacts: int
    left_out: int


def versions() -> list[str]:
    """The versions of MuJoCo that this package has a plugin for."""
    return sorted(path.stem.removeprefix("plugin-") for path in _folder.glob("plugin-*.so"))


def library() -> str:
    """The plugin for the installed MuJoCo, for `mj_loadPluginLibrary` of a program of your own.

    Raises ImportError naming the version if there is none.
    """
    path = _folder / f"plugin-{mujoco.__version__}.so"
    if not path.exists():
        raise ImportError(
            f"raycontact.mujoco has no plugin for mujoco {mujoco.__version__}, but for {', '.join(versions())}: "
            "install one of these, or a newer raycontact-mujoco"
        )
    return str(path)


mujoco.mj_loadPluginLibrary(library())
_plugin = ctypes.CDLL(library())


def install() -> None:
    """Again, after `uninstall()`. The import has done it."""
    _plugin.raycontact_mujoco_install()


def uninstall() -> None:
    """Gives all geoms back to MuJoCo's own functions, and frees the shapes."""
    _plugin.raycontact_mujoco_uninstall()


def counts() -> Counts:
    """What was found since the import, over all models and threads."""
    three = (ctypes.c_ulonglong * 3)()
    _plugin.raycontact_mujoco_counts(three)
    return Counts(*three)


__all__ = ["Counts", "counts", "install", "library", "uninstall", "versions"]
