"""Faults that stop a run: lost energy, a pad that strikes an edge, a speed, a displacement or
friction outside the range of the method."""

import numpy as np

from tipoff.highfi.contact.pads import FASTEST_APPROACH
from tipoff.highfi.contact.surface import magnification
from tipoff.highfi.dynamics import linear_range, observe, samples, substeps
from tipoff.highfi.dynamics.stepper import Stepper
from tipoff.highfi.rail import spin
from tipoff.highfi.recorded import Recorded
from tipoff.highfi.state.records import TOTAL
from tipoff.kernels import rotation
from tipoff.mechanics import ledger, outcome

_ROUNDING = 1e-15  # J, while the payload is held and no work is done
_STOP_RATIO = 0.1  # of the transverse scale; with a larger loss of energy the run has no result


def fault(stepper: Stepper, recorded: Recorded, row: np.ndarray) -> tuple[str, float]:
    """Reason why a run must stop at the sample ``row``, or "", and its scale of energy (J)."""
    state, now, scale = stepper.state, f"at {stepper.time:.6g} s", recorded.scale
    if not (np.isfinite(row).all() and np.isfinite(state.work.view(float)).all()):
        return f"a value became infinite {now}", scale
    # Plain numbers: numpy joins records in a multiple of the time.
    work_done = [each.view(float) for each in (*recorded.work[:1], state.work)]
    _, transverse = samples.ledgers(np.array([*recorded.rows[:1], row]), np.array(work_done))
    scale = max(scale, float(transverse[-1, 2:5].sum()))
    loss, work = abs(ledger.residual(transverse)[-1]), abs(state.work["thrust"][TOTAL])
    words = ""
    if stepper.active.struck["depth"].any():
        words = _strike(stepper)
    # Without transverse motion, rounding of the large axial work is no fault.
    elif loss > _STOP_RATIO * scale + 1e-11 * work + _ROUNDING:
        words = f"transverse energy is off by {loss:.3g} J, its scale being {scale:.3g} J, {now}"
    elif (speed := _approach_speed(stepper)) > FASTEST_APPROACH:
        words = (
            f"payload and rails approach at up to {speed:.3g} m/s, contact search allows "
            f"{FASTEST_APPROACH:g} m/s, {now}"
        )
    elif substeps.too_many(stepper):
        words = (
            f"friction damps nodes faster than {substeps.MOST} parts of the step of "
            f"{stepper.setup.stepping.dt_s:.4g} s can follow, {now}; raise friction.static_speed"
        )
    return words, scale


def out_of_range(stepper: Stepper, taken: int, row: np.ndarray) -> str:
    """Reason why the rails are no longer linear at the sample ``row``, or ""; ``taken``: number of
    samples before it."""
    setup, words = stepper.setup, ""
    if taken % -(-linear_range.EVERY // setup.stepping.steps_per_sample) == 0:
        words = linear_range.fault(setup.system, stepper.state.displacement, setup.small)
    rate = row[observe.PLATFORM_RATE : observe.PLATFORM_RATE + 3]
    size = float(np.linalg.norm(rate))
    if not words and setup.system.frame is not None and size > setup.slow:
        found = spin.too_fast(size, setup.lowest_frequency)
        words = "; expected ".join(found) if found else ""
    return f"{words}, at {stepper.time:.6g} s" if words else ""


def _strike(stepper: Stepper) -> str:
    """First face that struck an edge of a wall, with place and time."""
    struck, system = stepper.active.struck, stepper.setup.system
    face = int(max(np.flatnonzero(struck["depth"]), key=lambda each: struck["age"][each]))
    depth, x, age = struck[face]
    return outcome.strike(
        system.model.faces,
        face,
        "strikes an edge or the back",
        depth,
        x + system.origin[0],
        stepper.time - age,
    )


def _approach_speed(stepper: Stepper) -> float:
    """Upper bound (m/s) of the speed across the rail at which a pad and a point of a wall approach each
    other at the last sample; zero without contact."""
    state, system = stepper.state, stepper.setup.system
    payload = system.model.payload
    if system.model.interface_stiffness is None:
        return 0.0
    # A slender body turns much slower than its angular momentum over its least moment of inertia.
    attitude = rotation.single(state.payload.quaternion)
    spin = np.linalg.norm(payload.inverse_inertia @ (attitude.T @ state.payload.spin))
    reach = np.sqrt((system.faces.centre**2).sum(axis=1).max())
    turn = rotation.single(state.platform.quaternion)
    moving = magnification(system.surface) * state.sums[observe.FASTEST]
    return float(max(moving, _approach_of_rigid_part(stepper, turn)) + spin * reach)


def _approach_of_rigid_part(stepper: Stepper, turn: np.ndarray) -> float:
    """Upper bound (m/s) of the speed across the rail between the payload's mass centre and walls at
    rest in the frame; ``turn``: rotation of the frame."""
    state, frame = stepper.state, stepper.now.frame
    if frame is None:
        return float(np.linalg.norm((state.payload.velocity @ turn)[1:]))
    spin = np.linalg.norm(frame.inverse_inertia @ (turn.T @ state.platform.spin))
    away = ((state.payload.velocity - state.platform.velocity) @ turn)[1:]
    return float(np.linalg.norm(away) + spin * stepper.setup.reach)
