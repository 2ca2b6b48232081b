"""Warm rails on compliant contact: one potential of all forces, and displacement that starts at the
warm walls."""

import numpy as np
import pytest

from tests.lowfi.compliance import (
    REFERENCE,
    SMOOTH,
    between,
    flexibility_at,
    pressed,
    reference_compliance,
    whole_at,
)
from tests.lowfi.contact.compliant.test_statics import (
    BASES,
    POSES,
    derivative,
    energy,
    generalised,
    pose_of,
    solved,
)
from tipoff import highfi, lowfi
from tipoff.lowfi import Numerics
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant import thermal_offset
from tipoff.mechanics.rail_compliance import PATTERNS

# Steep enough that what the walls' slope pushes is far above the rounding of the differences.
FIELD = {
    "thermal.mean": 20.0,
    "thermal.gradient.x": 100.0,
    "thermal.gradient.y": 500.0,
    "thermal.gradient.z": -300.0,
}
PRESSED = ("all faces of a rail, tilted", "rear pads over the end")


@pytest.fixture(scope="module")
def heated():
    """Rail compliance, model, records."""
    compliance = reference_compliance()
    return compliance, *pressed(REFERENCE.replace(SMOOTH | FIELD), compliance)


@pytest.mark.parametrize("name", PRESSED)
def test_forces_are_the_gradient_of_the_energy(heated, name):
    _, model, system = heated
    pose, h = pose_of(model, name, BASES["moved and turned"]), 1e-9
    twists = np.eye(12)
    out = [derivative(system, model, pose, twist) for twist in twists]
    forces, released = generalised(pose, out[0]), np.array([each[slot.RELEASED] for each in out])
    slopes = np.array(
        [
            (
                energy(system, model, pose.moved(twist, h))
                - energy(system, model, pose.moved(twist, -h))
            )
            / (2.0 * h)
            for twist in twists
        ]
    )
    size = np.abs(forces).max()
    assert size > 20.0 and slopes == pytest.approx(-forces - released, abs=1e-7 * size, rel=0.0)
    # Control: what the slope of the warm walls pushes along the rail is far above that; at
    # the ends these may be level.
    pushed = 0.0
    for rail in range(len(system.compliance.members)):
        faces = system.compliance.workspace.order[: solved(system, model, pose, rail)]
        pushed = max(
            pushed,
            *(
                abs(
                    thermal_offset.axial_force(
                        system.compliance.thermal_offset,
                        face,
                        system.compliance.workspace.force[face],
                    )
                )
                for face in faces
            ),
            0.0,
        )
    assert "over" in name or pushed > 1e-5 * size


@pytest.mark.parametrize("name", PRESSED[:1])
def test_displacement_starts_at_the_warm_walls(heated, name):
    """U = W + F P, W being the sum of the fields."""
    compliance, model, system = heated
    travel, pose, workspace = POSES[name][0], pose_of(model, name), system.compliance.workspace
    standing = warm_at(compliance, model, travel)
    for rail in range(len(system.compliance.members)):
        faces = workspace.order[: solved(system, model, pose, rail)].copy()
        own = flexibility_at(compliance, travel)[
            np.ix_(faces, range(PATTERNS), faces, range(PATTERNS))
        ]
        expected = standing[faces] + np.einsum("iajb,jb->ia", own, workspace.force[faces])
        assert workspace.displacement[faces] == pytest.approx(expected, rel=1e-9, abs=1e-15)
    assert np.abs(standing).max() > 1e-6


def warm_at(compliance, model, travel):
    """W (f,p) m."""
    moved = compliance.moved(model.thermal.amounts)[..., None]
    own = (compliance.on_part.swapaxes(-1, -2) @ moved)[..., 0]
    found = [between(compliance, own[:, face], travel, face) for face in range(own.shape[1])]
    return (whole_at(compliance, travel) @ np.array(found)[..., None])[..., 0]


@pytest.mark.slow
@pytest.mark.parametrize("condition", ["phi35", "h9"])
def test_ledgers_and_momentum(condition):
    asked, compliance = REFERENCE.condition(condition).replace(FIELD), reference_compliance()
    coarse, fine = (
        lowfi.run(asked, numerics=Numerics(relative_tolerance=tolerance), compliance=compliance)
        for tolerance in (2e-7, 1e-10)
    )
    for run in (coarse, fine):
        assert run.status == "exited" and run.checks["friction_power_max"] <= 0.0
        assert (
            run.checks["linear_momentum_error"] <= 1e-12
            and run.checks["angular_momentum_error"] <= 1e-11
        )
        assert run.checks["energy_error"] <= 1e-6 and run.checks["transverse_energy_error"] <= 1e-4
    assert fine.checks["transverse_energy_error"] < 0.1 * coarse.checks["transverse_energy_error"]
    assert np.degrees(fine.outcome.rate) == pytest.approx(np.degrees(coarse.outcome.rate), abs=0.01)


@pytest.mark.slow
def test_nothing_warm_is_the_same_as_no_temperature():
    """Zero in every field is no temperature, and opposite fields change the rates in the opposite
    way, to first order."""
    cold = REFERENCE.condition("phi35")
    # zero fields change the rounding, and at 1e-10 that moves the rates by 1e-7 deg/s
    small = {key: 0.02 * value for key, value in FIELD.items()}
    tight = Numerics(relative_tolerance=1e-13)
    rates = [
        np.degrees(
            lowfi.run(
                cold.replace(change), compliance=reference_compliance(), numerics=tight
            ).outcome.rate
        )
        for change in (
            {},
            {"thermal.mean": 0.0},
            small,
            {key: -value for key, value in small.items()},
        )
    ]
    assert rates[1] == pytest.approx(rates[0], abs=1e-9)
    there, back = rates[2] - rates[0], rates[3] - rates[0]
    assert np.abs(there + back).max() < 0.2 * np.abs(there).max() and np.abs(there).max() > 1e-4


@pytest.mark.slow
def test_both_fidelities_agree_on_warm_rails():
    """Elements of 4 mm in both, 20 K with the sun on one side: within the limits of agreement,
    while the temperature changes the rates by ten times as much. Control: with the opposite
    temperature, or none, they are missed."""
    cold, sun = (
        REFERENCE.condition("phi35"),
        {"thermal.mean": 20.0, "thermal.gradient.y": 100.0, "thermal.gradient.z": -50.0},
    )
    wanted = np.degrees(
        highfi.run(cold.replace(sun), highfi.Numerics(element_size=4e-3)).outcome.rate
    )
    shade = {key: -value for key, value in sun.items()}
    errors = [
        np.abs(
            np.degrees(
                lowfi.run(cold.replace(change), compliance=reference_compliance()).outcome.rate
            )
            - wanted
        ).max()
        for change in (sun, shade, {})
    ]
    assert errors[0] < 0.1 and min(errors[1:]) > 0.9
