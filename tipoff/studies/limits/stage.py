"""Stage ``limits``: the tolerances that keep the rates below limits, at a probability, and what is
not certain about them.

A set of tolerances is certified when the upper bound of the probability that some rate is above its
limit (Clopper and Pearson, one side) is at most 1 - p. That is asked of each factor alone, the rest
nominal; of a whole set, times a factor; and of pairs of misalignment and mass eccentricity. Two
things are then told apart: the constants of the surrogate, by repeating the search for draws from
their intervals, and the surrogate itself, by taking its measured error off every limit.
"""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tipoff.mechanics.models import COMPLIANT
from tipoff.studies.core.checked import together
from tipoff.studies.core.progress import Board
from tipoff.studies.core.stage import Stage
from tipoff.studies.core.study import Study
from tipoff.studies.limits import constants, search, within
from tipoff.studies.limits.inputs import DRAWS, Options, checked
from tipoff.studies.limits.search import Found
from tipoff.studies.limits.within import ADVISED, SETS, Cases, Factor
from tipoff.studies.populations import answers, exceedance, population, spread
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.population import Surrogate

NAME = "limits"
TOGETHER = "together"
PAIR = ("misalignment", "mass_eccentricity")
_RAYS = 5  # between the axes of the map of two tolerances
_REACH = 5.0  # times the tolerances that are scaled together


def run(study: Study, options: Options = Options()) -> dict:
    """``rows`` by factor and one of all together, ``map`` of two, ``summary`` in words. Raises
    SceneError for bad input, every fault listed."""
    (limits, cases), _ = together(
        lambda: checked(options), lambda: options.condition and study.condition(options.condition)
    )
    model = population.surrogate(study, options.model, options.condition)
    margin = _margin(study, options)

    def make() -> tuple[dict, list[Path]]:
        from tipoff.studies.limits import page as pictures
        from tipoff.studies.render.chart import to_files

        with Board(NAME, 1) as board:
            found = _Answers(
                study, options, limits, cases, model, margin, board.callback(NAME)
            ).all()
            board.finished(NAME, f"{found['evaluations']:,} sets of {cases:,} cases")
        found["summary"] = pictures.summary(found)
        return found, [
            path
            for chart, _ in pictures.charts(found)
            for path in to_files(chart, study.path("figures"))
        ]

    return STAGE.run(study, options, make)


def _margin(study: Study, options: Options) -> constants.Margin:
    return constants.margin(study, options.model or COMPLIANT)


STAGE = Stage(NAME, __name__, Options, _margin)


