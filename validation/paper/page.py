"""The paper's numbers: its Table 2 and speed-up beside our values, and the inferred inputs."""

import numpy as np

from tipoff.studies.populations import answers
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Bullets, Figure, Fold, Part
from tipoff.studies.render.palette import AMBER, GREY, NAVY, TEAL, VERMILION
from tipoff.studies.render.table import Cells, Column, Table
from tipoff.workspace.words import counted
from validation import published
from validation.paper import summary

_AXES = tuple(zip("xyz", (NAVY, VERMILION, AMBER), ("o", "s", "^")))
_NINE = ("largest_error_deg_s", "largest error of nine rates, deg/s")
_QUIET = ("largest_negligible_deg_s", "largest rate, conditions 1 and 5, deg/s")
_DEVIATIONS = ("largest_deviation_error_deg_s", "largest error of 54 deviations, deg/s")
_MEASURES = {
    "largest_error_deg_s": Column("largest error of nine rates", "deg/s"),
    "largest_deviation_error_deg_s": Column("largest error of 54 deviations", "deg/s"),
    "largest_negligible_deg_s": Column("largest rate, conditions 1 and 5", "deg/s"),
}
_PAIRS = (
    ("Nine rates, conditions 1 and 5", _NINE, _QUIET),
    ("Nine rates, 54 deviations", _NINE, _DEVIATIONS),
    ("54 deviations, conditions 1 and 5", _DEVIATIONS, _QUIET),
)
_SWEPT = {
    "misalignment": "misalignment (deg)",
    "thrust_eccentricity": "thrust eccentricity (mm)",
    "mass_eccentricity": "mass eccentricity (mm)",
}
_ABOUT = ("here: about x", "about y", "about z", "total")
_NOT_SWEPT = ("",) * len(_ABOUT)
_TRADED = (
    "Ends of the searches by three measures, two in each panel: largest error of the nine "
    "printed rates, largest error of their 54 deviations, largest rate on conditions 1 and 5. "
    "Squares: searches over conditions 2 to 4; circles: over all five. The line is the Pareto "
    "front of all points, with any deviations."
)
_BESIDE = (
    "Printed rates (left) and deviations (right) and those of the best set; equal on the line."
)
_AT_EXIT = (
    "Exit state with the best set, one run for each condition; heads give the radial misalignment. "
    "The paper prints rates of conditions 2 to 4 only. {calibration}"
)


def draw(found: dict) -> list[Part]:
    """The section."""
    trade, beside = figures(found)
    best = found["searches"][found["best"]]
    words = (
        f"The paper prints no geometry, inertia, thrust, friction or clearance. "
        f"{len(found['searches'])} searches over {len(found['inputs'])} inputs within physical "
        "bounds fit the nine rates of its Table 2 and their 54 deviations. Half of them also keep "
        "the rates of conditions 1 and 5, which the paper calls negligible, below "
        f"{found['negligible_deg_s']:g} deg/s. Other inputs can fit as well as the best set."
    )
    return [
        words,
        trade,
        _fit(found),
        beside,
        _table2(best),
        *_deviations(best),
        table_at_exit(found["exit"]),
        table_of_inputs(found),
        Fold("Reasons for the bounds", [_reasons(found["inputs"])]),
        Fold("All searches", [_searches(found["searches"])]),
        table_of_plateaus(found["plateaus"]),
        *_headline(found),
        Bullets(found["slips"]),
        f"Scene {found['scene_file']}, data {found['data']}.",
    ]


def _fit(found: dict) -> Table:
    """Errors of the best set and of the catalogue's scene."""
    best, kept = found["searches"][found["best"]], found["catalogue"]
    rows = [
        (f"best of {len(found['searches'])} searches", *(best[key] for key in _MEASURES)),
        (f"scene {kept['name']}", *(found["known"][key] for key in _MEASURES)),
    ]
    same = (
        f"The best set is the scene {kept['name']} of the catalogue."
        if kept["same"]
        else f"The best set is not the scene {kept['name']} of the catalogue, which is from "
        "another run."
    )
    return Table(["inputs", *_MEASURES.values()], rows, notes=(_verdict(found), same))


def _admissible(found: dict) -> list[str]:
    """How many points the ranges of the inputs come from, one sentence each."""
    kept, count = found["admissible"], len(found["searches"])
    limit = f"no error of a printed rate or deviation above {found['admissible_deg_s']:g} deg/s"
    if not kept["points"]:
        return [f"None of {count} searches found an admissible set ({limit}): no range is known."]
    return [
        f"Admissible sets ({limit}): {kept['points']} from {kept['searches']} of {count} searches, "
        f"at most {kept['most_of_one']} from one search. Sets of one search are close to each "
        "other, so the true ranges are at least as wide." + _outside(found)
    ]


