"""Conditions that no single run can judge: both models on neighbours of the condition within 1 um.

A condition is judged as a distribution where its reference is not converged, or where 1 um of clearance
moves a settled rate of the reference by more than the limit of agreement (sensitive). Both models stand
on the coarse mesh, the surrogate with the rail compliance of that mesh, so that the mesh is no part of
their difference. ``agreement.neighbours`` draws, ``agreement.equivalence`` judges.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Protocol

import numpy as np

from tipoff import lowfi
from tipoff.mechanics.models import FINITE_ELEMENTS
from tipoff.mechanics.trajectory import Trajectory
from tipoff.studies.agreement import equivalence, neighbours, verdicts
from tipoff.studies.agreement.growth import Growth
from tipoff.workspace.announcing import announce
from tipoff.workspace.progress import Board
from tipoff.workspace.run import Run
from tipoff.workspace.study import Study

FURTHER = 8  # draws of the surrogates beside each of the reference; more would add little
_CURVE = tuple(round(0.01 * share, 2) for share in range(1, 100))  # of distributions that are drawn
_STABLE_SHARE = 4  # a reference that 1 um does not move much needs fewer neighbours
_LEAST = 5  # fewer do not enclose a median
_FORETOLD = 20


class Surrogate(Protocol):
    """A surrogate that is compared (``stage.Candidate``)."""

    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    def request(self, study: Study, condition: str) -> Run: ...


def counts(
    rows: Iterable[dict], growths: Iterable[Growth], undecided: Iterable[str], draws: int
) -> dict[str, int]:
    """Number of neighbours by condition, for those that are judged as distributions: ``draws``, or a
    quarter where the reference is not converged though 1 um does not move it by more than the limit.
    ``undecided`` conditions, which no single run can judge either, were found elsewhere."""
    found = {item.condition: item for item in growths if item.model == FINITE_ELEMENTS}
    # one whose twin did not settle counts as sensitive
    sensitive = {name for name, item in found.items() if item.sensitive is not False}
    sensitive |= set(undecided)
    few = max(_LEAST, draws // _STABLE_SHARE)
    return {
        row["condition"]: draws if row["condition"] in sensitive else few
        for row in rows
        if row["condition"] in sensitive or not row["reference_converged"]
    }


def judge(
    study: Study, wanted: Mapping[str, int], surrogates: Sequence[Surrogate], limit: float
) -> list[dict]:
    """The distributions of each condition with its verdicts, as result files hold them; ``limit``
    (deg/s) is that of the settled rates. The surrogates stand on the coarse mesh."""
    distance = study.settings.clearance_change
    possible = {
        name: count
        for name, count in wanted.items()
        if neighbours.possible(study.condition(name), distance)
    }
    drawn = {
        name: neighbours.draw(study.condition(name), distance, (1 + FURTHER) * count)
        for name, count in possible.items()
    }
    reference = _reference(study, possible, drawn)
    found = []
    with Board("neighbours, surrogates", len(possible)) as board:
        for name, count in possible.items():
            own = {
                item.name: _settled(study, item, name, drawn[name], board) for item in surrogates
            }
            titles = {item.name: item.title for item in surrogates}
            found.append(_judged(name, reference[name], own, titles, limit))
            board.finished(name, f"{(1 + FURTHER) * count} draws of each model")
    return found


def _reference(
    study: Study, wanted: Mapping[str, int], drawn: Mapping[str, list[dict]]
) -> dict[str, np.ndarray]:
    """Settled rates (n,3) deg/s of the reference on the neighbours of each condition; NaN where a run
    did not settle."""
    runs = {
        name: [
            study.coarse(name, drawn[name][number], f"-neighbour-{number}")
            for number in range(count)
        ]
        for name, count in wanted.items()
    }
    every = [run for own in runs.values() for run in own]
    announce(study, every)
    made = iter(study.store.fill("neighbours", every))
    return {name: np.array([_rates(next(made)) for _ in own]) for name, own in runs.items()}


def _rates(run: Trajectory) -> list[float]:
    rate = run.outcome.rate
    return [float("nan")] * 3 if rate is None else np.degrees(rate).tolist()


def _settled(
    study: Study, surrogate: Surrogate, condition: str, drawn: list[dict], board: Board
) -> np.ndarray:
    """Settled rates (n,3) deg/s of a surrogate on every draw; NaN where a case did not settle."""
    run = surrogate.request(study, condition)
    board.callback(f"{condition}, {surrogate.title}")(0.0)
    cases = lowfi.run_many(
        run.scene,
        drawn,
        run.model,
        compliance=run.compliance,
        calibration=run.calibration,
        numerics=run.numerics,
        workers=study.settings.workers,
    )
    return np.degrees(cases["rate"].values)


def _judged(
    name: str,
    reference: np.ndarray,
    surrogates: Mapping[str, np.ndarray],
    titles: Mapping[str, str],
    limit: float,
) -> dict:
    return {
        "condition": name,
        "neighbours": len(reference),
        "further": FURTHER * len(reference),
        "limit_deg_s": limit,
        "reference_deg_s": np.round(reference, 7).tolist(),
        "models": {
            model: {"title": titles[model], **_model(reference, rates, limit)}
            for model, rates in surrogates.items()
        },
    }


def _model(reference: np.ndarray, rates: np.ndarray, limit: float) -> dict:
    """Verdict on one surrogate, its comparisons, and the curves of its distribution."""
    count = len(reference)
    settled = rates[np.isfinite(rates).all(axis=1)]
    curve = np.quantile(settled, _CURVE, axis=0).T.tolist() if len(settled) else None
    if lost := _lost(reference):
        word = verdicts.CANNOT
        why = f"{lost} of {count} neighbours did not settle in the reference"
        return _entry(word, f"{word}: {why}", [], curve)
    for part, most in ((rates[:count], 0.0), (rates, len(rates) / count)):
        if (lost := _lost(part)) > most:
            word, why = verdicts.MISSES, f"{lost} of {len(part)} neighbours did not settle"
            return _entry(word, f"{word}: {why}", [], curve)
    further = rates[count:][np.isfinite(rates[count:]).all(axis=1)]
    found = equivalence.compare(reference, rates[:count], further, limit)
    word = {
        equivalence.AGREES: verdicts.AS_DISTRIBUTION,
        equivalence.MISSES: verdicts.MISSES,
        equivalence.UNKNOWN: verdicts.CANNOT,
    }[equivalence.verdict(found)]
    return _entry(word, f"{word}{_why(word, found, count)}", found, curve)


def _lost(rates: np.ndarray) -> int:
    """How many neighbours (rows of ``rates``) did not settle."""
    return int((~np.isfinite(rates).all(axis=1)).sum())


def _entry(word: str, words: str, found: list[equivalence.Comparison], curve: list | None) -> dict:
    return {
        "judgement": word,
        "verdict": words,
        "comparisons": [asdict(item) for item in found],
        "quantiles": {"shares": list(_CURVE), "rates_deg_s": curve},
    }


def _why(word: str, found: list[equivalence.Comparison], draws: int) -> str:
    """What decides a verdict, as text behind its word."""
    if word == verdicts.AS_DISTRIBUTION:
        return ""
    shown = [item for item in found if item.shown]
    if word == verdicts.MISSES and not shown:
        widest = max(found, key=lambda item: item.bound)
        return f": {_place(widest)} within {widest.bound:.3g} x margin only"
    if word == verdicts.MISSES:
        worst = max(shown, key=lambda item: abs(item.difference_deg_s) / item.margin_deg_s)
        times = abs(worst.difference_deg_s) / worst.margin_deg_s
        return f": {_place(worst)} {times:.3g} x margin"
    worst = max(found, key=lambda item: item.width)
    needed = equivalence.needed(found, draws)
    # far beyond, the width of so few draws foretells nothing
    words = f"up to {needed}" if needed <= _FORETOLD * draws else f"more than {_FORETOLD * draws}"
    return (
        f": with {draws} neighbours the {_place(worst)} of the reference is uncertain by "
        f"{worst.width:.2g} x margin; {words} are needed"
    )


def _place(item: equivalence.Comparison) -> str:
    share = "median" if item.share == 0.5 else f"{100.0 * item.share:g} % quantile"
    return f"{share} of rate {item.axis}"


def combined(
    rows: Iterable[dict], found: Iterable[dict], wanted: Iterable[str], model: str
) -> list[dict]:
    """Rows of the agreement table of a ``model`` with the verdicts on distributions. A condition that
    was ``wanted`` and has none cannot be judged."""
    own = {item["condition"]: item["models"][model] for item in found}
    asked = set(wanted)
    return [
        row
        if row["condition"] not in asked
        else row | {"judged_as": verdicts.DISTRIBUTION} | _words(own.get(row["condition"]))
        for row in rows
    ]


def _words(entry: dict | None) -> dict[str, str]:
    if entry is None:
        return {
            "judgement": verdicts.CANNOT,
            "verdict": f"{verdicts.CANNOT}: no clearance for neighbours",
        }
    return {"judgement": entry["judgement"], "verdict": entry["verdict"]}
