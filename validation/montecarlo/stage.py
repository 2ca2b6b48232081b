"""Stage ``montecarlo``: the paper's random errors (Table 3), or those of a file, on the surrogate, with the
paper's 1,000 cases and with many more.

Case n depends on the seed and on n alone, so the first 1,000 cases are the same for any number of
cases. The paper gives no numbers of this study: its Figure 9 shows histograms, and its text states
that three drop tests lie within them.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.faults import together
from tipoff.mechanics.model_names import COMPLIANT, SPRINGS
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.limits import within
from tipoff.studies.populations import answers, exceedance, population, random_factors, spread
from tipoff.studies.populations.population import Population
from tipoff.studies.populations.random_factors import READINGS
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study, StudyError
from validation.montecarlo import cases
from validation.montecarlo.options import Cases
from validation.montecarlo.results import (
    Compared,
    Converging,
    Difference,
    Distribution,
    MonteCarlo,
    ReadingRow,
    Spread,
    Tail,
)

NAME = "montecarlo"
PAPER = 1000  # number of cases in the paper
_COMPARED = 10_000  # cases of each reading: enough to detect a distance of 2 %
_FEWEST = 2  # settled cases: a standard deviation needs two
_SHARES = (0.5, 0.95, 0.99)
_RATES = (*answers.RATES, answers.TOTAL_RATE)


def run(study: Study, options: Cases = Cases()) -> Made[MonteCarlo]:
    """The rates under random errors.

    Raises SceneError for bad input, and StudyError where fewer than two cases settle.
    """
    limits, source = together(
        lambda: exceedance.limits(options.limits),
        lambda: cases.source(study.scene, options, options.cases),
    )

    def make() -> tuple[MonteCarlo, list[Path]]:
        from tipoff.studies.render.document import with_figures
        from validation.montecarlo import page

        model = population.surrogate(study, options.model)
        population.require_settling(model, within.without_errors(model))
        found = population.run(study, NAME, model.watched(options.at), source)
        if (settled := int(found.settled.sum())) < _FEWEST:
            raise StudyError(
                f"{settled or 'no'} case settled; {found.counts['refused']:,} were refused, for "
                f"the reasons in {found.store}/done"
            )
        made = MonteCarlo(
            **population.answering(study, found.model),
            asked=options,
            reading=cases.words(study.scene, options),
            store=found.store,
            counts=found.counts,
            settled=settled,
            confidence=spread.CONFIDENCE,
            paper_cases=min(PAPER, options.cases),
            quantities=tuple(distribution(item, found) for item in answers.ALL),
            tails=tuple(_tail(limit, np.degrees(found.results.rate)) for limit in limits),
            convergence=tuple(
                Converging(**vars(quantile), name=item.name, cases=count)
                for item in _RATES
                for count, quantile in spread.convergence(item.of(found.results), _SHARES)
            ),
            readings=() if options.vary else tuple(_readings(study, options, found)),
            models=compared(study, options, found),
            models_missing=missing(study),
        )
        return with_figures(made, page.figures, study.path("figures"))

    return STAGE.run(study, options, make)


def inputs(study: Study, options: Cases) -> Any:
    """Key of the calibration, with which both models are compared, None without one; with the errors of a
    file, if one is given."""
    found = calibrate.stored(study)
    key = found.key if found else None
    return (more | {"calibration": key}) if (more := cases.inputs(study.scene, options)) else key


STAGE = Stage(NAME, __name__, options=Cases, inputs=inputs, result=MonteCarlo)


def _settled(quantity: answers.Quantity, found: Population, first: int | None = None) -> np.ndarray:
    """Values (m,) of the settled cases among all, or among the ``first`` cases, settled or not."""
    return quantity.of(found.results)[:first][found.settled[:first]]


def distribution(quantity: answers.Quantity, found: Population) -> Distribution:
    """The distribution of ``quantity`` over the settled cases."""
    values, first = _settled(quantity, found), _settled(quantity, found, PAPER)
    return Distribution(
        **vars(spread.moments(values)),
        **quantity.named,
        quantiles=spread.quantiles(values),
        first=spread.quantiles(first) if first.size else None,
        histogram=spread.histograms(first, values),
    )


def _tail(limit: exceedance.Limit, rates: np.ndarray) -> Tail:
    """Number and probability of ``rates`` (n,3), deg/s, above ``limit``."""
    count = int(exceedance.above(rates, limit).sum())
    low, high = exceedance.bounds(count, len(rates), spread.CONFIDENCE)
    return Tail(
        **vars(limit),
        limit=limit.words,
        above=count,
        cases=len(rates),
        share=count / len(rates),
        low=low,
        high=high,
    )


def _readings(study: Study, options: Cases, found: Population) -> Iterator[ReadingRow]:
    """Each reading with its own seed and the modes of the study, compared with the cases of the study;
    the row of the same reading is the control."""
    count = min(_COMPARED, options.cases)
    here = [_settled(item, found, count) for item in _RATES]
    for place, reading in enumerate(READINGS):
        if reading.needs_contact and study.scene.contact is None:
            continue
        drawn = random_factors.source(study.scene, reading, count, options.seed + 1 + place)
        other = population.run(study, f"{NAME}-reading", found.model, drawn)
        values = [_settled(item, other) for item in _RATES]
        enough = values[0].size >= _FEWEST
        distance, chance = (
            spread.apart(here, values) if enough and here[0].size >= _FEWEST else (None, None)
        )
        rates = (
            Spread(**vars(spread.moments(each)), name=item.name, quantiles=spread.quantiles(each))
            for item, each in zip(_RATES, values)
        )
        yield ReadingRow(
            reading=reading.words,
            same=reading == options.reading,
            cases=count,
            settled=int(other.settled.sum()),
            distance=distance,
            chance=chance,
            rates=tuple(rates) if enough else None,
        )


def missing(study: Study) -> str:
    """Why there are no ``compared`` models; empty where there are."""
    if study.scene.contact is None:
        return "without contact both models are the same"
    return (
        ""
        if calibrate.stored(study)
        else "no calibration of this scene and code (tipoff calibrate)"
    )


def compared(study: Study, options: Cases, found: Population) -> Compared | None:
    """The first 1,000 cases with springs and with compliant contact. None without contact, where
    both are the same model, and without a calibration for the scene."""
    if missing(study):
        return None
    count = min(PAPER, options.cases)
    drawn = cases.source(study.scene, options, count)
    names = (SPRINGS, COMPLIANT) if found.model.name == SPRINGS else (COMPLIANT, SPRINGS)
    own = population.surrogate(study, names[1])._replace(instant=found.model.instant)
    other = population.run(study, f"{NAME}-other", own, drawn)
    both = found.settled[:count] & other.settled

    def of(item: answers.Quantity) -> dict[str, np.ndarray]:
        results = (found.results, other.results)
        return {name: item.of(each)[:count][both] for name, each in zip(names, results)}

    return Compared(
        cases=count,
        both_settled=int(both.sum()),
        modes=other.model.modes,
        modes_why=other.model.modes_why,
        quantities=tuple(_difference(item, of(item)) for item in answers.ALL) if both.any() else (),
        pairs={
            item.name: {
                name: tuple(np.round(values, 4).tolist()) for name, values in of(item).items()
            }
            for item in _RATES
        },
    )


def _difference(item: answers.Quantity, values: dict[str, np.ndarray]) -> Difference:
    apart = np.abs(values[SPRINGS] - values[COMPLIANT])
    return Difference(
        **item.named,
        root_mean_square=float(np.sqrt((apart**2).mean())),
        quantiles=spread.quantiles(apart, _SHARES),
        most=float(apart.max()),
        springs=spread.quantiles(values[SPRINGS], _SHARES),
        compliant=spread.quantiles(values[COMPLIANT], _SHARES),
    )
