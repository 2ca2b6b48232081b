"""The pencil kernel against the element kernel on the same mesh, and meshes it must leave alone."""

from dataclasses import replace

import numpy as np
import pytest

from highfi import assembly, pencils
from highfi.mesh import read
from highfi.operator import internal_force
from highfi.pencil_kernel import pencil_force, room_for_sums
from meshes import l_rail
from tests.fe.blocks import ALUMINIUM, block


def both_forces(mesh):
    """Internal force (n,3) of one random displacement by pencils and by elements."""
    operator = assembly.build(mesh, **ALUMINIUM)
    columns, number = pencils.find(mesh.points, operator)
    displacement = np.random.default_rng(3).standard_normal(mesh.points.shape)
    expected = np.empty_like(displacement)
    internal_force(displacement, operator.cells, operator.shape_class, operator.stiffness, expected)
    size = -(-(number.max() + 1) // pencils.LANES) * pencils.LANES
    padded, force = np.zeros((3, size)), np.zeros((3, size))
    padded[:, number] = displacement.T
    pencil_force(columns, padded, force, 0, columns.first.size - 1, room_for_sums(columns.stride)[0])
    return force, number, expected


@pytest.mark.parametrize("mesh", [
    pytest.param(read(l_rail.build(l_rail.LRailGeometry(), 0.004)), id="L rails"),
    pytest.param(block((3, 2, 2), (0.03, 0.02, 0.03)), id="three layers"),
    pytest.param(block((40, 3, 4), (0.6, 0.03, 0.04)), id="cantilever")])
def test_pencils_give_the_force_of_the_elements(mesh):
    force, number, expected = both_forces(mesh)
    assert np.abs(force[:, number].T - expected).max() <= 1e-13 * np.abs(expected).max()


def test_padding_stays_without_force():
    force, number, _ = both_forces(block((5, 2, 2), (0.05, 0.02, 0.02)))
    padding = np.ones(force.shape[1], dtype=bool)
    padding[number] = False
    assert padding.any() and (force[:, padding] == 0.0).all()


def test_uneven_and_distorted_meshes_are_left_to_the_element_kernel():
    uneven = block((4, 2, 2), (0.04, 0.02, 0.02), stations=[0.0, 0.01, 0.02, 0.035, 0.04])
    bent = block((4, 2, 2), (0.04, 0.02, 0.02))
    points = bent.points.copy()
    points[len(points) // 2, 1] += 1e-3
    for mesh in (uneven, replace(bent, points=points)):
        assert pencils.find(mesh.points, assembly.build(mesh, **ALUMINIUM)) is None
