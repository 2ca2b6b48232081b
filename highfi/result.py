"""The Trajectory of a run of the reference, from its samples, its totals of work and its
ledgers."""

import numpy as np

from tipoff.highfi.dynamics import ending, samples
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.stress import monitor
from tipoff.mechanics import comoving, ledger, model_names, outcome
from tipoff.mechanics.promises import FINITE_ELEMENTS, broken
from tipoff.mechanics.trajectory import Trajectory


def trajectory(loop, cost: dict, numerics: Numerics) -> Trajectory:
    """The result of the samples of a ``run.Loop`` so far."""
    rows, moved = np.array(loop.rows), _motion(loop)
    total, transverse = samples.ledgers(rows, np.array(loop.work))
    status, result = ending.found(loop.system, loop.book)
    forces = np.array(loop.forces)
    linear, angular = samples.momentum_errors(rows, moved, loop.system, forces, loop.steps)
    friction = (
        np.diff(total[:, ledger.ENTRIES.index("friction")], prepend=0.0)
        / loop.scene.output.interval
    )
    checks = {
        "energy_error": ledger.total_error(total, FINITE_ELEMENTS),
        "transverse_energy_error": ledger.transverse_error(transverse, total, FINITE_ELEMENTS),
        "linear_momentum_error": linear,
        "angular_momentum_error": angular,
        "quaternion_error": float(np.abs(np.linalg.norm(moved.quaternion, axis=1) - 1.0).max()),
        "friction_power_max": float(-friction.min()),
        "friction_step_ratio": float(loop.damping),
    }
    exceeded = _broken(checks)
    if loop.message or exceeded:
        status, result = "diverged", outcome.Outcome()
    pressed = outcome.pressed_at_ignition(loop.system.faces, loop.forces[0]) if loop.forces else ""
    message = "; ".join(filter(None, [loop.message, exceeded, pressed]))
    seen_from = comoving.frame(loop.system.model)
    return Trajectory(
        model=model_names.FINITE_ELEMENTS,
        status=status,
        message=message,
        **comoving.motion(seen_from, moved)._asdict(),
        pad_force=forces,
        energy=total,
        transverse_energy=transverse,
        outcome=comoving.outcome(seen_from, result),
        checks=checks,
        cost=cost,
        scene=loop.scene.resolved(),
        numerics=numerics.as_dict(),
        stress=None if status == "diverged" else _stress(loop),
        wall_stress=np.array(loop.gauges).reshape(len(rows), -1, 6) if loop.gauges else None,
    )


def _motion(loop) -> outcome.Motion:
    return samples.motion(np.array(loop.rows), loop.scene.output.interval, loop.system.body_offset)


def _stress(loop) -> dict:
    return monitor.record(
        loop.monitor, loop.system, loop.peak, loop.scene.rail.material.yield_strength
    )


def _broken(checks: dict[str, float]) -> str:
    """The accuracy limits that the run exceeded, with a remedy, or "". The run is not repeated with
    smaller steps: its cost is the user's decision."""
    words = broken(checks, FINITE_ELEMENTS)
    return f"{words}; lower safety or element_size" if words else ""
