"""What an ensemble says of the state a payload leaves with: counts, quantiles with their bounds,
and how it was drawn, in words."""

from collections.abc import Callable

import numpy as np

from tipoff.lowfi.ensemble import columns
from tipoff.lowfi.ensemble.request import Ensemble
from tipoff.lowfi.ensemble.rows import Drawn
from tipoff.lowfi.ensemble.store import Store
from tipoff.studies.core import words
from tipoff.studies.populations import order_statistics

SHARES = (0.05, 0.5, 0.95, 0.99, 0.9973)
CONFIDENCE = 0.95
_SHOWN = 5  # failed cases that are printed; the store lists all
_VALUES: dict[str, tuple[str, Callable[[np.ndarray], np.ndarray]]] = {
    "rate_deg_s": ("rate", lambda rate: np.degrees(np.linalg.norm(rate, axis=1))),
    "lateral_velocity_mm_s": ("lateral_velocity", lambda speed: 1e3 * speed),
    "direction_error_deg": ("direction_error", np.degrees),
}
_LABELS = {
    "rate_deg_s": "|rate|, deg/s",
    "lateral_velocity_mm_s": "across, mm/s",
    "direction_error_deg": "off axis, deg",
}


def of(ensemble: Ensemble, store: Store) -> dict:
    """Counts, and quantiles of the settled values with what bounds them. ``failed`` has the reasons
    when no case is ok."""
    status, settled, failures = (
        store.column("status"),
        np.isfinite(store.column("exit_time")),
        store.failures(),
    )
    counts, why = columns.counts(status), _no_bounds(ensemble.source)
    values = (
        {name: _values(store, *what)[settled] for name, what in _VALUES.items()}
        if settled.any()
        else {}
    )
    return {
        "model": words.model(ensemble.scene, ensemble.calibration, ensemble.compliance),
        "counts": counts,
        "statuses": {
            name: int((status == code).sum()) for code, name in enumerate(columns.STATUSES)
        },
        "settled": int(settled.sum()),
        "confidence": CONFIDENCE,
        "bounds": why or "order statistics of independent draws",
        "quantiles": {name: _quantiles(found, why is None) for name, found in values.items()},
        "cases": ensemble.source.identity,
        "provenance": _provenance(ensemble.source),
        "numerics": ensemble.numerics.as_dict(),
        "failures": failures[:_SHOWN],
        "digest": store.digest(),
        "failed": []
        if counts["ok"]
        else [
            f"case {item['case']}: {item['status']}: {item['reason']}" for item in failures[:_SHOWN]
        ],
    }


def _values(store: Store, name: str, of: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """A function of a result, chunk by chunk: whole vectors of ten million cases would not fit
    beside each other."""
    return np.concatenate(
        [of(store.column(name, *store.bounds(number))) for number in range(len(store))]
    )


def _no_bounds(source) -> str | None:
    """Why order statistics bound nothing here, or None."""
    if not isinstance(source, Drawn):
        return "none: nothing is known of how the table's cases were drawn"
    if source.uncertainty.sampling != "random":
        return (
            f"none: points of {source.uncertainty.sampling} sampling depend on each other; "
            f"sampling random has bounds"
        )
    return None


def _quantiles(values: np.ndarray, bounded: bool) -> list[dict]:
    rows = []
    for share in SHARES:
        low, high = order_statistics.bounds(values, share, CONFIDENCE) if bounded else (None, None)
        rows.append(
            {"share": share, "value": float(np.quantile(values, share)), "low": low, "high": high}
        )
    return rows


def _provenance(source) -> dict[str, str]:
    return (
        {key: item.provenance for key, item in source.uncertainty.vary.items()}
        if isinstance(source, Drawn)
        else {}
    )


def lines(found: dict) -> list[str]:
    """The summary in words and units."""
    counts, run_ = found["counts"], found["run"]
    said = [
        f"{found['scene']}, model {found['model']}: {counts['asked']:,} cases = {counts['ok']:,} "
        f"ok + "
        f"{counts['refused']:,} refused + {counts['failed']:,} failed; {found['settled']:,} left "
        f"the rail and settled"
    ]
    said += [
        f"  {item['status']}       case {item['case']}: {' '.join(item['reason'].split())}"
        for item in found["failures"]
    ]
    for key, item in found["cases"].get("vary", {}).items():
        rule = f", rule {item['rule']}" if "rule" in item else ""
        said.append(f"  varied        {key}: {item['distribution']}{rule}")
    said += [
        f"  {_LABELS[name]:13} " + "   ".join(map(_quantile, rows))
        for name, rows in found["quantiles"].items()
    ]
    said.append(f"  bounds        {found['confidence']:.0%} confidence: {found['bounds']}")
    speed = (
        f", {run_['cpu_ms_per_case']:.3f} ms of processor time per case"
        if "cpu_ms_per_case" in run_
        else ""
    )
    memory = f"{run_['peak_memory_bytes'] / 1e6:.0f} MB of memory at most"
    said.append(
        f"  took          {run_['wall_s']:.3g} s for {run_['cases']:,} cases{speed}; {memory}"
    )
    return [*said, f"  agreement     {found['agreement']}", f"  store         {found['store']}"]


def _quantile(row: dict) -> str:
    bounds = (
        ""
        if row["low"] is None and row["high"] is None
        else f" [{_bound(row['low'])}, {_bound(row['high'])}]"
    )
    return f"{row['share']:.4g}: {row['value']:.4g}{bounds}"


def _bound(value: float | None) -> str:
    return "none" if value is None else f"{value:.4g}"
