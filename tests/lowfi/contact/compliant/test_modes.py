"""Modes of the rails on compliant contact: one potential of all forces, the step limit, and the
compliances that have modes."""

from dataclasses import replace

import numpy as np
import pytest

from tests.lowfi.compliance import REFERENCE, SMOOTH, pressed, reference_compliance, state_of
from tests.lowfi.contact.compliant.test_statics import (
    BASES,
    POSES,
    derivative,
    energy,
    generalised,
    pose_of,
    solved,
)
from tipoff import lowfi
from tipoff.faults import SceneError
from tipoff.lowfi import Numerics
from tipoff.lowfi import state as slot
from tipoff.lowfi.contact.compliant import step_limit

COUNT, FOUR, COEFFICIENT = 5, Numerics(modes=4), 0.3
DAMPED = {"rail.damping.ratios": [0.02, 0.01], "rail.damping.frequencies": [1e3, 5e3]}


@pytest.fixture(scope="module")
def vibrating():
    """Model, records with friction that drags the walls and has no other force, and any motion of the
    modes: walls out by micrometres, at centimetres a second."""
    model, system = pressed(REFERENCE.replace(SMOOTH | DAMPED), reference_compliance(), COUNT)
    system.compliance.workspace.friction[0] = COEFFICIENT
    size = system.compliance.modes.square.size
    random = np.random.default_rng(5)
    return (
        model,
        system,
        np.append(3e-7 * random.standard_normal(size), 3e-3 * random.standard_normal(size)),
    )


def rails(system):
    return range(len(system.compliance.members))


@pytest.mark.parametrize("name", POSES)
def test_forces_are_the_gradient_of_the_energy(vibrating, name):
    """For translations and rotations of either body with the modes fixed, and for every mode: q'' =
    -dE/dq - omega^2 q - d q'."""
    model, system, modes = vibrating
    pose, h, twists = pose_of(model, name, BASES["moved and turned"]), 1e-9, np.eye(12)
    out = [derivative(system, model, pose, twist, modes) for twist in twists]
    forces, released = generalised(pose, out[0]), np.array([each[slot.RELEASED] for each in out])
    slopes = np.array(
        [
            (
                energy(system, model, pose.moved(twist, h), modes)
                - energy(system, model, pose.moved(twist, -h), modes)
            )
            / (2.0 * h)
            for twist in twists
        ]
    )
    size = np.abs(forces).max()
    assert size > 20.0
    assert slopes == pytest.approx(-forces - released, abs=1e-7 * size, rel=0.0)
    # Control: without the force along the rail of a wall that modes have bent they would not agree.
    assert abs(pull_of_modes(system, model, pose, modes)) > 1e-6 * size
    q, rate = modes.reshape(2, -1)
    square, drag = system.compliance.modes.square.ravel(), system.compliance.modes.drag.ravel()
    steps = 1e-9 * np.eye(q.size, modes.size)
    by_mode = (
        np.array(
            [
                energy(system, model, pose, modes + step)
                - energy(system, model, pose, modes - step)
                for step in steps
            ]
        )
        / 2e-9
    )
    swung, found = out[0][slot.STATE_SIZE :].reshape(2, -1)
    assert (swung == rate).all() and np.abs(by_mode).max() > 1.0
    assert found + square * q + drag * rate == pytest.approx(
        -by_mode, abs=1e-6 * np.abs(by_mode).max()
    )
    assert out[0][slot.STRUCTURAL] == pytest.approx(drag @ rate**2, rel=1e-12)


def pull_of_modes(system, model, pose, modes) -> float:
    """Force (N) along the rail on the payload by walls that modes have bent."""
    found = 0.0
    for rail in rails(system):
        faces = system.compliance.workspace.order[: solved(system, model, pose, rail, None, modes)]
        found += (
            system.compliance.workspace.force[faces] * system.compliance.modes.slope[faces]
        ).sum()
    return found


