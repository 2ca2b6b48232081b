"""Beams of hexahedra against beam theory: deflection and root stress of a cantilever, and the modes
of a free beam."""

import numpy as np
import pytest

from tests.exact import elasticity
from tests.highfi.blocks import ALUMINIUM, block, modes, static, without_bubbles
from tests.highfi.elements.recovered import centre_strain
from tipoff.highfi.elements import hexahedron
from tipoff.highfi.statics import assembly

BEAM = {"length": 0.6, "width": 0.03, "height": 0.04}
ELASTIC = {name: ALUMINIUM[name] for name in ("youngs_modulus", "poisson_ratio")}
FORCE = 100.0
ROOT_STRESS = FORCE * BEAM["length"] * 6.0 / (BEAM["width"] * BEAM["height"] ** 2)
MESHES = pytest.mark.parametrize("divisions", [(20, 2, 2), (40, 2, 4)])


def beam(divisions):
    return block(divisions, tuple(BEAM.values()))


def loaded(mesh, mass, faces):
    """Nodal forces (n,3) of shear forces (N) spread evenly over sections; `faces` maps the station
    (m) to its force."""
    load = np.zeros(mesh.points.shape)
    for station, force in faces.items():
        share = np.where(mesh.points[:, 0] == station, mass, 0.0)
        load[:, 2] += force * share / share.sum()
    return load


def deflection(mesh, operator):
    """Deflection (m) of the tip against the root under FORCE, and the displacement (n,3), on the
    supports of beam theory.

    The root section stays plane but may contract sideways, and its shear force is given. A solid
    clamp, which forbids the contraction, bends 0.7 % less: that is elasticity, not the error looked
    for here.
    """
    x, y, z = mesh.points.T
    load = loaded(mesh, operator.mass, {BEAM["length"]: FORCE, 0.0: -FORCE})
    held = np.zeros(mesh.points.shape, dtype=bool)
    middle = (x == 0.0) & np.isclose(y, 0.5 * BEAM["width"])
    held[:, 0], held[:, 1] = x == 0.0, middle
    held[:, 2] = middle & np.isclose(z, 0.5 * BEAM["height"])
    displacement = static(operator, load, held)
    mean = [
        np.average(displacement[x == station, 2], weights=operator.mass[x == station])
        for station in (BEAM["length"], 0.0)
    ]
    return mean[0] - mean[1], displacement


@pytest.mark.case("O6")
@MESHES
def test_cantilever_deflection(divisions):
    """P L^3 / 3 E I + P L / (5/6 G A) = 0.627217 mm, of which bending is 0.625 mm."""
    bending, shear = elasticity.cantilever_deflection(FORCE, **BEAM, **ELASTIC)
    assert (bending, bending + shear) == pytest.approx((0.625e-3, 0.627217e-3), rel=1e-6)
    mesh = beam(divisions)
    operator = assembly.build(mesh, **ALUMINIUM, fixed=())
    assert deflection(mesh, operator)[0] == pytest.approx(bending + shear, rel=5e-3)
    # Control: without bubbles the same mesh is at least 6 % too stiff.
    assert deflection(mesh, without_bubbles(mesh, operator, **ELASTIC))[0] < 0.94 * (
        bending + shear
    )


@pytest.mark.parametrize("layers", [1, 2, 3, 4, 6])
def test_shear_of_layers_through_a_wall(layers):
    """The bubbles do not warp a section: each layer has the mean shear strain of its depth. So n
    layers deflect by P L / (k G A) with k = (2/3)^2 / mean(m_i^2), m_i the mean of the parabola
    1 - z^2 over layer i: 1, 1, 0.910, 0.877, 0.853 in place of 5/6. Control: bending is exact for
    any number, so two layers are as stiff as one."""
    size = {"length": 0.08, "width": 0.005, "height": 0.02}
    mesh, elastic = block((128, 1, layers), tuple(size.values())), ELASTIC | {"poisson_ratio": 0.0}
    operator = assembly.build(mesh, ALUMINIUM["density"], **elastic)
    load = loaded(mesh, operator.mass, {size["length"]: FORCE})
    displacement = static(operator, load, np.repeat(~operator.free[:, None], 3, axis=1))
    edge = np.linspace(-1.0, 1.0, layers + 1)
    mean = 1.0 - np.diff(edge**3) / (3.0 * np.diff(edge))
    bending, shear = elasticity.cantilever_deflection(FORCE, **size, **elastic)
    expected = shear * 5.0 / 6.0 * (mean**2).mean() / (2.0 / 3.0) ** 2
    assert (load * displacement).sum() / FORCE - bending == pytest.approx(expected, rel=3e-3)
    assert expected < 0.99 * shear


