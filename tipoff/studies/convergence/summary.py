"""Results of the convergence study as sentences."""

from tipoff.comparison.extrapolation import NOT_CONVERGED
from tipoff.highfi.numerics import Numerics
from tipoff.studies.agreement import equal_accuracy, verdicts
from tipoff.studies.convergence.quantities import RATE
from tipoff.studies.render.uncertain import LEAST, number


def lines(found: dict) -> list[str]:
    """One sentence for each of: meshes, steps, interface stiffness, contact cells, ripple, equal
    accuracy, where the result ``found`` has it."""
    equal = found["equal_accuracy"]
    return [
        *refinements(found),
        *_changes("interface stiffness, times", "factor", found["interface_stiffness"]),
        *_changes(
            "contact cells along each edge of a pad,", "cells_per_edge", found["contact_cells"]
        ),
        *_ripple(found["ripple"]),
        *([equal_accuracy.sentence(equal)] if equal else []),
    ]


def refinements(found: dict) -> list[str]:
    """Uncertainty of the settled rates by mesh and by step."""
    text, name = [], found["condition"]
    step = (
        f", {Numerics().safety:g} of the step limit on elements of "
        f"{1e3 * found['coarse_size_m']:g} mm"
    )
    for parameter, unit, factor, default in (
        ("element size", "mm", 1e3, ""),
        ("time step", "ns", 1e9, step),
    ):
        rows = [
            row
            for row in found["quantities"]
            if row["parameter"] == parameter and row["quantity"].startswith(RATE)
        ]
        unknown = [row for row in rows if None in (row["nominal_uncertainty"], row["uncertainty"])]
        worst = (unknown or sorted(rows, key=lambda row: row["nominal_uncertainty"]))[-1]
        if unknown:
            text.append(f"{parameter} on {name}: uncertainty unknown, {worst['method']}")
            continue
        text.append(
            f"{parameter} on {name}: uncertainty of the settled rates "
            f"{number(worst['nominal_uncertainty'], '.2g', LEAST)} deg/s at the default "
            f"{factor * worst['nominal_size']:.3g} {unit}{default}, "
            f"{number(max(row['uncertainty'] for row in rows), '.2g', LEAST)} deg/s at "
            f"{factor * worst['sizes'][-1]:.3g} {unit}"
            f"{f'; {NOT_CONVERGED}' if worst['method'] == NOT_CONVERGED else ''}"
        )
    return text


def _changes(title: str, key: str, rows: list[dict]) -> list[str]:
    """Largest change of a settled rate over the ``rows``; none without rows."""
    if not rows:
        return []
    change = verdicts.largest(row["settled_rate_change_deg_s"] for row in rows)
    odd = "".join(
        f"; {row[key]:g} {row['status']}"
        for row in rows
        if row["settled_rate_change_deg_s"] is None
    )
    found = (
        "no run settled"
        if change is None
        else f"a settled rate changes by up to {number(change, '.2g', LEAST)} deg/s"
    )
    return [f"{title} {rows[0][key]:g} to {rows[-1][key]:g}: {found}{odd}"]


def _ripple(rows: list[dict]) -> list[str]:
    """Ripple on the finest mesh; none without rows."""
    return [
        f"ripple of a constant contact force at the facet frequency {row['frequency']:.4g} Hz, "
        f"facets of {1e3 * row['element_size_m']:.3g} mm: {100.0 * row['ripple']:.2g} %"
        for row in rows[-1:]
    ]
