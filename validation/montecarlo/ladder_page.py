"""What accuracy costs in time over the draws, by settings of the surrogate: on the page and for the
terminal. Nothing where the rails have no modes."""

from tipoff.lowfi.numerics import AUTO, Numerics
from tipoff.mechanics.model_names import SPRINGS
from tipoff.studies.populations import answers
from tipoff.studies.render.chart import Chart, Line, Panel
from tipoff.studies.render.document import Figure, Part
from tipoff.studies.render.palette import GREY, NAVY, VERMILION
from tipoff.studies.render.table import Table, number, percent
from tipoff.workspace.words import counted
from validation.montecarlo.results import ByRung, Tails

_RATES = tuple(item.name for item in answers.RATES)
_NOTE = (
    "Errors are those of single runs on the mesh of the reference, and the largest of the three "
    "axes. Times are means over the draws, of one core. Case by case: the default of a single run, "
    "with the runs that choose the modes. Case of a population: all its cases have this number of "
    "modes, and their steps are longer."
)
_CAPTION = (
    "Each point is one choice of the surrogate's settings in all {paired} draws. The square is the "
    "reference on {coarse:g} mm, against {fine:g} mm in {count} draws."
)


def best(found: Tails) -> list[str]:
    """The settings that agree in the most draws, with their cost."""
    rows = [row for row in found.ladder.rows if row.within_gate] if found.ladder else []
    if not rows:
        return []
    row = max(rows, key=lambda each: (each.within_gate or 0.0, -each.cpu_s))
    return [
        f"At the surrogate's best settings ({setting(row, found)}) "
        f"{percent(row.within_gate, '.0f')} % of the draws agree. The median difference is then "
        f"{number(row.median, '.2g')} deg/s, and a run takes {1e3 * row.cpu_s:.2g} ms"
    ]


def sentences(found: Tails) -> list[str]:
    """How many draws choose modes, and what these change; nothing where the rails have none."""
    if (own := found.ladder) is None:
        return []
    draws, choosing = counted(found.draws, "draw"), own.choosing
    if not choosing:
        return [f"none of {draws} chooses rail modes for itself"]
    return [
        f"{choosing} of {draws} choose rail modes for themselves, {own.choosing_all} of them "
        f"all {own.held}. In the median, these modes change a rate of such a draw by "
        f"{number(own.moved_deg_s, '.2g')} deg/s, and {1e6 * own.clearance_change_m:g} µm "
        f"more of every clearance changes it by {number(own.moved_by_clearance_deg_s, '.2g')} "
        f"deg/s. In {own.more_by_clearance} of the {choosing} the clearance changes it more"
    ]


def table(found: Tails) -> list[Part]:
    """Agreement and cost by settings of the surrogate; nothing where the rails have no modes."""
    if (by := found.ladder) is None:
        return []
    gate = f"within {found.gate_deg_s:g} deg/s (%)"
    return [
        Table.of_records(
            by.rows,
            ("surrogate", lambda row: setting(row, found)),
            (gate, lambda row: percent(row.within_gate, ".1f")),
            *("median", "most_95", "most", "cpu_s", "case_s"),
            notes=(_NOTE,),
        )
    ]


def setting(row: ByRung, found: Tails) -> str:
    """A choice of settings in words."""
    assert found.ladder is not None
    if row.model == SPRINGS:
        return "calibrated springs"
    if row.modes == AUTO:
        return "modes case by case"
    count = int(row.modes)
    modes = {0: "no modes", found.ladder.held: f"all {count} modes"}.get(
        count, counted(count, "mode")
    )
    degree = f"degree {row.degree}, " if row.degree else ""
    if row.cells != Numerics().cells:
        return f"{degree}{row.cells} cells, {modes}"
    return (
        f"{degree}{modes}{', as the population' if row.modes == found.modes and not degree else ''}"
    )


def figures(found: Tails) -> list[Figure]:
    """Error over time of one run, from springs to finite elements."""
    if (by := found.ladder) is None:
        return []
    rows = [row for row in by.rows if row.median and row.most_95]
    lines = [
        _points(rows, "most_95", "95 % of the draws below", VERMILION, "^"),
        _points(rows, "median", "median of the draws", NAVY, "o"),
        *(_named(found, row) for row in rows),
    ]
    change = [row.mesh.median for row in found.errors if row.name in _RATES and row.mesh]
    if change:
        lines.append(
            Line(
                [found.cost.reference_cpu_s],
                [max(change)],
                name="finite elements, median change by the finer mesh",
                colour=GREY,
                dash="",
                marker="s",
            )
        )
    panel = Panel(
        "What accuracy costs, over random ejections",
        "processor time of one run (s)",
        "error of the settled rates (deg/s)",
        lines,
        log=True,
    )
    caption = _CAPTION.format(
        paired=found.paired,
        coarse=1e3 * found.element_size_m,
        fine=1e3 * found.fine_element_size_m,
        count=found.fine,
    )
    return [Figure(lambda: Chart("ladder", [panel], height=420), caption)]


def _points(rows: list[ByRung], error: str, name: str, colour: str, marker: str) -> Line:
    """The errors of all settings over their times."""
    y = [getattr(row, error) for row in rows]
    return Line([row.cpu_s for row in rows], y, name=name, colour=colour, dash="", marker=marker)


def _named(found: Tails, row: ByRung) -> Line:
    """The name of a setting at its median, above, below or before it, so that names do not
    overlap."""
    assert found.ladder is not None
    beside = "top right"
    if row.model == SPRINGS or (row.degree and row.modes == found.ladder.held):
        beside = "bottom right"
    elif row.degree or row.modes not in (0, AUTO, found.modes, found.ladder.held):
        beside = "bottom left"
    return Line(
        [row.cpu_s],
        [row.median or 0.0],
        name="",
        dash="",
        legend=False,
        labels=(setting(row, found).removesuffix(", as the population"),),
        beside=beside,
    )
