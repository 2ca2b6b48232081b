"""A trajectory as text: one line, and the values of its summary and of its card."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from tipoff.cards import fixed
from tipoff.faults import SceneError
from tipoff.mechanics import instant
from tipoff.mechanics.model_names import SPRINGS
from tipoff.mechanics.outcome import Outcome
from tipoff.results import answer, guides, hand_calculation, unfinished
from tipoff.scenes.scene import parse
from tipoff.units import duration, is_number

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
    if at == instant.SETTLED and not _is_one_of_many(run):
        text |= _beyond("at exit", found, instant.EXIT)
    velocity, rate = instant.velocity(found, at), instant.rate(found, at)
    if rate is not None and velocity is not None:
        own = answer.words(velocity, list(map(math.degrees, rate)), run.error)
        text |= own | {"velocity": f"{own['velocity']}{_where(at)}"}
        if run.error is not None:
            text["error"] = run.error.words
    if at == instant.EXIT and not _is_one_of_many(run):
        text |= _beyond("burnt out", found, instant.SETTLED)
    return (
        text
        | _beside(run)
        | _used(run)
        | _checks(run.checks)
        | {"took": f"{run.cost.get('wall_s', 0.0):.3g} s"}
    )


def _is_one_of_many(run: "Trajectory") -> bool:
    """Whether the answer is the range over neighbours of the run."""
    return run.error is not None and run.error.range is not None


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


def _beside(run: "Trajectory") -> dict[str, str]:
    """The rates by hand, each button, and advice for a run that ended too early. Both need the scene; a
    trajectory that was read back may lack its files."""
    try:
        scene = parse(run.scene, bare_numbers_are_si=True)
    except SceneError:
        return {}
    at, found = instant.of_outcome(run.outcome), {}
    for hand in hand_calculation.of_run(scene, run):
        if hand.at == at:
            rates = answer.rates(list(map(math.degrees, hand.rate_rad_s)))
            found["by hand"] = f"{rates}: {hand.words}"
    for guide in guides.of_run(scene, run):
        if not guide.name.startswith("pad"):
            found[guide.name] = answer.of_guide(guide, not _is_one_of_many(run))
    if words := unfinished.advice(scene, run):
        found["advice"] = words
    return found


def _used(run: "Trajectory") -> dict[str, str]:
    """The numbers by which the run was made."""
    found = run.numerics
    rail = found.get("rail_compliance") or found
    forms = {
        "modes": "{} modes of each rail",
        "degree": "patterns of degree {}",
        "cells": "{} contact cells along each edge of a pad",
        "relative_tolerance": "tolerance {:g}",
    }
    if run.model == SPRINGS or not run.scene.get("contact"):  # nothing has cells
        forms = {"relative_tolerance": forms["relative_tolerance"]}
    size = next((rail[key] for key in ("element_size_m", "element_size") if rail.get(key)), None)
    words = [f"rail of {1e3 * size:.3g} mm elements"] if size else []
    words += [form.format(found[key]) for key, form in forms.items() if is_number(found.get(key))]
    return {"numerics": ", ".join(words)} if words else {}


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
