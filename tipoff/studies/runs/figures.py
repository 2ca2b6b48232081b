"""Figures of the trajectories of both models."""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from tipoff.mechanics import ledger
from tipoff.mechanics.estimates import ends
from tipoff.mechanics.laws import thrust as thrust_law
from tipoff.results.trajectory import Trajectory
from tipoff.scenes import launch
from tipoff.scenes.scene import Scene
from tipoff.studies.convergence.contact_loads import by_pad
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.palette import AMBER, AXIS_COLOURS, GREY, INK, NAVY, TEAL, VERMILION

_MILLISECONDS = "time after ignition (ms)"


class Runs(NamedTuple):
    """Trajectories by condition: the reference, compliant contact, and springs after and before
    calibration (empty where there are none)."""

    highfi: dict[str, Trajectory]
    compliant: dict[str, Trajectory]
    calibrated: Mapping[str, Trajectory] = MappingProxyType({})
    uncalibrated: Mapping[str, Trajectory] = MappingProxyType({})


# In the order of the legend. Width, dash, opacity: the reference is a broad pale line under the
# thin lines of the surrogate.
_STYLES = {
    "highfi": ("finite elements", 5.0, "-", 0.35),
    "compliant": ("compliant", 1.5, "-", 1.0),
    "calibrated": ("springs, calibrated", 1.2, "--", 0.9),
    "uncalibrated": ("springs, uncalibrated", 1.1, ":", 0.9),
}
_COLOURS = {"highfi": NAVY, "compliant": VERMILION, "calibrated": AMBER}


def thrust_curve(scene: Scene) -> Chart:
    """Thrust until the expected end of the run."""
    time = np.linspace(0.0, scene.expected_end, 600)
    force = thrust_law.sample(ends.over_time(launch.of_scene(scene)), time)
    line = Line(1e3 * time, 1e-3 * force, "thrust", width=2.0, legend=False)
    return Chart("thrust", [Panel("", _MILLISECONDS, "thrust (kN)", [line])], height=260)


def figure6(runs: Runs, conditions: list[str]) -> Chart:
    """Figure 6 of the paper: v_x and the three rates of each condition, all models; beside them the
    differences of the surrogates from the reference. The colour shows the axis, the line the model.
    """
    first = conditions[0]
    speed = [
        _line(found.time, found.velocity[:, 0], NAVY, kind, legend=False)
        for kind, found in _of(runs, first).items()
    ]
    speed += _legend(runs, first)
    slower = _differences(runs, first, lambda run: run.velocity[:, :1], {"x": NAVY}, 1e3)
    panels = [
        Panel(f"(a) {first}: velocity along X", _MILLISECONDS, y_label="v_x (m/s)", lines=speed),
        Panel("difference of v_x", _MILLISECONDS, y_label="difference (mm/s)", lines=slower),
    ]
    for letter, name in zip("bcdefghijk", conditions):
        lines = [
            _line(run.time, np.degrees(run.rate[:, i]), colour, kind, legend=False)
            for kind, run in _of(runs, name).items()
            for i, colour in enumerate(AXIS_COLOURS.values())
        ]
        other = _differences(runs, name, lambda run: np.degrees(run.rate), AXIS_COLOURS)
        title, axes = f"{name}: difference of the rates", (_MILLISECONDS, "difference (deg/s)")
        panels += [
            Panel(f"({letter}) {name}: rates", _MILLISECONDS, "rate (deg/s)", lines),
            Panel(title, *axes, other),
        ]
    return Chart("figure6", panels, columns=2, height=290)


def _legend(runs: Runs, name: str) -> list[Line]:
    """Lines without points for the legend: one colour for each axis, one line for each model."""
    nowhere = [math.nan]
    axes = [
        Line(nowhere, nowhere, name=f"along or about {axis.upper()}", colour=colour, width=3.0)
        for axis, colour in AXIS_COLOURS.items()
    ]
    models = [_line(np.array(nowhere), nowhere, INK, kind) for kind in _of(runs, name)]
    return axes + models


