"""Rails of ten-node tetrahedra in the full time loop: promises, threads, and the rates that
hexahedra give."""

import numpy as np
import pytest

from tests.highfi import tet_rails, tets
from tests.highfi.blocks import ALUMINIUM, block
from tests.highfi.rail.test_own_rail import assert_promises, from_file, saved
from tests.highfi.support import COARSE, assert_same_bits, tiny
from tipoff import highfi
from tipoff.highfi.dynamics.system import general_elements
from tipoff.highfi.mesh import facets, pieces
from tipoff.highfi.mesh.halve import halved
from tipoff.highfi.mesh.rail_mesh import read
from tipoff.highfi.rail.geometry import geometry
from tipoff.highfi.statics import assembly
from tipoff.highfi.statics.solve import Clamped
from tipoff.meshes import l_rail, msh

# Thrown at the walls, so that pads press from the first samples on, while sliding: at rest,
# friction would damp light nodes faster than any step follows.
PRESSED = {
    "duration": "0.6 ms",
    "contact__clearance": "0.02 mm",
    "initial__velocity__x": "3 m/s",
    "initial__velocity__y": "0.1 m/s",
    "initial__velocity__z": "-0.06 m/s",
}
# From nearer walls, so that pads press in the first sample.
SHORT = PRESSED | {"duration": "0.2 ms", "contact__clearance": "5 um"}
both = pytest.mark.parametrize(
    "thrown", [SHORT, pytest.param(PRESSED, marks=pytest.mark.slow)], ids=["short", "whole"]
)


def cut(scene, size, path):
    """``scene`` on its built-in rails, each hexahedron of ``size`` (m) cut into six tetrahedra."""
    mesh = tets.split(read(l_rail.build(geometry(scene), size)))
    return from_file(scene, saved(msh.tagged(mesh.points, mesh.cells, mesh.surfaces), path))


@pytest.mark.gmsh
@both
def test_promises_hold_on_rails_that_gmsh_fills(tmp_path, thrown):
    scene = tiny(**thrown)
    file = from_file(scene, saved(tet_rails.build(geometry(scene), 0.020), tmp_path / "rails.msh"))
    found = highfi.run(file, COARSE)
    assert highfi.prepare(file, COARSE).cells.shape[1] == 10
    assert found.status == "time_limit" and np.abs(found.pad_force).max() > 100.0
    assert_promises(found)
    assert found.cost["dt_s"] <= found.cost["dt_limit_s"] * found.cost["safety"]
    assert found.cost["dt_limit_s"] > found.cost["dt_element_s"]


@pytest.mark.case("X20")
@both
def test_threads_do_not_change_a_bit(tmp_path, thrown):
    scene = cut(tiny(**thrown), 0.008, tmp_path / "rails.msh")
    alone, shared = (highfi.run(scene, COARSE, threads=threads) for threads in (1, 2))
    assert alone.status == "time_limit" and np.abs(alone.pad_force).max() > 0.0
    assert_same_bits(shared, alone)


def shared_nodes(operator, elements) -> int:
    """Nodes that elements of two slabs with one between them share."""
    parts = [np.unique(elements.cells[a:b]) for a, b in zip(elements.slabs, elements.slabs[1:])]
    return sum(np.intersect1d(one, other).size for one, other in zip(parts, parts[2:]))


@pytest.mark.case("X20")
def test_slabs_with_one_between_share_no_node():
    """Otherwise two threads would add to one node at once. Control: with tetrahedra sorted by the
    mean of their nodes such slabs share nodes."""
    mesh = tets.split(block((24, 2, 2), (0.24, 0.02, 0.02)))
    operator = assembly.build(mesh, **ALUMINIUM)
    elements = general_elements(mesh.points, operator, np.arange(len(mesh.points)))
    assert elements.slabs.size > 10 and shared_nodes(operator, elements) == 0
    x = mesh.points[operator.cells][:, :, 0]
    slab = ((x.mean(axis=1) - x.mean(axis=1).min()) / (1.001 * np.ptp(x, axis=1).max())).astype(int)
    order = np.argsort(slab, kind="stable")
    by_mean = elements._replace(
        cells=operator.cells[order], slabs=np.searchsorted(slab[order], np.arange(slab.max() + 2))
    )
    assert shared_nodes(operator, by_mean) > 0


def compliance(mesh) -> float:
    """Compliance (m/N) of the wall contact_y of one rail between two mounts, under a smooth
    pressure of 1 N, so that it does not depend on the facets."""
    mesh = next(rail for rail in pieces.pieces(mesh) if (rail.points.mean(axis=0)[1:] > 0.0).all())
    operator, quads = assembly.build(mesh, **ALUMINIUM), mesh.surfaces["contact_y"]
    shape, area = facets.gauss(mesh.points[quads], 6)
    place = np.einsum("qa,mai->mqi", shape, mesh.points[quads])
    pressure = (
        np.exp(-(((place[..., 0] - 0.060) / 0.006) ** 2) - ((place[..., 2] - 0.091) / 0.006) ** 2)
        * area
    )
    load = np.zeros(mesh.points.shape)
    np.add.at(load[:, 1], quads, np.einsum("mq,qa->ma", pressure / pressure.sum(), shape))
    load = load[operator.free].ravel()
    return float(Clamped(operator).solve(load) @ load)


@pytest.mark.gmsh
def test_the_compliance_of_the_wall_is_that_of_hexahedra():
    """Against hexahedra of 2 mm: one layer of tetrahedra of 20 mm is 30 % too stiff, halved 6 %;
    hexahedra of 4 mm 5 %."""
    rails = geometry(tiny())
    exact = compliance(read(l_rail.build(rails, 0.002)))
    coarse = read(tet_rails.build(rails, 0.020))
    errors = [compliance(mesh) / exact - 1.0 for mesh in (coarse, halved(coarse))]
    assert (
        -0.35 < errors[0] < -0.25
        and abs(errors[1]) < 0.07
        and abs(errors[1]) < 0.25 * abs(errors[0])
    )


@pytest.mark.slow
def test_settled_rates_are_those_of_hexahedra(tmp_path):
    """The largest rate is 9 deg/s within 1 %, and both agree within 0.06 deg/s on the same coarse
    grid. Of hexahedra of 2 mm tetrahedra of the 8 mm grid are 0.13 deg/s away, of the 4 mm grid
    0.034; hexahedra of these grids 0.075 and 0.040."""
    scene = tiny()
    expected, found = (
        highfi.run(scene, COARSE),
        highfi.run(cut(scene, 0.008, tmp_path / "rails.msh"), COARSE, threads=2),
    )
    assert found.status == expected.status == "exited"
    assert_promises(found)
    assert np.degrees(expected.outcome.rate).max() == pytest.approx(9.0, rel=0.01)
    assert np.abs(np.degrees(np.subtract(found.outcome.rate, expected.outcome.rate))).max() < 0.06
    assert found.outcome.exit_time == pytest.approx(expected.outcome.exit_time, rel=1e-5)
