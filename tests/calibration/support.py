"""Scenes with given constants, and a search small enough for a test."""

import functools
from pathlib import Path

import numpy as np

from tipoff import lowfi, scenes
from tipoff.calibration.search import Plan
from tipoff.results.trajectory import Trajectory

CONDITIONS = ("phi15", "phi60")
SMALL = Plan(points=32, starts=1, evaluations=80, polish=12)
# Force at 0.02 mm 300 N, e 1.3, and damping that a few micrometres of penetration can show.
TRUTH = {
    "contact.exponent": 1.3,
    "contact.stiffness": 300.0 / 2e-5**1.3,
    "contact.damping": 6000.0,
    "friction.static": 0.13,
    "friction.dynamic": 0.13,
}


@functools.cache
def scene() -> scenes.Scene:
    """The reference scene with two conditions to fit, its constants wrong by 30 % and more; d has
    its true value."""
    return scenes.load("clamped").replace(
        {
            "agreement.fitted": list(CONDITIONS),
            "contact.damping_depth": "0.05 mm",
            "contact.damping": "3 N*s/mm",
        }
    )


@functools.cache
def own_curves() -> dict[str, Trajectory]:
    """The surrogate's own runs with the true constants."""
    return {
        name: lowfi.run(scene().replace(TRUTH).condition(name), "springs") for name in CONDITIONS
    }


def write_curves(path: Path, run: Trajectory, keep: slice | np.ndarray = slice(None)) -> Path:
    """A CSV file of samples of a run in units of a test stand, as another code would write it, with
    a column that is not needed."""
    columns = np.column_stack(
        [1e3 * run.time, run.velocity[:, 0], np.degrees(run.rate), np.zeros(run.time.size)]
    )[keep]
    lines = [",".join(f"{value:.12g}" for value in row) for row in columns]
    header = "time [ms], velocity_x [m/s], rate_x [deg/s], rate_y [deg/s], rate_z [deg/s], shock"
    path.write_text("\n".join([header, *lines]) + "\n")
    return path


def correlated(generator, samples: int, rho: float) -> np.ndarray:
    """Noise of variance 1 whose neighbours are correlated by rho, begun in its steady state."""
    fresh = generator.standard_normal(samples) * np.sqrt(1.0 - rho**2)
    fresh[0] /= np.sqrt(1.0 - rho**2)
    for i in range(1, samples):
        fresh[i] += rho * fresh[i - 1]
    return fresh
