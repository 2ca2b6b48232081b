"""The pad faces that touch a wall: the first one, and the one with the largest impulse.

An ensemble keeps no pad forces, so single runs of ``lowfi.run`` are made on a coarser grid of directions.
A face has the normal of the pad, so a face "-y" presses on the wall at -y.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from tipoff import lowfi
from tipoff.lowfi.numerics import Numerics
from tipoff.mechanics import instant
from tipoff.scenes.scene import Scene
from tipoff.studies.populations.population import TOLERANCE, Surrogate

NONE = -1  # no face touched


class Sides(NamedTuple):
    """Number of the face that touched first and of the face with the largest impulse, (n,) each,
    ``NONE`` without contact; rates (n,3) in rad/s at the
    instant of the model, NaN where a run has none."""

    first: np.ndarray
    most: np.ndarray
    rate: np.ndarray


def names(scene: Scene) -> list[str]:
    """Faces in the order of the pad forces: end of the payload and normal, such as "rear -y"."""
    middle = np.mean([pad.position[0] for pad in scene.pads])
    return [
        f"{'rear' if pad.position[0] < middle else 'front'} {normal}"
        for pad in scene.pads
        for normal in pad.normals
    ]


def found(
    model: Surrogate, rows: list[dict[str, float]], workers: int, progress: Callable[[float], None]
) -> Sides:
    """Sides of every row of overrides of ``model.scene``; ``progress`` is called with the share
    done."""
    numerics = Numerics.of_many(TOLERANCE, model.modes, model.name)

    def one(row: dict[str, float]) -> tuple[int, int, list[float]]:
        run = lowfi.run(
            model.scene.replace(row), model.name, numerics=numerics, compliance=model.compliance
        )
        rate = instant.rate(run.outcome, model.instant.at) or [np.nan] * 3
        return *touched(run.time, np.linalg.norm(run.pad_force, axis=2)), rate

    seen = []
    with ThreadPoolExecutor(workers) as pool:
        for item in pool.map(one, rows):
            seen.append(item)
            progress(len(seen) / len(rows))
    return Sides(*map(np.array, zip(*seen)))


def touched(time: np.ndarray, force: np.ndarray) -> tuple[int, int]:
    """First and most loaded face from forces (t,f) in N at ``time`` (t,) s."""
    touched = force > 0.0
    if not touched.any():
        return NONE, NONE
    began = np.where(touched.any(axis=0), touched.argmax(axis=0), len(time))
    # If several faces touch within one sample, such as both legs of a corner, the face with the
    # largest force counts.
    earliest = np.flatnonzero(began == began.min())
    first = earliest[np.argmax(force[began.min(), earliest])]
    return int(first), int(np.argmax(np.trapezoid(force, time, axis=0)))


def jumps(walls: np.ndarray, rate: np.ndarray) -> tuple[float | None, float | None]:
    """Median change of the ``rate`` (s,a,3), in its unit, between neighbours in size or direction:
    with different labels ``walls`` (s,a), and with equal labels. The directions are the second
    axis. None without such a pair."""
    differing, moves = [], []
    for one, other in (
        (np.s_[:-1], np.s_[1:]),
        (np.s_[:, :], (slice(None), np.arange(walls.shape[1]) - 1)),
    ):
        differing.append((walls[one] != walls[other]).ravel())
        moves.append(np.linalg.norm(rate[one] - rate[other], axis=2).ravel())
    changed, moved = np.concatenate(differing), np.concatenate(moves)
    settled = np.isfinite(moved)
    there, elsewhere = (
        float(np.median(moved[chosen & settled])) if (chosen & settled).any() else None
        for chosen in (changed, ~changed)
    )
    return there, elsewhere