@pytest.mark.case("O6")
@MESHES
def test_clamped_root_without_contraction(divisions):
    """At nu = 0 the clamp of the product is the clamp of beam theory."""
    mesh, elastic = beam(divisions), ELASTIC | {"poisson_ratio": 0.0}
    operator = assembly.build(mesh, ALUMINIUM["density"], **elastic)
    load = loaded(mesh, operator.mass, {BEAM["length"]: FORCE})
    displacement = static(operator, load, np.repeat(~operator.free[:, None], 3, axis=1))
    tip = mesh.points[:, 0] == BEAM["length"]
    exact = sum(elasticity.cantilever_deflection(FORCE, **BEAM, **elastic))
    assert np.average(displacement[tip, 2], weights=operator.mass[tip]) == pytest.approx(
        exact, rel=5e-3
    )


@pytest.mark.case("O6")
@MESHES
def test_root_stress(divisions):
    """6 P L / b h^2 = 7.5 MPa in the outer fibre of the root: the stress of the first layer's outer
    elements, taken from their centres to the root along M(x) and to the fibre along z."""
    assert ROOT_STRESS == pytest.approx(7.5e6, rel=1e-12)
    mesh = beam(divisions)
    operator = assembly.build(mesh, **ALUMINIUM, fixed=())
    corners = mesh.points[mesh.cells]
    centre = corners.mean(axis=1)
    law = hexahedron.elasticity(**ELASTIC)

    def fibre_stress(found):
        stress = centre_strain(corners, found[mesh.cells]) @ law
        outer = (centre[:, 0] == centre[:, 0].min()) & np.isclose(centre[:, 2], centre[:, 2].max())
        height = 2.0 * centre[outer, 2] / BEAM["height"] - 1.0
        return -(stress[outer, 0] / height / (1.0 - centre[outer, 0] / BEAM["length"])).mean()

    assert fibre_stress(deflection(mesh, operator)[1]) == pytest.approx(ROOT_STRESS, rel=5e-3)
    assert (
        fibre_stress(deflection(mesh, without_bubbles(mesh, operator, **ELASTIC))[1])
        < 0.95 * ROOT_STRESS
    )


def free_frequencies(operator):
    """The six lowest frequencies (Hz), and the first three of the flexible modes that move mostly
    across the height."""
    frequencies, shapes = modes(operator, 14, shift=-1e6)
    order = np.argsort(frequencies)
    frequencies, shapes = frequencies[order], shapes[order]
    part = (operator.mass[:, None] * shapes**2).sum(axis=1)
    return frequencies[:6], frequencies[6:][part[6:, 2] > 0.5 * part[6:].sum(axis=1)][:3]


@pytest.mark.case("O8")
@pytest.mark.parametrize("divisions", [(40, 3, 4), (60, 3, 4)])
def test_free_beam_frequencies(divisions):
    """Timoshenko, free-free: 568.930, 1524.139, 2875.119 Hz above six rigid motions."""
    exact = elasticity.timoshenko_free(3, **BEAM, **ALUMINIUM)
    assert exact == pytest.approx([568.930, 1524.139, 2875.119], abs=1e-3)
    mesh = beam(divisions)
    operator = assembly.build(mesh, **ALUMINIUM, fixed=())
    rigid, flexible = free_frequencies(operator)
    assert flexible == pytest.approx(exact, rel=5e-3)
    assert rigid.max() < 1e-5 * flexible[0]
    # Control: without bubbles every mode is more than 1.5 % too high.
    _, plain = free_frequencies(without_bubbles(mesh, operator, **ELASTIC))
    assert (plain > 1.015 * exact).all()
