"""Peak stress of a run: place and time are those of a plain evaluation at every sample, with any
number of threads; wall gauges."""

import numpy as np
import pytest

from tests.highfi.blocks import block
from tests.highfi.elements.recovered import corner_matrix
from tests.highfi.support import COARSE, assert_same_bits, begun, tiny
from tipoff import highfi
from tipoff.highfi.dynamics import monitor
from tipoff.highfi.dynamics.system import build
from tipoff.highfi.elements import hexahedral_recovery, hexahedron
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.stress import gauge, peaks
from tipoff.highfi.stress.peak import ROTATION, STRAIN, STRESS, no_peak

LAW = hexahedron.elasticity(72e9, 0.33)


@pytest.fixture(scope="module")
def seen():
    """The run on ``tiny`` and, at every sample, the plain von Mises stress (e,8) Pa at all corners
    of all elements."""
    mesh, stresses = highfi.prepare(tiny(), COARSE), []
    matrix = corner_matrix(mesh.points[mesh.cells], LAW)

    def look(loop):
        np.testing.assert_array_equal(loop.setup.system.mesh.cells, mesh.cells)
        moved = loop.stepper.state.displacement[loop.setup.system.number[mesh.cells]].reshape(
            -1, 1, 24, 1
        )
        stresses.append(hexahedral_recovery.von_mises((matrix @ moved)[..., 0]))

    return highfi.run(tiny(), COARSE, observer=look), np.array(stresses)


@pytest.fixture(scope="module")
def bare():
    return highfi.run(tiny(), COARSE)


def test_peak_is_that_of_the_plain_formulas(seen):
    run, stresses = seen
    mesh = highfi.prepare(tiny(), COARSE)
    every = run.stress["samples_between_looks"]
    sample, _number, _corner = np.unravel_index(stresses[::every].argmax(), stresses[::every].shape)
    assert run.stress["peak_stress_pa"] == pytest.approx(stresses[::every].max(), rel=1e-12)
    assert run.stress["peak_stress_time_s"] == pytest.approx(run.time[every * sample], rel=1e-12)
    place = np.array(run.stress["peak_stress_place_m"])
    # Mirror images of the place are other rails; of corners that tie within rounding any may be
    # named.
    there = stresses[every * sample][(mesh.points[mesh.cells] == place).all(axis=2)]
    assert there.max() == pytest.approx(stresses[::every].max(), rel=1e-12)
    assert run.stress["peak_stress_rail"] == " ".join(
        f"{'+' if place[axis] > 0.0 else '-'}{'xyz'[axis]}" for axis in (1, 2)
    )


def test_observer_sees_every_sample_and_changes_no_bit(seen, bare):
    run, stresses = seen
    assert len(stresses) == run.time.size
    assert_same_bits(run, bare, "wall_stress")
    assert (run.stress, run.checks, run.outcome) == (bare.stress, bare.checks, bare.outcome)


def test_stress_survives_the_file(bare, tmp_path):
    bare.save(tmp_path / "run.nc")
    again = type(bare).load(tmp_path / "run.nc")
    assert again.stress == bare.stress
    np.testing.assert_array_equal(again.wall_stress, bare.wall_stress)
    assert bare.to_xarray().wall_stress.attrs["units"] == "Pa"


def test_yield_and_large_motion_are_warned_of(bare):
    """Control: the run as it is bears a twentieth of its yield strength and is warned of
    nothing."""
    assert bare.stress["yield_strength_pa"] == 503e6 and bare.stress["warnings"] == []
    weak = highfi.run(tiny(duration="12 ms", rail__material__yield_strength="1 MPa"), COARSE)
    assert weak.stress["peak_stress_pa"] > 1e6
    assert (
        len(weak.stress["warnings"]) == 1 and "yield strength, 1 MPa" in weak.stress["warnings"][0]
    )
    large = monitor.warnings(
        bare.stress
        | {"largest_strain": 0.02, "largest_rotation_rad": 0.05, "yield_strength_pa": None}
    )
    assert [words.split()[0] for words in large] == ["strain", "an"]


def scanned(threads):
    """Peaks that a loop with some threads finds in two random states."""
    loop = begun(threads=threads)
    moved = 1e-6 * np.random.default_rng(7).standard_normal(
        (2, *loop.stepper.state.displacement.shape)
    )
    for time, displacement in enumerate(moved):
        monitor.scan(
            loop.setup.monitor,
            np.asfortranarray(displacement),
            float(time),
            loop.recorded.peak,
            loop.setup.pool,
        )
    return loop.recorded.peak


@pytest.fixture(scope="module")
def single():
    return scanned(threads=1)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_any_number_of_threads_finds_the_same_corner(threads, single):
    for found, expected in zip(scanned(threads), single):
        np.testing.assert_array_equal(found, expected)


