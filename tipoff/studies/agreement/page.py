"""Agreement with the reference on the page."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from tipoff.studies.agreement import distribution_page, verdicts
from tipoff.studies.render.document import Fold, Part
from tipoff.studies.render.table import Cells, Column, Table, percent
from tipoff.studies.render.uncertain import LEAST, Measured, number, rounded

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def _percent(title: str) -> Column:
    return Column(title, "%", ".2g", 100.0)


def _to_floor(key: str) -> Callable[[dict], Measured]:
    """A cell with an error, rounded to the floor."""
    return lambda row: Measured(row[key], row["floor_deg_s"], apart=True)


def starred(shown: str, measured_here: bool) -> str:
    """A number, with a star where it was measured on other conditions."""
    return shown if measured_here else f"{shown}*"


def _starred(key: str, measured_here: str, shown: Callable[..., str]) -> Callable[[dict], str]:
    """A cell with a value that may have a star."""
    return lambda row: starred(shown(row[key]), row[measured_here])


def _rounded(uncertainty: float | None) -> str:
    """A floor or an uncertainty (deg/s) with the digits that count."""
    return rounded(uncertainty, uncertainty)


_FLOOR, _REFERENCE = "floor_measured_here", "reference_uncertainty_measured_here"
_COLUMNS: Cells = (
    ("condition", "condition"),
    ("role", lambda row: row["role"].replace("_", " ")),
    (_percent("rate L2"), "rate_relative_l2"),
    (_percent("floor L2"), _starred("floor_l2", _FLOOR, lambda share: percent(share, ".2g"))),
    (_percent("v_x L2"), "velocity_relative_l2"),
    (Column("settled error", "deg/s"), _to_floor("settled_rate_error_deg_s")),
    (Column("error x, y, z", "deg/s", "+.2g"), _to_floor("settled_rate_error_xyz_deg_s")),
    (Column("floor", "deg/s"), _starred("floor_deg_s", _FLOOR, _rounded)),
    (
        Column("reference ±", "deg/s"),
        _starred("reference_uncertainty_deg_s", _REFERENCE, _rounded),
    ),
    (Column("ISO 18571", form=".3f"), "iso18571"),
    (_percent("S-G magnitude"), "sprague_geers_magnitude"),
    (_percent("S-G phase"), "sprague_geers_phase"),
    ("judged as", "judged_as"),
    ("verdict", "verdict"),
)


def draw(page: "Page") -> list[Part]:
    """The section, or how to make its result."""
    return page.shown("agreement", agreement, "compare")


def agreement(document: dict) -> list[Part]:
    """The agreement tables, first that of compliant contact; every row has its floor and the
    uncertainty of the reference."""
    calibrated = [*document["fitted"], *document["held_out"]]
    return [
        "Compliant contact with the rail compliance and without fitted constants. The role is "
        f"that of the condition in the calibration of springs. {summary(document['compliant'])}.",
        judged(document["compliant"], "agreement", _notes(document)),
        _further(document["compliant"]),
        _simpler(document),
        *distribution_page.parts(document),
        *interface(document["interface"]),
        "One spring and damper at each pad face, calibrated on the fitted conditions. "
        f"{summary(document['fitted'], 'fitted ')}; {summary(document['held_out'], 'held-out ')}.",
        judged(calibrated, "agreement-calibrated"),
        _further(calibrated),
        Fold("Before calibration", [judged(document["uncalibrated"], "agreement-uncalibrated")]),
        _evidence(document),
    ]


def terminal(document: dict) -> list[Part]:
    """Verdicts on compliant contact, and at other values of the interface stiffness."""
    columns: Cells = (
        ("condition", "condition"),
        (_percent("rate L2"), "rate_relative_l2"),
        (Column("settled error", "deg/s", ".2g"), "settled_rate_error_deg_s"),
        (Column("reference ±", "deg/s", ".2g"), "reference_uncertainty_deg_s"),
        ("judged as", "judged_as"),
        ("verdict", "verdict"),
    )
    title = f"Compliant contact: {summary(document['compliant'])}."
    under = document.get("rail_compliance")
    alike = document["distributions"]
    return [
        Table.of(
            document["compliant"], columns, title=title, notes=(under["words"],) if under else ()
        ),
        *([distribution_page.verdicts_of(alike)] if alike else []),
        *by_factor(document["interface"]),
    ]


def _notes(document: dict) -> tuple[str, ...]:
    gates, under = document["gates"], document.get("rail_compliance")
    return (
        *([f"Elements: {under['words']}."] if under else []),
        f"Limits of agreement: rate L2 {percent(gates['rate_relative_l2'])} %, v_x L2 "
        f"{percent(gates['velocity_relative_l2'])} %, settled error "
        f"{gates['settled_rate_error_deg_s']:g} deg/s or twice the floor, if that is larger. "
        f"Floor: change of either model by ±{1e6 * document['clearance_change_m']:g} µm of "
        "clearance.",
        "Reference ±: the largest uncertainty of its settled rates by mesh, step and contact "
        "cells, each extrapolated with its observed order. Above "
        f"{document['converged_deg_s']:g} deg/s the reference is not converged. A condition is "
        "judged as a distribution if its reference is not converged, or if 1 µm changes a "
        "settled rate by more than the limit of agreement.",
        "Settled errors are rounded to the floor. A star marks a value that is not measured on "
        "this condition: the largest value of other conditions. ISO 18571 is the mean rating of "
        "the three rates (1 is perfect). Sprague and Geers (S-G) is over the three rates "
        "together.",
    )


def judged(rows: list[dict], name: str, notes: tuple[str, ...] = ()) -> Table:
    """A table of agreement rows: good, bad, or not judged."""
    kinds = [distribution_page.kind(row["judgement"]) for row in rows]
    return Table.of(rows, _COLUMNS, notes=notes, name=name, kinds=kinds, dense=True)


def _simpler(document: dict) -> Fold:
    """Errors with parts of the rail compliance."""
    found = document["simpler"]
    names = list(dict.fromkeys(item["condition"] for item in found))
    rows = []
    for words in dict.fromkeys(item["walls"] for item in found):
        own = {item["condition"]: item for item in found if item["walls"] == words}
        rows.append((words, *(_errors(own[name]) for name in names)))
    whole = {
        "all": "compliant",
        f"all, and the {document['rail_modes']} lowest modes of each rail": "modal",
    }
    rows += [
        (
            words,
            *(
                _errors(row)
                for name in names
                for row in document[group]
                if row["condition"] == name
            ),
        )
        for words, group in whole.items()
    ]
    return Fold(
        "Compliant contact with parts of the rail compliance, and with modes: rate L2 (%) and "
        "settled error (deg/s)",
        [Table(("rail compliance", *names), rows, dense=True)],
    )


def interface(found: list[dict]) -> list[Part]:
    """Both models at other values of the interface stiffness; nothing without contact."""
    if not found:
        return []
    columns: Cells = (
        ("condition", "condition"),
        (Column("factor", form="g"), "factor"),
        (Column("interface stiffness", "N/m³", ".3g"), "interface_stiffness_n_m3"),
        (Column("change of the reference", "deg/s", ".2g"), "reference_change_deg_s"),
        (Column("change of the surrogate", "deg/s", ".2g"), "surrogate_change_deg_s"),
        (_percent("rate L2"), "rate_relative_l2"),
        (Column("settled error", "deg/s", ".2g"), "settled_rate_error_deg_s"),
        ("verdict", "verdict"),
    )
    kinds = [distribution_page.kind(item["judgement"]) for item in found]
    note = (
        "Both models run on the coarse mesh. Changes are those of the largest settled rate, "
        "relative to factor 1. The interface stiffness is a property of the launcher and "
        "changes both models. A condition agrees if it agrees at every factor at which it is "
        "judged."
    )
    return [
        f"Other values of the interface stiffness: {stiffnesses(found)}.",
        Fold(
            "Agreement at a quarter, once and four times the interface stiffness",
            [Table.of(found, columns, notes=(note,), name="interface", kinds=kinds, dense=True)],
        ),
    ]


def by_factor(found: list[dict]) -> list[Part]:
    """The same, one line a condition; nothing where they were not compared."""
    factors = list(dict.fromkeys(item["factor"] for item in found))
    rows = []
    for name in dict.fromkeys(item["condition"] for item in found):
        own = {item["factor"]: item for item in found if item["condition"] == name}
        moved = own[factors[-1]]["reference_change_deg_s"]
        rows.append((name, *(f"{_errors(own[at])}; {own[at]['verdict']}" for at in factors), moved))
    if not rows:
        return []
    return [
        Table(
            [
                "condition",
                *(f"{factor:g} times" for factor in factors),
                Column(f"change of the reference at {factors[-1]:g} times", "deg/s", ".2g"),
            ],
            rows,
            title="Compliant contact at other values of the interface stiffness, which both models "
            "share, on the coarse mesh\n(rate L2 in %; largest error of a settled rate in deg/s): "
            f"{stiffnesses(found)}.",
        )
    ]


def stiffnesses(found: list[dict]) -> str:
    """How many of the judged conditions agree at each factor."""
    judged_rows = [item for item in found if item["judgement"] != verdicts.CANNOT]
    if not judged_rows:
        return "none of these conditions can be judged"
    parts = []
    for factor in dict.fromkeys(item["factor"] for item in found):
        own = [item for item in judged_rows if item["factor"] == factor]
        agree = sum(item["judgement"] == verdicts.AGREES for item in own)
        parts.append(
            f"{agree} of {len(own)} judged conditions agree at {factor:g} times"
            if own
            else f"none is judged at {factor:g} times"
        )
    return ", ".join(parts)


def _errors(row: dict) -> str:
    error = number(row["settled_rate_error_deg_s"], ".2g", LEAST)
    return f"{percent(row['rate_relative_l2'], '.2g')}; {error}"


def summary(rows: list[dict], words: str = "") -> str:
    """How many of the ``words`` conditions agree, as curves and as distributions, cannot be judged, and
    miss."""
    return " ".join(counts(rows, words))


def counts(rows: list[dict], words: str = "") -> tuple[str, str]:
    """The same in two parts: how many of how many, and the rest of the sentence."""
    count = {word: sum(row["judgement"] == word for row in rows) for word in verdicts.JUDGEMENTS}
    free = sum(row["judgement"] == verdicts.AGREES and not row["touches"] for row in rows)
    alike, missing = count[verdicts.AS_DISTRIBUTION], count[verdicts.MISSES]
    return f"{count[verdicts.AGREES]} of {len(rows)}", (
        f"{words}conditions agree"
        + (f" ({free} of them without contact)" if free else "")
        + (
            f", {alike} {'agrees as a distribution' if alike == 1 else 'agree as distributions'}"
            if alike
            else ""
        )
        + f", {count[verdicts.CANNOT]} cannot be judged, "
        + f"{missing} {'misses' if missing == 1 else 'miss'}"
    )


def _further(rows: list[dict]) -> Fold:
    """Lateral velocity, direction, and the ratings of each channel."""
    channels = list(rows[0]["iso18571_channels"]) if rows else []
    names = [name.replace("_", " ") for name in channels]
    heads: tuple[Column | str, ...] = (
        "condition",
        Column("lateral velocity", "mm/s", "+.3g", 1e3),
        Column("direction", "deg", "+.3g"),
        *(Column(f"ISO 18571, {name}", form=".3f") for name in names),
        *(Column(f"S-G M, P, {name}", "%", ".2g", 100.0) for name in names),
    )
    lines = [
        (
            row["condition"],
            row["lateral_velocity_difference_m_s"],
            row["direction_error_difference_deg"],
            *(row["iso18571_channels"][name] for name in channels),
            *(row["sprague_geers_channels"][name] for name in channels),
        )
        for row in rows
    ]
    note = "Lateral velocity and direction: surrogate minus reference."
    return Fold(
        "Lateral velocity, direction, and ratings of each channel",
        [Table(heads, lines, (note,), dense=True)],
    )


def _evidence(document: dict) -> Fold:
    run: Cells = (("condition", "condition"), ("model", "model"))
    metrics: Cells = (
        (_percent("rate L2"), "rate_relative_l2"),
        (Column("settled rates", "deg/s"), "settled_rate_change_deg_s"),
    )
    estimated: Cells = (
        (Column("uncertainty", "deg/s", ".2g"), "uncertainty_deg_s"),
        (Column("order", form=".2g"), "order"),
        ("method", "method"),
    )
    return Fold(
        "Measured floor and uncertainty of the reference",
        [
            Table.of(document["floor"], (*run, ("changed input", "cause"), *metrics)),
            Table.of(
                document["refinement"],
                (*run, ("refined", "cause"), *metrics, *estimated),
                notes=("Changes are those of the last refinement.",),
                dense=True,
            ),
        ],
    )
