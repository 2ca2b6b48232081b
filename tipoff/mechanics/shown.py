"""A trajectory as text: one line, and the values of its summary and of its card."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from tipoff.mechanics import hand_calculation, unfinished
from tipoff.scenes.faults import SceneError
from tipoff.scenes.scene import parse

if TYPE_CHECKING:
    from tipoff.mechanics.trajectory import Trajectory


def line(run: "Trajectory") -> str:
    """One line: model, status, samples, settled velocity and rates."""
    end = (
        f"{len(run.time)} samples to {1e3 * run.time[-1]:.4g} ms" if len(run.time) else "no samples"
    )
    found = run.outcome
    settled = (
        f": v_x {found.velocity[0]:.5g} m/s, rates {_rates(found.rate)} deg/s"
        if found.rate is not None and found.velocity is not None
        else ""
    )
    return f"Trajectory({run.model}, {run.status}, {end}{settled})"


def facts(run: "Trajectory") -> dict[str, str]:
    """The main results as text by title."""
    found = run.outcome
    text = {"scene": str(run.scene.get("name", "")), "model": run.model, "status": run.status}
    if run.message:
        text["message"] = run.message
    if found.exit_time is not None:
        text["exit"] = f"{1e3 * found.exit_time:.4g} ms after ignition"
        if found.impulse_after_exit is not None:
            text["exit"] += f", {100.0 * found.impulse_after_exit:.3g} % of the impulse after it"
    if found.exit_rate is not None and found.exit_velocity is not None:
        speed = f"v_x {found.exit_velocity[0]:.4f} m/s"
        text["at exit"] = f"{_rates(found.exit_rate)} deg/s (x, y, z), {speed}"
    if found.rate is not None and found.velocity is not None:
        across, error = found.lateral_velocity, found.direction_error
        text |= {
            "velocity": ", ".join(f"{value + 0.0:.4f}" for value in found.velocity)
            + " m/s (x, y, z)",
            "rate": f"{_rates(found.rate)} deg/s (x, y, z)",
        }
        if across is not None and error is not None:
            words = f"{math.degrees(error):.3g} deg off axis, {1e3 * across:.3g} mm/s across"
            text["direction"] = words
    return (
        text | _beside(run) | _checks(run.checks) | {"took": f"{run.cost.get('wall_s', 0.0):.3g} s"}
    )


def _beside(run: "Trajectory") -> dict[str, str]:
    """The rates by hand, and advice for a run that ended too early. Both need the scene; a
    trajectory that was read back may lack its files."""
    try:
        scene = parse(run.scene, bare_numbers_are_si=True)
    except SceneError:
        return {}
    found = {}
    if (hand := hand_calculation.rates(scene, run)) is not None:
        found["by hand"] = f"{_rates(hand.rate.tolist())} deg/s: {hand.words}"
    if words := unfinished.advice(scene, run):
        found["advice"] = words
    return found


def _checks(checks: Mapping[str, float]) -> dict[str, str]:
    named = {"energy_error": "energy", "linear_momentum_error": "momentum"}
    words = [f"{name} to {checks[key]:.1g}" for key, name in named.items() if key in checks]
    return {"balances": ", ".join(words)} if words else {}


def _rates(rate: list[float]) -> str:
    return ", ".join(f"{round(math.degrees(value), 3) + 0.0:.3f}" for value in rate)
