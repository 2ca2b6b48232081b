"""Uneven temperature in the reference: the motion starts in the equilibrium of the warm rails,
contact is with the bowed walls, the ledgers close."""

import numpy as np
import pytest

from tests.highfi.support import COARSE, begun, reachable, stopped, tiny, whole
from tipoff import highfi
from tipoff.highfi import compliance
from tipoff.highfi.elements import hexahedral_recovery
from tipoff.highfi.statics import thermal
from tipoff.mechanics.rail_compliance.patterns import powers

WARM = {"thermal__mean": 20.0, "thermal__gradient__y": 500.0, "thermal__gradient__z": -300.0}
KEPT = ("velocity", "rate", "pad_force", "energy", "transverse_energy", "wall_stress")
EXPANSION = 23.6e-6


@pytest.fixture(scope="module")
def cold():
    return whole()


@pytest.fixture(scope="module")
def warm():
    return highfi.run(tiny(**WARM), COARSE)


@pytest.fixture(scope="module")
def start():
    """A warm run that has just begun and goes no further."""
    return begun(tiny(**WARM))


@pytest.fixture(scope="module")
def cold_start():
    """The same without temperature."""
    return begun()


def test_no_difference_of_temperature_leaves_contact_where_it_was(cold_start):
    """The time loop depends on temperature in no other way, so a run has the same bits."""
    zero, plain = (
        begun(tiny(thermal__mean=0.0)).setup.system.surface,
        cold_start.setup.system.surface,
    )
    assert all(
        np.array_equal(getattr(zero, name), getattr(plain, name))
        for name in ("places", "map", "border", "share")
    )


@pytest.mark.slow
def test_no_difference_of_temperature_is_no_effect(cold):
    """To the bit."""
    zero = highfi.run(tiny(thermal__mean=0.0), COARSE)
    assert all(np.array_equal(getattr(zero, name), getattr(cold, name)) for name in KEPT)
    assert zero.stress == cold.stress


@pytest.mark.slow
def test_ledgers_close_and_momentum_is_kept(cold, warm):
    assert warm.status == cold.status == "exited"
    for run in (cold, warm):
        assert run.checks["energy_error"] <= 1e-5 and run.checks["transverse_energy_error"] <= 1e-2
        assert (
            run.checks["linear_momentum_error"] <= 1e-12
            and run.checks["angular_momentum_error"] <= 1e-8
        )
    assert np.abs(np.degrees(warm.outcome.rate) - np.degrees(cold.outcome.rate)).max() > 0.05


def test_rails_do_not_ring():
    """Until the first touch they move like cold ones, bit for bit, by recoil alone, though their
    bow is thousands of times larger."""
    loop, plain = stopped(10, tiny(**WARM)), stopped(10)
    assert np.array_equal(loop.stepper.state.displacement, plain.stepper.state.displacement)
    assert np.abs(loop.stepper.deformed()).max() > 1e3 * np.abs(plain.stepper.deformed()).max()


def test_contact_meets_the_bowed_walls(start, cold_start):
    """The nodes that contact uses, and no others, are displaced as in the static solution."""
    system = start.setup.system
    moved = thermal.displacement(system.mesh, start.setup.scene.rail.material, system.model.thermal)
    number, points = system.number, system.mesh.points - system.origin
    assert np.array_equal(system.surface.places[number], points + moved) and np.array_equal(
        system.rail.points[number], points
    )
    assert (
        cold_start.setup.system.surface.places is not None and cold_start.setup.system.warm is None
    )


@pytest.mark.slow
def test_a_platform_that_grows_with_its_rails_is_a_wider_clearance():
    """Mounts and rails apart by a ten-thousandth: every wall 10 um farther out, and no stress. The
    rails are longer by as much."""
    strain = 1e-4
    grown = highfi.run(
        tiny(thermal__mean=strain / EXPANSION, thermal__platform_strain=strain), COARSE
    )
    wide = highfi.run(tiny(contact__clearance=2.5e-4 + strain * 0.10025), COARSE)
    assert np.degrees(grown.outcome.rate) == pytest.approx(np.degrees(wide.outcome.rate), abs=0.01)
    inward = highfi.run(
        tiny(thermal__mean=-strain / EXPANSION, thermal__platform_strain=-strain), COARSE
    )
    assert np.abs(np.degrees(inward.outcome.rate) - np.degrees(wide.outcome.rate)).max() > 0.02


def test_stress_is_that_of_the_held_rail():
    """At ignition: von Mises stress of the static solution, free expansion taken off; none in rails
    that grow with their platform."""
    strain = 1e-4
    free = begun(tiny(thermal__mean=strain / EXPANSION, thermal__platform_strain=strain))
    modulus = free.setup.scene.rail.material.youngs_modulus
    assert (
        np.sqrt(free.recorded.peak.square[0]) * free.setup.monitor.shear_modulus
        < 1e-6 * modulus * strain
    )
    assert np.abs(free.recorded.gauges[0]).max() < 1e-6 * modulus * strain
    held = begun(tiny(thermal__mean=strain / EXPANSION))
    gauges = hexahedral_recovery.von_mises(held.recorded.gauges[0])
    assert 0.1 * modulus * strain < gauges.max() < 2.0 * modulus * strain
    # Control: with the free expansion left in, the gauges of rails free of stress would show it.
    assert np.abs(free.setup.monitor.free).max() > modulus * strain


def test_a_bow_that_closes_the_clearance_is_warned_about():
    warm = tiny(thermal__platform_strain=-0.0026, duration=1e-4, friction=None)  # needs no substeps
    run = highfi.run(warm, COARSE)
    assert (
        "initial interference: pads 0, 1, 2, 3, 4, 5, 6, 7 press on the rail at ignition"
        in run.message
    )


def test_warm_walls_of_the_surrogate_are_those_of_the_reference(start):
    """The six patterns of a pad face at ignition against the nodes under it, within a sixth of what
    the wall moves over its length."""
    rails, system = compliance.condense(start.setup.scene, COARSE.element_size), start.setup.system
    found, faces, surface = (
        rails.moved(system.model.thermal.amounts),
        system.faces,
        system.surface,
    )
    at_ignition = np.abs(rails.travel).argmin()
    assert abs(rails.travel[at_ignition]) < 1e-3
    for face in range(0, faces.axis.size, 3):
        nodes = np.unique(surface.facets[reachable(surface, face)])
        axis = faces.axis[face]
        plane = [0, 3 - axis]
        local = (system.rail.points[nodes] + system.origin - faces.centre[face])[
            :, plane
        ] / rails.half[face]
        under = (np.abs(local) < 1.01).all(axis=1)
        patterns = (local[under, None] ** powers()).prod(axis=2)
        moved = faces.sign[face] * system.warm[nodes, axis]
        assert under.any() and patterns @ found[at_ignition, face] == pytest.approx(
            moved[under], abs=np.ptp(moved) / 6.0
        )
