"""Predicted launches with the errors of a scene, by the quantities of the measured ones.

Each case is one run of the surrogate. The start of a run is where its acceleration along the rail passes the rise
that counts as the start of the record.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np

from tipoff import lowfi
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.results.trajectory import Trajectory
from tipoff.studies.measured.launch.analysis import Launched
from tipoff.studies.measured.launch.quantities import BY_AXIS, blurred, over_way
from tipoff.studies.populations import population
from tipoff.studies.populations.population import Surrogate
from tipoff.workspace.progress import Board
from tipoff.workspace.study import Study, StudyError

_FEWEST = 20  # cases with an exit
_SEED = 20231


class Predicted(NamedTuple):
    """Quantities of the cases with an exit, by name, for each launch; their rates without noise (c,n,3) rad/s at
    the instants of each record; number of cases without an exit; the ``model`` with its modes."""

    quantities: list[list[dict[str, float]]]
    rates: list[np.ndarray]
    lost: int
    model: Surrogate


def run(
    study: Study, name: str, asked: Surrogate, drawn: Drawn, launches: Sequence[Launched]
) -> Predicted:
    """Every case of ``drawn`` on the model ``asked``. Raises StudyError if too few leave the rail."""
    model = asked.with_modes_of(population.chosen_modes(name, asked.ensemble(drawn)))
    numerics = model.numerics(population.TOLERANCE)

    def one(case: tuple[int, dict[str, Any]]) -> list[tuple[dict[str, float], np.ndarray]] | None:
        number, row = case
        scene = model.scene.replace(row)
        found = lowfi.run(scene, model.name, numerics=numerics, compliance=model.compliance)
        seen = [seen_in(found, own, [_SEED, number, which]) for which, own in enumerate(launches)]
        return None if None in seen else seen  # type: ignore[return-value]

    rows = list(enumerate(drawn.rows(0, drawn.asked)))
    with Board(name, 1) as board:
        report = board.callback(f"{name}, {drawn.asked:,} launches")
        every = _all(one, rows, study.settings.workers, report)
    kept = [each for each in every if each is not None]
    if len(kept) < _FEWEST:
        raise StudyError(
            f"only {len(kept)} of {drawn.asked} predicted launches left the rail; at least {_FEWEST} are needed"
        )
    return Predicted(
        [[each[which][0] for each in kept] for which in range(len(launches))],
        [np.array([each[which][1] for each in kept]) for which in range(len(launches))],
        len(every) - len(kept),
        model,
    )


def _all(one: Callable, rows: list, workers: int, report: Callable[[float], None]) -> list:
    found = []
    with ThreadPoolExecutor(workers) as pool:
        for each in pool.map(one, rows):
            found.append(each)
            report(len(found) / len(rows))
    return found


def seen_in(
    run: Trajectory, own: Launched, seed: Sequence[int]
) -> tuple[dict[str, float], np.ndarray] | None:
    """The quantities of a ``run`` as the sensor of a launch would have measured them, and its rates (n,3) rad/s
    at the instants of the record without noise; None if it does not leave the rail."""
    out = run.outcome
    if (
        run.status != "exited"
        or out.exit_time is None
        or not out.exit_rate
        or not out.exit_velocity
    ):
        return None
    risen = np.flatnonzero(np.gradient(run.velocity[:, 0], run.time) > own.rise)
    if not risen.size:
        return None
    start, record = float(run.time[risen[0]]), own.record
    clean = np.column_stack([np.interp(record.time + start, run.time, one) for one in run.rate.T])
    clean[record.time < 0.0] = 0.0
    generator = np.random.default_rng(list(seed))
    left = (out.exit_time - start, out.exit_velocity[0])
    found = blurred(own.stated, left, np.array(out.exit_rate), generator)
    return found | over_way(record, clean + record.shaken(generator), BY_AXIS), clean
