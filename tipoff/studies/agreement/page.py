"""Agreement with the reference."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import Any

from tipoff.comparison.metrics import CHANNELS
from tipoff.studies.agreement import distribution_page, interface, verdicts
from tipoff.studies.agreement.stage import Agreement, Simpler
from tipoff.studies.agreement.verdicts import JudgedCondition
from tipoff.studies.render.column import of_record
from tipoff.studies.render.document import Fold, Part
from tipoff.studies.render.table import Column, Table, percent
from tipoff.uncertain import LEAST, Measured, number, rounded


def starred(shown: str, measured_here: bool) -> str:
    """A number, with a star if it was measured on other conditions."""
    return shown if measured_here else f"{shown}*"


def _to_floor(name: str, signed: bool = False) -> Callable[[JudgedCondition], Measured]:
    """A cell with an error, rounded to the floor; its size, unless it is ``signed``."""
    return lambda row: Measured(
        getattr(row, name), row.floor_deg_s, apart=signed, magnitude=not signed
    )


def _rounded(uncertainty: float | None) -> str:
    """A floor or an uncertainty (deg/s) with two digits."""
    return rounded(uncertainty, uncertainty)


_RATINGS = (
    "ISO 18571 is the mean rating of the three rates (1 is perfect). Sprague and Geers (S-G) is over the "
    "three rates together."
)
_percent = partial(Column, unit="%", form=".2g", scale=100.0, detail=True)
_COLUMNS: tuple[Any, ...] = (
    "condition",
    (Column("role", detail=True), lambda row: row.role.replace("_", " ")),
    "rate_relative_l2",
    (
        _percent("floor L2"),
        lambda row: starred(percent(row.floor_l2, ".2g"), row.floor_measured_here),
    ),
    (_percent("v_x L2"), attrgetter("velocity_relative_l2")),
    (Column("settled error", "deg/s"), _to_floor("settled_rate_error_deg_s")),
    (
        Column("error x, y, z", "deg/s", "+.2g", detail=True),
        _to_floor("settled_rate_error_xyz_deg_s", signed=True),
    ),
    (
        Column("floor", "deg/s", detail=True),
        lambda row: starred(_rounded(row.floor_deg_s), row.floor_measured_here),
    ),
    (
        Column("reference ±", "deg/s"),
        lambda row: starred(
            _rounded(row.reference_uncertainty_deg_s), row.reference_uncertainty_measured_here
        ),
    ),
    (Column("ISO 18571", form=".3f", detail=True), attrgetter("iso18571")),
    (_percent("S-G magnitude"), attrgetter("sprague_geers_magnitude")),
    (_percent("S-G phase"), attrgetter("sprague_geers_phase")),
    *("judged_as", "verdict"),
)


def draw(found: Agreement) -> list[Part]:
    """The agreement tables, first that of compliant contact; every row has its floor and the
    uncertainty of the reference."""
    return [
        "Compliant contact with the rail compliance and without fitted constants. The role is "
        f"that of the condition in the calibration of springs. {summary(found.compliant)}.",
        replace(judged(found.compliant, "agreement", _notes(found)), details=(_RATINGS,)),
        _further(found.compliant),
        _simpler(found),
        *distribution_page.parts(found.distributions, found.clearance_change_m),
        *at_factors(found.interface),
        "One spring and damper at each pad face, calibrated on the fitted conditions. "
        f"{summary(found.fitted, 'fitted ')}; {summary(found.held_out, 'held-out ')}.",
        judged(found.calibrated, "agreement-calibrated"),
        _further(found.calibrated),
        Fold("Before calibration", [judged(found.uncalibrated, "agreement-uncalibrated")]),
        _evidence(found),
    ]


def _notes(found: Agreement) -> tuple[str, ...]:
    gates, under = found.gates, found.rail_compliance
    return (
        *([f"Elements: {under['words']}."] if under else []),
        f"Limits of agreement: rate L2 {percent(gates.rate_relative_l2)} %, v_x L2 "
        f"{percent(gates.velocity_relative_l2)} %, settled error "
        f"{gates.settled_rate_error_deg_s:g} deg/s or twice the floor, if that is larger. "
        f"Floor: change of either model by ±{1e6 * found.clearance_change_m:g} µm of "
        "clearance.",
        "Reference ±: the largest uncertainty of its settled rates by mesh, step and contact "
        "cells, each extrapolated with its observed order. Above "
        f"{found.converged_deg_s:g} deg/s the reference is not converged. A condition is "
        "judged as a distribution if its reference is not converged, or if 1 µm changes a "
        "settled rate by more than the limit of agreement.",
        "Settled errors are rounded to the floor. A star marks a value that is not measured on "
        "this condition: the largest value of other conditions.",
    )


def judged(rows: Sequence[JudgedCondition], name: str, notes: tuple[str, ...] = ()) -> Table:
    """A table of agreement rows: good, bad, or not judged."""
    kinds = [distribution_page.kind(row.judgement) for row in rows]
    return Table.of_records(
        rows, *_COLUMNS, kind=JudgedCondition, notes=notes, name=name, kinds=kinds, dense=True
    )


def _simpler(found: Agreement) -> Fold:
    """Errors with parts of the rail compliance."""
    lines: dict[str, list[JudgedCondition | Simpler]] = {}
    for item in found.simpler:
        lines.setdefault(item.walls, []).append(item)
    lines["all"] = list(found.compliant)
    lines[f"all, and the {found.rail_modes} lowest modes of each rail"] = list(found.modal)
    names = list(dict.fromkeys(item.condition for item in found.simpler))
    rows = []
    for words, items in lines.items():
        own = {item.condition: item for item in items}
        rows.append((words, *(_errors(own[name]) for name in names)))
    return Fold(
        "Compliant contact with parts of the rail compliance, and with modes: rate L2 (%) and "
        "settled error (deg/s)",
        [Table(("rail compliance", *names), rows, dense=True)],
    )


def at_factors(found: Sequence[interface.AtStiffness]) -> list[Part]:
    """Both models at other values of the interface stiffness, with a line for each condition and in
    full; empty without contact."""
    if not found:
        return []
    kinds = [distribution_page.kind(item.judgement) for item in found]
    note = (
        "Both models run on the coarse mesh. Changes are those of the largest settled rate, "
        "relative to factor 1. The interface stiffness is a property of the launcher and "
        "changes both models. A condition agrees if it agrees at every factor at which it is "
        "judged."
    )
    names = [name for name in of_record(interface.AtStiffness) if name != "verdict"]
    table = Table.of_records(
        found, *names, "verdict", notes=(note,), name="interface", kinds=kinds, dense=True
    )
    return [
        by_factor(found),
        Fold("Agreement at a quarter, once and four times the interface stiffness", [table]),
    ]


def by_factor(found: Sequence[interface.AtStiffness]) -> Table:
    """Errors and verdicts at other values of the interface stiffness, a line for each condition."""
    factors = list(dict.fromkeys(item.factor for item in found))
    rows = []
    for name in dict.fromkeys(item.condition for item in found):
        own = {item.factor: item for item in found if item.condition == name}
        moved = own[factors[-1]].reference_change_deg_s
        rows.append((name, *(f"{_errors(own[at])}; {own[at].verdict}" for at in factors), moved))
    heads: tuple[Column | str, ...] = (
        "condition",
        *(f"{factor:g} times" for factor in factors),
        Column(f"change of the reference at {factors[-1]:g} times", "deg/s", ".2g"),
    )
    title = (
        "Compliant contact at other values of the interface stiffness, which both models share, on "
        "the coarse mesh\n(rate L2 in %; largest error of a settled rate in deg/s): "
        f"{stiffnesses(found)}."
    )
    return Table(heads, rows, title=title)


def stiffnesses(found: Sequence[interface.AtStiffness]) -> str:
    """How many of the judged conditions agree at each factor."""
    judged_rows = [item for item in found if item.judgement != verdicts.CANNOT]
    if not judged_rows:
        return "none of these conditions can be judged"
    parts = []
    for factor in dict.fromkeys(item.factor for item in found):
        own = [item.judgement for item in judged_rows if item.factor == factor]
        parts.append(
            f"{own.count(verdicts.AGREES)} of {len(own)} judged conditions agree at {factor:g} times"
            if own
            else f"none is judged at {factor:g} times"
        )
    return ", ".join(parts)


def _errors(row: JudgedCondition | Simpler | interface.AtStiffness) -> str:
    error = number(row.settled_rate_error_deg_s, ".2g", LEAST)
    return f"{percent(row.rate_relative_l2, '.2g')}; {error}"


def summary(rows: Sequence[JudgedCondition], words: str = "") -> str:
    """How many of the ``words`` conditions agree, as curves and as distributions, cannot be judged, and
    miss."""
    return " ".join(counts(rows, words))


def counts(rows: Sequence[JudgedCondition], words: str = "") -> tuple[str, str]:
    """The two parts of ``summary``: how many of how many, and the rest of the sentence."""
    count = Counter(row.judgement for row in rows)
    free = sum(row.judgement == verdicts.AGREES and not row.touches for row in rows)
    curves, alike, missing = (
        count[word] for word in (verdicts.AGREES, verdicts.AS_DISTRIBUTION, verdicts.MISSES)
    )
    of_them = [
        *([f"{free} of them without contact"] if free else []),
        *([f"{alike} of them as distributions"] if alike else []),
    ]
    return f"{curves + alike} of {len(rows)}", (
        f"{words}conditions agree"
        + (f" ({', '.join(of_them)})" if of_them else "")
        + f", {count[verdicts.CANNOT]} cannot be judged, "
        + f"{missing} {'misses' if missing == 1 else 'miss'}"
    )


def _further(rows: Sequence[JudgedCondition]) -> Fold:
    """Lateral velocity, direction, and the ratings of each channel."""
    columns: list[Any] = [
        "condition",
        (
            Column("lateral velocity", "mm/s", "+.3g", 1e3),
            attrgetter("lateral_velocity_difference_m_s"),
        ),
        (Column("direction", "deg", "+.3g"), attrgetter("direction_error_difference_deg")),
    ]
    for words, column, field in (
        ("ISO 18571", partial(Column, form=".3f"), "iso18571_channels"),
        ("S-G M, P", partial(Column, unit="%", form=".2g", scale=100.0), "sprague_geers_channels"),
    ):
        columns += [
            (
                column(f"{words}, {channel.replace('_', ' ')}"),
                lambda row, field=field, channel=channel: getattr(row, field)[channel],
            )
            for channel in CHANNELS
        ]
    note = "Lateral velocity and direction: surrogate minus reference."
    return Fold(
        "Lateral velocity, direction, and ratings of each channel",
        [Table.of_records(rows, *columns, kind=JudgedCondition, notes=(note,), dense=True)],
    )


def _evidence(found: Agreement) -> Fold:
    note = "Changes are those of the last refinement."
    refinements = Table.of_records(
        found.refinement, kind=verdicts.Refinement, notes=(note,), dense=True
    )
    return Fold(
        "Measured floor and uncertainty of the reference",
        [Table.of_records(found.floor, kind=verdicts.Spread), refinements],
    )
