"""Runs of both models on the page: thrust, curves, contact forces, energy."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from tipoff.studies.render.document import Figure, Part
from tipoff.studies.render.table import Column, Table
from tipoff.studies.runs import figures
from tipoff.studies.runs.thrust_facts import thrust_facts

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page

_CURVES = (
    "The paper's Figure 6 for this scene. The colour shows the axis, the line the model. Broad "
    "and pale: finite elements; thin: compliant contact; dashed: springs, calibrated; dotted: "
    "springs before calibration. Right: surrogate minus finite elements. Rates are inertial, in "
    "payload body axes."
)


def settled(rows: list[dict]) -> Table:
    """Velocity and rates of each condition for the terminal, from the ``rows`` of a result file."""
    columns: tuple[Column | str, ...] = (
        "condition",
        "model",
        "status",
        Column("v_x", "m/s", ".4f"),
        *(Column(f"rate {axis}", "deg/s", "+.3f") for axis in "xyz"),
        Column("off axis", "deg", ".3g"),
        Column("took", "s", ".2g"),
    )
    found = []
    for row in rows:
        own = row["settled"] or {}
        found.append(
            (
                row["condition"],
                row["model"],
                row["status"],
                own.get("velocity_m_s", [None])[0],
                *own.get("rate_deg_s", [None] * 3),
                own.get("direction_error_deg"),
                row["wall_s"],
            )
        )
    under = [row["rail_compliance"] for row in rows if row.get("rail_compliance")]
    return Table(columns, found, notes=tuple(dict.fromkeys(own["words"] for own in under)))


def thrust(page: "Page") -> list[Part]:
    """Thrust over time, and its facts."""
    caption = "Thrust over time, the same in all models."
    return [Figure(figures.thrust_curve(page.scene), caption), thrust_facts(page.scene)]


def curves(page: "Page") -> list[Part]:
    """Velocity and rates of all models."""
    fitted = [name for name in page.scene.agreement.fitted if name in page.runs.highfi]
    names = fitted or list(page.runs.highfi)[:5]
    if not names:
        return [page.missing("highfi", "highfi")]
    caption = _CURVES if page.runs.calibrated else f"{_CURVES} There are no runs with springs."
    return [Figure(figures.figure6(page.runs, names), caption)]


def contact(page: "Page") -> list[Part]:
    """Contact forces of one condition."""
    return _of_one_condition(page, _contact)


def _contact(page: "Page", name: str) -> Part:
    chart = figures.contact_forces(page.scene, page.runs, name)
    if not chart.panels:
        return f"No pad carries more than 1 N, condition {name}."
    return Figure(
        chart, f"Magnitude of the force on each pad that touches a rail, condition {name}."
    )


def energy(page: "Page") -> list[Part]:
    """Energy ledgers of one condition."""
    return _of_one_condition(page, _energy)


def _energy(page: "Page", name: str) -> Part:
    return Figure(
        figures.energy_ledgers(page.runs, name),
        f"Energy ledgers, condition {name}. The transverse ledger leaves out the axial motion, so "
        "that small transverse energies are visible. The dashed residual should be zero.",
    )


def _of_one_condition(page: "Page", draw: Callable[["Page", str], Part]) -> list[Part]:
    """What ``draw`` makes of the first refined, fitted or other condition with a run."""
    preferred = [*page.scene.agreement.refined, *page.scene.agreement.fitted, *page.runs.highfi]
    name = next((name for name in preferred if name in page.runs.highfi), None)
    return [page.missing("highfi", "highfi") if name is None else draw(page, name)]
