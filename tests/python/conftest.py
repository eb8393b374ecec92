# SPDX-License-Identifier: Apache-2.0
"""Shapes that many tests ask for."""

import meshes
import pytest
import raycontact as rc


@pytest.fixture(scope="session")
def torus():
    return rc.Shape(rc.Mesh(*meshes.torus(), name="torus"))


@pytest.fixture(scope="session")
def bracket():
    return rc.Shape(rc.Mesh(*meshes.bracket(), name="bracket"))
