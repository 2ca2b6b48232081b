"""Agreement with the reference on the page."""

from typing import TYPE_CHECKING

from tipoff.studies.render.markup import (
    Html,
    caption,
    fold,
    joined,
    number,
    paragraph,
    percent,
    table,
)

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_HEADS = (
    "condition",
    "role",
    "rate L2 (%)",
    "floor L2 (%)",
    Html("v<sub>x</sub> L2 (%)"),
    "settled error (deg/s)",
    "error x, y, z (deg/s)",
    "floor (deg/s)",
    "reference ± (deg/s)",
    "ISO 18571",
    "S-G magnitude (%)",
    "S-G phase (%)",
    "verdict",
)

_FLOOR = "Floor: what ±{change:g} µm of clearance changes in either model. "


def draw(page: "Page") -> Html:
    """The section, or how to make what it shows."""
    return page.section(
        "agreement", "agreement-section", "Agreement with the reference", agreement, "compare"
    )


def agreement(document: dict) -> Html:
    """The agreement tables, the surrogate on compliant contact first, with floor and reference
    uncertainty beside every claim."""
    gates = document["gates"]
    legend = (
        f"Gates: rate L2 {percent(gates['rate_relative_l2'])} %, v_x L2 "
        f"{percent(gates['velocity_relative_l2'])} %, "
        f"settled error {gates['settled_rate_error_deg_s']:g} deg/s, or twice the floor where that "
        f"is more. "
        + _FLOOR.format(change=1e6 * document["clearance_change_m"])
        + "Reference ±: the largest change of its settled rates from twice the element size on, "
        f"and there under half the step or four times the penalty; above "
        f"{document['converged_deg_s']:g} deg/s no agreement "
        "is claimed. A star marks a value measured on other conditions, of which the largest is "
        "taken. ISO 18571 is the mean "
        "rating of the three rates (1 is perfect); Sprague and Geers over the three rates together."
    )
    calibrated = [*document["fitted"], *document["held_out"]]
    return joined(
        paragraph(
            "On compliant contact as the statics of the rail has them, nothing fitted (the role is "
            "that of the "
            "condition in the calibration of springs): " + summary(document["compliant"])
        ),
        judged(document["compliant"], "agreement"),
        caption(legend),
        _further(document["compliant"]),
        _simpler(document),
        _stiffer(document["stiffer"]),
        paragraph(
            "One spring and damper per pad face, calibrated on the fitted conditions: "
            + summary(document["fitted"], "fitted ")
            + "; "
            + summary(document["held_out"], "held-out ")
        ),
        judged(calibrated, "agreement-calibrated"),
        _further(calibrated),
        fold(
            "the same before calibration",
            judged(document["uncalibrated"], "agreement-uncalibrated"),
        ),
        _evidence(document),
    )


def judged(rows: list[dict], name: str) -> Html:
    """A table of agreement rows: good, bad, or of a reference that is not converged."""
    kinds = [
        "doubt" if not row["reference_converged"] else "good" if row["passes"] else "bad"
        for row in rows
    ]
    return table(_HEADS, [_agreement_row(row) for row in rows], name, kinds, dense=True)


def _simpler(document: dict) -> Html:
    """What each part of the walls' flexibility is worth."""
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
    return fold(
        "what the parts of the flexibility are worth: rate L2 (%) and settled error (deg/s) when "
        "the surrogate knows less, "
        "or more",
        table(("walls", *names), rows, dense=True),
    )


def _stiffer(found: list[dict]) -> Html:
    """What the penalty makes uncertain, and what of it is a difference of the models."""
    if not found:
        return Html("")
    rows = [
        (
            item["condition"],
            *(
                number(item[key], 2)
                for key in (
                    "reference_change_deg_s",
                    "surrogate_change_deg_s",
                    "apart_deg_s",
                    "apart_with_more_deg_s",
                )
            ),
        )
        for item in found
    ]
    return fold(
        "four times the penalty in both models: how far settled rates move, and how far apart the "
        "models are (deg/s)",
        table(
            (
                "condition",
                "the reference moves by",
                "the surrogate moves by",
                "apart before",
                "apart after",
            ),
            rows,
        ),
        caption(
            "The reference on the coarse mesh. Where both move alike the stiffness of the penalty "
            "makes the answer "
            "uncertain, and the agreement of the models does not depend on it."
        ),
    )


