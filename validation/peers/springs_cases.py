"""The surrogate's model ``springs`` in Exudyn and in MuJoCo, on ten conditions of scene ``clamped``."""

import statistics
from collections.abc import Callable

import numpy as np

from tipoff import lowfi
from tipoff.mechanics.model_names import SPRINGS
from validation.peers import exudyn_model, mujoco_model
from validation.peers.case import OURS, Case, Point, require_ours
from validation.peers.springs_problem import (
    AXES,
    CONDITIONS,
    LINEAR,
    problem,
    rates,
    scene,
    settled,
    solved,
    window,
)

_AFTER = 2.1e-3  # s from the start of the window to the end of a run
_FRICTION, _SLIP = 0.2, 0.01  # of scene ``clamped``: coefficient, m/s
IMPACT = exudyn_model.Law(
    7e4 * 1e3**1.5, 1.5, damping=6e4, depth=3e-4, friction=_FRICTION, slip=_SLIP
)
_SHOWN = "phi35"  # in the diagram of work and precision
_TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8)
_STEPS = (4e-5, 2e-5, 1e-5, 5e-6)  # s
_REPEATS = 5
_TIGHT = 1e-9  # relative tolerance of Exudyn


def exudyn_cases() -> tuple[Case, ...]:
    """The law IMPACT with friction."""

    def theirs(
        condition: str, method: str = exudyn_model.ADAPTIVE, setting: float = _TIGHT
    ) -> dict:
        numbers, start = problem(condition, "impact", True), window(condition, "impact", True)
        found = exudyn_model.run(numbers, IMPACT, method, setting, start + _AFTER)
        return _named(settled(found.time, found.rate, start)) | {"cpu_s": found.cpu_s}

    def work() -> list[Point]:
        ladder = [(exudyn_model.FIXED, step) for step in _STEPS]
        ladder += [(exudyn_model.ADAPTIVE, tolerance) for tolerance in _TOLERANCES]
        found = _ours_by_tolerance("impact", True)
        for method, setting in ladder:
            answer = theirs(_SHOWN, method, setting)
            unit = "s" if method == exudyn_model.FIXED else ""
            label, error = f"{setting:g} {unit}".strip(), _error(answer, "impact", True)
            found.append(Point(f"Exudyn {method}", label, error, answer["cpu_s"]))
        return found

    return (
        _case(
            name="exudyn-impact",
            title="Settled rates of springs with IMPACT and friction: Exudyn, DOPRI5 at 1e-9",
            law="impact",
            friction=True,
            unmatched="IMPACT is a user function in Python, which takes most of the time",
            theirs=theirs,
            within=2e-6,
            work=work,
        ),
    )


def mujoco_cases() -> tuple[Case, ...]:
    """The linear law, without friction and with it."""

    def answers(friction: bool, step: float) -> Callable[[str], dict]:
        def theirs(condition: str) -> dict:
            start = window(condition, "linear", friction)
            numbers, slip = problem(condition, "linear", friction), _FRICTION if friction else 0.0
            found = mujoco_model.run(numbers, LINEAR, slip, step, start + _AFTER)
            return _named(settled(found.time, found.rate, start)) | {"cpu_s": found.cpu_s}

        return theirs

    def work() -> list[Point]:
        found = _ours_by_tolerance("linear", False)
        for step in _STEPS:
            answer = answers(False, step)(_SHOWN)
            error = _error(answer, "linear", False)
            found.append(Point("MuJoCo RK4", f"{step:g} s", error, answer["cpu_s"]))
        return found

    soft = "the force of MuJoCo differs by 1e-4 of itself; a ball of 1 mm leaves the rail's end"
    return (
        _case(
            name="mujoco-linear",
            title="Settled rates of springs with a linear law, no friction: MuJoCo, RK4 with 5 us",
            law="linear",
            friction=False,
            unmatched=soft,
            theirs=answers(False, 5e-6),
            within=5e-3,
            work=work,
        ),
        _case(
            name="mujoco-friction",
            title="Settled rates of springs with a linear law and friction: MuJoCo, RK4 with 5 us",
            law="linear",
            friction=True,
            unmatched=f"{soft}; its friction raises the normal force by about 0.5 N at 6 m/s, "
            "or sticks too softly: its damping of 0.4 N s/m was chosen by agreement among 0.1 to 1, "
            "over which rates of phi35 move by 0.02 deg/s and of h4 by 0.08",
            theirs=answers(True, 5e-6),
            within=1e-2,
            work=None,
        ),
    )


def _case(
    *,
    name: str,
    title: str,
    law: str,
    friction: bool,
    unmatched: str,
    theirs: Callable[[str], dict],
    within: float,
    work: Callable[[], list[Point]] | None,
) -> Case:
    contact = "IMPACT of the scene" if law == "impact" else "linear spring and damper, no pull"
    return Case(
        name=name,
        title=title,
        inputs=lambda: {
            "scene": "clamped",
            "contact": dict(LINEAR) if law == "linear" else "as the scene",
            "friction": friction,
        },
        matched=f"bodies, thrust, recoil, points and walls; {contact}; start of the window",
        unmatched=unmatched,
        settings=CONDITIONS,
        units=dict.fromkeys((f"rate {axis}" for axis in AXES), "deg/s"),
        ours=lambda condition: _ours(condition, law, friction),
        theirs=theirs,
        within=lambda setting, quantity: within,
        work=work,
        error_of=f"settled rates of springs, {law}{', friction' if friction else ''}",
    )


def _ours(condition: str, law: str, friction: bool) -> dict:
    """Rates at a tight tolerance, and the time of the default one."""
    spent = _median(condition, law, friction, lowfi.Numerics())
    return _named(rates(solved(condition, law, friction))) | {"cpu_s": spent}


def _median(condition: str, law: str, friction: bool, numerics: lowfi.Numerics) -> float:
    chosen = scene(condition, law, friction)
    lowfi.run(chosen, SPRINGS, numerics=numerics)  # compiles
    runs = [lowfi.run(chosen, SPRINGS, numerics=numerics) for _ in range(_REPEATS)]
    for run in runs:
        require_ours(run, "exited")
    return statistics.median(run.cost["cpu_s"] for run in runs)


def _named(values: np.ndarray) -> dict[str, float]:
    return {f"rate {axis}": value for axis, value in zip(AXES, values.tolist())}


def _ours_by_tolerance(law: str, friction: bool) -> list[Point]:
    points = []
    for tolerance in _TOLERANCES:
        answer = _named(rates(solved(_SHOWN, law, friction, tolerance)))
        numerics = lowfi.Numerics(relative_tolerance=tolerance)
        spent = _median(_SHOWN, law, friction, numerics)
        points.append(Point(OURS, f"{tolerance:g}", _error(answer, law, friction), spent))
    return points


def _error(found: dict, law: str, friction: bool) -> float:
    """Largest error (%) of a rate of ``found``, relative to the largest rate."""
    exact = rates(solved(_SHOWN, law, friction))
    values = np.array([found[f"rate {axis}"] for axis in AXES])
    return float(100.0 * np.abs(values - exact).max() / np.abs(exact).max())
