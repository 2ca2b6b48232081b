"""Stage ``montecarlo``: the paper's random errors (Table 3) on the surrogate, with the paper's
1,000 cases and with many more.

Case n depends on the seed and on n alone, so the first 1,000 cases are the same for any number of
cases. The paper gives no numbers of this study: its Figure 9 shows histograms, and its text states
that three drop tests lie within them.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.mechanics.models import COMPLIANT, SPRINGS
from tipoff.scenes.faults import together
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.limits import within
from tipoff.studies.populations import answers, exceedance, population, random_factors, spread
from tipoff.studies.populations.population import Population
from tipoff.studies.populations.random_factors import READINGS, Reading
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study, StudyError

NAME = "montecarlo"
PAPER = 1000  # number of cases in the paper
CASES = 1_000_000
_COMPARED = 10_000  # cases of each reading: enough to detect a distance of 2 %
_FEWEST = 2  # settled cases: a standard deviation needs two
_CONVERGING = (0.5, 0.95, 0.99)
_RATES = (*answers.RATES, answers.TOTAL_RATE)


@dataclass(frozen=True)
class Options:
    """Options of ``tipoff montecarlo``: number of cases, seed, reading of Table 3, ``limits`` in
    the form of ``exceedance.limits``, name of the ``model`` (None: the default)."""

    cases: int = CASES
    seed: int = 1
    reading: Reading = Reading()
    limits: tuple[str, ...] = ("x=5 deg/s", "y=5 deg/s", "z=5 deg/s", "5 deg/s")
    model: str | None = None


def run(study: Study, options: Options = Options()) -> dict:
    """Distribution of every quantity, probabilities above limits (``tails``), convergence, all
    readings, and both surrogates on the same cases.

    Raises SceneError for bad input, and StudyError where fewer than two cases settle.
    """
    limits, source = together(
        lambda: exceedance.limits(options.limits),
        lambda: random_factors.source(study.scene, options.reading, options.cases, options.seed),
    )

    def make() -> tuple[dict, list[Path]]:
        from tipoff.studies.montecarlo import page
        from tipoff.studies.render.document import with_figures

        model = population.surrogate(study, options.model)
        population.require_settling(model, within.without_errors(model))
        found = population.run(study, NAME, model, source)
        if (settled := int(found.settled.sum())) < _FEWEST:
            raise StudyError(
                f"{settled or 'no'} case settled; {found.counts['refused']:,} were refused, for "
                f"the reasons in {found.store}/done"
            )
        made: dict[str, Any] = {
            "asked": STAGE.plain(options),
            "reading": options.reading.words,
            "store": found.store,
            **population.answering(study, found.model),
            "counts": found.counts,
            "settled": settled,
            "confidence": spread.CONFIDENCE,
            "paper_cases": min(PAPER, options.cases),
            "quantities": [quantity_row(item, found) for item in answers.ALL],
            "tails": [_tail(limit, np.degrees(found.results.rate)) for limit in limits],
            "convergence": [
                {"name": item.name, **row}
                for item in _RATES
                for row in spread.convergence(item.of(found.results), _CONVERGING)
            ],
            "readings": _readings(study, options, found),
            "models": compared(study, options, found),
            "models_missing": missing(study),
        }
        return with_figures(made, page.figures, study.path("figures"))

    return STAGE.run(study, options, make)


def fitted(study: Study, _options: object) -> str | None:
    """Key of the calibration, with which both models are compared; None without one."""
    found = calibrate.stored(study)
    return found["key"] if found else None


STAGE = Stage(NAME, __name__, Options, fitted)


def _settled(quantity: answers.Quantity, found: Population, first: int | None = None) -> np.ndarray:
    """Values (m,) of the settled cases among all, or among the ``first`` cases, settled or not."""
    return quantity.of(found.results)[:first][found.settled[:first]]


def quantity_row(quantity: answers.Quantity, found: Population) -> dict:
    """Moments, quantiles and histogram of ``quantity`` over the settled cases, and quantiles over
    those of the paper's first thousand (None without any), in the units of the quantity."""
    values, first = _settled(quantity, found), _settled(quantity, found, PAPER)
    return {
        "name": quantity.name,
        "label": quantity.label,
        "unit": quantity.unit,
        **spread.moments(values),
        "quantiles": spread.quantiles(values),
        "first": spread.quantiles(first) if first.size else None,
        "histogram": spread.histograms(first, values),
    }


