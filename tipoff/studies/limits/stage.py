"""Stage ``limits``: the tolerances that keep the rates below limits with a given probability, and
their uncertainty.

A set of tolerances is certified when the upper bound of the probability that some rate is above its
limit (Clopper and Pearson, one side) is at most 1 - p. The largest certified tolerance is searched
for each factor alone, with the others nominal; for a multiple of a whole set; and for pairs of
misalignment and mass eccentricity. Two uncertainties are separate: for the constants of the
surrogate, the search is repeated for draws from their intervals; for the surrogate itself, its
measured error reduces every limit.

All searches, and the check by the reference, are of one model with one number of rail modes: that
which pilot cases within the certified multiple of the whole set choose.
"""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tipoff.mechanics.models import COMPLIANT
from tipoff.scenes.faults import together
from tipoff.studies.limits import certificate, constants, search, within
from tipoff.studies.limits.inputs import DRAWS, checked
from tipoff.studies.limits.options import Options
from tipoff.studies.limits.search import Found
from tipoff.studies.limits.within import ADVISED, SETS, TOGETHER, Cases, Factor
from tipoff.studies.populations import answers, exceedance, population, spread
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.population import Surrogate
from tipoff.workspace.progress import Board
from tipoff.workspace.stage import Stage
from tipoff.workspace.study import Study

NAME = "limits"
PAIR = ("misalignment", "mass_eccentricity")
RAYS = 5  # rays between the axes of the map of two tolerances
_REACH = 5.0  # largest multiple of a whole set


def run(study: Study, options: Options = Options()) -> dict:
    """``rows`` for each factor and for all together, and the ``map`` of two. Raises SceneError for
    bad input, every fault listed, and StudyError where the payload does not leave without errors
    either."""
    (limits, cases), _ = together(
        lambda: checked(options), lambda: options.condition and study.condition(options.condition)
    )
    model = population.surrogate(study, options.model, options.condition)
    margin = _margin(study, options)

    def make() -> tuple[dict, list[Path]]:
        from tipoff.studies.limits import page
        from tipoff.studies.render.document import with_figures

        population.require_settling(model, within.without_errors(model))
        with Board(NAME, 1) as board:
            found = Search(study, options, limits, cases, model, margin, board.callback(NAME)).all()
            board.finished(NAME, f"{found['evaluations']:,} sets of {cases:,} cases")
        return with_figures(found, page.figures, study.path("figures"))

    return STAGE.run(study, options, make)


def _margin(study: Study, options: Options) -> constants.Margin:
    return constants.margin(study, options.model or COMPLIANT)


STAGE = Stage(NAME, __name__, Options, _margin)