def _outside(found: dict) -> str:
    """A further sentence if the best set is not admissible."""
    best = found["searches"][found["best"]]
    missed = max(best["largest_error_deg_s"], best["largest_deviation_error_deg_s"])
    note = " The best set is not among them: its misfit includes conditions 1 and 5."
    return note if missed > found["admissible_deg_s"] else ""


def figures(found: dict) -> tuple[Figure, Figure]:
    """Measures of all searches, and rates and deviations of the best set over the printed ones."""
    best, printed = found["searches"][found["best"]], published.sensitivity()
    rates = np.array(best["rates_deg_s"])[1:4]
    deviations = np.array(best["changed_deg_s"]) - rates[:, None, :]
    traded = [_traded(found, *pair) for pair in _PAIRS]
    against = [
        _against("Nine rates, deg/s", printed.baseline, rates),
        _against("54 deviations, deg/s", printed.deviations(), deviations),
    ]
    return (
        Figure(lambda: Chart("paper", traded, columns=3), _TRADED),
        Figure(lambda: Chart("paper_tables", against, columns=2), _BESIDE),
    )


def _traded(found: dict, title: str, across: tuple[str, str], upwards: tuple[str, str]) -> Panel:
    """Panel of two measures (key, label) of every search, with the Pareto front if it is of these
    two."""
    front, best = np.array(found["front"]), found["searches"][found["best"]]
    lines = (
        [Line(front[:, 0], front[:, 1], name="Pareto front", colour=TEAL)]
        if (across, upwards) == (_NINE, _QUIET)
        else []
    )
    known = found["known"]
    for own, name, colour, marker, size in (
        (best, "best set", VERMILION, "D", 17.0),
        (known, f"scene {known['name']}", TEAL, "^", 11.0),
    ):
        place = [own[across[0]]], [own[upwards[0]]]
        lines.append(Line(*place, name=name, colour=colour, dash="", marker=marker, size=size))
    for all_five, name, colour, marker in (
        (False, "search over three conditions", GREY, "s"),
        (True, "search over five conditions", NAVY, "o"),
    ):
        ends = [
            (item[across[0]], item[upwards[0]])
            for item in found["searches"]
            if bool(item["stress"]) is all_five
        ]
        if ends:
            x, y = zip(*ends)
            lines.append(Line(x, y, name=name, colour=colour, dash="", marker=marker))
    return Panel(title, across[1], y_label=upwards[1], lines=lines, log=True)


def _against(title: str, printed: np.ndarray, ours: np.ndarray) -> Panel:
    """Panel of ``ours`` over ``printed`` (..., 3)."""
    ends = [float(min(printed.min(), ours.min())), float(max(printed.max(), ours.max()))]
    points = [
        Line(
            printed[..., axis].ravel(),
            ours[..., axis].ravel(),
            name=f"about {name}",
            colour=colour,
            dash="",
            marker=marker,
        )
        for axis, (name, colour, marker) in enumerate(_AXES)
    ]
    return Panel(
        title,
        "printed",
        y_label="found",
        lines=[Line(ends, ends, name="equal", colour=GREY, dash="--"), *points],
    )


def _table2(best: dict) -> Fold:
    printed, changed = published.sensitivity(), np.array(best["changed_deg_s"])
    nominal = np.array(best["rates_deg_s"])[1:4]
    rows: list[tuple] = []
    for place, condition in enumerate(published.SENSITIVE):
        rows.append((str(condition), "baseline", *_pairs(printed.baseline[place], nominal[place])))
        rows += [
            (str(condition), words, *_pairs(printed.changed[place, row], changed[place, row]))
            for row, words in enumerate(summary.CHANGES)
        ]
    rates = [
        Column(f"{axis}, {kind}", "deg/s", "+.3f")
        for axis in "xyz"
        for kind in ("printed", "found")
    ]
    table = Table(["condition", "constant", *rates], rows, dense=True)
    return Fold("Table 2, printed and found", [table])


def _pairs(printed: np.ndarray, ours: np.ndarray) -> list[float]:
    return [value for pair in zip(printed, ours) for value in pair]


def _deviations(best: dict) -> list[Part]:
    """The 54 deviations, printed and found, and the largest of each axis relative to its rate."""
    printed = published.sensitivity()
    ours = published.Sensitivity(
        np.array(best["rates_deg_s"])[1:4], np.array(best["changed_deg_s"])
    )
    theirs, found = printed.deviations(), ours.deviations()
    rows = [
        (
            str(condition),
            words,
            *(
                f"{first:+.3f} / {second:+.3f}"
                for first, second in zip(theirs[place, row], found[place, row])
            ),
        )
        for place, condition in enumerate(published.SENSITIVE)
        for row, words in enumerate(summary.CHANGES)
    ]
    largest = [
        (kind, *(f"{100.0 * share:.2f} %" for share in table_2.largest_relative()))
        for kind, table_2 in (("printed", printed), ("found", ours))
    ]
    heads = ("condition", "constant", *(f"{axis}, printed / found (deg/s)" for axis in "xyz"))
    return [
        Table(
            ("", "x", "y", "z"),
            largest,
            title="Largest deviation of each axis relative to its rate, conditions 2 and 4; the z "
            "rate of condition 3 is nearly zero.",
        ),
        Fold("54 deviations, printed and found", [Table(heads, rows, dense=True)]),
    ]