def test_strain_and_rotation_of_a_distorted_mesh():
    """A constant gradient: its symmetric part has the norm found as strain, its antisymmetric part
    that of the rotation."""
    mesh = block((3, 2, 2), (0.03, 0.02, 0.02))
    points = mesh.points + 1e-3 * np.random.default_rng(8).uniform(-1.0, 1.0, mesh.points.shape)
    gradient = 1e-4 * np.random.default_rng(9).standard_normal((3, 3))
    count = len(points)
    classes, peak = np.arange(len(mesh.cells), dtype=np.uint32), no_peak()
    found = peaks.build(points, mesh.cells, classes, LAW, np.arange(count))
    peaks.find(
        np.asfortranarray(points @ gradient.T),
        found,
        peak,
        np.zeros(peaks.SIZE),
        0,
        len(mesh.cells),
    )
    even, odd = 0.5 * (gradient + gradient.T), 0.5 * (gradient - gradient.T)
    stress = (
        np.array(
            [even[0, 0], even[1, 1], even[2, 2], 2 * even[0, 1], 2 * even[1, 2], 2 * even[2, 0]]
        )
        @ LAW
    )
    assert LAW[3, 3] * np.sqrt(peak.square[STRESS]) == pytest.approx(
        hexahedral_recovery.von_mises(stress), rel=1e-10
    )
    assert np.sqrt(peak.square[STRAIN]) == pytest.approx(np.linalg.norm(even), rel=1e-10)
    assert np.sqrt(peak.square[ROTATION]) == pytest.approx(
        np.linalg.norm(odd) / np.sqrt(2.0), rel=1e-10
    )


def test_elements_that_cannot_raise_a_peak_are_skipped_without_a_difference():
    """Peaks of smooth and of rough displacements in random order, to the bit those of a scan of every
    element (a reach without a bound). Control: a thousandth of the reach skips elements of the peaks."""
    mesh, random = block((3, 2, 2), (0.03, 0.02, 0.02)), np.random.default_rng(12)
    points = mesh.points + 2e-3 * random.uniform(-1.0, 1.0, mesh.points.shape)
    count, elements = len(points), len(mesh.cells)
    classes = np.arange(elements, dtype=np.uint32)
    found = peaks.build(points, mesh.cells, classes, LAW, np.arange(count))
    seen = {factor: no_peak() for factor in (1.0, np.inf, 1e-3)}
    for _ in range(300):
        field = points @ random.standard_normal((3, 3)) + random.standard_normal(3)
        field += 10.0 ** random.uniform(-5.0, -2.0) * random.standard_normal(points.shape)
        field *= 1e-4 * random.uniform()
        for factor, peak in seen.items():
            recovery = found._replace(reach=factor * found.reach)
            peaks.find(np.asfortranarray(field), recovery, peak, np.zeros(peaks.SIZE), 0, elements)
    for part, expected in zip(seen[1.0], seen[np.inf]):
        np.testing.assert_array_equal(part, expected)
    assert not np.array_equal(seen[1e-3].square, seen[np.inf].square)
    for e in range(elements):
        worst = 0.0
        for unit in np.eye(3 * count)[[3 * n + i for n in mesh.cells[e] for i in range(3)]]:
            field = np.asfortranarray(unit.reshape(count, 3))
            out = peaks.gradients(field, found, np.zeros(peaks.SIZE), e, e + 1)
            worst = max(worst, (out**2).sum(axis=(2, 3)).max())
        assert worst < found.reach[e] < 100.0 * worst


def patches(size):
    scene, numerics = tiny(), Numerics(element_size=size)
    system = build(scene, numerics, highfi.prepare(scene, numerics))
    return system, monitor.build(system, scene.rail.material, 100, 1).patch


@pytest.mark.parametrize("size", [0.016, 0.008, 0.004, 0.003])
def test_patches_are_where_they_are_on_every_mesh_and_see_a_uniform_stress(size):
    """Midway between the last two clamps, on the track of the pads; under a constant gradient the
    mean is that constant."""
    system, found = patches(size)
    centres = found.centre + system.origin
    assert centres[:, 0] == pytest.approx(0.068, abs=1e-12)
    assert sorted(np.abs(centres[:, 1:]).max(axis=1)) == pytest.approx([0.10025] * 8)
    assert sorted(np.abs(centres[:, 1:]).min(axis=1)) == pytest.approx([0.091] * 8)
    gradient = 1e-4 * np.random.default_rng(10).standard_normal((3, 3))
    even = 0.5 * (gradient + gradient.T)
    strain = np.array(
        [even[0, 0], even[1, 1], even[2, 2], 2 * even[0, 1], 2 * even[1, 2], 2 * even[2, 0]]
    )
    stress = gauge.stress(found, system.rail.points @ gradient.T)
    assert np.abs(stress - strain @ LAW).max() < 1e-9 * np.abs(strain @ LAW).max()


def test_a_wall_too_narrow_for_a_patch_has_none():
    scene = tiny(rail__leg="14 mm")
    found = highfi.run(scene.replace({"duration": "1 ms"}), COARSE)
    assert found.stress["patch_places_m"] == [] and found.wall_stress.shape == (
        found.time.size,
        0,
        6,
    )