class Search:
    """All searches of one study."""

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
        assert allowed is not None  # ``checked`` has refused fewer cases
        self.allowed = allowed
        self.overrides, self.drawn = (
            ([], [])
            if model.calibration is None
            else constants.draws(
                study.scene,
                model.calibration,
                DRAWS if options.draws is None else options.draws,
                options.seed,
            )
        )
        self.others: list[Surrogate] = []
        self.report, self.evaluations = report, 0
        # Halvings and refinements of each full search, and about five evaluations of each search
        # that starts near its result.
        self.expected = (len(self.factors) + 1) * (14 + 5 * (len(self.overrides) + 2)) + 9 * RAYS

    def all(self) -> dict:
        """The whole result."""
        full = {name: {name: factor.most} for name, factor in self.factors.items()}
        full[TOGETHER] = {
            name: _REACH * size for name, size in SETS[self.options.tolerances].items()
        }
        together = self._choose_modes(full[TOGETHER])
        self.others = [self.model.at(item) for item in self.overrides]
        searched = {
            name: together if name == TOGETHER else self._search(tolerances)
            for name, tolerances in full.items()
        }
        rows = [self._row(name, tolerances, searched[name]) for name, tolerances in full.items()]
        shown = {
            "probability": self.options.probability,
            "confidence": self.options.confidence,
            "cases": self.cases,
            "allowed": self.allowed,
            **population.answering(self.study, self.model, self.options.condition),
            "constants": {"draws": len(self.others), "drawn": self.drawn},
            "margin": {"deg_s": self.margin.deg_s, "said": self.margin.source},
        }
        return {
            "asked": STAGE.plain(self.options),
            "limits": [limit._asdict() for limit in self.limits],
            **shown,
            "rows": rows,
            "map": self.pairs(searched[PAIR[0]].scale or 0.1),
            "certificate": self.certified(full[TOGETHER], searched[TOGETHER]),
            "evaluations": self.evaluations,
        }

    def _choose_modes(self, tolerances: dict[str, float]) -> Found:
        """Give the model its number of rail modes, and return the search of the whole set with it. The
        number is what pilot cases within the result of that search choose, and the result depends on
        the number: the search begins without modes, and is made again with more while the pilot needs
        more."""
        choosing, self.model = self.model, self.model._replace(modes=0)
        while True:
            found = self._search(tolerances)
            scale = found.fails if found.scale is None else found.scale
            assert scale is not None  # a search fails somewhere or certifies a scale
            sizes = {name: scale * size for name, size in tolerances.items()}
            chosen = within.with_modes(choosing, sizes, self.cases, self.options.seed)
            if chosen.mode_count > self.model.mode_count:
                self.model = chosen
                continue
            if chosen.mode_count == self.model.mode_count:
                self.model = chosen  # with the reason from its own result
            return found

    def certified(self, tolerances: dict[str, float], found: Found) -> dict | None:
        """The set of ``tolerances`` at the ``found`` scale, checked by the reference; None where that was
        not asked for, or where there is no such scale."""
        if self.options.certify is None or found.scale is None:
            return None
        name = self.options.condition
        reference = Surrogate(self.study.condition(name) if name else self.study.scene, None, None)
        if self.options.others != "scene":
            reference = within.without_errors(reference)
        sizes = {key: found.scale * size for key, size in tolerances.items()}
        checked_within = certificate.Within(self.model, reference.scene, sizes)
        return certificate.made(self.study, self.options, self.limits, self.cases, checked_within)

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
        # The paper advises one of the sets; it advises no multiple of its Table 3.
        advised = 1.0 / _REACH if self.options.tolerances == "advised" else None
        factor = self.factors.get(name) or Factor(
            "all together, multiple of the set", "1", 1.0 / _REACH, 1.0, advised
        )
        size = factor.most / factor.scale
        row = {
            "name": name,
            "words": factor.words,
            "unit": factor.unit,
            "most": size,
            "nominal": _plain(found, size),
            "advised": self._advised(tolerances, factor),
            **dict.fromkeys(("constants", "model", "both", "beside")),
        }
        if found.scale is None:
            return row
        cases = self._of(tolerances)
        row["beside"] = self._beside(cases.values(found.scale))
        near = [self._near(tolerances, other, self.limits, found.scale) for other in self.others]
        if near:
            row["constants"] = [_plain(item, size) for item in near]
        shrunk = self._shrunk()
        if shrunk is not None:
            row["model"] = _plain(self._near(tolerances, None, shrunk, found.scale), size)
            if near:
                worst = min(range(len(near)), key=lambda place: near[place].scale or 0.0)
                row["both"] = _plain(
                    self._near(
                        tolerances, self.others[worst], shrunk, near[worst].scale or found.scale
                    ),
                    size,
                )
        return row

    def _beside(self, values: np.ndarray) -> list[dict]:
        """The magnitude that each quantity stays below with the given probability, from ``values``
        (n,k) of ``answers.ALL``."""
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
        """The limits less the error of the model; None where that error is not known or zero."""
        error = self.margin.deg_s
        if not error or not any(error.values()):
            return None
        return [Limit(limit.axis, limit.deg_s - error[limit.axis]) for limit in self.limits]

    def _advised(self, tolerances: dict[str, float], factor: Factor) -> dict | None:
        """Probability of a rate above its limit at the tolerance that the paper advises."""
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

    def pairs(self, start: float) -> dict | None:
        """Certified pairs of two tolerances on rays from one axis to the other; each search starts
        at the last result. None where there is no such pair."""
        pair, points = [self.factors[name] for name in PAIR], []
        for number in range(RAYS + 2):
            angle = 0.5 * math.pi * number / (RAYS + 1)
            shares = [round(part, 12) for part in (math.cos(angle), math.sin(angle))]
            edge = 1.0 / max(shares)  # there one of both reaches its largest searched tolerance
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


def _plain(found: Found, size: float) -> dict:
    """A search as JSON values in the unit of its factor; scale one is ``size``."""
    return {
        "state": found.state,
        "tolerance": None if found.scale is None else size * found.scale,
        "fails": None if found.fails is None else size * found.fails,
        "again": [size * scale for scale in found.again],
        "falls": [[size * one, size * two] for one, two in found.falls],
        "trials": [[size * trial.scale, trial.above] for trial in found.trials],
    }
