"""Stage ``limits``: the tolerances that keep the rates below limits with a given probability, and
their uncertainty.

A set of tolerances is certified when the upper bound of the probability that some rate is above its
limit (Clopper and Pearson, one side) is at most 1 - p. The largest certified tolerance is searched
for each factor alone, with the others nominal; for a multiple of a whole set; and for pairs of
misalignment and mass eccentricity. Two uncertainties are separate: for the constants of the
surrogate, the search is repeated for draws from their intervals; for the surrogate itself, its
measured error reduces every limit.

All searches and the check by the reference use one model with one number of rail modes. Pilot cases
within the certified multiple of the whole set choose this number.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from tipoff.comparison import order_statistics
from tipoff.faults import Fault, SceneError, together
from tipoff.mechanics.model_names import COMPLIANT
from tipoff.scenes import halving, uncertainty
from tipoff.scenes.scene import Scene
from tipoff.scenes.uncertainty import Uncertainty
from tipoff.studies.limits import certificate, constants, search, within
from tipoff.studies.limits.certificate import Certificate
from tipoff.studies.limits.options import LimitsOptions
from tipoff.studies.limits.results import (
    Advised,
    CertifiedFactor,
    Drawn,
    Limits,
    Magnitude,
    Map,
    Pair,
)
from tipoff.studies.limits.search import Found
from tipoff.studies.limits.within import ADVISED, REACH, SEED, TOGETHER, CasesAtScale, Factor
from tipoff.studies.populations import answers, exceedance, population, spread
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.population import Surrogate
from tipoff.workspace.options import require
from tipoff.workspace.progress import Board
from tipoff.workspace.stage import Made, Stage
from tipoff.workspace.study import Study

NAME = "limits"
TIMES_NEEDED = 10  # times the smallest number of cases, so that some cases may be above a limit
DRAWS = 8
RAYS = 5  # rays between the axes of the map of two tolerances


def run(study: Study, options: LimitsOptions = LimitsOptions()) -> Made[Limits]:
    """The certified tolerances. Raises SceneError listing every fault of the input, and StudyError
    if the payload does not leave the rail even without errors."""
    (limits, cases), *_ = together(
        lambda: checked(options),
        lambda: options.condition and study.condition(options.condition),
        lambda: options.vary and _errors(options.vary, study.scene),
    )
    model = population.surrogate(study, options.model, options.condition)
    margin = constants.margin(study, options.model or COMPLIANT)

    def make() -> tuple[Limits, list[Path]]:
        from tipoff.studies.limits import page
        from tipoff.studies.render.document import with_figures

        population.require_settling(model, within.without_errors(model))
        watched = model.watched(options.at)
        with Board(NAME, 1) as board:
            found = Search(
                study, options, limits, cases, watched, margin, board.callback(NAME)
            ).all()
            board.finished(NAME, f"{found.evaluations:,} sets of {cases:,} cases")
        return with_figures(found, page.figures, study.path("figures"))

    return STAGE.run(study, options, make)


def _inputs(study: Study, options: LimitsOptions) -> dict:
    margin = vars(constants.margin(study, options.model or COMPLIANT))
    if options.vary is None:
        return margin
    return margin | {"errors": _errors(options.vary, study.scene).resolved()}


def _errors(vary: str, scene: Scene) -> Uncertainty:
    """The errors of a file for ``scene``. Raises SceneError with every fault."""
    found = uncertainty.load(vary, scene)
    if not halving.tolerances(found):
        raise SceneError([Fault(vary, "vary", "fixed values", "a distribution with a scatter")])
    return found


STAGE = Stage(NAME, __name__, options=LimitsOptions, inputs=_inputs, result=Limits)


def checked(options: LimitsOptions) -> tuple[list[Limit], int]:
    """Limits and number of cases. Raises SceneError listing every fault."""
    return tuple(together(lambda: _limits(options.limits), lambda: _cases(options)))


def _limits(texts: tuple[str, ...]) -> list[Limit]:
    found = exceedance.limits(texts)
    axes = [limit.axis for limit in found]
    if twice := sorted({axis for axis in axes if axes.count(axis) > 1}):
        raise SceneError(
            [Fault("--limit", axis, "two limits", "one limit for a rate") for axis in twice]
        )
    return found


def _cases(options: LimitsOptions) -> int:
    require(options)
    needed = order_statistics.runs_needed(options.probability, options.confidence)
    if options.cases is None:
        return TIMES_NEEDED * needed
    if options.cases >= needed:
        return options.cases
    expected = (
        f"{needed:,} or more, to show a probability of {options.probability:g} at a confidence of "
        f"{options.confidence:g}"
    )
    raise SceneError([Fault("--cases", "value", f"{options.cases:,}", expected)])


class Search:
    """All searches of one study."""

    def __init__(
        self,
        study: Study,
        options: LimitsOptions,
        limits: list[Limit],
        cases: int,
        model: Surrogate,
        margin: constants.Margin,
        report: Callable[[float], None],
    ):
        self.study, self.options, self.limits, self.cases = study, options, limits, cases
        self.margin = margin
        self.model = model if options.others == "scene" else within.without_errors(model)
        self.inputs = (
            within.of_paper(self.model.scene)
            if options.vary is None
            else within.of_file(_errors(options.vary, self.model.scene))
        )
        self.factors = self.inputs.factors
        allowed = exceedance.allowed(cases, options.probability, options.confidence)
        assert allowed is not None  # ``checked`` has refused fewer cases
        self.allowed = allowed
        self.overrides, self.drawn = (
            ([], [])
            if model.calibration is None
            else constants.draws(
                study.scene,
                model.calibration,
                DRAWS,
                SEED,
            )
        )
        self.others: list[Surrogate] = []
        self.report, self.evaluations = report, 0
        # Halvings and refinements of each full search, and about five evaluations of each search
        # that starts near its result.
        self.expected = (len(self.factors) + 1) * (14 + 5 * (len(self.overrides) + 2)) + 9 * RAYS

    def all(self) -> Limits:
        """The whole result."""
        full = {name: {name: factor.most} for name, factor in self.factors.items()}
        full[TOGETHER] = {name: REACH * size for name, size in self.inputs.whole.items()}
        together = self._choose_modes(full[TOGETHER])
        self.others = [self.model.at(item) for item in self.overrides]
        searched = {
            name: together if name == TOGETHER else self._search(tolerances)
            for name, tolerances in full.items()
        }
        return Limits(
            **population.answering(self.study, self.model, self.options.condition),
            asked=self.options,
            limits=tuple(self.limits),
            probability=self.options.probability,
            confidence=self.options.confidence,
            cases=self.cases,
            allowed=self.allowed,
            constants=Drawn(len(self.others), tuple(self.drawn)),
            margin=self.margin,
            rows=tuple(self._row(name, full[name], searched[name]) for name in full),
            map=self.pairs(self.inputs.pair, searched) if self.inputs.pair else None,
            certificate=self.certified(full[TOGETHER], together),
            evaluations=self.evaluations,
        )

    def _choose_modes(self, tolerances: dict[str, float]) -> Found:
        """Give the model its number of rail modes, and return the search of the whole set with it.
        Pilot cases within the result of that search choose the number, and the result depends on
        the number. So the first search has no modes, and it is repeated with more modes until the
        pilot needs no more."""
        choosing, self.model = self.model, self.model._replace(modes=0)
        while True:
            found = self._search(tolerances)
            scale = found.fails if found.tolerance is None else found.tolerance
            assert scale is not None  # a search fails somewhere or certifies a scale
            sizes = {name: scale * size for name, size in tolerances.items()}
            drawn = self.inputs.source(choosing.scene, sizes, self.cases, SEED)
            chosen = within.with_modes(choosing, drawn)
            if chosen.mode_count > self.model.mode_count:
                self.model = chosen
                continue
            if chosen.mode_count == self.model.mode_count:
                self.model = chosen  # with the reason that its own pilot gives
            return found

    def certified(self, tolerances: dict[str, float], found: Found) -> Certificate | None:
        """The set of ``tolerances`` at the ``found`` scale, checked by the reference; None if not
        requested, or without such a scale."""
        if self.options.certify is None or found.tolerance is None:
            return None
        name = self.options.condition
        reference = Surrogate(self.study.condition(name) if name else self.study.scene, None, None)
        if self.options.others != "scene":
            reference = within.without_errors(reference)
        sizes = {key: found.tolerance * size for key, size in tolerances.items()}
        checked_within = certificate.Within(self.model, reference.scene, sizes, self.inputs.source)
        return certificate.made(self.study, self.options, self.limits, self.cases, checked_within)

    def _of(self, tolerances: dict[str, float], model: Surrogate | None = None) -> CasesAtScale:
        source = self.inputs.source
        return CasesAtScale(
            self.study, NAME, model or self.model, tolerances, self.cases, SEED, source
        )

    def _above(self, cases: CasesAtScale, limits: list[Limit]) -> Callable[[float], int]:
        def count(scale: float) -> int:
            self.evaluations += 1
            self.report(self.evaluations / self.expected)
            return int(exceedance.any_above(cases.rates(scale), limits).sum())

        return count

    def _search(self, tolerances: dict[str, float]) -> Found:
        return search.largest(self._above(self._of(tolerances), self.limits), self.allowed)

    def _near(
        self, cases: CasesAtScale, limits: list[Limit], start: float, most: float = 1.0
    ) -> Found:
        if any(limit.deg_s <= 0.0 for limit in limits):
            return Found(search.LOST)
        return search.near(self._above(cases, limits), self.allowed, start, most)

    def _row(self, name: str, tolerances: dict[str, float], found: Found) -> CertifiedFactor:
        factor = self.factors.get(name) or Factor(
            "all together, multiple of the set", "1", 1.0 / REACH, 1.0, 1.0 / REACH
        )
        words = self.inputs.words if name in self.factors else None
        size = factor.most / factor.scale
        row = CertifiedFactor(
            name=name,
            words=factor.words,
            unit=factor.unit,
            most=size,
            nominal=found.times(size),
            advised=self._advised(tolerances, factor),
            stated=words and words(name, 1.0),
        )
        if found.tolerance is None:
            return row
        cases, start = self._of(tolerances), found.tolerance
        others = [self._of(tolerances, other) for other in self.others]
        near = [self._near(other, self.limits, start) for other in others]
        shrunk, model, both = self._shrunk(), None, None
        if shrunk is not None:
            model = self._near(cases, shrunk, start).times(size)
            if near:
                worst = min(range(len(near)), key=lambda place: near[place].tolerance or 0.0)
                begin = near[worst].tolerance or start
                both = self._near(others[worst], shrunk, begin).times(size)
        return replace(
            row,
            constants=tuple(item.times(size) for item in near) or None,
            model=model,
            both=both,
            beside=self._beside(cases.values(start)),
            certified=words and words(name, start * factor.most),
        )

    def _beside(self, values: np.ndarray) -> tuple[Magnitude, ...]:
        """The magnitude that each quantity stays below with the given probability, from ``values``
        (n,k) of ``answers.ALL``."""
        settled = np.abs(values[np.isfinite(values).all(axis=1)])
        quantiles = (
            spread.quantiles(column, (self.options.probability,))[0] for column in settled.T
        )
        return tuple(
            Magnitude(**vars(quantile), **item.named)
            for item, quantile in zip(answers.ALL, quantiles)
        )

    def _shrunk(self) -> list[Limit] | None:
        """The limits less the error of the model; None if that error is zero or not known."""
        error = self.margin.deg_s
        if not error or not any(error.values()):
            return None
        return [Limit(limit.axis, limit.deg_s - error[limit.axis]) for limit in self.limits]

    def _advised(self, tolerances: dict[str, float], factor: Factor) -> Advised | None:
        """Cases above a limit at the tolerance that the paper advises, or the file states."""
        if factor.advised is None:
            return None
        count = self._above(self._of(tolerances), self.limits)(factor.advised / factor.most)
        low, high = exceedance.bounds(count, self.cases, self.options.confidence)
        return Advised(
            tolerance=factor.advised / factor.scale,
            above=count,
            share=count / self.cases,
            low=low,
            high=high,
            certified=count <= self.allowed,
        )

    def pairs(self, names: tuple[str, str], searched: dict[str, Found]) -> Map | None:
        """Certified pairs of two tolerances on rays from one axis to the other; each search starts
        at the last result, the first at that of the first one alone. None without such a pair."""
        one, two = (self.factors[name] for name in names)
        start = searched[names[0]].tolerance or 0.1
        points = []
        for number in range(RAYS + 2):
            angle = 0.5 * math.pi * number / (RAYS + 1)
            shares = [round(part, 12) for part in (math.cos(angle), math.sin(angle))]
            edge = 1.0 / max(shares)  # there one of the two reaches its largest searched tolerance
            ray = {
                name: share * factor.most for name, share, factor in zip(names, shares, (one, two))
            }
            found = self._near(self._of(ray), self.limits, min(start, edge), edge)
            if found.tolerance is not None:
                start = found.tolerance
                x, y = (
                    start * share * factor.most / factor.scale
                    for share, factor in zip(shares, (one, two))
                )
                points.append(Pair((x, y), found.state))
        if not points:
            return None
        return Map(
            names=names,
            words=(one.words, two.words),
            units=(one.unit, two.unit),
            advised=(ADVISED[names[0]] / one.scale, ADVISED[names[1]] / two.scale),
            points=tuple(points),
        )
