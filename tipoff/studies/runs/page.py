"""Runs of both models on the page: thrust, curves, contact forces, energy."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from tipoff.mechanics import instant
from tipoff.results.model_error import Range
from tipoff.studies.render.document import Figure, Fold, Part
from tipoff.studies.render.table import Column, Table
from tipoff.studies.runs import figures
from tipoff.studies.runs.results import AtExit, ConditionRun, Settled
from tipoff.studies.runs.thrust_facts import thrust_facts
from tipoff.uncertain import LEAST, STEPS, range_of

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_CURVES = (
    "The paper's Figure 6 for this scene. The colour shows the axis, the line the model. Broad "
    "and pale: finite elements; thin: compliant contact; dashed: springs, calibrated; dotted: "
    "springs before calibration. Right: surrogate minus finite elements. Rates are inertial, in "
    "payload body axes."
)


_Cells = tuple[Column | str, Callable[[Any], Any]]
RANGES = "A range in place of a value: the run is sensitive, and the range is that of runs within 1 µm of clearance."


def draw(rows: Sequence[ConditionRun]) -> list[Part]:
    """Velocity and rates of each condition, at the instant that counts."""
    under = [row.rail_compliance["words"] for row in rows if row.rail_compliance]
    notes = tuple(dict.fromkeys(under))
    if any(row.range for row in rows):
        notes += (RANGES,)
    return [Table.of_records(rows, *_SETTLED, notes=notes, kind=ConditionRun)]


def _of_taken(
    head: Column,
    cell: Callable[[Settled | AtExit], Any],
    ends: Callable[[Range], tuple[float, float]],
    least: float = LEAST,
) -> _Cells:
    """A column of values at the instant that counts, or of the ranges of sensitive runs."""

    def shown(row: ConditionRun) -> Any:
        if row.range is not None:
            return range_of(*ends(row.range), least=least)
        return row.taken and cell(row.taken)

    return head, shown


def _about(axis: int) -> _Cells:
    return _of_taken(
        Column(f"rate {'xyz'[axis]}", "deg/s", "+.3f"),
        lambda own: own.rate_deg_s[axis],
        lambda found: (found.low_deg_s[axis], found.high_deg_s[axis]),
    )


_SETTLED: tuple[str | _Cells, ...] = (
    *("condition", "model", "status"),
    (Column("values"), lambda row: instant.where(row.at) if row.taken else None),
    _of_taken(
        Column("v_x", "m/s", ".4f"),
        lambda own: own.velocity_m_s[0],
        lambda found: (found.low_m_s[0], found.high_m_s[0]),
        STEPS["m/s"],
    ),
    *map(_about, range(3)),
    _of_taken(
        Column("off axis", "deg", ".3g"),
        lambda own: own.direction_error_deg,
        lambda found: found.off_axis_deg,
    ),
    (
        Column("rate at exit x, y, z", "deg/s", "+.3f"),
        lambda row: None if row.range else row.at_exit and row.at_exit.rate_deg_s,
    ),
    (Column("impulse after exit", "%", ".2g", 100.0), lambda row: row.impulse_after_exit),
    "wall_s",
)


def thrust(page: "Page") -> list[Part]:
    """Thrust over time, and its facts."""
    caption = "Thrust over time, the same in all models."
    return [Figure(lambda: figures.thrust_curve(page.scene), caption), thrust_facts(page.scene)]


def curves(page: "Page") -> list[Part]:
    """Velocity and rates of all models over time, and their values."""
    tables = [part for rows in page.rows().values() if rows for part in draw(rows)]
    values: list[Part] = [Fold("Values of each condition", tables)] if tables else []
    fitted = [name for name in page.scene.agreement.fitted if name in page.runs.highfi]
    names = fitted or list(page.runs.highfi)[:5]
    if not names:
        return [page.missing("highfi", "highfi"), *values]
    caption = _CURVES if page.runs.calibrated else f"{_CURVES} There are no runs with springs."
    return [Figure(lambda: figures.figure6(page.runs, names), caption), *values]


def contact(page: "Page") -> list[Part]:
    """Contact forces of one condition."""
    return _of_one_condition(page, _contact)


def _contact(page: "Page", name: str) -> Part:
    chart = figures.contact_forces(page.scene, page.runs, name)
    if not chart.panels:
        return f"No pad carries more than 1 N, condition {name}."
    return Figure(
        lambda: chart, f"Magnitude of the force on each pad that touches a rail, condition {name}."
    )


def energy(page: "Page") -> list[Part]:
    """Energy ledgers of one condition."""
    return _of_one_condition(page, _energy)


def _energy(page: "Page", name: str) -> Part:
    return Figure(
        lambda: figures.energy_ledgers(page.runs, name),
        f"Energy ledgers, condition {name}. The transverse ledger leaves out the axial motion, so "
        "that small transverse energies are visible. The dashed residual should be zero.",
    )


def _of_one_condition(page: "Page", draw: Callable[["Page", str], Part]) -> list[Part]:
    """The parts that ``draw`` makes of the first refined, fitted or other condition with a run."""
    preferred = [*page.scene.agreement.refined, *page.scene.agreement.fitted, *page.runs.highfi]
    name = next((name for name in preferred if name in page.runs.highfi), None)
    return [page.missing("highfi", "highfi") if name is None else draw(page, name)]
