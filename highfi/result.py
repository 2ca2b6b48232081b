"""The Trajectory of a run of the reference, from its samples, its totals of work and its
ledgers."""

import numpy as np

from tipoff.highfi.dynamics import ending, monitor, samples
from tipoff.highfi.dynamics.stepper import Stepper
from tipoff.highfi.numerics import Numerics
from tipoff.highfi.recorded import Recorded
from tipoff.mechanics import books, comoving, ledger, model_names, outcome
from tipoff.mechanics.promises import FINITE_ELEMENTS, broken
from tipoff.results.trajectory import Trajectory


def trajectory(stepper: Stepper, recorded: Recorded, cost: dict, numerics: Numerics) -> Trajectory:
    """The result of the samples so far."""
    setup, scene, system = stepper.setup, stepper.setup.scene, stepper.setup.system
    rows, forces, gauges = map(np.array, (recorded.rows, recorded.forces, recorded.gauges))
    interval, yields = scene.output.interval, scene.rail.material.yield_strength
    moved = samples.motion(rows, interval, system.body_offset)
    total, transverse = samples.ledgers(rows, np.array(recorded.work))
    status, result = ending.found(system, stepper.book)
    linear, angular = samples.momentum_errors(rows, moved, system, forces, stepper.steps)
    friction = np.diff(total[:, ledger.ENTRIES.index("friction")], prepend=0.0) / interval
    checks = {
        "energy_error": ledger.total_error(total, FINITE_ELEMENTS),
        "transverse_energy_error": ledger.transverse_error(transverse, total, FINITE_ELEMENTS),
        "linear_momentum_error": linear,
        "angular_momentum_error": angular,
        "quaternion_error": float(np.abs(np.linalg.norm(moved.quaternion, axis=1) - 1.0).max()),
        "friction_power_max": float(-friction.min()),
        "friction_step_ratio": recorded.damping,
    }
    exceeded = _broken(checks)
    if recorded.message or exceeded:
        status, result = "diverged", outcome.Outcome()
    stress = None
    if status != "diverged":
        stress = monitor.record(setup.monitor, system, recorded.peak, yields)
    pressed = outcome.pressed_at_ignition(system.model, forces[0]) if forces.size else ""
    message = "; ".join(filter(None, [recorded.message, exceeded, pressed]))
    seen_from = comoving.frame(system.model)
    return Trajectory(
        model=model_names.FINITE_ELEMENTS,
        status=status,
        message=message,
        **comoving.motion(seen_from, moved)._asdict(),
        pad_force=forces,
        **books.named_loads(stepper.state.guide_loads[0]),
        energy=total,
        transverse_energy=transverse,
        outcome=comoving.outcome(seen_from, result),
        checks=checks,
        cost=cost,
        scene=scene.resolved(),
        numerics=numerics.as_dict(),
        stress=stress,
        wall_stress=gauges.reshape(len(rows), -1, 6) if gauges.size else None,
    )


def _broken(checks: dict[str, float]) -> str:
    """The accuracy limits that the run exceeded, with a remedy, or "". The run is not repeated with
    smaller steps: its cost is the user's decision."""
    words = broken(checks, FINITE_ELEMENTS)
    return f"{words}; lower safety or element_size" if words else ""