def _of(runs: Runs, name: str) -> dict[str, Trajectory]:
    """The runs of one condition by model."""
    return {kind: getattr(runs, kind)[name] for kind in _STYLES if name in getattr(runs, kind)}


def _differences(
    runs: Runs,
    name: str,
    measured: Callable[[Trajectory], np.ndarray],
    colours: Mapping[str, str],
    factor: float = 1.0,
) -> list[Line]:
    """Surrogates minus reference, up to the end of the shorter run; uncalibrated springs, which
    differ most, are left out."""
    found = _of(runs, name)
    if (reference := found.get("highfi")) is None:
        return []
    lines = []
    for kind in ("compliant", "calibrated"):
        if (run := found.get(kind)) is None:
            continue
        time = run.time[run.time <= reference.time[-1]]
        for i, colour in enumerate(colours.values()):
            own = measured(run)[: time.size, i]
            there = np.interp(time, reference.time, measured(reference)[:, i])
            lines.append(_line(time, factor * (own - there), colour, kind, legend=False))
    return lines


def _line(time, values, colour: str, kind: str, legend: bool = True) -> Line:
    model, width, dash, opacity = _STYLES[kind]
    return Line(1e3 * time, values, model, colour, width, dash, opacity, legend=legend)


def contact_forces(scene: Scene, runs: Runs, condition: str) -> Chart:
    """Force on every pad that touches a rail, one condition, all models except uncalibrated
    springs."""
    forces = {
        kind: (
            found[condition].time,
            np.linalg.norm(by_pad(scene, found[condition].pad_force), axis=2),
        )
        for kind in _COLOURS
        if condition in (found := getattr(runs, kind))
    }
    loaded = sorted(
        {
            int(pad)
            for _, force in forces.values()
            for pad in np.flatnonzero(force.max(axis=0) > 1.0)
        }
    )
    panels = []
    for pad in loaded:
        lines = [
            _line(time, force[:, pad], _COLOURS[kind], kind)
            for kind, (time, force) in forces.items()
        ]
        panels.append(Panel(_pad_title(scene, pad), _MILLISECONDS, "force (N)", lines))
    return Chart("contact-forces", panels, columns=2 if len(panels) > 1 else 1, height=250)


def _pad_title(scene: Scene, pad: int) -> str:
    x, y, z = (f"{1e3 * place:.4g}" for place in scene.pads[pad].position)
    return f"pad {pad + 1} at x {x}, y {y}, z {z} mm"


_LEDGER_COLOURS = dict(
    zip(
        ledger.ENTRIES,
        (NAVY, GREY, VERMILION, AMBER, TEAL, "#7b4b94", "#8c6d46", "#b0b5bb", "#5f9ed1", "#c98bb9"),
    )
)


def energy_ledgers(runs: Runs, condition: str) -> Chart:
    """Every entry of both ledgers that is not zero, with the residual, one condition, all models
    except uncalibrated springs."""
    panels = []
    for kind in _COLOURS:
        run = getattr(runs, kind).get(condition)
        if run is None:
            continue
        for title, entries, unit, factor in (
            ("total", run.energy, "J", 1.0),
            ("transverse", run.transverse_energy, "mJ", 1e3),
        ):
            largest = np.abs(entries).max()
            time = 1e3 * run.time
            lines = [
                Line(time, factor * entries[:, i], name.replace("_", " "), _LEDGER_COLOURS[name])
                for i, name in enumerate(ledger.ENTRIES)
                if np.abs(entries[:, i]).max() > 1e-6 * largest
            ]
            rest = factor * ledger.residual(entries)
            lines.append(Line(time, rest, "residual", "#000000", dash="--"))
            words = f"{title} ledger, {_STYLES[kind][0]}"
            panels.append(Panel(words, _MILLISECONDS, f"energy ({unit})", lines))
    return Chart("energy-ledgers", panels, columns=2, height=290)
