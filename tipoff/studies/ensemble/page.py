"""An ensemble for the terminal: quantiles with bounds, and the distributions of the inputs."""

from typing import Any

from tipoff.mechanics.instant import EXIT, Instant
from tipoff.scenes import overrides
from tipoff.scenes.scene import Scene
from tipoff.studies.ensemble.halves import SHARE, Halved
from tipoff.studies.ensemble.sensitivity import CAUSES
from tipoff.studies.ensemble.stage import Cost, One, Ran, Sensitive
from tipoff.studies.ensemble.summary import Above
from tipoff.studies.populations.paired import Bounded
from tipoff.studies.render.document import Bullets, Part
from tipoff.studies.render.table import Column, Table, bounded, estimate, percent
from tipoff.uncertain import LEAST, number
from tipoff.workspace.words import counted

_LABELS = {
    "rate_deg_s": "total settled rate (deg/s)",
    "exit_rate_deg_s": "total rate at exit (deg/s)",
    **{f"rate_{axis}_deg_s": f"settled rate about {axis}, size (deg/s)" for axis in "xyz"},
    **{f"exit_rate_{axis}_deg_s": f"rate at exit about {axis}, size (deg/s)" for axis in "xyz"},
    "lateral_velocity_mm_s": "lateral velocity (mm/s)",
    "direction_error_deg": "direction error (deg)",
    "exit_lateral_velocity_mm_s": "lateral velocity at exit (mm/s)",
    "exit_direction_error_deg": "direction error at exit (deg)",
    "impulse_after_exit_percent": "impulse after the exit (%)",
}
_STORED = {
    None: "no stored result to compare with",
    True: "the stored result has the same bits",
    False: "THE STORED RESULT DIFFERS",
}


def summary(found: Ran) -> list[Part]:
    """Counts, failures, quantiles and the cost of the run."""
    counts, cost = found.counts, found.run
    failures = [
        f"{item['status']}: case {item['case']}: {' '.join(item['reason'].split())}"
        for item in found.failures
    ]
    run = [
        f"{found.scene}, model {found.model}: {counted(counts['asked'], 'case')} = {counts['ok']:,} "
        f"ok + {counts['refused']:,} refused + {counts['failed']:,} failed; {found.settled:,} "
        f"left the rail{'' if found.at == EXIT else ' and settled'}{_others(found.statuses)}",
        f"rates {Instant(found.at, found.at_why).words}",
        f"agreement: {found.agreement}",
        *failures,
    ]
    return [
        Bullets(run),
        *_varied(found.cases.get("vary", {}), found.ranges),
        *([table_of_quantiles(found)] if found.quantiles else []),
        *(_above(found) if found.above else []),
        *([table_of_halves(found)] if found.halves else []),
        f"run time: {_time(cost)}; {(cost.peak_memory_bytes or 0) / 1e6:.0f} MB of memory at most",
        *(_sensitivity(found.sensitivity) if found.sensitivity else []),
        f"store: {found.store}, with its figures",
    ]


def _above(found: Ran) -> list[Part]:
    """The probability above any limit, and above each of several. Cases without a rate count as above."""
    above = found.above
    assert above is not None
    lost = found.counts["asked"] - found.settled
    unknown = f"; {counted(lost, 'case')} without a rate count as above" if lost else ""
    lines = [f"above any of the limits {', '.join(above.limits)}: {_shared(above, found)}{unknown}"]
    lines += [f"  above {item.limits[0]}: {_shared(item, found)}" for item in above.each]
    return [Bullets(lines)]


def _shared(above: Above, found: Ran) -> str:
    most = (
        ""
        if above.low is None or above.high is None
        else f" ({found.confidence:.0%} bounds {percent(above.low)} to {percent(above.high)} %)"
    )
    return f"{percent(above.share)} % of the cases, {above.count:,}{most}"


def _others(statuses: dict[str, int]) -> str:
    """Cases that neither left the rail nor failed: jammed, or at the time limit."""
    words = {"jammed": "jammed", "time_limit": "reached the time limit"}
    found = [f"{statuses[name]:,} {text}" for name, text in words.items() if statuses.get(name)]
    return "".join(f", {text}" for text in found)


def _time(cost: Cost) -> str:
    each = cost.cpu_ms_per_case
    processor = "" if each is None else f", {each:.3f} ms of processor time per case"
    return f"{cost.wall_s:.3g} s for {counted(cost.cases, 'case')}{processor}"


