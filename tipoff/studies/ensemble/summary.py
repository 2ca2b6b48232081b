"""The statistics of an ensemble: counts, quantiles with their bounds, and how it was drawn."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.lowfi.ensemble.store import Store
from tipoff.mechanics import instant
from tipoff.mechanics.instant import Instant
from tipoff.scenes import halving
from tipoff.studies.populations import exceedance, spread
from tipoff.studies.populations.exceedance import Limit
from tipoff.studies.populations.spread import Quantile
from tipoff.workspace import words

SHARES = (0.05, 0.5, 0.95, 0.99, 0.9973)
CONFIDENCE = 0.95
_SHOWN = 5  # failed cases in the result; the store lists all


def _total(rate: np.ndarray) -> np.ndarray:
    return np.degrees(np.linalg.norm(rate, axis=1))


def _about(axis: int) -> Callable[[np.ndarray], np.ndarray]:
    return lambda rate: np.degrees(np.abs(rate[:, axis]))


def _sizes(prefix: str) -> dict[str, tuple[str, Callable[[np.ndarray], np.ndarray]]]:
    """The size of the rate in total and about each axis."""
    column = f"{prefix}rate"
    about = {f"{column}_{axis}_deg_s": (column, _about(place)) for place, axis in enumerate("xyz")}
    return {f"{column}_deg_s": (column, _total), **about}


# the column, and a function of it; those of the instant first, then the total rate of the other one
_SETTLED: dict[str, tuple[str, Callable[[np.ndarray], np.ndarray]]] = {
    **_sizes(""),
    "lateral_velocity_mm_s": ("lateral_velocity", lambda speed: 1e3 * speed),
    "direction_error_deg": ("direction_error", np.degrees),
}
_AT_EXIT: dict[str, tuple[str, Callable[[np.ndarray], np.ndarray]]] = {
    **_sizes("exit_"),
    "exit_lateral_velocity_mm_s": ("exit_velocity", lambda speed: 1e3 * instant.lateral(speed)),
    "exit_direction_error_deg": ("exit_velocity", lambda speed: np.degrees(instant.off(speed))),
}
_AFTER = ("impulse_after_exit", lambda share: 100.0 * share)


@dataclass(frozen=True, kw_only=True)
class Above:
    """Cases above any of the ``limits`` (in words), or without a rate, and the bounds of their share;
    None where the cases are not independent draws."""

    limits: tuple[str, ...]
    count: int
    share: float
    low: float | None
    high: float | None
    each: tuple["Above", ...] = ()  # of each limit alone, if there are several


@dataclass(frozen=True, kw_only=True)
class Statistics:
    """Counts, and quantiles of the cases that settled, with the method of their bounds. ``at``: the
    instant of the quantities, and why; ``settled``: cases with values at it; ``above``: None without
    limits. ``cases``: the source of
    the cases; ``ranges`` with 95 % of the values
    and ``provenance`` of the distributions by key; ``failures``: the first ones, with number,
    status, reason and inputs; ``failed``: their reasons if no case is ok."""

    model: str
    at: str
    at_why: str
    counts: dict[str, int]
    statuses: dict[str, int]
    settled: int
    confidence: float
    bounds: str
    quantiles: dict[str, tuple[Quantile, ...]]
    above: Above | None
    cases: dict[str, Any]
    ranges: dict[str, str]
    provenance: dict[str, str]
    numerics: dict[str, Any]
    modes_why: str
    failures: list[dict]
    digest: str
    failed: list[str]


def summarized(
    ensemble: Ensemble,
    store: Store,
    calibrated: bool,
    chosen: Instant,
    limits: Sequence[Limit] = (),
) -> Statistics:
    """Statistics of a whole store at the ``chosen`` instant; ``calibrated``: the constants of the model
    are not the scene's."""
    own, other = (_AT_EXIT, _SETTLED) if chosen.at == instant.EXIT else (_SETTLED, _AT_EXIT)
    rate = next(iter(own.values()))[0]
    status, settled = store.column("status"), np.isfinite(store.column(rate)[:, 0])
    failures = store.failures()[:_SHOWN]
    counts, unbounded = columns.counts(status), _no_bounds(ensemble.source)
    shown = {
        name: what
        for name, what in _shown(own, other)
        # without thrust there is no share of its impulse
        if settled.any() and np.isfinite(store.column(what[0])[settled]).all()
    }
    lines = [f"case {item['case']}: {item['status']}: {item['reason']}" for item in failures]
    return Statistics(
        model=words.model(ensemble.scene, calibrated, ensemble.compliance),
        at=chosen.at,
        at_why=chosen.why,
        counts=counts,
        statuses={name: int((status == code).sum()) for code, name in enumerate(columns.STATUSES)},
        settled=int(settled.sum()),
        confidence=CONFIDENCE,
        bounds=unbounded or "order statistics of independent draws",
        quantiles={
            name: spread.quantiles(
                _values(store, *what)[settled], SHARES, bounded=unbounded is None
            )
            for name, what in shown.items()
        },
        above=_above(store, rate, limits, unbounded is None) if limits else None,
        cases=ensemble.source.identity,
        ranges=_ranges(ensemble.source),
        provenance=_provenance(ensemble.source),
        numerics=ensemble.numerics.as_dict(),
        modes_why=ensemble.modes_why,
        failures=failures,
        digest=store.digest(),
        failed=[] if counts["ok"] else lines,
    )


def _above(store: Store, rate: str, limits: Sequence[Limit], bounded: bool) -> Above:
    """Share of the cases whose column ``rate`` is above any of the ``limits``, and above each."""
    places = [store.bounds(number) for number in range(len(store))]
    groups = [list(limits), *([limit] for limit in limits if len(limits) > 1)]
    counts = np.zeros(len(groups), dtype=int)
    for place in places:
        rates = np.degrees(store.column(rate, *place))
        counts += [int(exceedance.any_above(rates, group).sum()) for group in groups]
    whole, *each = (
        _share(group, int(count), store.asked, bounded) for group, count in zip(groups, counts)
    )
    return replace(whole, each=tuple(each))


def _share(limits: Sequence[Limit], count: int, asked: int, bounded: bool) -> Above:
    low, high = exceedance.bounds(count, asked, CONFIDENCE) if bounded else (None, None)
    return Above(
        limits=tuple(limit.words for limit in limits),
        count=count,
        share=count / asked,
        low=low,
        high=high,
    )


def _shown(own: dict, other: dict) -> list[tuple]:
    """Name and function of each quantity."""
    return [*own.items(), *list(other.items())[:1], ("impulse_after_exit_percent", _AFTER)]


def _values(store: Store, name: str, of: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """A function of a result (n,), computed by chunk, because ten million cases would need too much
    memory at once."""
    return np.concatenate(
        [of(store.column(name, *store.bounds(number))) for number in range(len(store))]
    )


def _no_bounds(source) -> str | None:
    """The reason why order statistics give no bounds here, or None."""
    if not isinstance(source, Drawn):
        return "none: the distribution of the table's cases is not known"
    if source.uncertainty.sampling != "random":
        return (
            f"none: points of {source.uncertainty.sampling} sampling depend on each other; "
            "random sampling has bounds"
        )
    return None


def _ranges(source) -> dict[str, str]:
    errors = source.uncertainty if isinstance(source, Drawn) else None
    return {key: halving.range_of(errors, key) for key in errors.vary} if errors else {}


def _provenance(source) -> dict[str, str]:
    return (
        {key: item.provenance for key, item in source.uncertainty.vary.items()}
        if isinstance(source, Drawn)
        else {}
    )