def table_at_exit(found: dict) -> Table:
    """Exit state with the best set by condition; a dash if it did not settle."""
    conditions = [
        Column(
            f"{row['condition']} at {row['radial_misalignment_deg']:g} deg"
            + ("" if row["status"] == "exited" else f", {row['status'].replace('_', ' ')}"),
            form=".4g",
        )
        for row in found["conditions"]
    ]
    rows = [
        (f"{item.label} ({item.unit})", *(row[item.name] for row in found["conditions"]))
        for item in answers.ALL
    ]
    return Table(["exit state, condition", *conditions], rows, notes=(_AT_EXIT.format(**found),))


def _verdict(found: dict) -> str:
    limit = found["admissible_deg_s"]
    ends = [
        item
        for item in found["searches"]
        if max(item["largest_error_deg_s"], item["largest_deviation_error_deg_s"]) <= limit
    ]
    quiet = [item for item in ends if item["largest_negligible_deg_s"] <= found["negligible_deg_s"]]
    if quiet:
        return (
            f"Sets of {counted(len(quiet), 'search', 'searches')} fit the printed rates, their "
            f"deviations and the negligible rates within {limit:g} deg/s."
        )
    least = min((size for error, size in found["front"] if error <= limit), default=None)
    if least is None:
        return f"No search fits all nine rates within {limit:g} deg/s."
    return (
        f"Sets of {counted(len(ends), 'search', 'searches')} fit the nine rates and 54 deviations "
        f"within {limit:g} deg/s, none of them with negligible rates on conditions 1 and 5. Where "
        f"the nine rates alone are within the limit, the largest rate on conditions 1 and 5 is at "
        f"least {least:.2g} deg/s."
    )


def _headline(found: dict) -> list[Part]:
    """Cost of one case in both fidelities, in the paper and here."""
    printed, ours = found["headline"], found["ours"]
    springs = "springs, calibrated"
    rows = [
        (
            "the paper",
            "LS-DYNA, 4 million hexahedra",
            f"{printed['high_fidelity_wall_time']} h",
            f"ADAMS, {printed['low_fidelity_wall_time']} s",
            float(printed["speedup"]),
        ),
        (
            f"here, scene {found['scene']}",
            "explicit finite elements",
            ours and f"{ours['highfi_wall_s']:.3g} s",
            f"{springs}, {1e3 * ours['lowfi_wall_s']:.3g} ms" if ours else springs,
            ours and ours["ratio"],
        ),
    ]
    heads: tuple[Column | str, ...] = (
        "",
        "model with flexible rail",
        "wall time of one case",
        "rigid bodies, wall time of one case",
        Column("speed-up", form=",.0f"),
    )
    missing = f"Not measured here yet; `tipoff compare --scene {found['scene']}` measures it."
    return [Table(heads, rows, notes=() if ours else (missing,))]


def table_of_plateaus(found: dict[str, dict[str, str]] | None) -> Table:
    """The size of each error at which the rates stop growing, in the paper, and the verdicts here."""
    printed = published.headline()
    rows = [
        (error, float(printed[f"plateau_starts_{name}"]), *((found or {}).get(name) or _NOT_SWEPT))
        for name, error in _SWEPT.items()
    ]
    notes = () if found else ("Not swept here yet; `tipoff sensitivity --sweep 120` does it.",)
    return Table(("plateau of the rates from", "the paper", *_ABOUT), rows, notes=notes)


def table_of_inputs(found: dict) -> Table:
    """One row for each input of the search."""
    columns: Cells = (
        ("input", lambda item: item["name"].replace("_", " ")),
        ("unit", "unit"),
        ("lower bound", "low"),
        ("upper bound", "high"),
        (Column("best", form=".4g"), "best"),
        ("admissible from", "from"),
        ("admissible to", "to"),
        (Column("share of the bounds", "%", ".0f", 100.0), "share"),
    )
    return Table.of(found["inputs"], columns, notes=tuple(_admissible(found)), dense=True)


def _reasons(found: list[dict]) -> Table:
    rows = [(item["name"].replace("_", " "), item["reason"]) for item in found]
    return Table(["input", "reason for the bounds"], rows)


def _searches(found: list[dict]) -> Table:
    columns = _MEASURES | {"misfit": Column("misfit"), "admissible": Column("admissible sets")}
    rows = [
        (item["seed"] + 1, "five" if item["stress"] else "three", *(item[name] for name in columns))
        for item in found
    ]
    return Table(["search", "conditions", *columns.values()], rows)
