"""Runs of both models on the page: thrust, curves, contact forces, energy."""

from typing import TYPE_CHECKING

from tipoff.studies.render.markup import Html, paragraph, section
from tipoff.studies.report.inputs import thrust_facts
from tipoff.studies.runs import figures

if TYPE_CHECKING:
    from tipoff.studies.report.page import Page


def thrust(page: "Page") -> Html:
    """Thrust over time, and its facts."""
    return section(
        "thrust",
        "Thrust",
        page.figure(figures.thrust_curve(page.scene), "Thrust as both models apply it."),
        thrust_facts(page.scene),
    )


def curves(page: "Page") -> Html:
    """Velocity and rates of all models."""
    names = [name for name in page.scene.agreement.fitted if name in page.runs.highfi] or list(
        page.runs.highfi
    )[:5]
    if not names:
        return section("figure6", "Velocity and rates", page.missing("highfi", "highfi"))
    words = (
        "The paper's Figure 6 for this scene. Broad pale lines: finite elements. Thin lines: "
        "compliant contact. Dashed: "
        "springs, calibrated. Dotted: springs before calibration. Rates are inertial, in "
        "payload body axes. " + ("" if page.runs.calibrated else "Springs are missing.")
    )
    return section(
        "figure6",
        "Velocity and rates, all models",
        page.figure(figures.figure6(page.runs, names), words),
    )


def contact(page: "Page") -> Html:
    """Contact forces of one condition."""
    name = _condition(page)
    if name is None:
        return section("contact-forces", "Contact forces", page.missing("highfi", "highfi"))
    chart = figures.contact_forces(page.scene, page.runs, name)
    if not chart.panels:
        return section(
            "contact-forces",
            "Contact forces",
            paragraph(f"No pad carries more than 1 N on {name}."),
        )
    return section(
        "contact-forces",
        "Contact forces",
        page.figure(
            chart, f"Magnitude of the force on each pad that is touched, condition {name}."
        ),
    )


def energy(page: "Page") -> Html:
    """Energy ledgers of one condition."""
    name = _condition(page)
    if name is None:
        return section("energy", "Energy", page.missing("highfi", "highfi"))
    return section(
        "energy",
        "Energy ledgers",
        page.figure(
            figures.energy_ledgers(page.runs, name),
            f"Condition {name}. The transverse ledger leaves out the axial motion, "
            "so that its hundreds of joules cannot hide the millijoules that decide the rates. "
            "The dashed residual should lie on "
            "zero.",
        ),
    )


def _condition(page: "Page") -> str | None:
    """The condition that is shown alone."""
    preferred = [*page.scene.agreement.refined, *page.scene.agreement.fitted, *page.runs.highfi]
    return next((name for name in preferred if name in page.runs.highfi), None)
