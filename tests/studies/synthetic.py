"""Trajectories with closed forms, for tests that need a result without a run, and files that take no
time to write."""

from pathlib import Path

import numpy as np
import pytest

from tests.in_memory import memory
from tipoff.mechanics import ledger
from tipoff.mechanics.outcome import Outcome
from tipoff.results.trajectory import Trajectory
from tipoff.studies.render import chart
from tipoff.workspace import store

COSTS = {  # of a run of the reference
    "wall_s": 1.0,
    "compile_s": 0.0,
    "steps": 1,
    "dt_s": 1e-6,
    "elements": 1,
    "ns_per_element_step": 1.0,
    "ns_per_element_stepped": 2.0,
}


def flight(
    rate=None,
    velocity_x=None,
    duration=0.03,
    samples=601,
    model="finite-elements",
    status="exited",
    **parts,
) -> Trajectory:
    """A payload that settles in the last 2 ms: ``rate(t)`` -> (n,3) rad/s and ``velocity_x(t)`` ->
    (n,) m/s."""
    time = np.linspace(0.0, duration, samples)
    rates = np.zeros((samples, 3)) if rate is None else rate(time)
    velocity = np.zeros((samples, 3))
    velocity[:, 0] = 6.0 * time / duration if velocity_x is None else velocity_x(time)
    turn = np.tile([1.0, 0.0, 0.0, 0.0], (samples, 1))
    zeros = np.zeros((samples, 3))
    settled = (
        Outcome(
            duration - 3e-3,
            duration - 2e-3,
            velocity[-40:].mean(axis=0).tolist(),
            rates[-40:].mean(axis=0).tolist(),
            0.0,
            0.0,
            [0.0, 0.0, 0.0],
        )
        if status == "exited"
        else Outcome()
    )
    energy = np.zeros((samples, len(ledger.ENTRIES)))
    entries = dict(
        model=model,
        status=status,
        time=time,
        position=zeros,
        velocity=velocity,
        quaternion=turn,
        rate=rates,
        platform_position=zeros,
        platform_velocity=zeros,
        platform_quaternion=turn,
        platform_rate=zeros,
        pad_force=np.zeros((samples, 16, 3)),
        energy=energy,
        transverse_energy=energy,
        outcome=settled,
        checks={},
        cost={"wall_s": 1.0, "compile_s": 0.0, "steps": 100, "dt_s": 1e-4},
        scene={},
    )
    return Trajectory(**entries | parts)


def kept_in_memory(patch: pytest.MonkeyPatch) -> None:
    """Trajectories are kept in memory beside empty files: to write one takes 0.08 s."""
    patch.setattr(store, "RUNS", memory())


def undrawn(patch: pytest.MonkeyPatch, laid_out: bool = False) -> None:
    """Figures are made and not drawn; their files are empty. To draw one takes half a second. With
    ``laid_out``, a quarter of it, everything in them is placed, of which most faults are seen."""

    def save(figure, stem, made):
        if laid_out:
            figure.draw_without_rendering()
        return [_touched(stem.with_name(f"{stem.name}.{kind}")) for kind in ("png", "svg")]

    patch.setattr(chart, "save", save)


def _touched(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()
    return path
