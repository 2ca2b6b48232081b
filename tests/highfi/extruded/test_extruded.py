"""The kernel of extruded meshes against the element kernel on the same mesh, and meshes that are not
extruded."""

from dataclasses import replace

import numpy as np
import pytest

from tests.highfi.blocks import ALUMINIUM, block
from tipoff.highfi.extruded import folding, kernel
from tipoff.highfi.extruded import mesh as extruded
from tipoff.highfi.extruded.kernel import column_force
from tipoff.highfi.extruded.vectors import Part
from tipoff.highfi.mesh.rail_mesh import read
from tipoff.highfi.statics import assembly
from tipoff.highfi.statics.operator import internal_force
from tipoff.kernels.cached import KernelCache
from tipoff.kernels.memory import zeros
from tipoff.meshes import l_rail


def graded(divisions, size):
    """A brick whose section has elements of as many widths and heights as it has columns and
    rows."""
    mesh = block(divisions, size)
    points = mesh.points.copy()
    for axis in (1, 2):
        points[:, axis] *= 0.5 + 0.5 * points[:, axis] / size[axis]
    return replace(mesh, points=points)


def layers_of(lengths):
    """A brick without symmetry in the section, of layers with these ``lengths`` (m)."""
    stations = np.concatenate([[0.0], np.cumsum(lengths)])
    divisions = (len(lengths), 5, 4)
    mesh = graded(divisions, (float(stations[-1]), 0.02, 0.03))
    even = np.linspace(0.0, stations[-1], stations.size)
    points = mesh.points.copy()
    points[:, 0] = stations[np.searchsorted(even, points[:, 0] - 1e-9)]
    return replace(mesh, points=points)