def _tail(limit: exceedance.Limit, rates: np.ndarray) -> dict:
    """Number and probability of ``rates`` (n,3), deg/s, above ``limit``, with its bounds."""
    above = exceedance.above(rates, limit)
    count = int(above.sum())
    low, high = exceedance.bounds(count, len(rates), spread.CONFIDENCE)
    return {
        "limit": limit.words,
        **limit._asdict(),
        "above": count,
        "cases": len(rates),
        "share": count / len(rates),
        "low": low,
        "high": high,
    }


def _readings(study: Study, options: Options, found: Population) -> list[dict]:
    """Each reading with its own seed and the modes of the study, compared with the cases of the study;
    the row of the same reading is the control. Without enough settled cases, ``rates`` and ``distance``
    are None."""
    rows, cases = [], min(_COMPARED, options.cases)
    here = [_settled(item, found, cases) for item in _RATES]
    for place, reading in enumerate(READINGS):
        if reading.needs_contact and study.scene.contact is None:
            continue
        drawn = random_factors.source(study.scene, reading, cases, options.seed + 1 + place)
        other = population.run(study, f"{NAME}-reading", found.model, drawn)
        values = [_settled(item, other) for item in _RATES]
        rows.append(
            {
                "reading": reading.words,
                "same": reading == options.reading,
                "cases": cases,
                "settled": int(other.settled.sum()),
                **_apart(here, values),
            }
        )
    return rows


def _apart(here: list[np.ndarray], values: list[np.ndarray]) -> dict:
    enough = values[0].size >= _FEWEST
    distance, chance = (
        spread.apart(here, values) if enough and here[0].size >= _FEWEST else (None, None)
    )
    return {
        "distance": distance,
        "chance": chance,
        "rates": [
            {"name": item.name, **spread.moments(each), "quantiles": spread.quantiles(each)}
            for item, each in zip(_RATES, values)
        ]
        if enough
        else None,
    }


def missing(study: Study) -> str:
    """Why there are no ``compared`` models; empty where there are."""
    if study.scene.contact is None:
        return "without contact both models are the same"
    return (
        ""
        if calibrate.stored(study)
        else "no calibration of this scene and code (tipoff calibrate)"
    )


def compared(study: Study, options: Options, found: Population) -> dict | None:
    """The first 1,000 cases with springs and with compliant contact. None without contact, where
    both are the same model, and without a calibration for the scene. ``quantities`` is empty where
    no case settled in both models. ``modes`` and ``modes_why``: those of the other model."""
    if missing(study):
        return None
    cases = min(PAPER, options.cases)
    drawn = random_factors.source(study.scene, options.reading, cases, options.seed)
    names = (SPRINGS, COMPLIANT) if found.model.name == SPRINGS else (COMPLIANT, SPRINGS)
    other = population.run(study, f"{NAME}-other", population.surrogate(study, names[1]), drawn)
    both = found.settled[:cases] & other.settled
    rows = []
    for item in answers.ALL if both.any() else ():
        one, two = item.of(found.results)[:cases][both], item.of(other.results)[both]
        apart = np.abs(two - one)
        rows.append(
            {
                "name": item.name,
                "label": item.label,
                "unit": item.unit,
                "root_mean_square": float(np.sqrt((apart**2).mean())),
                "quantiles": spread.quantiles(apart, (0.5, 0.95, 0.99)),
                "most": float(apart.max()),
                **{
                    name: spread.quantiles(values, (0.5, 0.95, 0.99))
                    for name, values in zip(names, (one, two))
                },
            }
        )
    pairs = {
        item.name: {
            name: np.round(item.of(results)[:cases][both], 4).tolist()
            for name, results in zip(names, (found.results, other.results))
        }
        for item in _RATES
    }
    return {
        "cases": cases,
        "both_settled": int(both.sum()),
        "modes": other.model.modes,
        "modes_why": other.model.modes_why,
        "quantities": rows,
        "pairs": pairs,
    }
