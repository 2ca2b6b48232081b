"""A trajectory as text: one line, and the values of its summary and of its card."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from tipoff.cards import fixed
from tipoff.faults import SceneError
from tipoff.mechanics import instant
from tipoff.mechanics.outcome import Outcome
from tipoff.results import hand_calculation, unfinished
from tipoff.results.model_error import Range
from tipoff.scenes.scene import parse
from tipoff.units import duration

if TYPE_CHECKING:
    from tipoff.results.trajectory import Trajectory


def line(run: "Trajectory") -> str:
    """One line: model, status, samples, velocity and rates at the instant that counts."""
    end = (
        f"{len(run.time)} samples to {duration(float(run.time[-1]), 4)}"
        if len(run.time)
        else "no samples"
    )
    at = instant.of_outcome(run.outcome)
    velocity, rate = instant.velocity(run.outcome, at), instant.rate(run.outcome, at)
    found = (
        f": v_x {velocity[0]:.5g} m/s, rates {_rates(rate)} deg/s{_where(at)}"
        if rate is not None and velocity is not None
        else ""
    )
    return f"Trajectory({run.model}, {run.status}, {end}{found})"


def facts(run: "Trajectory") -> dict[str, str]:
    """The main results as text by title, at the instant that counts and then at the other one."""
    found, at = run.outcome, instant.of_outcome(run.outcome)
    text = {"scene": str(run.scene.get("name", "")), "model": run.model, "status": run.status}
    if run.message:
        text["message"] = run.message
    if found.exit_time is not None:
        text["exit"] = f"{duration(found.exit_time, 4)} after ignition"
        if found.impulse_after_exit is not None:
            text["exit"] += f", {100.0 * found.impulse_after_exit:.3g} % of the impulse after it"
    if at == instant.SETTLED:
        text |= _beyond("at exit", found, instant.EXIT)
    velocity, rate = instant.velocity(found, at), instant.rate(found, at)
    if rate is not None and velocity is not None:
        own = run.error.range if run.error is not None else None
        if own is not None:
            text |= _spans(own, _where(at))
        else:
            text |= {
                "velocity": f"{_vector(velocity)} m/s (x, y, z){_where(at)}",
                "rate": f"{_rates(rate)} deg/s (x, y, z)",
                "direction": _direction(velocity),
            }
        if run.error is not None:
            text["error"] = run.error.words
    if at == instant.EXIT:
        text |= _beyond("burnt out", found, instant.SETTLED)
    return (
        text | _beside(run) | _checks(run.checks) | {"took": f"{run.cost.get('wall_s', 0.0):.3g} s"}
    )


def _spans(found: Range, where: str) -> dict[str, str]:
    """Velocity, rate and direction of a sensitive run."""

    def of(low: Sequence[float], high: Sequence[float], digits: int) -> str:
        return ", ".join(
            f"{fixed(one, digits)} to {fixed(other, digits)}" for one, other in zip(low, high)
        )

    millimetres = [1e3 * end for end in found.across_m_s]
    off, across = (f"{low:.3g} to {high:.3g}" for low, high in (found.off_axis_deg, millimetres))
    return {
        "velocity": f"{of(found.low_m_s, found.high_m_s, 4)} m/s (x, y, z){where}",
        "rate": f"{of(found.low_deg_s, found.high_deg_s, 3)} deg/s (x, y, z)",
        "direction": f"{off} deg off axis, {across} mm/s across",
    }


def _beyond(title: str, found: Outcome, at: str) -> dict[str, str]:
    """Rates and speed at the other instant, if there are any."""
    velocity, rate = instant.velocity(found, at), instant.rate(found, at)
    if rate is None or velocity is None:
        return {}
    words = f"{_rates(rate)} deg/s (x, y, z), v_x {fixed(velocity[0], 4)} m/s"
    return {title: words + (f", {instant.IN_A_VACUUM}" if at == instant.SETTLED else "")}


def _where(at: str) -> str:
    """The instant, where it is not the usual one."""
    return f", {instant.where(at)}" if at == instant.EXIT else ""


def _direction(velocity: list[float]) -> str:
    moved = np.array([velocity])
    off, across = instant.off(moved)[0], instant.lateral(moved)[0]
    return f"{math.degrees(off):.3g} deg off axis, {1e3 * across:.3g} mm/s across"


def _vector(values: list[float]) -> str:
    return ", ".join(fixed(value, 4) for value in values)


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
    found = {"balances": ", ".join(words)} if words else {}
    causes = {"clearance": "1 µm of clearance", "tolerance": "a tighter tolerance"}
    changes = [
        f"{checks[key]:.2g} deg/s by {words}"
        for cause, words in causes.items()
        if (key := f"rate_change_by_{cause}_deg_s") in checks
    ]
    return found | ({"sensitivity": ", ".join(changes)} if changes else {})


def _rates(rate: list[float]) -> str:
    return ", ".join(fixed(math.degrees(value), 3) for value in rate)
