"""Contact springs at warm walls: their offset, one potential of their forces, and changes of the
scene that are equal to a warm wall."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from tests.lowfi.compliance import REFERENCE, handmade, reference_compliance
from tipoff import lowfi
from tipoff.lowfi import Numerics
from tipoff.lowfi import system as systems
from tipoff.lowfi.contact import springs, thermal_offset
from tipoff.mechanics.laws.thermal import FIELDS
from tipoff.mechanics.rail_compliance import PATTERNS
from tipoff.mechanics.rail_compliance.patterns import gram
from tipoff.scenes import scene_model
from validation import oracle

MEAN = 1.0 / REFERENCE.rail.material.expansion  # K: one of the first field
WARM = {"thermal.mean": 20.0, "thermal.gradient.y": 500.0, "thermal.gradient.z": -300.0}
TIGHT = Numerics(relative_tolerance=1e-10)


def standing_away(scene, distance, flexible=None):
    """Walls of ``scene`` that stand ``distance`` (s,) m away from the payload at every mean of 1 /
    alpha K, all faces alike; with ``flexible`` entries they are compliant too."""
    compliance = handmade(scene, flexible or {})
    travel = np.linspace(0.0, 0.23, len(distance))
    warm = np.zeros((FIELDS, travel.size, compliance.rail.size, PATTERNS))
    warm[0, :, :, 0] = np.asarray(distance)[:, None]
    flexibility, shape = (
        np.repeat(table[:1], travel.size, axis=0)
        for table in (compliance.flexibility, compliance.shape)
    )
    found = replace(compliance, travel=travel, flexibility=flexibility, shape=shape, warm=warm)
    return found if flexible else found.rigid()


def model_of(flexible):
    """The surrogate's model for such walls."""
    return "compliant" if flexible else "springs"


def test_places_of_the_walls():
    """The mean over the part of a face that has a wall, as a spline of its place, straight beyond the
    ends."""
    scene, compliance = REFERENCE.replace(WARM), reference_compliance().rigid()
    model = scene_model.build(scene)
    record = thermal_offset.under_pads(model, compliance)
    offset = np.tensordot(scene.thermal.record(scene.rail).amounts, compliance.warm, 1)
    on_rail = (compliance.part == [0.0, 1.0]).all(axis=2)
    assert on_rail.any() and not on_rail.all()
    mean = (offset * compliance.gram[..., 0, :]).sum(axis=2)
    assert mean[on_rail] == pytest.approx((offset @ gram()[0])[on_rail], rel=1e-12)
    wanted = CubicSpline(compliance.travel, mean)
    first, last = compliance.travel[[0, -1]]
    for face in (0, 5, 15):
        start = model.faces.centre[face, 0] - model.platform.mass_centre[0]
        for way in (0.0, 0.0371, 0.2, last):
            here = wanted(way)[face], wanted(way, 1)[face]
            assert thermal_offset.offset_and_slope(record, face, start + way) == pytest.approx(
                here, rel=1e-9, abs=1e-15
            )
        for end, over in ((first, -0.01), (last, 0.01)):
            beyond = wanted(end)[face] + over * wanted(end, 1)[face], wanted(end, 1)[face]
            assert thermal_offset.offset_and_slope(
                record, face, start + end + over
            ) == pytest.approx(beyond, rel=1e-9, abs=1e-15)
    assert thermal_offset.under_pads(scene_model.build(REFERENCE), None) is None
    # compliant contact holds the offset itself
    assert thermal_offset.under_pads(model, reference_compliance()) is None