@pytest.mark.parametrize("name", ["both legs", "rails of both sides"])
def test_limit_bounds_the_spectrum(vibrating, name):
    """Every eigenvalue of the coupled system lies below the bound, which is not far above; the
    highest mode alone would be no bound."""
    model, system, modes = vibrating
    pose, bodies = pose_of(model, name), (model.payload, model.platform)
    metric = np.zeros((12 + modes.size // 2,) * 2)
    for first, body in zip((0, 6), bodies):
        metric[first : first + 3, first : first + 3] = np.eye(3) / body.mass
        metric[first + 3 : first + 6, first + 3 : first + 6] = body.inverse_inertia
    metric[12:, 12:] = np.eye(modes.size // 2)

    def forces(moved, tail):
        out = derivative(system, model, moved, np.zeros(12), tail)
        return np.append(generalised(moved, out), out[slot.STATE_SIZE + modes.size // 2 :])

    still = modes * (np.arange(modes.size) < modes.size // 2)
    columns = [
        (forces(pose.moved(twist, 1e-9), still) - forces(pose.moved(twist, -1e-9), still)) / 2e-9
        for twist in np.eye(12)
    ]
    columns += [
        (forces(pose, still + step) - forces(pose, still - step)) / 2e-9
        for step in 1e-9 * np.eye(modes.size // 2, modes.size)
    ]
    fastest = np.abs(np.linalg.eigvals(metric @ np.array(columns).T)).max()
    springs, dampers = step_limit.stiffness_and_damping(
        system.compliance,
        system.friction,
        system.faces,
        system.platform,
        system.payload,
        np.ones(len(system.faces), dtype=np.bool_),
        np.append(state_of(model, pose), modes),
        False,
    )
    assert system.compliance.modes.square.max() < fastest < springs < 10.0 * fastest
    assert dampers == system.compliance.modes.drag.max() > 0.0


def test_modes_need_a_compliance_that_has_them():
    with pytest.raises(
        SceneError, match="numerics.modes: given 4, expected 0: springs stand on rigid rails"
    ):
        lowfi.run(REFERENCE, "springs", numerics=FOUR)
    compliance = reference_compliance()
    few = replace(
        compliance, frequency=compliance.frequency[:, :3], shape=compliance.shape[..., :3]
    )
    with pytest.raises(SceneError, match="numerics.modes: given 4, expected at most 3"):
        lowfi.run(REFERENCE, numerics=FOUR, compliance=few)
    nothing = REFERENCE.replace({"contact": None, "friction": None})  # presses the rails
    assert lowfi.run(nothing, numerics=FOUR).outcome.rate == lowfi.run(nothing).outcome.rate


@pytest.mark.parametrize("given", [-1, 21, 2.5, "many", True])
def test_a_number_of_modes_is_a_whole_one(given):
    with pytest.raises(ValueError, match="modes.*expected a whole number from 0 to 20"):
        Numerics(modes=given)


def test_rails_that_nothing_touches_take_no_time():
    """No pad touches in h5: not a step more, and the numbers of a run without modes, bit by bit."""
    asked, compliance = REFERENCE.condition("h5"), reference_compliance()
    plain, modes = (
        lowfi.run(asked, numerics=each, compliance=compliance) for each in (Numerics(modes=0), FOUR)
    )
    assert modes.cost["steps"] == plain.cost["steps"]
    np.testing.assert_array_equal(modes.position, plain.position)
    np.testing.assert_array_equal(modes.rate, plain.rate)


def test_walls_and_modes_of_different_rails_are_refused():
    compliance = reference_compliance()
    with pytest.raises(ValueError, match="^modes: given"):
        replace(compliance, shape=3.0 * compliance.shape).residual(1)
    unknown = compliance.shape.copy()
    unknown[0, 0, 0, 0] = np.nan
    with pytest.raises(ValueError, match="^modes: given"):
        replace(compliance, shape=unknown).residual(1)
    assert compliance.residual(0) is compliance.flexibility
