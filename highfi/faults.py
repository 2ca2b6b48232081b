"""Faults that stop a run: lost energy, a pad that strikes an edge, a speed or friction outside the
range of the method."""

import numpy as np

from tipoff.highfi.contact.pads import FASTEST_APPROACH
from tipoff.highfi.contact.surface import magnification
from tipoff.highfi.dynamics import samples, substeps
from tipoff.highfi.state.records import TOTAL
from tipoff.kernels import rotation
from tipoff.mechanics import ledger, outcome

_STOP_RATIO = 0.1  # of the transverse scale; with a larger loss of energy the run has no result


def fault(loop, row: np.ndarray) -> str:
    """Reason why a ``run.Loop`` must stop at the sample ``row``, or ""; updates its energy
    scale."""
    now = f"at {loop.steps * loop.stepping.dt_s:.6g} s"
    if not (np.isfinite(row).all() and np.isfinite(loop.state.work.view(float)).all()):
        return f"a value became infinite {now}"
    _, transverse = samples.ledgers(
        np.array([*loop.rows[:1], row]), np.array([*loop.work[:1], loop.state.work])
    )
    loop.scale = max(loop.scale, transverse[-1, 2:5].sum())
    if loop.active.struck["depth"].any():
        return _strike(loop)
    loss, work = abs(ledger.residual(transverse)[-1]), abs(loop.state.work["thrust"][TOTAL])
    # Without transverse motion, rounding of the large axial work is no fault.
    if loss > _STOP_RATIO * loop.scale + 1e-11 * work:
        return (
            f"transverse energy is off by {loss:.3g} J, its scale being {loop.scale:.3g} J, {now}"
        )
    if loop.system.model.interface_stiffness is not None:
        if (speed := _approach_speed(loop)) > FASTEST_APPROACH:
            return (
                f"payload and rails approach at up to {speed:.3g} m/s, contact search allows "
                f"{FASTEST_APPROACH:g} m/s, {now}"
            )
    if substeps.too_many(loop):
        return (
            f"friction damps nodes faster than {substeps.MOST} parts of the step of "
            f"{loop.stepping.dt_s:.4g} s can follow, {now}; raise friction.static_speed"
        )
    return ""


def _strike(loop) -> str:
    """First face that struck an edge of a wall, with place and time."""
    struck = loop.active.struck
    face = int(max(np.flatnonzero(struck["depth"]), key=lambda each: struck["age"][each]))
    depth, x, age = struck[face]
    time = loop.steps * loop.stepping.dt_s - age
    return outcome.strike(
        loop.system.model.faces,
        face,
        "strikes an edge or the back",
        depth,
        x + loop.system.origin[0],
        time,
    )


def _approach_speed(loop) -> float:
    """Upper bound (m/s) of the present speed across the rail at which a pad and a point of a wall
    approach each other."""
    state, payload = loop.state, loop.system.model.payload
    # The Frobenius norm is an upper bound of the spectral norm and much faster.
    spin = np.linalg.norm(payload.inverse_inertia) * np.linalg.norm(state.payload.spin)
    reach = np.sqrt((loop.system.faces.centre**2).sum(axis=1).max())
    turn = rotation.single(state.platform.quaternion)
    _, across_y, across_z = state.payload.velocity @ turn
    walls = loop.now.walls
    y, z = state.velocity.T[1][walls] - across_y, state.velocity.T[2][walls] - across_z
    moving = magnification(loop.system.surface) * np.sqrt((y * y + z * z).max(initial=0.0))
    return float(max(moving, _approach_of_rigid_part(loop, turn)) + spin * reach)


def _approach_of_rigid_part(loop, turn: np.ndarray) -> float:
    """Upper bound (m/s) of the speed across the rail between the payload's mass centre and walls at
    rest in the frame; ``turn``: rotation of the frame."""
    state, frame = loop.state, loop.now.frame
    if frame is None:
        return float(np.linalg.norm((state.payload.velocity @ turn)[1:]))
    spin = np.linalg.norm(frame.inverse_inertia @ (turn.T @ state.platform.spin))
    away = ((state.payload.velocity - state.platform.velocity) @ turn)[1:]
    return float(np.linalg.norm(away) + spin * loop.reach)