def test_force_is_along_the_gradient_of_the_penetration():
    """Differences of the penetration over the place of the payload; the straight wall's normal
    would leave out what is along the rail."""
    scene = REFERENCE.replace({"thermal.mean": MEAN})
    model, x = scene_model.build(scene), np.linspace(0.0, 0.23, 9)
    system = systems.build(
        model,
        thermal_offset=thermal_offset.under_pads(
            model, standing_away(scene, 1e-3 * np.sin(20.0 * x))
        ),
    )
    upright, h = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), 1e-6
    place = np.array([0.137, 2e-4, 1e-4])
    for face in system.faces[[0, 3, 12]]:

        def depth(at, face=face):
            return springs.penetration(system.contact.thermal_offset, face, tuple(at), upright)

        difference = [
            (depth(place + h * axis) - depth(place - h * axis)) / (2.0 * h) for axis in np.eye(3)
        ]
        rates = [
            springs.approach(
                system.contact.thermal_offset, face, tuple(place), upright, tuple(axis), (0.0,) * 9
            )
            for axis in np.eye(3)
        ]
        assert rates == pytest.approx(difference, abs=1e-8)
        assert abs(difference[0]) > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    "flexible", [None, {(face, 0, face, 0): 3e-8 for face in range(16)}], ids=["law", "compliant"]
)
def test_an_even_offset_is_a_wider_clearance(flexible):
    """20 um more on every side, by temperature or by the clearance, give the same motion; without
    them it differs."""
    scene, more = REFERENCE.condition("phi35"), 2e-5
    compliance, model = standing_away(scene, np.full(4, more), flexible), model_of(flexible)
    warm = lowfi.run(
        scene.replace({"thermal.mean": MEAN}), model, numerics=TIGHT, compliance=compliance
    )
    wide, plain = (
        lowfi.run(each, model, numerics=TIGHT, compliance=compliance)
        for each in (scene.replace({"contact.clearance": scene.contact.clearance + more}), scene)
    )
    assert np.degrees(warm.outcome.rate) == pytest.approx(np.degrees(wide.outcome.rate), abs=1e-6)
    assert np.abs(np.degrees(warm.outcome.rate) - np.degrees(plain.outcome.rate)).max() > 0.01


@pytest.mark.slow
@pytest.mark.parametrize(
    "flexible", [None, {(face, 0, face, 0): 3e-8 for face in range(16)}], ids=["law", "compliant"]
)
def test_ledgers_on_a_wavy_wall(flexible):
    """Waves of 0.1 mm along the rail: what they push along it is in the ledger, and momentum is
    kept."""
    scene = REFERENCE.condition("phi35").replace({"thermal.mean": MEAN})
    compliance = standing_away(scene, 1e-4 * np.sin(np.linspace(0.0, 12.0, 40)), flexible)
    run = lowfi.run(scene, model_of(flexible), compliance=compliance)
    assert run.status == "exited" and np.abs(run.pad_force).max() > 100.0
    checks = run.checks
    assert checks["linear_momentum_error"] <= 1e-12 and checks["angular_momentum_error"] <= 1e-11
    assert (
        checks["energy_error"] <= 1e-6
        and checks["transverse_energy_error"] <= 1e-4
        and checks["friction_power_max"] <= 0.0
    )


@pytest.mark.slow
def test_the_plain_equations_agree():
    """Fixed steps of 5 us, over all impacts. Control: with cold rails the contacts differ."""
    scene, compliance = REFERENCE.condition("phi35").replace(WARM), reference_compliance().rigid()
    run = lowfi.run(scene, "springs", numerics=TIGHT, compliance=compliance)
    plain = oracle.solve(scene, 10, compliance=compliance)
    cold = lowfi.run(REFERENCE.condition("phi35"), "springs", numerics=TIGHT)
    same = min(run.time.size, cold.time.size)
    error, change = (np.abs(other.rate[:same] - run.rate[:same]).max() for other in (plain, cold))
    assert error < 5e-6 * np.abs(run.rate).max() and change > 1e-2 * np.abs(run.rate).max()


@pytest.mark.slow
def test_ensembles_vary_the_temperature():
    """Every case has the bits of ``lowfi.run``; without walls every warm case is refused."""
    scene, compliance = REFERENCE.condition("phi35"), reference_compliance().rigid()
    rows = [{"thermal.mean": mean} for mean in (0.0, 20.0, 60.0)] + [{"payload.mass": 10.0}]
    found = lowfi.run_many(scene, rows, "springs", compliance=compliance)
    for row, rate in zip(rows, found.rate.values):
        assert (
            rate.tolist()
            == lowfi.run(scene.replace(row), "springs", compliance=compliance).outcome.rate
        )
    assert len({*map(tuple, found.rate.values.tolist())}) == 4
    assert lowfi.run_many(scene, rows, "springs").status.values.tolist() == ["refused"] * 3 + [
        "exited"
    ]


@pytest.mark.slow
def test_a_bow_that_closes_the_clearance_is_warned_about():
    scene = REFERENCE.condition("phi35").replace({"thermal.mean": MEAN})
    # where pads stand at ignition, and nowhere else
    tight = np.where(np.arange(12) < 2, -3e-4, 0.0)
    run = lowfi.run(scene, "springs", compliance=standing_away(scene, tight))
    assert (
        "initial interference: pads 1, 2, 3, 4, 5, 6, 7, 8 press" in run.message
        or "initial interference: pads 0" in run.message
    )
