# SPDX-License-Identifier: Apache-2.0
"""Settings of scenes, as the C++ half takes them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._arrays import as_count, as_length
from ._core import InputError

_LENGTHS = ("speculative_margin", "displacement_threshold", "confidence", "culling_distance", "distance_extension")
_COUNTS = ("max_contacts_per_pair", "max_contacts", "threads", "max_iterations")
_SWITCHES = ("inexact", "cast_lost_walks", "skip_outside")
_MAY_BE_NONE = ("speculative_margin", "displacement_threshold", "culling_distance", "distance_extension")


def as_settings(words: dict[str, Any]) -> dict[str, Any]:
    """Settings with the types that the C++ half takes; words of choices it checks itself."""
    made: dict[str, Any] = {}
    for key, value in words.items():
        if value is None and key in _MAY_BE_NONE:
            made[key] = None
        elif key in _LENGTHS:
            made[key] = as_length(value, key)
        elif key in _COUNTS:
            made[key] = as_count(value, key)
        elif key in _SWITCHES or key == "speculative":
            if not isinstance(value, (bool, np.bool_)):
                raise InputError(f"{key}: {value!r} is neither True nor False")
            made[key] = bool(value)
        elif not isinstance(value, str) or not value.isascii():
            raise InputError(f"{key}: {value!r} is no word")
        else:
            made[key] = value
    return made
