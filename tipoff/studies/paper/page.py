"""The paper's own numbers on the page: its Table 2 and headline beside ours, the inputs that must
have been, and what they trade."""

import numpy as np

from tipoff.studies import published
from tipoff.studies.paper import summary
from tipoff.studies.populations import answers
from tipoff.studies.render.chart import (
    AMBER,
    GREY,
    NAVY,
    TEAL,
    VERMILION,
    Chart,
    Line,
    Panel,
)
from tipoff.studies.render.document import Figure, Fold, Part
from tipoff.studies.render.table import Column, Table

_AXES = tuple(zip("xyz", (NAVY, VERMILION, AMBER), ("o", "s", "^")))
_NINE = ("largest_error_deg_s", "largest error of nine rates, deg/s")
_QUIET = ("largest_negligible_deg_s", "largest rate, conditions 1 and 5, deg/s")
_DEVIATIONS = ("largest_deviation_error_deg_s", "largest error of 54 deviations, deg/s")
_PAIRS = (
    ("Nine rates, conditions 1 and 5", _NINE, _QUIET),
    ("Nine rates, 54 deviations", _NINE, _DEVIATIONS),
    ("54 deviations, conditions 1 and 5", _DEVIATIONS, _QUIET),
)
_AT_EXIT = (
    "What the best set leaves its rail with, of one more run of each condition, which the radial "
    "misalignment tells "
    "apart. The paper prints rates only, those of conditions 2 to 4. {calibration}"
)


def draw(found: dict) -> list[Part]:
    """The section."""
    trade, beside = charts(found)
    best = found["searches"][found["best"]]
    words = (
        f"The paper prints no geometry, inertia, thrust, friction or clearance. "
        f"{len(found['searches'])} searches over "
        f"{len(found['inputs'])} inputs within physical bounds ask which would give the nine rates "
        f"of its Table 2 and their "
        f"54 deviations, half of them also that no rate of conditions 1 and 5 exceeds "
        f"{found['negligible_deg_s']:g} deg/s, "
        "where the paper speaks of negligible rates and prints none. The best misses a printed "
        "rate by at most "
        f"{best['largest_error_deg_s']:.2g} deg/s and a deviation by "
        f"{best['largest_deviation_error_deg_s']:.2g} deg/s; its "
        "largest rate on conditions 1 and 5 is "
        f"{best['largest_negligible_deg_s']:.2g} deg/s. It is inferred, one of many that would do. "
        f"{in_catalogue(found)}"
    )
    return [
        words,
        Figure(trade, _TRADED),
        _verdict(found),
        Figure(beside, _BESIDE),
        _table2(best),
        *_deviations(best),
        _at_exit(found["exit"]),
        _inputs(found["inputs"]),
        admissible(found),
        Fold("Every search", [_searches(found["searches"])]),
        *_headline(found),
        "On the printed numbers: " + " ".join(found["slips"]),
    ]


_TRADED = (
    "Where searches ended, each with all three: the largest error of the nine printed rates, the "
    "largest error of their 54 "
    "deviations, and the largest rate of conditions 1 and 5, two in each panel. Squares were asked "
    "for three conditions, "
    "circles for all five; the diamond has the least misfit, the triangle is the catalogue's. A "
    "set has all three only if "
    "it lies low and left in every panel. The line of the first panel is the front of all that "
    "searches met on their way, "
    "whatever the deviations there."
)
_BESIDE = (
    "Printed rates (left) and deviations (right) against those of the best set; on the line "
    "they agree."
)


def in_catalogue(found: dict) -> str:
    """Whether the best set is the catalogue's, in words."""
    kept, known = found["catalogue"], found["known"]
    if kept["same"]:
        return f"It is the catalogue's scene {kept['name']}."
    return (
        f"It is not the catalogue's scene {kept['name']}, which another run found; here that "
        f"misses a printed rate by at most "
        f"{known['largest_error_deg_s']:.2g} deg/s and a deviation by "
        f"{known['largest_deviation_error_deg_s']:.2g} deg/s, and "
        f"its largest rate on conditions 1 and 5 is {known['largest_negligible_deg_s']:.2g} deg/s."
    )


def admissible(found: dict) -> str:
    """How much the ranges of the inputs rest on, in words."""
    kept, all_searches = found["admissible"], len(found["searches"])
    limit = (
        f"missing no printed rate and no deviation by more than {found['admissible_deg_s']:g} deg/s"
    )
    if not kept["points"]:
        return (
            f"No set {limit} was met in {all_searches} searches, so that nothing is known of any "
            f"input."
        )
    return (
        f"Admissible sets, {limit}: {kept['points']}, kept from {kept['searches']} of "
        f"{all_searches} searches, "
        f"{kept['most_of_one']} of them from one. Those of one search lie in few basins, so that "
        f"every range is at least so "
        "wide: it shows what is possible and excludes nothing outside it." + _outside(found)
    )


def _outside(found: dict) -> str:
    """A word more where the best set, which counts conditions 1 and 5 too, is not admissible
    itself."""
    best = found["searches"][found["best"]]
    missed = max(best["largest_error_deg_s"], best["largest_deviation_error_deg_s"])
    note = " The best set is none of them: it is best with conditions 1 and 5 counted."
    return note if missed > found["admissible_deg_s"] else ""


def charts(found: dict) -> list[Chart]:
    """What searches trade, and printed against found rates and deviations of the best."""
    best, printed = found["searches"][found["best"]], published.sensitivity()
    rates = np.array(best["rates_deg_s"])[1:4]
    deviations = np.array(best["changed_deg_s"]) - rates[:, None, :]
    return [
        Chart("paper", [_traded(found, *pair) for pair in _PAIRS], columns=3),
        Chart(
            "paper_tables",
            [
                _against("Nine rates, deg/s", printed.baseline, rates),
                _against("54 deviations, deg/s", printed.deviations(), deviations),
            ],
            columns=2,
        ),
    ]


