"""The draws by rail modes: one number for all draws, beside the modes that each draw chooses."""

from tipoff.lowfi.numerics import AUTO
from tipoff.studies.render.document import Part
from tipoff.studies.render.table import Cells, Column, Table, number, percent
from tipoff.workspace.words import counted

_NOTE = (
    "Errors are those of single runs on the mesh of the reference, and the largest of the three "
    "axes. Times are means over the draws, of one core. Single run: case by case, it includes "
    "the runs that choose the modes. Case of a population: all its cases have this number of "
    "modes, and their steps are longer."
)


def table(found: dict) -> list[Part]:
    """Agreement and cost by rail modes; nothing where the rails have none."""
    if not (own := found.get("own_modes")):
        return []
    columns: Cells = (
        ("modes of each rail", lambda row: _words(row["modes"], own["held"], found["modes"])),
        (
            f"within {found['gate_deg_s']:g} deg/s (%)",
            lambda row: percent(row["within_gate"], ".1f"),
        ),
        (Column("median error", "deg/s", ".2g"), "median"),
        (Column("largest", "deg/s", ".2g"), "most"),
        (Column("single run", "ms", ".2g"), lambda row: 1e3 * row["cpu_s"]),
        (
            Column("case of a population", "ms", ".2g"),
            lambda row: None if row["case_s"] is None else 1e3 * row["case_s"],
        ),
    )
    return [Table.of(own["rows"], columns, notes=(_NOTE,))]


def sentences(found: dict) -> list[str]:
    """How many draws choose modes, and what these change; nothing where the rails have none."""
    if not (own := found.get("own_modes")):
        return []
    draws, choosing = counted(found["draws"], "draw"), own["choosing"]
    if not choosing:
        return [f"none of {draws} chooses rail modes for itself"]
    return [
        f"{choosing} of {draws} choose rail modes for themselves, {own['choosing_all']} of them "
        f"all {own['held']}. In the median, these modes change a rate of such a draw by "
        f"{number(own['moved_deg_s'], '.2g')} deg/s, and {1e6 * own['clearance_change_m']:g} µm "
        f"more of every clearance changes it by {number(own['moved_by_clearance_deg_s'], '.2g')} "
        f"deg/s. In {own['more_by_clearance']} of the {choosing} the clearance changes it more"
    ]


def _words(modes: int | str, held: int, population: int) -> str:
    if modes == AUTO:
        return "case by case"
    words = {0: "none", held: f"all {held}"}.get(int(modes), str(modes))
    return f"{words}, as the population" if modes == population else words
