"""Stage ``montecarlo``: the paper's random errors (Table 3) on the surrogate, its thousand cases
and many more.

Case n is drawn from the seed and n alone, so the paper's thousand are the first of however many
there are. The paper prints no number of its own here: its Figure 9 shows histograms, and its text
says that three drop tests lie within them.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tipoff.mechanics.models import COMPLIANT, SPRINGS
from tipoff.studies.calibration import stage as calibrate
from tipoff.studies.core.checked import together
from tipoff.studies.core.stage import Stage
from tipoff.studies.core.study import Study, StudyError
from tipoff.studies.populations import answers, exceedance, population, random_factors, spread
from tipoff.studies.populations.population import Population, Surrogate
from tipoff.studies.populations.random_factors import READINGS, Reading

NAME = "montecarlo"
PAPER = 1000  # cases of the paper
CASES = 1_000_000
_COMPARED = 10_000  # cases of each reading: differences of 2 % between distributions can be seen
_FEWEST = 2  # settled cases, without which there is no standard deviation
_CONVERGING = (0.5, 0.95, 0.99)
_RATES = (*answers.RATES, answers.TOTAL_RATE)


@dataclass(frozen=True)
class Options:
    """What ``tipoff montecarlo`` is given beside the scene; ``limits`` as ``exceedance.limits``
    reads them; the name of a ``model``, None for the default."""

    cases: int = CASES
    seed: int = 1
    reading: Reading = Reading()
    limits: tuple[str, ...] = ("x=5 deg/s", "y=5 deg/s", "z=5 deg/s", "5 deg/s")
    model: str | None = None


def run(study: Study, options: Options = Options()) -> dict:
    """Spread of every quantity, tails, convergence, all readings, and both surrogates on the same
    draws; ``summary`` in words.

    Raises SceneError for bad input, StudyError where no case settles.
    """
    limits, source = together(
        lambda: exceedance.limits(options.limits),
        lambda: random_factors.source(study.scene, options.reading, options.cases, options.seed),
    )

    def make() -> tuple[dict, list[Path]]:
        from tipoff.studies.montecarlo import page as pictures
        from tipoff.studies.render.chart import to_files

        model = population.surrogate(study, options.model)
        found = population.run(study, NAME, model, source)
        if (settled := int(found.settled.sum())) < _FEWEST:
            raise StudyError(
                f"{settled or 'no'} case settled, {found.counts['refused']:,} of them refused; the "
                f"reasons are in "
                f"{found.store}/done"
            )
        made: dict[str, Any] = {
            "asked": STAGE.plain(options),
            "reading": options.reading.words,
            "store": found.store,
            **population.answering(study, model),
            "counts": found.counts,
            "settled": settled,
            "confidence": spread.CONFIDENCE,
            "paper_cases": min(PAPER, options.cases),
            "quantities": [_quantity(item, found) for item in answers.ALL],
            "tails": [_tail(limit, np.degrees(found.results.rate)) for limit in limits],
            "convergence": [
                {"name": item.name, **row}
                for item in _RATES
                for row in spread.convergence(item.of(found.results), _CONVERGING)
            ],
            "readings": _readings(study, options, model, found),
            "models": _models(study, options, model.name, found),
        }
        made |= {"findings": _findings(made), "summary": _numbers(made)}
        return made, [
            path
            for chart, _ in pictures.charts(made)
            for path in to_files(chart, study.path("figures"))
        ]

    return STAGE.run(study, options, make)


def _fitted(study: Study, options: Options) -> str | None:
    """Both models are compared where there is a calibration."""
    fitted = calibrate.stored(study)
    return fitted["key"] if fitted else None


STAGE = Stage(NAME, __name__, Options, _fitted)


def _settled(quantity: answers.Quantity, found: Population, first: int | None = None) -> np.ndarray:
    """Values of the settled of all cases, or of the ``first``: a case that did not settle keeps its
    number."""
    return quantity.of(found.results)[:first][found.settled[:first]]


def _quantity(quantity: answers.Quantity, found: Population) -> dict:
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
    """How often ``rates`` (n,3), deg/s, are above ``limit``."""
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


def _readings(study: Study, options: Options, model: Surrogate, found: Population) -> list[dict]:
    """Each reading with a seed of its own beside the cases that were asked for; the row of the same
    reading is the control. Where too few settled there are no rates, and no distance."""
    rows, cases = [], min(_COMPARED, options.cases)
    here = [_settled(item, found, cases) for item in _RATES]
    for place, reading in enumerate(READINGS):
        if reading.initial and study.scene.contact is None:
            continue
        drawn = random_factors.source(study.scene, reading, cases, options.seed + 1 + place)
        other = population.run(study, f"{NAME}-reading", model, drawn)
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


def _models(study: Study, options: Options, model: str, found: Population) -> dict | None:
    """The paper's thousand on springs and on compliant contact; None where no pad can touch, for
    then both are one model, and where no springs were calibrated for the scene. No quantities where
    no case settled on both."""
    if study.scene.contact is None or calibrate.stored(study) is None:
        return None
    cases = min(PAPER, options.cases)
    drawn = random_factors.source(study.scene, options.reading, cases, options.seed)
    other = population.run(
        study,
        f"{NAME}-other",
        population.surrogate(study, SPRINGS if model == COMPLIANT else COMPLIANT),
        drawn,
    )
    both = found.settled[:cases] & other.settled
    names = (SPRINGS, COMPLIANT) if model == SPRINGS else (COMPLIANT, SPRINGS)
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
    return {"cases": cases, "both_settled": int(both.sum()), "quantities": rows, "pairs": pairs}


def _findings(made: dict) -> list[str]:
    """What was run and what it says beside its numbers, one line each."""
    counts, options = made["counts"], made["asked"]
    text = [
        f"{counts['asked']:,} cases = {counts['ok']:,} ok + {counts['refused']:,} refused + "
        f"{counts['failed']:,} failed; {made['settled']:,} settled; seed {options['seed']}",
        population.model_line(made),
        f"errors: {made['reading']}",
    ]
    lost = [row["reading"] for row in made["readings"] if row["distance"] is None]
    text += [f"too few cases settled to compare: {'; '.join(lost)}"] if lost else []
    others = [
        row
        for row in made["readings"]
        if row["reading"] not in lost and row["chance"] < 0.01 and not row["same"]
    ]
    if others_text := "; ".join(
        f"{row['reading']} (distance {row['distance']:.3f})" for row in others
    ):
        text.append(f"readings that can be told from this one: {others_text}")
    elif not lost:
        text.append("no other reading of the table can be told from this one")
    if made["models"] and not made["models"]["quantities"]:
        text.append(
            f"springs against compliant contact on the same {made['models']['cases']:,} draws: "
            f"none settled on both"
        )
    elif made["models"]:
        rates = [row for row in made["models"]["quantities"] if row["unit"] == "deg/s"]
        text.append(
            f"springs against compliant contact on the same {made['models']['cases']:,} draws, "
            f"root mean square: "
            + ", ".join(f"{row['label']} {row['root_mean_square']:.3g}" for row in rates)
            + " deg/s"
        )
    return text


def _numbers(made: dict) -> list[str]:
    """The numbers in words and units."""
    text = []
    for item in made["quantities"]:
        row = next(row for row in item["quantiles"] if row["share"] == 0.99)
        text.append(
            f"{item['label']}: sd {item['sd']:.4g} ± {item['sd_error']:.2g}, 99 % below "
            f"{_in_bounds(row)} {item['unit']}"
        )
    return text + [
        f"{row['limit']}: above it in {row['above']:,} of {row['cases']:,}, probability "
        f"{row['share']:.3g} "
        f"[{row['low']:.3g}, {row['high']:.3g}]"
        for row in made["tails"]
    ]


def _in_bounds(row: dict) -> str:
    low, high = ("none" if row[side] is None else f"{row[side]:.4g}" for side in ("low", "high"))
    return f"{row['value']:.4g} [{low}, {high}]"