def _traded(found: dict, title: str, across: tuple[str, str], upwards: tuple[str, str]) -> Panel:
    """Panel of two measures (key, label) of every search's end; with the front where it is of these
    two."""
    front, best = np.array(found["front"]), found["searches"][found["best"]]
    lines = (
        [Line(front[:, 0], front[:, 1], "front of all met", TEAL)]
        if (across, upwards) == (_NINE, _QUIET)
        else []
    )
    lines.append(
        Line(
            [best[across[0]]],
            [best[upwards[0]]],
            "best of all",
            VERMILION,
            dash="",
            marker="D",
            size=17.0,
        )
    )
    known = found["known"]
    lines.append(
        Line(
            [known[across[0]]],
            [known[upwards[0]]],
            f"the catalogue's {known['name']}",
            TEAL,
            dash="",
            marker="^",
            size=11.0,
        )
    )
    for asked, name, colour, marker in (
        (False, "three conditions asked", GREY, "s"),
        (True, "all five asked", NAVY, "o"),
    ):
        ends = [
            (item[across[0]], item[upwards[0]])
            for item in found["searches"]
            if bool(item["stress"]) is asked
        ]
        if ends:
            x, y = zip(*ends)
            lines.append(Line(x, y, f"ended, {name}", colour, dash="", marker=marker))
    return Panel(title, across[1], upwards[1], lines, log=True)


def _against(title: str, printed: np.ndarray, ours: np.ndarray) -> Panel:
    """Panel of ``ours`` over ``printed`` (..., 3)."""
    ends = [float(min(printed.min(), ours.min())), float(max(printed.max(), ours.max()))]
    points = [
        Line(
            printed[..., axis].ravel(),
            ours[..., axis].ravel(),
            f"about {name}",
            colour,
            dash="",
            marker=marker,
        )
        for axis, (name, colour, marker) in enumerate(_AXES)
    ]
    return Panel(title, "printed", "found", [Line(ends, ends, "equal", GREY, dash="--"), *points])


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
    """The 54 deviations, printed and ours, and the largest of each axis as a share of its rate."""
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
        for kind, table_2 in (("printed", printed), ("ours", ours))
    ]
    heads = ("condition", "constant", *(f"{axis}, printed / ours (deg/s)" for axis in "xyz"))
    return [
        Table(
            ("", "x", "y", "z"),
            largest,
            title="Largest deviation by axis as a share of the rate, on conditions 2 and 4; about "
            "z that of condition 3 is nearly zero.",
        ),
        Fold("54 deviations, printed and ours", [Table(heads, rows, dense=True)]),
    ]


def _at_exit(found: dict) -> Table:
    """What the best set leaves its rail with, by condition; a dash where it did not settle."""
    rows = [
        (
            str(row["condition"]),
            row["radial_misalignment_deg"],
            row["status"].replace("_", " "),
            *(row[item.name] for item in answers.ALL),
        )
        for row in found["conditions"]
    ]
    heads: tuple[Column | str, ...] = (
        "condition",
        Column("radial misalignment", "deg", "g"),
        "ended",
        *(Column(item.label, item.unit) for item in answers.ALL),
    )
    return Table(heads, rows, (_AT_EXIT.format(**found),), dense=True)


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
            f"{len(quiet)} searches met all within {limit:g} deg/s: printed rates, their "
            f"deviations and negligible ones can "
            "hold together."
        )
    least = min((size for error, size in found["front"] if error <= limit), default=None)
    if least is None:
        return (
            f"No search met all nine rates within {limit:g} deg/s; the figure shows how close they "
            f"came, and at which rates of "
            "conditions 1 and 5."
        )
    return (
        f"{len(ends)} searches ended within {limit:g} deg/s of all nine rates and 54 deviations, "
        f"none of them with negligible "
        f"rates on conditions 1 and 5. Where nine rates are met as closely, whatever the "
        f"deviations, the least largest rate "
        f"met there is {least:.2g} deg/s."
    )


def _headline(found: dict) -> list[Part]:
    """Cost of one case in both fidelities, the paper's beside ours."""
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
        "flexible rail",
        "one case",
        "rigid bodies, one case",
        Column("times as fast", form=",.0f"),
    )
    missing = f"Ours is not measured yet: `make compare SCENE={found['scene']}` does it."
    return [Table(heads, rows), "" if ours else missing]


def _inputs(found: list[dict]) -> Table:
    rows = [
        (
            item["name"].replace("_", " "),
            item["unit"],
            item["low"],
            item["high"],
            item["best"],
            item["from"],
            item["to"],
            item["share"] and f"{100.0 * item['share']:.0f} %",
            item["reason"],
        )
        for item in found
    ]
    heads: tuple[Column | str, ...] = (
        "input",
        "unit",
        "bound from",
        "to",
        Column("best", form=".4g"),
        "admissible at least from",
        "to",
        "of the bounds, at least",
        "why these bounds",
    )
    return Table(heads, rows, dense=True)


def _searches(found: list[dict]) -> Table:
    columns: dict[str, Column | str] = {
        "largest_error_deg_s": Column("largest error of nine rates", "deg/s"),
        "largest_negligible_deg_s": Column("largest rate, conditions 1 and 5", "deg/s"),
        "largest_deviation_error_deg_s": Column("largest error of 54 deviations", "deg/s"),
        "misfit": "misfit",
        "admissible": "admissible points kept",
    }
    rows = [
        (
            item["seed"] + 1,
            "five" if item["stress"] else "three",
            *(item[name] for name in columns),
        )
        for item in found
    ]
    return Table(["search", "conditions asked", *columns.values()], rows)