def _sensitivity(found: Sensitive) -> list[Part]:
    """How many cases are sensitive, the changes by cause, and the additional run time."""
    limit = f"{found.limit_deg_s:.3g} deg/s"
    rows = [
        (
            CAUSES[cause],
            *(
                "-" if value is None else f"{value:.2g}"
                for value in (item.median_deg_s, item.q95_deg_s, item.largest_deg_s)
            ),
            f"{item.above_limit:,}",
            f"{item.unsettled:,}",
        )
        for cause, item in found.by.items()
    ]
    heads = ["change by", "median (deg/s)", "95 % below", "largest", f"above {limit}", "unsettled"]
    took = [f"{CAUSES[cause]}: {_time(cost)}" for cause, cost in found.run.items()]
    return [
        f"sensitive: {counted(found.sensitive, 'case')}. A settled rate changes by more than "
        f"{limit}, or the disturbed run does not settle.",
        Table(heads, rows),
        f"additional run time of the sensitivity: {'; '.join(took)}",
    ]


def _varied(vary: dict, stated: dict[str, str]) -> list[Part]:
    rows = [
        (key, stated.get(key, ""), item["distribution"], item.get("rule", ""))
        for key, item in vary.items()
    ]
    heads = ["varied input", "95 % of its values", "distribution", "beyond its bounds"]
    return [Table(heads, rows)] if rows else []


def table_of_quantiles(found: Ran) -> Table:
    """Quantiles of each result with their bounds."""
    rows = [(_LABELS[name], *map(estimate, rows)) for name, rows in found.quantiles.items()]
    shares = [row.share for row in next(iter(found.quantiles.values()))]
    heads = ["quantity", *(f"{percent(share, 'g')} % below" for share in shares)]
    return Table(heads, rows, notes=(f"{found.confidence:.0%} bounds: {found.bounds}.",))


def table_of_halves(found: Ran) -> Table:
    """The errors as stated, and with each tolerance halved."""
    limited = found.halves[0].above is not None
    rate = Column(f"{100.0 * SHARE:g} % quantile of the total rate", "deg/s")
    above = Column("above a limit", "%")
    heads: list[Column | str] = ["halved tolerance", "95 % of its values", "halved", rate, "change"]
    rows = [_half(row, limited) for row in found.halves]
    lost = sum(row.unsettled for row in found.halves)
    notes = [
        f"All rows have the same draws. Bounds: {found.confidence:.0%}; those of a change are from the pairs of "
        "cases."
        if found.halves[0].rate.low is not None
        else f"Bounds: {found.bounds}."
    ]
    if lost:
        notes.append(
            f"{counted(lost, 'case')} of all rows without a rate: in no quantile, and above a limit."
        )
    if limited:
        heads += [above, "change"]
    return Table(heads, rows, notes=tuple(notes))


def _half(row: Halved, limited: bool) -> tuple:
    cells = [
        row.tolerance or "none",
        row.stated,
        row.halved,
        _cell(row.rate),
        _cell(row.rate_change),
    ]
    if limited:
        cells += [_cell(row.above, 100.0), _cell(row.above_change, 100.0)]
    return tuple(cells)


def _cell(found: Bounded | None, scale: float = 1.0) -> Any:
    if found is None:
        return ""
    low, high = (None if end is None else scale * end for end in (found.low, found.high))
    return bounded(scale * found.value, low, high)


def _named(key: str) -> str:
    """An input with the unit of its numbers."""
    unit = overrides.unit(Scene, key)
    return f"{key} ({unit})" if unit and unit != "dimensionless" else key


def case(one: One) -> list[Part]:
    """One case: status, inputs, velocity and rate with all digits, and the comparison with the
    store."""
    found = one.found
    message, outcome = f" ({found.message})" if found.message else "", found.outcome
    parts: list[Part] = [
        f"case {one.case}: {found.status}{message}",
        Table(["input", "value"], [(_named(key), text) for key, text in one.inputs.items()]),
    ]
    if outcome.rate is not None and outcome.velocity is not None:
        vectors = (
            ("velocity (m/s)", outcome.velocity),
            ("rate (rad/s)", outcome.rate),
            ("velocity at exit (m/s)", outcome.exit_velocity),
            ("rate at exit (rad/s)", outcome.exit_rate),
        )
        rows = [
            (name, *(f"{value:.17g}" for value in vector)) for name, vector in vectors if vector
        ]
        parts.append(Table(["", "x", "y", "z"], rows))
    parts += [
        f"{CAUSES[cause]}: "
        + ("does not settle" if change is None else f"{number(change, '.2g', LEAST)} deg/s")
        for cause, change in (one.changes or {}).items()
    ]
    return [*parts, _STORED[one.stored]]
