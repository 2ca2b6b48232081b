"""Tolerances checked by the finite-element reference: an upper bound of the probability that a rate of
the reference is above its limit, at the tolerances that the surrogate certifies.

New cases within these tolerances are put into strata by the largest ratio of a rate to its limit in the
surrogate: above one, near one, far below one. The reference runs the first cases of the strata near and
far, and ``populations.stratified`` bounds the probability. The search chose the tolerances by its own
cases, so the check draws other cases.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tipoff.mechanics.model_names import FINITE_ELEMENTS
from tipoff.scenes.names import NOMINAL
from tipoff.scenes.scene import Scene
from tipoff.studies.limits.options import LimitsOptions
from tipoff.studies.limits.within import SEED, CasesAtScale, Source, source
from tipoff.studies.populations import draws, exceedance, stratified
from tipoff.studies.populations.draws import Lost
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.population import Surrogate
from tipoff.studies.populations.stratified import Bound, Runs
from tipoff.workspace.study import Study

TIMES = 10  # cases for each case of the search, for accurate weights of the strata
NEAR = 0.9  # of a limit: from here on, a case is near it
STRATA = ("above", "near", "far")


class Within(NamedTuple):
    """Cases within tolerances (SI) by name of an error, of a ``source``: the surrogate ``model``, and the
    ``scene`` of the reference with the same errors."""

    model: Surrogate
    scene: Scene
    tolerances: dict[str, float]
    source: Source = source


@dataclass(frozen=True, kw_only=True)
class Stratum(Runs):
    """The ``runs`` of the reference among the ``cases`` of a stratum."""

    name: str
    cases: int


@dataclass(frozen=True, kw_only=True)
class Certificate(Bound):
    """The bound from the ``strata`` of all ``cases`` within the ``tolerances`` (SI; multiples of those of a
    file of errors); ``near``: of a limit,
    where the second one begins; ``plain``: the bound of as many runs without strata, none above;
    ``needed``: the number of runs that would certify, None where none does; ``lost``: runs that did not
    settle."""

    model: str
    element_size_m: float
    tolerances: dict[str, float]
    cases: int
    near: float
    strata: tuple[Stratum, ...]
    certified: bool
    plain: float
    needed: int | None
    lost: tuple[Lost, ...]


def made(
    study: Study, options: LimitsOptions, limits: Sequence[Limit], cases: int, within: Within
) -> Certificate:
    """The bound from ``options.certify`` runs of the reference, among ten times the ``cases`` of the
    search."""
    assert options.certify is not None
    tried = CasesAtScale(
        study,
        "limits",
        within.model,
        within.tolerances,
        TIMES * cases,
        SEED + 1,
        within.source,
    )
    above, *places = strata(tried.rates(1.0), limits)
    counts = (len(above), len(places[0]), len(places[1]))
    numbers = stratified.allocated(counts, options.certify, options.confidence)
    chosen = [place[:count] for place, count in zip(places, numbers)]
    drawn = tried.source(1.0)
    requested = [
        draws.reference(
            study,
            f"{options.condition or NOMINAL}-tolerances-case{case}-coarse",
            within.scene.replace(dict(drawn.rows(case, case + 1)[0])),
            study.settings.coarse_size,
        )
        for case in np.concatenate(chosen).tolist()
    ]
    draws.announce(study, requested)
    kept = draws.filled(study, "limits, reference", requested)
    events = exceedance.any_above(
        np.degrees(draws.results(kept, within.model.instant.at).rate), limits
    )
    near, far = (Runs(len(part), int(part.sum())) for part in np.split(events, [len(chosen[0])]))
    bound = stratified.upper_bound(counts, near, far, options.confidence)
    return Certificate(
        **vars(bound),
        model=FINITE_ELEMENTS,
        element_size_m=study.settings.coarse_size,
        tolerances=within.tolerances,
        cases=sum(counts),
        near=NEAR,
        strata=tuple(
            Stratum(**vars(runs), name=name, cases=count)
            for name, count, runs in zip(STRATA, counts, (Runs(0, 0), near, far))
        ),
        certified=bound.upper <= 1.0 - options.probability,
        plain=exceedance.at_most(0, len(events), options.confidence),
        needed=needed(counts, near, far, options),
        lost=tuple(draws.lost(requested, kept)),
    )


def strata(rates: np.ndarray, limits: Sequence[Limit]) -> tuple[np.ndarray, ...]:
    """The cases, of ``rates`` (n,3) in deg/s, that are above a limit, near one, and far from all. One
    that did not settle is above."""
    above = exceedance.any_above(rates, limits)
    close = exceedance.any_above(rates, [Limit(limit.axis, NEAR * limit.deg_s) for limit in limits])
    return tuple(np.flatnonzero(part) for part in (above, close & ~above, ~close))


def needed(
    counts: tuple[int, int, int], near: Runs, far: Runs, options: LimitsOptions
) -> int | None:
    """The number of runs, allocated as above, that certifies the probability if no further one shows a
    rate above its limit; None where that of all ``counts`` cases does not."""

    def split(runs: int) -> tuple[Runs, Runs]:
        wanted = stratified.allocated(counts, runs, options.confidence)
        first, second = (
            Runs(max(count, done.runs), done.events) for count, done in zip(wanted, (near, far))
        )
        return first, second

    def enough(runs: int) -> bool:
        found = stratified.upper_bound(counts, *split(runs), options.confidence)
        return found.upper <= 1.0 - options.probability

    low, high = 0, sum(counts)
    if not enough(high):
        return None
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if enough(middle) else (middle, high)
    return sum(part.runs for part in split(high))