def groups_of(mesh):
    """Places (s,2) of the section points, and how many products and how many folded groups each has
    per layer."""
    operator = assembly.build(mesh, **ALUMINIUM)
    columns, number = extruded.find(mesh.points, operator)
    places = np.zeros((number.max() // columns.stride + 1, 2))
    places[number // columns.stride] = mesh.points[:, 1:]
    counts = columns.groups.counts
    return places, *(
        counts @ np.array(size)
        for size in (
            [len(used) for used in folding.EQUAL.used],
            [len(kind.folded) > 0 for kind in folding.KINDS],
        )
    )


def both_forces(mesh, column_force=column_force):
    """Internal force (n,3) of one random displacement by columns and by elements."""
    operator = assembly.build(mesh, **ALUMINIUM)
    columns, number = extruded.find(mesh.points, operator)
    displacement = np.random.default_rng(3).standard_normal(mesh.points.shape)
    expected = np.empty_like(displacement)
    internal_force(displacement, operator.cells, operator.shape_class, operator.stiffness, expected)
    size = -(-(number.max() + 1) // extruded.LANES) * extruded.LANES
    padded, force = np.zeros((3, size)), np.zeros((3, size))
    padded[:, number] = displacement.T
    turn = np.zeros(3)
    column_force(
        columns, padded, force, 0, columns.first.size - 1, zeros((3, extruded.LANES)), turn
    )
    assert (
        np.abs(turn - np.cross(displacement, expected).sum(axis=0)).max()
        <= 1e-12 * np.abs(displacement * expected).sum()
    )
    return force, number, expected


@pytest.mark.parametrize(
    "mesh",
    [
        pytest.param(read(l_rail.build(l_rail.LRailGeometry(), 0.004)), id="L rails"),
        pytest.param(read(l_rail.build(l_rail.LRailGeometry(fillet=0.002), 0.004)), id="fillets"),
        pytest.param(graded((6, 5, 4), (0.03, 0.02, 0.02)), id="no symmetry in the section"),
        pytest.param(block((3, 2, 2), (0.03, 0.02, 0.03)), id="three layers"),
        pytest.param(block((40, 3, 4), (0.6, 0.03, 0.04)), id="cantilever"),
        pytest.param(
            read(l_rail.build(l_rail.LRailGeometry(fillet=0.002), 0.008)),
            id="two lengths of layers",
        ),
        pytest.param(
            block((2, 3, 4), (0.03, 0.03, 0.04), stations=[0.0, 0.001, 0.03]), id="two layers"
        ),
        pytest.param(layers_of(lengths=1e-3 * 1.1 ** np.arange(40.0)), id="growing layers"),
        pytest.param(
            layers_of(lengths=[0.004, 0.004 + 3e-9, 0.004 + 5e-9] * 9), id="almost equal layers"
        ),
    ],
)
def test_columns_give_the_force_of_the_elements(mesh):
    force, number, expected = both_forces(mesh)
    assert np.abs(force[:, number].T - expected).max() <= 1e-13 * np.abs(expected).max()


def test_the_force_does_not_depend_on_the_width_of_the_registers(monkeypatch):
    """To the last bit, for equal layers and for two lengths, in columns with and without mirror images."""
    meshes = [
        read(l_rail.build(l_rail.LRailGeometry(fillet=0.002), size)) for size in (0.004, 0.008)
    ]
    forces, used = [], []
    monkeypatch.setattr(KernelCache, "load_overload", lambda *_: None)
    monkeypatch.setattr(KernelCache, "save_overload", lambda *_: None)
    for own in (Part(8, 2), Part(4, 1), Part(4, 2)):
        monkeypatch.setattr(
            kernel, "fitting_part", lambda codegen, own=own: used.append(own) or own
        )
        compiled = type(column_force)(column_force.py_func)  # is compiled again
        forces.append(np.concatenate([both_forces(mesh, compiled)[0] for mesh in meshes], axis=1))
    assert set(used) == {Part(8, 2), Part(4, 1), Part(4, 2)}
    assert (forces[1] == forces[0]).all() and (forces[2] == forces[0]).all()


def test_mirrored_neighbours_share_their_products():
    """Nine neighbours with 14 numbers each are 126 products; folded twice 36, and on a side 44
    instead of 84."""
    places, products, _ = groups_of(block((4, 5, 5), (0.04, 0.05, 0.05)))
    outside = ((places == places.min(axis=0)) | (places == places.max(axis=0))).sum(axis=1)
    assert (
        set(products[outside == 0]) == {36}
        and set(products[outside == 1]) == {44}
        and set(products[outside == 2]) == {56}
    )


def test_without_symmetry_nothing_is_folded():
    _, _, folded = groups_of(graded((4, 3, 3), (0.04, 0.03, 0.03)))
    assert (folded == 0).all()


def test_padding_stays_without_force():
    force, number, _ = both_forces(block((5, 2, 2), (0.05, 0.02, 0.02)))
    padding = np.ones(force.shape[1], dtype=bool)
    padding[number] = False
    assert padding.any() and (force[:, padding] == 0.0).all()


def test_meshes_that_are_no_extrusion_are_left_to_the_element_kernel():
    straight = block((4, 2, 2), (0.04, 0.02, 0.02), stations=[0.0, 0.01, 0.02, 0.035, 0.04])
    bent = straight.points.copy()
    bent[len(bent) // 2, 1] += 1e-3
    oblique = straight.points + [[1.0, 0.0, 0.0]] * straight.points[:, 1:2] * 0.1
    for mesh in (
        replace(straight, points=bent),
        replace(straight, points=oblique),
        replace(straight, cells=straight.cells[:-1]),
    ):
        assert extruded.find(mesh.points, assembly.build(mesh, **ALUMINIUM)) is None
    assert extruded.find(straight.points, assembly.build(straight, **ALUMINIUM)) is not None


def test_a_layer_of_another_material_is_left_to_the_element_kernel():
    """Its blocks do not follow from its length."""
    mesh = block((4, 2, 2), (0.04, 0.02, 0.02), stations=[0.0, 0.01, 0.02, 0.035, 0.04])
    operator = assembly.build(mesh, **ALUMINIUM)
    for stiff in range(len(operator.stiffness)):
        changed = operator.stiffness.copy()
        changed[stiff] *= 1.0 + 1e-6
        assert extruded.find(mesh.points, operator._replace(stiffness=changed)) is None