def _errors(row: dict) -> str:
    return f"{percent(row['rate_relative_l2'])}; {number(row['settled_rate_error_deg_s'], 2)}"


def summary(rows: list[dict], words: str = "") -> str:
    """How many of the ``words`` conditions agree."""
    passed, doubtful = (
        sum(row["passes"] for row in rows),
        sum(not row["reference_converged"] for row in rows),
    )
    return (
        f"{passed} of {len(rows)} {words}conditions pass all three gates"
        + _free(rows)
        + (
            f" ({doubtful} of {len(rows)} with a reference that is not converged)"
            if doubtful
            else ""
        )
    )


def _free(rows: list[dict]) -> str:
    count = sum(row["passes"] and not row["touches"] for row in rows)
    return f", {count} of them without touching the rail at all" if count else ""


def _agreement_row(row: dict) -> tuple:
    floor_here, uncertainty_here = (
        row["floor_measured_here"],
        row["reference_uncertainty_measured_here"],
    )
    xyz = row["settled_rate_error_xyz_deg_s"]
    return (
        row["condition"],
        row["role"].replace("_", " "),
        percent(row["rate_relative_l2"]),
        _starred(percent(row["floor_l2"]), floor_here),
        percent(row["velocity_relative_l2"]),
        number(row["settled_rate_error_deg_s"]),
        "–" if xyz is None else ", ".join(f"{value:+.2g}" for value in xyz),
        _starred(number(row["floor_deg_s"]), floor_here),
        _starred(number(row["reference_uncertainty_deg_s"]), uncertainty_here),
        f"{row['iso18571']:.3f}",
        percent(row["sprague_geers_magnitude"]),
        percent(row["sprague_geers_phase"]),
        row["verdict"],
    )


def _starred(shown: str, measured_here: bool) -> Html:
    """A number, with a star where it was measured on other conditions."""
    return Html(shown if measured_here else f"{shown}*")


def _further(rows: list[dict]) -> Html:
    """Lateral velocity, direction, and the ratings of each channel."""
    channels = list(rows[0]["iso18571_channels"]) if rows else []
    lines = [
        (
            row["condition"],
            *(
                _signed(row[name], factor)
                for name, factor in (
                    ("lateral_velocity_difference_m_s", 1e3),
                    ("direction_error_difference_deg", 1.0),
                )
            ),
            *(f"{row['iso18571_channels'][name]:.3f}" for name in channels),
            *(_pair(row["sprague_geers_channels"][name]) for name in channels),
        )
        for row in rows
    ]
    names = [name.replace("_", " ") for name in channels]
    return fold(
        "lateral velocity, direction, and each channel by itself",
        table(
            (
                "condition",
                "lateral velocity (mm/s)",
                "direction (deg)",
                *(f"ISO 18571, {name}" for name in names),
                *(f"S-G M; P (%), {name}" for name in names),
            ),
            lines,
            dense=True,
        ),
        caption("Differences are surrogate minus reference."),
    )


def _signed(value: float | None, factor: float) -> str:
    return "–" if value is None else f"{factor * value:+.3g}"


def _pair(values: list[float] | None) -> str:
    return "–" if values is None else "; ".join(f"{100.0 * value:.2g}" for value in values)


def _evidence(document: dict) -> Html:
    rows = [
        (
            item["condition"],
            item["model"],
            item["cause"],
            percent(item["rate_relative_l2"]),
            number(item["settled_rate_change_deg_s"]),
        )
        for item in [*document["floor"], *document["refinement"]]
    ]
    return fold(
        "floor and reference uncertainty as measured",
        table(
            ("condition", "model", "what was changed", "rate L2 (%)", "settled rates (deg/s)"), rows
        ),
    )