class _Answers:
    """One study: everything that its answers share."""

    def __init__(
        self,
        study: Study,
        options: Options,
        limits: list[Limit],
        cases: int,
        model: Surrogate,
        margin: constants.Margin,
        report: Callable[[float], None],
    ):
        self.study, self.options, self.limits, self.cases, self.margin = (
            study,
            options,
            limits,
            cases,
            margin,
        )
        self.model = model if options.others == "scene" else within.without_errors(model)
        self.factors = within.factors(self.model.scene)
        allowed = exceedance.allowed(cases, options.probability, options.confidence)
        assert allowed is not None  # so many cases were asked for
        self.allowed = allowed
        overrides, self.drawn = (
            ([], [])
            if model.calibration is None
            else constants.draws(
                study.scene,
                model.calibration,
                DRAWS if options.draws is None else options.draws,
                options.seed,
            )
        )
        self.others = [self.model.at(item) for item in overrides]
        self.report, self.evaluations = report, 0
        # Halvings and refinements of each search, and about five evaluations of each that starts
        # from a known answer.
        self.expected = (len(self.factors) + 1) * (14 + 5 * (len(self.others) + 2)) + 9 * _RAYS

    def all(self) -> dict:
        """The whole result."""
        full = {name: {name: factor.most} for name, factor in self.factors.items()}
        full[TOGETHER] = {
            name: _REACH * size for name, size in SETS[self.options.tolerances].items()
        }
        searched = {name: self._search(tolerances) for name, tolerances in full.items()}
        rows = [self._row(name, tolerances, searched[name]) for name, tolerances in full.items()]
        shown = {
            "limits_said": [limit.words for limit in self.limits],
            "probability": self.options.probability,
            "confidence": self.options.confidence,
            "cases": self.cases,
            "allowed": self.allowed,
            **population.answering(self.study, self.model, self.options.condition),
            "constants": {"draws": len(self.others), "drawn": self.drawn},
            "margin": self.margin._asdict(),
        }
        return {
            "asked": STAGE.plain(self.options),
            "limits": [limit._asdict() for limit in self.limits],
            **shown,
            "rows": rows,
            "map": self._map(searched[PAIR[0]].scale or 0.1),
            "evaluations": self.evaluations,
        }

    def _above(self, cases: Cases, limits: list[Limit]) -> Callable[[float], int]:
        def count(scale: float) -> int:
            self.evaluations += 1
            self.report(self.evaluations / self.expected)
            return int(exceedance.any_above(cases.rates(scale), limits).sum())

        return count

    def _of(self, tolerances: dict[str, float], model: Surrogate | None = None) -> Cases:
        return Cases(
            self.study, NAME, model or self.model, tolerances, self.cases, self.options.seed
        )

    def _search(self, tolerances: dict[str, float]) -> Found:
        return search.largest(self._above(self._of(tolerances), self.limits), self.allowed)

    def _row(self, name: str, tolerances: dict[str, float], found: Found) -> dict:
        # The paper advises one of the sets, as it stands; of a multiple of its Table 3 it says
        # nothing.
        advised = 1.0 / _REACH if self.options.tolerances == "advised" else None
        factor = self.factors.get(name) or Factor(
            "all of them together, times", "1", 1.0 / _REACH, 1.0, advised
        )
        size = factor.most / factor.scale
        row = {
            "name": name,
            "words": factor.words,
            "unit": factor.unit,
            "most": size,
            "nominal": _told(found, size),
            "advised": self._advised(tolerances, factor),
            **dict.fromkeys(("constants", "model", "both", "beside")),
        }
        if found.scale is None:
            return row
        cases = self._of(tolerances)
        row["beside"] = self._beside(cases.values(found.scale))
        near = [self._near(tolerances, other, self.limits, found.scale) for other in self.others]
        if near:
            row["constants"] = [_told(item, size) for item in near]
        shrunk = self._shrunk()
        if shrunk is not None:
            row["model"] = _told(self._near(tolerances, None, shrunk, found.scale), size)
            if near:
                worst = min(range(len(near)), key=lambda place: near[place].scale or 0.0)
                row["both"] = _told(
                    self._near(
                        tolerances, self.others[worst], shrunk, near[worst].scale or found.scale
                    ),
                    size,
                )
        return row

    def _beside(self, values: np.ndarray) -> list[dict]:
        """What every quantity stays below in magnitude with the probability asked for, where the
        rates keep their limits."""
        settled, share = (
            np.abs(values[np.isfinite(values).all(axis=1)]),
            (self.options.probability,),
        )
        return [
            {
                "name": item.name,
                "label": item.label,
                "unit": item.unit,
                **spread.quantiles(column, share)[0],
            }
            for item, column in zip(answers.ALL, settled.T)
        ]

    def _near(
        self,
        tolerances: dict[str, float],
        model: Surrogate | None,
        limits: list[Limit],
        start: float,
    ) -> Found:
        if any(limit.deg_s <= 0.0 for limit in limits):
            return Found(search.LOST, None, None, [], self.allowed)
        return search.near(self._above(self._of(tolerances, model), limits), self.allowed, start)

    def _shrunk(self) -> list[Limit] | None:
        """The limits less the error of the model; None where that is not known, or none."""
        known = self.margin.deg_s
        if not known or not any(known.values()):
            return None
        return [Limit(limit.axis, limit.deg_s - known[limit.axis]) for limit in self.limits]

    def _advised(self, tolerances: dict[str, float], factor: Factor) -> dict | None:
        """How often the limits are kept at the tolerance that the paper advises."""
        if factor.advised is None:
            return None
        count = self._above(self._of(tolerances), self.limits)(factor.advised / factor.most)
        low, high = exceedance.bounds(count, self.cases, self.options.confidence)
        return {
            "tolerance": factor.advised / factor.scale,
            "above": count,
            "share": count / self.cases,
            "low": low,
            "high": high,
            "certified": count <= self.allowed,
        }

    def _map(self, start: float) -> dict | None:
        """Certified pairs of two tolerances, on rays from one axis, where the other error is zero,
        to the other axis; each search starts where the last one ended. None where there is no such
        pair."""
        pair, points = [self.factors[name] for name in PAIR], []
        for number in range(_RAYS + 2):
            angle = 0.5 * math.pi * number / (_RAYS + 1)
            shares = [round(part, 12) for part in (math.cos(angle), math.sin(angle))]
            edge = 1.0 / max(shares)  # where the first of both is the largest that is searched
            ray = {name: share * factor.most for name, share, factor in zip(PAIR, shares, pair)}
            found = search.near(
                self._above(self._of(ray), self.limits), self.allowed, min(start, edge), edge
            )
            if found.scale is not None:
                start = found.scale
                points.append(
                    {
                        "tolerances": [
                            start * share * factor.most / factor.scale
                            for share, factor in zip(shares, pair)
                        ],
                        "state": found.state,
                    }
                )
        if not points:
            return None
        return {
            "names": list(PAIR),
            "words": [factor.words for factor in pair],
            "units": [factor.unit for factor in pair],
            "advised": [ADVISED[name] / factor.scale for name, factor in zip(PAIR, pair)],
            "points": points,
        }


def _told(found: Found, size: float) -> dict:
    """A search in the unit of its factor, of which ``size`` are scale one."""
    return {
        "state": found.state,
        "tolerance": None if found.scale is None else size * found.scale,
        "fails": None if found.fails is None else size * found.fails,
        "again": [size * scale for scale in found.again],
        "falls": [[size * one, size * two] for one, two in found.falls],
        "trials": [[size * trial.scale, trial.above] for trial in found.trials],
    }
