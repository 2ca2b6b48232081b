"""Conditions that no single run can judge: both models on neighbours of the condition within 1 um.

A condition is judged as a distribution if its reference is not converged, or if 1 um of clearance changes
a settled rate of the reference by more than the limit of agreement (sensitive). Both models use the
coarse mesh, the surrogate by the rail compliance of this mesh, so the mesh adds nothing to their
difference. ``agreement.neighbours`` draws, ``agreement.equivalence`` judges.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from tipoff import lowfi
from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.results.trajectory import Trajectory
from tipoff.studies.agreement import equivalence, neighbours, verdicts
from tipoff.studies.agreement.equivalence import Comparison
from tipoff.studies.agreement.growth import Growth
from tipoff.studies.agreement.verdicts import JudgedCondition
from tipoff.workspace.announcing import announce
from tipoff.workspace.progress import Board
from tipoff.workspace.study import Study

if TYPE_CHECKING:
    from tipoff.studies.agreement.candidates import Candidate

FURTHER = 8  # further draws of a surrogate for each draw of the reference; more would add little
_CURVE = tuple(round(0.01 * share, 2) for share in range(1, 100))  # of distributions that are drawn
_STABLE_SHARE = 4  # divisor of the number of neighbours if 1 um changes the reference little
_LEAST = 5  # fewer give no bounds of a median
_FORETOLD = 20


@dataclass(frozen=True)
class Quantiles:
    """Distribution of the settled rates of a surrogate: ``rates_deg_s`` of x, y and z at the
    ``shares``, None if no case settled."""

    shares: list[float]
    rates_deg_s: list[list[float]] | None


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """Verdict on one surrogate, called ``title``; ``comparisons`` is empty if cases did not settle."""

    title: str
    judgement: str
    verdict: str
    comparisons: list[Comparison]
    quantiles: Quantiles

    @property
    def worst(self) -> Comparison | None:
        """The comparison with the largest bound."""
        return max(self.comparisons, key=lambda item: item.bound, default=None)


@dataclass(frozen=True, kw_only=True)
class Distribution:
    """Settled rates of the reference on the ``neighbours`` of one condition, None where one did not
    settle, and the verdicts on surrogates by name. Surrogates also ran ``further`` neighbours.
    ``limit_deg_s`` is the smallest margin."""

    condition: str
    neighbours: int
    further: int
    limit_deg_s: float
    reference_deg_s: list[list[float] | None]
    models: dict[str, Verdict]

    @property
    def settled_deg_s(self) -> list[list[float]]:
        """The rates of the neighbours that settled in the reference."""
        return [rates for rates in self.reference_deg_s if rates is not None]

    def within(self, measure: Callable[[Sequence[float]], float]) -> tuple[float, float]:
        """The smallest and the largest ``measure`` of the settled rates of the reference."""
        found = [measure(rates) for rates in self.settled_deg_s]
        return min(found), max(found)


def counts(
    rows: Iterable[JudgedCondition], growths: Iterable[Growth], undecided: Iterable[str], draws: int
) -> dict[str, int]:
    """Number of neighbours for each condition that is judged as a distribution: ``draws``, or a
    quarter if the reference is not converged but 1 um does not change it by more than the limit.
    The caller found the ``undecided`` conditions, which no single run can judge either."""
    found = {item.condition: item for item in growths if item.model == FINITE_ELEMENTS}
    # a condition whose twin did not settle counts as sensitive
    sensitive = {name for name, item in found.items() if item.sensitive is not False}
    sensitive |= set(undecided)
    few = max(_LEAST, draws // _STABLE_SHARE)
    return {
        row.condition: draws if row.condition in sensitive else few
        for row in rows
        if row.condition in sensitive or not row.reference_converged
    }


def judge(
    study: Study, wanted: Mapping[str, int], surrogates: "Sequence[Candidate]", limit: float
) -> list[Distribution]:
    """The distributions of each condition with its verdicts; ``limit`` (deg/s) of the settled
    rates. The surrogates have the rail compliance of the coarse mesh."""
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
            of = reference[name]
            found.append(
                Distribution(
                    condition=name,
                    neighbours=count,
                    further=FURTHER * count,
                    limit_deg_s=limit,
                    reference_deg_s=[
                        rates.tolist() if np.isfinite(rates).all() else None
                        for rates in np.round(of, 7)
                    ],
                    models={
                        item.name: _verdict(item.title, of, own[item.name], limit)
                        for item in surrogates
                    },
                )
            )
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
    study: Study, surrogate: "Candidate", condition: str, drawn: list[dict], board: Board
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


def _verdict(title: str, reference: np.ndarray, rates: np.ndarray, limit: float) -> Verdict:
    """Verdict on the surrogate ``title`` with settled ``rates``."""
    count = len(reference)
    settled = rates[np.isfinite(rates).all(axis=1)]
    curve = np.quantile(settled, _CURVE, axis=0).T.tolist() if len(settled) else None

    def said(word: str, why: str, found: list[Comparison] | None = None) -> Verdict:
        return Verdict(
            title=title,
            judgement=word,
            verdict=f"{word}: {why}" if why else word,
            comparisons=found or [],
            quantiles=Quantiles(list(_CURVE), curve),
        )

    if lost := _lost(reference):
        why = f"{lost} of {count} neighbours did not settle in the reference"
        return said(verdicts.CANNOT, why)
    for part, most in ((rates[:count], 0.0), (rates, len(rates) / count)):
        if (lost := _lost(part)) > most:
            return said(verdicts.MISSES, f"{lost} of {len(part)} neighbours did not settle")
    further = rates[count:][np.isfinite(rates[count:]).all(axis=1)]
    found = equivalence.compare(reference, rates[:count], further, limit)
    word = {
        equivalence.AGREES: verdicts.AS_DISTRIBUTION,
        equivalence.MISSES: verdicts.MISSES,
        equivalence.UNKNOWN: verdicts.CANNOT,
    }[equivalence.verdict(found)]
    return said(word, _why(word, found, count), found)


def _lost(rates: np.ndarray) -> int:
    """How many neighbours (rows of ``rates``) did not settle."""
    return int((~np.isfinite(rates).all(axis=1)).sum())


def _why(word: str, found: list[Comparison], draws: int) -> str:
    """The reason for a verdict; empty for agreement."""
    if word == verdicts.AS_DISTRIBUTION:
        return ""
    shown = [item for item in found if item.shown]
    if word == verdicts.MISSES and not shown:
        widest = max(found, key=lambda item: item.bound)
        return f"{_place(widest)} within {widest.bound:.3g} x margin only"
    if word == verdicts.MISSES:
        worst = max(shown, key=lambda item: abs(item.difference_deg_s) / item.margin_deg_s)
        times = abs(worst.difference_deg_s) / worst.margin_deg_s
        return f"{_place(worst)} {times:.3g} x margin{_of_the_model(found)}"
    worst = max(found, key=lambda item: item.width)
    needed = equivalence.needed(found, draws)
    # the width from few draws predicts no larger number
    words = f"up to {needed}" if needed <= _FORETOLD * draws else f"more than {_FORETOLD * draws}"
    return (
        f"with {draws} neighbours the {_place(worst)} of the reference is uncertain by "
        f"{worst.width:.2g} x margin; {words} are needed"
    )


def _of_the_model(found: list[Comparison]) -> str:
    """Words for a median that differs by more than the neighbours of the reference differ among
    themselves: from the 10 to the 90 % quantile. Chaos does not explain such a difference."""
    for axis in equivalence.AXES:
        low, middle, high = (item for item in found if item.axis == axis)
        spread = high.reference_deg_s - low.reference_deg_s
        if middle.shown and abs(middle.difference_deg_s) > spread:
            return (
                f"; a miss of the model, not chaos: the median of rate {axis} differs by "
                f"{abs(middle.difference_deg_s):.2g} deg/s, the neighbours of the reference by "
                f"{spread:.2g}"
            )
    return ""


def _place(item: Comparison) -> str:
    share = "median" if item.share == 0.5 else f"{100.0 * item.share:g} % quantile"
    return f"{share} of rate {item.axis}"


def combined(
    rows: Iterable[JudgedCondition],
    found: Iterable[Distribution],
    wanted: Iterable[str],
    model: str,
) -> list[JudgedCondition]:
    """Rows of the agreement table of a ``model`` with the verdicts on distributions. A ``wanted``
    condition without a distribution cannot be judged."""
    own = {item.condition: item.models[model] for item in found}
    asked = set(wanted)
    return [_as_distribution(row, own) if row.condition in asked else row for row in rows]


def _as_distribution(row: JudgedCondition, own: Mapping[str, Verdict]) -> JudgedCondition:
    judgement, verdict = verdicts.CANNOT, f"{verdicts.CANNOT}: no clearance for neighbours"
    if (found := own.get(row.condition)) is not None:
        judgement, verdict = found.judgement, found.verdict
    return replace(row, judged_as=verdicts.DISTRIBUTION, judgement=judgement, verdict=verdict)
